// Nodes and directions of bodies where a scene puts them, in space.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "models/face_seats.hpp"
#include "models/placed_model.hpp"

namespace stridor {

/// Out of the rigid plane or the first facet that a contact in space touches, of length 1; nothing
/// of other contacts.
std::optional<Eigen::Vector3d> normal_in_space(const System& system, const ContactPoint& contact);

/// The bodies of a scene at rest, before a drive has moved them. Plates and the bodies on their
/// faces are rolled into space, with the axis along z (FaceSeat).
class PlacedBodies {
 public:
  /// @param model must outlive this
  explicit PlacedBodies(const PlacedModel& model);

  /// Of every node of a body of PlacedModel::bodies, m, a row each; none of a master without end.
  const Eigen::MatrixX3d& nodes(std::size_t body) const { return nodes_[body]; }
  Eigen::Vector3d node(std::size_t body, int number) const {
    return nodes_[body].row(number).transpose();
  }
  /// A place in the frame of a body, m, in space.
  Eigen::Vector3d at(std::size_t body, const Eigen::Vector3d& in_body) const;
  /// A direction of the frame of a body at a place of that frame, in space.
  Eigen::Vector3d direction(std::size_t body, const Eigen::Vector3d& in_body,
                            Eigen::Vector3d along) const;
  /// Of a plate and of what stands on one.
  const std::optional<FaceSeat>& seat(std::size_t body) const { return seats_[body]; }
  bool has_faces() const { return has_faces_; }
  /// Out of the master of a contact at its slave, of length 1; nothing of contacts in space.
  std::optional<Eigen::Vector3d> normal_of(const ContactPoint& contact) const;
  /// From a spring towards the ground that holds it: the ground is where no master is, on the side
  /// to which the master's normal points.
  Eigen::Vector3d ground_side(std::size_t body, const BodySpring& spring) const;

 private:
  Eigen::Vector3d unrolled(std::size_t body, const Eigen::Vector3d& in_body) const;

  const PlacedModel* model_;
  std::vector<std::optional<FaceSeat>> seats_;
  std::vector<Eigen::MatrixX3d> nodes_;
  bool has_faces_ = false;
};

}  // namespace stridor
