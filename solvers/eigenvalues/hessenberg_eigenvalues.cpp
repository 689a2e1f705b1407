#include "solvers/eigenvalues/hessenberg_eigenvalues.hpp"

#include <fmt/format.h>

#include <limits>
#include <vector>

#include "core/errors.hpp"

extern "C" {
void dgebal_(const char* job, const int* n, double* a, const int* lda, int* ilo, int* ihi,
             double* scale, int* info);
void dgehrd_(const int* n, const int* ilo, const int* ihi, double* a, const int* lda, double* tau,
             double* work, const int* lwork, int* info);
void dhseqr_(const char* job, const char* compz, const int* n, const int* ilo, const int* ihi,
             double* h, const int* ldh, double* wr, double* wi, double* z, const int* ldz,
             double* work, const int* lwork, int* info);
void dhsein_(const char* side, const char* eigsrc, const char* initv, int* select, const int* n,
             const double* h, const int* ldh, double* wr, const double* wi, double* vl,
             const int* ldvl, double* vr, const int* ldvr, const int* mm, int* m, double* work,
             int* ifaill, int* ifailr, int* info);
}

namespace stridor {
namespace {

using Complex = std::complex<double>;

/// The balanced matrix in upper Hessenberg form, and the rows that balancing left to it.
struct Hessenberg {
  Eigen::MatrixXd matrix;
  int low = 1, high = 1;
  double norm = 0.0;
};

Hessenberg reduce(Eigen::MatrixXd matrix) {
  const auto n = static_cast<int>(matrix.rows());
  Hessenberg form;
  Eigen::VectorXd scale(n), tau(n);
  int info = 0;
  dgebal_("B", &n, matrix.data(), &n, &form.low, &form.high, scale.data(), &info);
  form.norm = matrix.cwiseAbs().colwise().sum().maxCoeff();
  double wanted = 0.0;
  const int query = -1;
  dgehrd_(&n, &form.low, &form.high, matrix.data(), &n, tau.data(), &wanted, &query, &info);
  const auto size = static_cast<int>(wanted);
  Eigen::VectorXd work(size);
  dgehrd_(&n, &form.low, &form.high, matrix.data(), &n, tau.data(), work.data(), &size, &info);
  for (Eigen::Index j = 0; j + 2 < n; ++j) matrix.col(j).tail(n - j - 2).setZero();
  form.matrix = std::move(matrix);
  return form;
}

struct RealPairs {
  Eigen::VectorXd re, im;
};

RealPairs eigenvalues_of(const Hessenberg& form) {
  const auto n = static_cast<int>(form.matrix.rows());
  Eigen::MatrixXd worked = form.matrix;
  RealPairs pairs{Eigen::VectorXd(n), Eigen::VectorXd(n)};
  double unused = 0.0;
  const int one = 1;
  int info = 0;
  const auto call = [&](double* work, int size) {
    dhseqr_("E", "N", &n, &form.low, &form.high, worked.data(), &n, pairs.re.data(),
            pairs.im.data(), &unused, &one, work, &size, &info);
  };
  double wanted = 0.0;
  call(&wanted, -1);
  Eigen::VectorXd work(static_cast<Eigen::Index>(wanted));
  call(work.data(), static_cast<int>(work.size()));
  if (info != 0) {
    throw NumericalError(
        Refusal::eigenvalues_incomplete,
        fmt::format("dense eigenvalues: the QR iteration failed at {} of {}", info, n));
  }
  return pairs;
}

/// Column, or pair of columns, of LAPACK's packing.
Eigen::VectorXcd unpacked(const Eigen::MatrixXd& packed, Eigen::Index column, bool is_pair) {
  Eigen::VectorXcd vector = packed.col(column).cast<Complex>();
  if (is_pair) vector.imag() = packed.col(column + 1);
  return vector.normalized();
}

/// |yᴴx| of the chosen eigenvalues, in their order; false where one was not found.
bool find_conditions(const Hessenberg& form, const RealPairs& pairs,
                     const std::vector<Eigen::Index>& chosen, Eigen::VectorXd& found) {
  const auto n = static_cast<int>(form.matrix.rows());
  std::vector<int> select(static_cast<std::size_t>(n), 0);
  int num_columns = 0;
  for (const Eigen::Index i : chosen) {
    select[static_cast<std::size_t>(i)] = 1;
    num_columns += pairs.im(i) != 0.0 ? 2 : 1;
  }
  Eigen::VectorXd re = pairs.re;  // dhsein moves those that coincide apart
  Eigen::MatrixXd left(n, num_columns), right(n, num_columns);
  Eigen::VectorXd work(static_cast<Eigen::Index>(n) * (n + 2));
  std::vector<int> left_failed(static_cast<std::size_t>(num_columns));
  std::vector<int> right_failed(static_cast<std::size_t>(num_columns));
  int num_used = 0;
  int info = 0;
  dhsein_("B", "Q", "N", select.data(), &n, form.matrix.data(), &n, re.data(), pairs.im.data(),
          left.data(), &n, right.data(), &n, &num_columns, &num_used, work.data(),
          left_failed.data(), right_failed.data(), &info);
  if (info != 0 || num_used != num_columns) return false;
  Eigen::Index column = 0;
  for (const Eigen::Index i : chosen) {
    const bool is_pair = pairs.im(i) != 0.0;
    found(i) = std::abs(unpacked(left, column, is_pair).dot(unpacked(right, column, is_pair)));
    column += is_pair ? 2 : 1;
  }
  return true;
}

}  // namespace

std::optional<HessenbergEigenvalues> hessenberg_eigenvalues(
    Eigen::MatrixXd matrix, const std::function<bool(Complex)>& is_wanted, int most) {
  constexpr double least_condition = 1e-6;
  const Eigen::Index n = matrix.rows();
  const Hessenberg form = reduce(std::move(matrix));
  const RealPairs pairs = eigenvalues_of(form);
  HessenbergEigenvalues result;
  result.norm = form.norm;
  result.values.resize(n);
  result.reciprocal_condition.setConstant(n, std::numeric_limits<double>::quiet_NaN());
  std::vector<Eigen::Index> chosen;
  for (Eigen::Index i = 0; i < n; ++i) {
    result.values(i) = {pairs.re(i), pairs.im(i)};
    if (pairs.im(i) >= 0.0 && is_wanted(result.values(i))) chosen.push_back(i);
  }
  if (static_cast<int>(chosen.size()) > most) return std::nullopt;
  if (chosen.empty()) return result;
  if (!find_conditions(form, pairs, chosen, result.reciprocal_condition)) return std::nullopt;
  for (const Eigen::Index i : chosen)
    if (!(result.reciprocal_condition(i) >= least_condition)) return std::nullopt;
  return result;
}

}  // namespace stridor
