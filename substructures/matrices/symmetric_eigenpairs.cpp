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
extern "C" void dsytrd_(const char* uplo, const int* n, double* a, const int* lda, double* d,
                        double* e, double* tau, double* work, const int* lwork, int* info);
extern "C" void dstemr_(const char* jobz, const char* range, const int* n, double* d, double* e,
                        const double* vl, const double* vu, const int* il, const int* iu, int* m,
                        double* w, double* z, const int* ldz, const int* nzc, int* isuppz,
                        int* tryrac, double* work, const int* lwork, int* iwork, const int* liwork,
                        int* info);
extern "C" void dormtr_(const char* side, const char* uplo, const char* trans, const int* m,
                        const int* n, const double* a, const int* lda, const double* tau, double* c,
                        const int* ldc, double* work, const int* lwork, int* info);

namespace stridor {
namespace {

/// Only what matters of a matrix: what the lower triangle holds.
bool is_finite(const Eigen::MatrixXd& matrix) {
  for (Eigen::Index column = 0; column < matrix.cols(); ++column)
    if (!matrix.col(column).tail(matrix.rows() - column).allFinite()) return false;
  return true;
}

[[noreturn]] void refuse(const std::string& what, int n, const char* why) {
  throw NumericalError(Refusal::eigenvalues_incomplete,
                       fmt::format("{}: the eigenproblem of {} unknowns {}", what, n, why));
}

/// Pairs `first` to `last` in ascending order, counted from 1.
SymmetricEigenpairs eigenpairs_in_range(Eigen::MatrixXd matrix, int first, int last,
                                        const std::string& what) {
  const int n = static_cast<int>(matrix.rows());
  int count = last - first + 1;
  SymmetricEigenpairs pairs{Eigen::VectorXd(n), Eigen::MatrixXd(n, count)};
  if (!is_finite(matrix)) refuse(what, n, "is not finite");
  const auto size = static_cast<std::size_t>(n);
  // As much as any of the three asks for; the blocks of LAPACK are not wider than 64.
  std::vector<double> work(64 * size);
  std::vector<int> iwork(10 * size);
  const int work_size = static_cast<int>(work.size());
  const int iwork_size = static_cast<int>(iwork.size());
  Eigen::VectorXd diagonal(n);
  Eigen::VectorXd beside(n);
  Eigen::VectorXd reflections(n);
  int info = 0;
  dsytrd_("L", &n, matrix.data(), &n, diagonal.data(), beside.data(), reflections.data(),
          work.data(), &work_size, &info);
  if (info == 0) {
    std::vector<int> support(2 * size);
    const double unused = 0.0;
    int is_relative_tried = 1;
    int num_found = 0;
    dstemr_("V", "I", &n, diagonal.data(), beside.data(), &unused, &unused, &first, &last,
            &num_found, pairs.values.data(), pairs.vectors.data(), &n, &count, support.data(),
            &is_relative_tried, work.data(), &work_size, iwork.data(), &iwork_size, &info);
    if (num_found != count) info = 1;
  }
  if (info == 0) {
    dormtr_("L", "L", "N", &n, &count, matrix.data(), &n, reflections.data(), pairs.vectors.data(),
            &n, work.data(), &work_size, &info);
  }
  if (info != 0) refuse(what, n, "did not converge");
  pairs.values.conservativeResize(count);
  return pairs;
}

[[noreturn]] void refuse_mass(const std::string& what) {
  throw NumericalError(Refusal::singular, what + ": the mass is not positive definite");
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

SymmetricEigenpairs lowest_eigenpairs(Eigen::MatrixXd matrix, Eigen::Index count,
                                      const std::string& what) {
  if (count == 0) return {Eigen::VectorXd(0), Eigen::MatrixXd(matrix.rows(), 0)};
  return eigenpairs_in_range(std::move(matrix), 1, static_cast<int>(count), what);
}

SymmetricEigenpairs highest_eigenpairs(Eigen::MatrixXd matrix, Eigen::Index count,
                                       const std::string& what) {
  if (count == 0) return {Eigen::VectorXd(0), Eigen::MatrixXd(matrix.rows(), 0)};
  const int n = static_cast<int>(matrix.rows());
  return eigenpairs_in_range(std::move(matrix), n - static_cast<int>(count) + 1, n, what);
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
