#include "substructures/lowest_modes.hpp"

#include <Spectra/MatOp/SparseSymMatProd.h>
#include <Spectra/SymGEigsShiftSolver.h>
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/errors.hpp"

namespace stridor {
namespace {

/// y = (K/s)⁻¹ x, in the form in which Spectra asks for (K/s − σ M)⁻¹; only σ = 0 is ever used.
///
/// The scale s brings the wanted eigenvalues near 1: Spectra compares norms with the rounding unit
/// itself, and 1/ω² of stiff bodies (1e-13 s²) would pass for zero there.
class ScaledInverse {
 public:
  using Scalar = double;

  ScaledInverse(const SparseCholesky& factor, double scale) : factor_(factor), scale_(scale) {}
  Eigen::Index rows() const { return factor_.size(); }
  Eigen::Index cols() const { return factor_.size(); }
  void set_shift(const double&) {}
  void perform_op(const double* in, double* out) const {
    Eigen::Map<Eigen::VectorXd>(out, rows()) =
        scale_ * factor_.solve(Eigen::Map<const Eigen::VectorXd>(in, rows()));
  }

 private:
  const SparseCholesky& factor_;
  double scale_;
};

/// Size of ω² of the softest motions: the Rayleigh quotient xᵀ M x / xᵀ M K⁻¹ M x of a vector that
/// has a part in all of them.
double typical_omega_squared(const SparseCholesky& factor, const SparseMatrix& mass) {
  Eigen::VectorXd x(factor.size());
  for (Eigen::Index i = 0; i < x.size(); ++i)
    x(i) = 1.0 + 0.5 * std::sin(static_cast<double>(i + 1));
  const Eigen::VectorXd mass_x = mass * x;
  return x.dot(mass_x) / mass_x.dot(factor.solve(mass_x).col(0));
}

Modes dense_modes(const SparseMatrix& stiffness, const SparseMatrix& mass, Eigen::Index count) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver{Eigen::MatrixXd(stiffness),
                                                                         Eigen::MatrixXd(mass)};
  if (solver.info() != Eigen::Success)
    throw NumericalError("fixed-interface modes: the dense eigenproblem failed");
  return {solver.eigenvalues().head(count), solver.eigenvectors().leftCols(count)};
}

Modes lanczos_modes(const SparseCholesky& factor, const SparseMatrix& mass, Eigen::Index count) {
  const double scale = typical_omega_squared(factor, mass);
  ScaledInverse inverse(factor, scale);
  Spectra::SparseSymMatProd<double> mass_product(mass);
  const Eigen::Index subspace = std::min(factor.size(), 2 * count + 20);
  Spectra::SymGEigsShiftSolver<ScaledInverse, Spectra::SparseSymMatProd<double>,
                               Spectra::GEigsMode::ShiftInvert>
      solver(inverse, mass_product, count, subspace, 0.0);
  solver.init();
  const Eigen::Index converged =
      solver.compute(Spectra::SortRule::LargestMagn, 1000, 1e-12, Spectra::SortRule::SmallestMagn);
  if (solver.info() != Spectra::CompInfo::Successful || converged < count) {
    throw NumericalError(
        fmt::format("fixed-interface modes: Lanczos found {} of {} eigenpairs", converged, count));
  }
  return {scale * solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace

Modes lowest_modes(const SparseCholesky& stiffness, const SparseMatrix& stiffness_matrix,
                   const SparseMatrix& mass, Eigen::Index count) {
  const Eigen::Index size = mass.rows();
  if (count < 0 || count > size) {
    throw std::invalid_argument(
        fmt::format("lowest_modes: {} modes asked of {} DoFs", count, size));
  }
  if (count == 0) return {Eigen::VectorXd(0), Eigen::MatrixXd(size, 0)};
  // A Krylov space needs room beyond the wanted pairs; without it the dense solver is as cheap.
  const bool is_small = size <= 2 * count + 20 || size <= 60;
  Modes modes =
      is_small ? dense_modes(stiffness_matrix, mass, count) : lanczos_modes(stiffness, mass, count);

  for (Eigen::Index i = 0; i < count; ++i) {
    auto shape = modes.shapes.col(i);
    const Eigen::VectorXd mass_times_shape = mass * shape;
    double scale = 1.0 / std::sqrt(shape.dot(mass_times_shape));
    Eigen::Index largest = 0;
    shape.cwiseAbs().maxCoeff(&largest);
    if (shape(largest) < 0.0) scale = -scale;
    shape *= scale;
    const Eigen::VectorXd force = stiffness_matrix * shape;
    const double residual =
        (force - modes.omega_squared(i) * scale * mass_times_shape).norm() / force.norm();
    if (!(residual < 1e-6)) {
      throw NumericalError(fmt::format(
          "fixed-interface modes: eigenpair {} has a residual of {:.1e}", i + 1, residual));
    }
  }
  return modes;
}

}  // namespace stridor
