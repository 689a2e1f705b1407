// Quadratic eigenvalue problem with sparse matrices: products, factorisations, determinants.
#pragma once

#include <Eigen/SparseCore>
#include <complex>
#include <memory>

#include "substructures/matrices/sparse_system.hpp"

namespace stridor {

/// Whether more than a quarter of the places of a matrix are filled.
bool is_full(const SparseMatrix& matrix);

/// P(s) = s² M + s P + Q at one s, factorised by UMFPACK; as dense matrices where P or Q is full.
class SparseFactor {
 public:
  ~SparseFactor();
  SparseFactor(SparseFactor&&) noexcept;
  SparseFactor& operator=(SparseFactor&&) noexcept;

  /// P(s)⁻¹ B.
  Eigen::MatrixXcd solve(const Eigen::MatrixXcd& right_hand_sides) const;
  /// P(s)⁻ᴴ B.
  Eigen::MatrixXcd solve_adjoint(const Eigen::MatrixXcd& right_hand_sides) const;
  /// log det P(s); real part −∞ where P(s) is singular to working precision.
  std::complex<double> log_determinant() const;

 private:
  friend class SparsePencil;
  struct Numbers;
  Eigen::MatrixXcd solve(int which, const Eigen::MatrixXcd& right_hand_sides) const;
  explicit SparseFactor(std::unique_ptr<Numbers> numbers);
  std::unique_ptr<Numbers> numbers_;
};

/// M q̈ + P q̇ + Q q = 0 on one pattern, which is analysed once for all factorisations; of full
/// matrices there is nothing to analyse.
class SparsePencil {
 public:
  /// @throws std::invalid_argument if sizes differ or a number is not finite
  explicit SparsePencil(const SparseSystem& system);
  ~SparsePencil();
  SparsePencil(SparsePencil&&) noexcept;
  SparsePencil& operator=(SparsePencil&&) noexcept;

  Eigen::Index size() const;
  const SparseSystem& system() const;

  /// P(s) x.
  Eigen::VectorXcd multiply(std::complex<double> s, const Eigen::VectorXcd& x) const;
  /// M v + P x.
  Eigen::VectorXcd momentum(const Eigen::VectorXcd& v, const Eigen::VectorXcd& x) const;
  /// (P(t) − P(s))/(t − s) x = ((s + t) M + P) x; the derivative where s and t are the same.
  Eigen::VectorXcd slope(std::complex<double> s, std::complex<double> t,
                         const Eigen::VectorXcd& x) const;
  /// ((s + t) M + P)ᴴ y.
  Eigen::VectorXcd slope_adjoint(std::complex<double> s, std::complex<double> t,
                                 const Eigen::VectorXcd& y) const;

  /// @throws NumericalError if memory runs out. A singular P(s) is factorised as it is.
  SparseFactor factorise(std::complex<double> s) const;

  /// Normwise backward error of an eigenpair (Tisseur 2000): the smallest relative change of the
  /// three matrices for which it is exact,
  ///
  ///   |P(s) x|₂ / ((|s|² ‖M‖₁ + |s| ‖P‖₁ + ‖Q‖₁) |x|₂) .
  ///
  /// ‖Q‖₁ is of the stiffest element, so that this says little of slow motions of a fine mesh;
  /// scaled_residual() does.
  double backward_error(std::complex<double> s, const Eigen::VectorXcd& x) const;
  /// |P(s) x|₂ / (|s|² |M x|₂ + |s| |P x|₂ + |Q x|₂).
  double scaled_residual(std::complex<double> s, const Eigen::VectorXcd& x) const;

 private:
  struct Pattern;
  Eigen::VectorXcd position_times(const Eigen::VectorXcd& x) const;
  std::unique_ptr<Pattern> pattern_;
};

}  // namespace stridor
