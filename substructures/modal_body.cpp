#include "substructures/modal_body.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <limits>

#include "core/errors.hpp"

namespace stridor {

ModalBody make_modal(const ReducedBody& body) {
  // The eigensolver takes the Cholesky factor of the mass unseen, and the factor takes NaN.
  if (!body.mass.allFinite() || body.mass.llt().info() != Eigen::Success) {
    throw NumericalError("modal form: the reduced mass is not positive definite");
  }
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(body.stiffness, body.mass);
  if (solver.info() != Eigen::Success)
    throw NumericalError("modal form: the eigensolver did not converge");
  constexpr double rigid_ratio = 1e-6;
  const Eigen::VectorXd& squares = solver.eigenvalues();
  const double largest = squares.size() > 0 ? squares(squares.size() - 1) : 0.0;
  const double rigid_below = rigid_ratio * rigid_ratio * largest;

  ModalBody modal;
  modal.damping = body.damping;
  modal.omega.resize(squares.size());
  for (Eigen::Index i = 0; i < squares.size(); ++i) {
    if (squares(i) < -rigid_below) {
      throw NumericalError(fmt::format("modal form: mode {} has the negative stiffness {:.3e} 1/s²",
                                       i + 1, squares(i)));
    }
    modal.omega(i) = squares(i) <= rigid_below ? 0.0 : std::sqrt(squares(i));
  }
  modal.shapes = solver.eigenvectors();
  modal.rows = body.rows * modal.shapes;
  if (body.base_inertia.size() > 0)
    modal.base_inertia = modal.shapes.transpose() * body.base_inertia;
  return modal;
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
