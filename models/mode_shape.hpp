// Motions of a system on all nodes of its bodies.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "models/body_cache.hpp"
#include "models/face_seats.hpp"
#include "models/model.hpp"
#include "solvers/equilibrium/equilibrium.hpp"
#include "substructures/reduction/recovery.hpp"

namespace stridor {

/// The bodies of a model with the matrices that give every node of them from their reduced
/// coordinates. A rigid master has no nodes and is left out. Plates and the bodies on their faces
/// are rolled into space, with the axis along z (FaceSeat).
class ShapeRecovery {
 public:
  /// @param model must outlive this
  /// Cost: a reduction of every body.
  ShapeRecovery(const Model& model, BodyCache& cache);

  /// Bodies about where they are.
  /// @param displaced along x of every body of the system by its drive, m
  /// @param still     reduced coordinates of every body of the system that displace the places of its
  ///                  nodes; empty for none
  /// @param moving    those that become BodyShape::displacement
  /// @throws std::invalid_argument if there are not as many as bodies
  std::vector<BodyShape> shapes(const std::vector<double>& displaced,
                                const std::vector<Eigen::VectorXd>& still,
                                const std::vector<Eigen::VectorXcd>& moving) const;
  /// A mode about an equilibrium, as mode_shape() gives it. @throws as mode_shape()
  std::vector<BodyShape> mode(const Equilibrium& equilibrium, const Eigen::VectorXcd& mode) const;

 private:
  struct Part {
    std::size_t body = 0;  ///< of the system
    BodyMatrices matrices;
    Eigen::MatrixXd recovery;
    BodyShape rest;                ///< without displacement, on a plate in the unrolled frame
    std::optional<FaceSeat> seat;  ///< of plates and of what stands on their faces
  };
  const Model* model_;
  std::vector<Part> parts_;
};

/// A mode about an equilibrium, on the meshes of the bodies.
///
/// @param equilibrium of its system, which gives the positions of nodes; the bodies that follow the
///                    drive are displaced by it. In the undeformed geometry they are not deformed
/// @param mode        q, modal coordinates of all bodies in their order
/// @throws std::invalid_argument if `mode` is not as long as the bodies have modes
/// Cost: a reduction of every body.
std::vector<BodyShape> mode_shape(const Model& model, const Equilibrium& equilibrium,
                                  const Eigen::VectorXcd& mode, BodyCache& cache);

}  // namespace stridor
