#include "substructures/matrices/symmetric_eigenpairs.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <utility>
#include <vector>

#include "core/errors.hpp"

extern "C" void dsyevd_(const char* jobz, const char* uplo, const int* n, double* a, const int* lda,
                        double* w, double* work, const int* lwork, int* iwork, const int* liwork,
                        int* info);

namespace stridor {
namespace {

/// Only what matters of a matrix: what the lower triangle holds.
bool is_finite(const Eigen::MatrixXd& matrix) {
  for (Eigen::Index column = 0; column < matrix.cols(); ++column)
    if (!matrix.col(column).tail(matrix.rows() - column).allFinite()) return false;
  return true;
}

[[noreturn]] void refuse(const std::string& what, int n, const char* why) {
  throw NumericalError(fmt::format("{}: the eigenproblem of {} unknowns {}", what, n, why));
}

[[noreturn]] void refuse_mass(const std::string& what) {
  throw NumericalError(what + ": the mass is not positive definite");
}

}  // namespace

SymmetricEigenpairs symmetric_eigenpairs(Eigen::MatrixXd matrix, const std::string& what) {
  SymmetricEigenpairs pairs{Eigen::VectorXd(matrix.rows()), std::move(matrix)};
  const int n = static_cast<int>(pairs.vectors.rows());
  if (n == 0) return pairs;
  if (!is_finite(pairs.vectors)) refuse(what, n, "is not finite");
  int info = 0;
  const auto solve = [&](double* work, int lwork, int* iwork, int liwork) {
    dsyevd_("V", "L", &n, pairs.vectors.data(), &n, pairs.values.data(), work, &lwork, iwork,
            &liwork, &info);
  };
  // Asked with −1 it tells the memory that it needs.
  double work_size = 0.0;
  int iwork_size = 0;
  solve(&work_size, -1, &iwork_size, -1);
  std::vector<double> work(static_cast<std::size_t>(std::max(work_size, 1.0)));
  std::vector<int> iwork(static_cast<std::size_t>(std::max(iwork_size, 1)));
  if (info == 0)
    solve(work.data(), static_cast<int>(work.size()), iwork.data(), static_cast<int>(iwork.size()));
  if (info != 0) refuse(what, n, "did not converge");
  return pairs;
}

SymmetricEigenpairs generalised_eigenpairs(Eigen::MatrixXd stiffness, const Eigen::MatrixXd& mass,
                                           const std::string& what) {
  if (stiffness.rows() == 0) return symmetric_eigenpairs(std::move(stiffness), what);
  // Checked first: the Cholesky factor takes NaN.
  if (!is_finite(mass)) refuse_mass(what);
  const Eigen::LLT<Eigen::MatrixXd> factor(mass);
  if (factor.info() != Eigen::Success) refuse_mass(what);
  // L⁻¹ K L⁻ᵀ, from both sides of all of K: what LAPACK does with one triangle (dsygst) is less
  // exact where the mass is badly conditioned.
  stiffness.triangularView<Eigen::StrictlyUpper>() = stiffness.transpose();
  factor.matrixL().solveInPlace(stiffness);
  factor.matrixU().solveInPlace<Eigen::OnTheRight>(stiffness);
  SymmetricEigenpairs pairs = symmetric_eigenpairs(std::move(stiffness), what);
  factor.matrixU().solveInPlace(pairs.vectors);
  return pairs;
}

}  // namespace stridor
