#include "solvers/eigenvalues/count_along.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

#include "solvers/eigenvalues/complex_eigenpairs.hpp"
#include "solvers/eigenvalues/eigenvalue_count.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

constexpr double least_counting = 0.3;  ///< of |c γ|; 1 is where a factor may be zero

/// Largest eigenvalues of an operator by Arnoldi's method from two vectors.
class LargestEigenvalues {
 public:
  LargestEigenvalues(Eigen::Index size, Eigen::Index most)
      : most_(std::min(size, most)),
        basis_(size, most_ + num_starts),
        projection_(Eigen::MatrixXcd::Zero(most_ + num_starts, most_)) {}

  /// @param least   size from which on eigenvalues must have converged
  /// @param is_real whether the operator is: eigenvalues then come with their conjugates, so that their
  ///                logarithms add up to a real number whether they have converged or not
  template <typename Operator>
  bool find(const Operator& apply, double least, bool is_real) {
    std::mt19937 generator(1);
    std::normal_distribution<double> normal;
    for (int i = 0; i < num_starts; ++i) {
      Eigen::VectorXcd start(basis_.rows());
      for (Complex& entry : start) {
        const double real = normal(generator);
        entry = {real, is_real ? 0.0 : normal(generator)};
      }
      append(apply(start), nullptr);
    }
    while (true) {
      const bool is_exhausted = num_applied_ == dim_;
      if (!is_exhausted && num_applied_ < most_) {
        append(apply(basis_.col(num_applied_)), projection_.col(num_applied_).data());
        ++num_applied_;
      }
      const bool is_last = num_applied_ == dim_ || num_applied_ == most_;
      if (is_last || num_applied_ % 6 == 0) {
        if (look(least)) return true;
        if (is_last) return num_applied_ == dim_;
      }
    }
  }

  const std::vector<Complex>& values() const { return values_; }

 private:
  static constexpr int num_starts = 2;

  void append(Eigen::VectorXcd vector, Complex* inside) {
    constexpr double shortest = 1e-12;  // of what a vector adds
    const double length = vector.norm();
    const auto basis = basis_.leftCols(dim_);
    for (int round = 0; round < 2; ++round) {
      const Eigen::VectorXcd products = basis.adjoint() * vector;
      vector.noalias() -= basis * products;
      if (inside != nullptr) Eigen::Map<Eigen::VectorXcd>(inside, dim_) += products;
    }
    const double rest = vector.norm();
    if (!(rest > shortest * std::max(length, longest_)) || dim_ == basis_.cols()) return;
    longest_ = std::max(longest_, length);
    if (inside != nullptr) inside[dim_] = rest;
    basis_.col(dim_++) = vector / rest;
  }

  bool look(double least) {
    constexpr double tolerance = 1e-3;
    values_.clear();
    if (num_applied_ == 0) return true;
    const ComplexEigenpairs ritz =
        complex_eigenpairs(projection_.topLeftCorner(num_applied_, num_applied_));
    const auto below = projection_.block(num_applied_, 0, dim_ - num_applied_, num_applied_).eval();
    bool have_converged = true;
    for (Eigen::Index i = 0; i < num_applied_; ++i) {
      const Complex value = ritz.values(i);
      values_.push_back(value);
      if (std::abs(value) < least) continue;
      have_converged &= (below * ritz.vectors.col(i)).norm() <= tolerance * std::abs(value);
    }
    return have_converged && num_applied_ >= 6;
  }

  Eigen::Index most_;
  Eigen::MatrixXcd basis_;
  Eigen::MatrixXcd projection_;
  Eigen::Index dim_ = 0, num_applied_ = 0;
  double longest_ = 0.0;
  std::vector<Complex> values_;
};

}  // namespace

CountAlong::CountAlong(SparseSystem base, SparseSystem direction, double reach)
    : pencil_(base), direction_(std::move(direction)), reach_(reach) {}

void CountAlong::add(Complex s, const SparseFactor& factor) {
  constexpr Eigen::Index most_steps = 80;
  Place& place = places_[{s.real(), s.imag()}];
  place.logarithm = factor.log_determinant();
  LargestEigenvalues largest(pencil_.size(), most_steps);
  place.has_converged = largest.find(
      [&](const Eigen::VectorXcd& x) -> Eigen::VectorXcd {
        Eigen::VectorXcd force = direction_.position * x;
        if (direction_.velocity.nonZeros() > 0) force += s * (direction_.velocity * x);
        if (direction_.mass.nonZeros() > 0) force += s * s * (direction_.mass * x);
        return factor.solve(force);
      },
      least_counting / reach_, s.imag() == 0.0);
  place.gamma = largest.values();
}

const CountAlong::Place& CountAlong::at(Complex s) {
  const auto found = places_.find({s.real(), s.imag()});
  if (found != places_.end()) return found->second;
  ++factorisations_;
  add(s, pencil_.factorise(s));
  return places_.at({s.real(), s.imag()});
}

std::optional<int> CountAlong::count(double c, const SpectrumRectangle& rectangle,
                                     const std::vector<Complex>& known) {
  constexpr double rounding = 1e-9;
  if (!(std::abs(c) <= reach_ * (1.0 + rounding))) return std::nullopt;
  bool have_converged = true;
  const auto logarithm = [&](Complex s) {
    const Place& place = at(s);
    have_converged &= place.has_converged;
    Complex sum = place.logarithm;
    for (const Complex& gamma : place.gamma) sum += std::log(1.0 + c * gamma);
    return sum;
  };
  const auto counted = count_in_rectangle(logarithm, rectangle.left(), rectangle.right(),
                                          rectangle.height, known);
  return have_converged ? counted : std::nullopt;
}

}  // namespace stridor
