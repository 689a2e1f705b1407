// Points on the faces of spinning bodies while the bodies move.
#pragma once

#include "solvers/contact/face_point.hpp"

namespace stridor {

/// On a place of the face of a spinning body, which stays where it is (docs/theory.md, 10.2).
class SpinningPoint : public FacePoint {
 public:
  SpinningPoint(const ContactPoint& point, Propagator& slave, Propagator& master, int slave_port,
                int master_port);

  bool find(double sought) override;
  std::optional<Eigen::Vector2d> stand(const System& system, const FaceInstant& at) override;
  double predicted_gap() const override;
  double gap_ahead(const FaceInstant& at) const override;
  double present_gap(double now) const override;
  double position() const override;
  Eigen::Vector2d predicted_slip(const FaceInstant& at) const override;
  Eigen::Vector2d expected_slip(const FaceInstant& at) const override;
  Eigen::Vector2d slip_ahead(const FaceInstant& at) const override;
  Eigen::Vector2d follow(const FaceInstant& at) override;
  Eigen::Vector2d drawn_velocity(double /*time*/) const override { return {face_.sliding, 0.0}; }
  Eigen::Vector2d drawn(double from, double step) const override;
  double lifted(double /*from*/, double /*step*/) const override { return 0.0; }
  FaceDirections directions(double step) const override;
  FaceDirections directions_at_rest(double step) const override;
  std::vector<double> numbers() const override;
  void restore(std::span<const double> numbers) override;
  std::string where() const override;

 private:
  FacePorts ports(const double* slave, const double* master) const;
  FacePorts predicted() const { return ports(slave().predicted(), master().predicted()); }
  FacePorts expected() const { return ports(slave().expected(), master().expected()); }
  FacePorts current() const { return ports(slave().current(), master().current()); }
  FacePorts ahead() const { return ports(slave().ahead(), master().ahead()); }
  void direct(const FacePorts& ports);
  FaceDirections directions_along(const FacePorts& normal, const FacePorts& along,
                                  double step) const;

  FaceKinematics face_;
  FacePorts directed_at_ = FacePorts::Zero();
  FacePorts bent_normal_, bent_along_;         ///< n + A y and b + B y
  FacePorts reached_ = FacePorts::Zero();  ///< y at the last instant that is known whole
};

}  // namespace stridor
