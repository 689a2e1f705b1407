// Initial motions of a body, from the values prescribed.
#pragma once

#include <Eigen/Core>
#include <span>

#include "substructures/modal_body.hpp"

namespace stridor {

/// The displacement (or velocity) of one row of ReducedBody::rows.
struct PrescribedRow {
  int row = 0;
  double value = 0.0;
};

/// The shape of least strain energy ½ qᵀ K q with rows q as prescribed, in reduced coordinates; of
/// several such shapes the smallest.
///
/// @throws NumericalError if the rows cannot take these values, because a support holds them or
/// they
///         contradict each other
Eigen::VectorXd static_shape(const ModalBody& body, std::span<const PrescribedRow> prescribed);

}  // namespace stridor
