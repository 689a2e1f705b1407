// A reduction of the interface of a reduced body.
#pragma once

#include "substructures/reduction/craig_bampton.hpp"

namespace stridor {

/// A body whose interface moves in its lowest characteristic constraint modes,
///
///   q_b = X p,   K_bb X = M_bb X diag(ν),   Xᵀ M_bb X = I
///
/// in the place of the displacement of every DoF of the interface (Castanier, Tan and Pierre 2001;
/// docs/theory.md, 1.2). K_bb and M_bb are the blocks of the interface of a Craig-Bampton reduction, so
/// that these modes are those of the body with its fixed-interface modes at rest. Frequencies come out at
/// or above those of the reduction with all DoFs; what the modes left out add to the static flexibility
/// between points of the interface is lost, which ReductionError shows.
///
/// @param body  as make_craig_bampton() gives it
/// @param count modes kept, at most as many as there are DoFs of the interface; all of them change
///              nothing but the coordinates
/// @throws std::invalid_argument if `count` is out of range
/// @throws NumericalError if the mass of the interface is not positive definite
/// Cost: 4 n_b³ operations and more.
ReducedBody with_interface_modes(const ReducedBody& body, Eigen::Index count);

/// Coordinates of the interface that displace its DoFs as near to `displacements` as they can.
/// @param displacements of the DoFs of the interface
Eigen::VectorXd interface_coordinates(const ReducedBody& body,
                                      const Eigen::VectorXd& displacements);

/// Columns of the displacements of DoFs per coordinate of a body, from those per DoF of the interface and
/// fixed-interface mode.
Eigen::MatrixXd in_interface_modes(const ReducedBody& body, const Eigen::MatrixXd& columns);

}  // namespace stridor
