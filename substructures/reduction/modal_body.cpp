#include "substructures/reduction/modal_body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/activity.hpp"
#include "core/errors.hpp"
#include "substructures/matrices/massless_motions.hpp"
#include "substructures/matrices/symmetric_eigenpairs.hpp"

namespace stridor {
namespace {

/// V += diag(ω)^(-1/2) Φᵀ (Σ η K) Φ diag(ω)^(-1/2): the viscous damping by which every mode loses at
/// its own frequency what the complex stiffness takes from it (docs/theory.md, 1.7).
void add_structural_damping(const Eigen::MatrixXd& loss_stiffness, ModalBody& modal) {
  const Eigen::Index n = modal.size();
  // A rigid motion strains nothing.
  const Eigen::VectorXd weights =
      (modal.omega.array() > 0.0)
          .select(modal.omega.cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse(),
                  0.0);
  const Eigen::MatrixXd shapes = modal.shapes * weights.asDiagonal();
  if (modal.coupled.is_empty())
    modal.coupled = {Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n)};
  modal.coupled.velocity += shapes.transpose() * loss_stiffness * shapes;
}

}  // namespace

namespace {

/// Of motions without mass, the frequency over the highest of the others. Response of theirs at ω is
/// wrong by (ω/ω_max)²/1e4, which for what is of interest is far below the rest.
constexpr double quasi_static_ratio = 100.0;

/// Of motions without mass those that rows see, as modes of a frequency far above all others: q = φ
/// with φᵀ M φ = 1 for a mass that is put there, ω² = φᵀ K φ. Their flexibility φφᵀ/ω² is exact.
Eigen::MatrixXd quasi_static_modes(const SemidefinitePairs& pairs, const Eigen::MatrixXd& rows,
                                   double omega) {
  if (pairs.massless.cols() == 0 || rows.rows() == 0) return pairs.massless.leftCols(0);
  // Turned so that the last ones are those that no row sees, which nothing ever moves by itself.
  const Eigen::MatrixXd seen = rows * pairs.massless;
  const SymmetricEigenpairs flexibility =
      symmetric_eigenpairs(seen.transpose() * seen, "motions without mass");
  const double largest = flexibility.values(flexibility.values.size() - 1);
  constexpr double rounding = 1e-14;
  const auto count =
      largest > 0.0 ? (flexibility.values.array() > rounding * largest).count() : Eigen::Index{0};
  return omega * pairs.massless * flexibility.vectors.rightCols(count);
}

}  // namespace

ModalBody make_modal(const ReducedBody& body) {
  const Activity solving(fmt::format("all modes of {} unknowns", body.size()));
  const SemidefinitePairs pairs =
      semidefinite_eigenpairs(body.stiffness, body.mass, "modal form");
  constexpr double rigid_ratio = 1e-6;
  const Eigen::VectorXd& squares = pairs.values;
  const double largest = squares.size() > 0 ? squares(squares.size() - 1) : 0.0;
  const double rigid_below = rigid_ratio * rigid_ratio * largest;

  ModalBody modal;
  modal.damping = body.damping;
  modal.omega.resize(squares.size());
  for (Eigen::Index i = 0; i < squares.size(); ++i) {
    const double rounding =
        body.interface_rounding * pairs.vectors.col(i).head(body.num_interface).squaredNorm();
    if (squares(i) < -std::max(rigid_below, rounding)) {
      throw NumericalError(Refusal::singular,
                           fmt::format("modal form: mode {} has the negative stiffness {:.3e} 1/s²",
                                       i + 1, squares(i)));
    }
    modal.omega(i) = squares(i) <= rigid_below ? 0.0 : std::sqrt(squares(i));
  }
  modal.shapes = pairs.vectors;
  if (pairs.massless.cols() > 0) {
    if (!(largest > 0.0))
      throw NumericalError(Refusal::singular,
                           "modal form: no motion has both mass and stiffness, though some have no "
                           "mass");
    const double omega = quasi_static_ratio * std::sqrt(largest);
    const Eigen::MatrixXd quasi_static = quasi_static_modes(pairs, body.rows, omega);
    const Eigen::Index num_modes = squares.size() + quasi_static.cols();
    modal.omega.conservativeResize(num_modes);
    modal.omega.tail(quasi_static.cols()).setConstant(omega);
    modal.shapes.conservativeResize(Eigen::NoChange, num_modes);
    modal.shapes.rightCols(quasi_static.cols()) = quasi_static;
  }
  modal.rows = body.rows * modal.shapes;
  if (body.base_inertia.size() > 0)
    modal.base_inertia = modal.shapes.transpose() * body.base_inertia;
  modal.coupled = body.coupled.in(modal.shapes);
  if (body.loss_stiffness.size() > 0) add_structural_damping(body.loss_stiffness, modal);
  return modal;
}

Eigen::VectorXd ModalBody::mode_damping(double alpha) const {
  Eigen::VectorXd c = alpha + damping.beta * omega.array().square();
  if (!coupled.is_empty()) c += coupled.velocity.diagonal();
  return c;
}

ModalBody with_static_residual(const ModalBody& body, double cutoff) {
  if (body.residual.num_modes > 0)
    throw std::invalid_argument("with_static_residual: the body has a residual already");
  if (!body.coupled.is_empty())
    throw std::invalid_argument("with_static_residual: the modes of the body are coupled");
  if (!(cutoff > 0.0)) throw std::invalid_argument("with_static_residual: cutoff must be positive");
  const auto num_kept = (body.omega.array() <= cutoff).count();  // ω ascends
  const Eigen::Index num_dropped = body.size() - num_kept;
  if (num_dropped == 0) return body;

  ModalBody kept;
  kept.damping = body.damping;
  kept.omega = body.omega.head(num_kept);
  kept.rows = body.rows.leftCols(num_kept);
  kept.shapes = body.shapes.leftCols(num_kept);

  const Eigen::VectorXd flexibility = body.omega.tail(num_dropped).array().square().inverse();
  const Eigen::MatrixXd rows = body.rows.rightCols(num_dropped);
  const Eigen::MatrixXd shapes = body.shapes.rightCols(num_dropped) * flexibility.asDiagonal();
  kept.residual.num_modes = num_dropped;
  kept.residual.beta = body.damping.beta;
  kept.residual.flexibility = rows * flexibility.asDiagonal() * rows.transpose();
  kept.residual.shapes = shapes * rows.transpose();
  if (body.base_inertia.size() > 0) {
    kept.base_inertia = body.base_inertia.head(num_kept);
    const Eigen::VectorXd base = body.base_inertia.tail(num_dropped);
    kept.residual.base_rows = rows * flexibility.asDiagonal() * base;
    kept.residual.base_shapes = shapes * base;
  }
  return kept;
}

double central_difference_limit(const ModalBody& body) {
  double limit = std::numeric_limits<double>::infinity();
  for (const double omega : body.omega) {
    const double c = body.damping.alpha_max() + body.damping.beta * omega * omega;
    const double sum = c + std::sqrt(c * c + 4.0 * omega * omega);
    if (sum > 0.0) limit = std::min(limit, 4.0 / sum);
  }
  return limit;
}

}  // namespace stridor
