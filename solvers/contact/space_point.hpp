// Points on rigid planes and on facets of bodies while the bodies move.
#pragma once

#include "solvers/contact/face_point.hpp"

namespace stridor {

/// On a rigid plane or on facets, from one to the next as the slave slides (docs/theory.md, 2.7).
class SpacePoint : public FacePoint {
 public:
  /// Parameters as make_space_point().
  SpacePoint(const ContactPoint& point, const FacetSurface* surface, NodePorts* nodes,
             const DrivenMotion& driven, Propagator& slave, Propagator& master, int slave_port);

  bool find(double sought) override;
  std::optional<Eigen::Vector2d> stand(const System& system, const FaceInstant& at) override;
  double predicted_gap() const override;
  double gap_ahead(const FaceInstant& at) const override;
  double present_gap(double now) const override;
  int facet() const override { return place_.facet; }
  double position() const override;
  Eigen::Vector2d predicted_slip(const FaceInstant& at) const override;
  Eigen::Vector2d expected_slip(const FaceInstant& at) const override;
  Eigen::Vector2d slip_ahead(const FaceInstant& at) const override;
  Eigen::Vector2d follow(const FaceInstant& at) override;
  Eigen::Vector2d drawn_velocity(double time) const override;
  Eigen::Vector2d drawn(double from, double step) const override;
  double lifted(double from, double step) const override;
  FaceDirections directions(double step) const override;
  std::vector<double> numbers() const override;
  void restore(std::span<const double> numbers) override;
  std::string where() const override;

 private:
  TangentPorts predicted() const { return gathered(slave().predicted(), master().predicted()); }
  TangentPorts expected() const { return gathered(slave().expected(), master().expected()); }
  TangentPorts current() const { return gathered(slave().current(), master().current()); }
  TangentPorts ahead() const { return gathered(slave().ahead(), master().ahead()); }

  /// Watches the nodes of the present facet.
  void watch_facet();
  /// Projects the slave on the facet under it. @returns false where there is none
  /// @param displacements of the ports, after the nodes of the facet are watched
  template <class Displacements>
  bool search(double displaced, const Displacements& displacements);
  /// Geometry and rows at the present place for displacements of the ports.
  void direct(double displaced, const TangentPorts& ports);
  Eigen::Vector3d from_origin(const Eigen::Vector3d& local) const;
  Eigen::Vector2d tangential(const Eigen::Vector3d& vector) const;
  Eigen::Vector2d slip_since_reached() const;
  Eigen::Vector2d slip_to(const TangentPorts& ports, double displaced) const;
  /// Slip in a step by drives that hold the slave in place.
  Eigen::Vector2d frozen_slip(double from, double step) const;
  /// Slip in a step by the spin of the master, from the last instant known whole on.
  Eigen::Vector2d carried_slip(double step) const {
    return 0.5 * step * tangential(carried_ + geometry_.carried);
  }
  bool is_carried() const { return surface_ != nullptr && !surface_->spin.isZero(0.0); }

  const FacetSurface* surface_;
  NodePorts* nodes_;
  int number_ = 0;  ///< among the contacts on these
  DrivenMotion driven_;
  FacetPlace place_;
  // At the displacements to which directions belong.
  TangentPorts directed_at_;
  double displaced_ = 0.0;  ///< of the slave against the master in +x by drives, m
  SpaceGeometry geometry_;
  /// Material place of the undeformed master under the slave at the last instant known whole, m.
  Eigen::Vector3d reached_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d carried_ = Eigen::Vector3d::Zero();  ///< SpaceGeometry::carried then, m/s
};

}  // namespace stridor
