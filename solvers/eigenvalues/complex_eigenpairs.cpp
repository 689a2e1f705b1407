#include "solvers/eigenvalues/complex_eigenpairs.hpp"

#include <fmt/format.h>

#include <complex>

#include "core/errors.hpp"

extern "C" void zgeev_(const char* left, const char* right, const int* n, std::complex<double>* a,
                       const int* lda, std::complex<double>* w, std::complex<double>* vl,
                       const int* ldvl, std::complex<double>* vr, const int* ldvr,
                       std::complex<double>* work, const int* lwork, double* rwork, int* info);

namespace stridor {

ComplexEigenpairs complex_eigenpairs(Eigen::MatrixXcd matrix) {
  const auto n = static_cast<int>(matrix.rows());
  ComplexEigenpairs found;
  found.values.resize(n);
  found.vectors.resize(n, n);
  if (n == 0) return found;
  Eigen::VectorXd real_work(2 * n);
  constexpr int no_left = 1;
  int info = 0;
  const auto call = [&](std::complex<double>* work, int size) {
    zgeev_("N", "V", &n, matrix.data(), &n, found.values.data(), nullptr, &no_left,
           found.vectors.data(), &n, work, &size, real_work.data(), &info);
  };
  std::complex<double> wanted;
  call(&wanted, -1);
  Eigen::VectorXcd work(static_cast<Eigen::Index>(wanted.real()));
  call(work.data(), static_cast<int>(work.size()));
  if (info != 0)
    throw NumericalError(
        Refusal::eigenvalues_incomplete,
        fmt::format("complex eigenvalues: the QR iteration failed at {} of {}", info, n));
  return found;
}

}  // namespace stridor
