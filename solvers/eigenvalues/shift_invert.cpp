#include "solvers/eigenvalues/shift_invert.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/blas.hpp"
#include "core/stop_token.hpp"
#include "solvers/eigenvalues/complex_eigenpairs.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

constexpr double shortest_addition = 1e-13;  ///< length of what a vector adds to the space

class Arnoldi {
 public:
  Arnoldi(const SparsePencil& pencil, const SparseFactor& factor, const NearestPairsWanted& wanted,
          const Eigen::MatrixXcd& start)
      : pencil_(pencil),
        factor_(factor),
        wanted_(wanted),
        scale_(std::abs(wanted.shift)),
        most_(std::min(wanted.most_steps, 2 * pencil.size())),
        basis_(2 * pencil.size(), most_ + start.cols()),
        projection_(Eigen::MatrixXcd::Zero(basis_.cols(), most_)) {
    for (const auto& x : start.colwise()) {
      Eigen::VectorXcd state(2 * pencil.size());
      state << x, x * (wanted.shift / scale_);
      append(state, nullptr);
    }
  }

  NearestPairs run() {
    Eigen::Index next_look = std::min(most_, 3 * wanted_.expected / 2 + 12);
    NearestPairs found;
    while (true) {
      throw_if_stopped();
      const bool is_exhausted = num_applied_ == dim_;
      if (!is_exhausted && num_applied_ < most_) step();
      const bool is_last = is_exhausted || num_applied_ == most_;
      if (num_applied_ < next_look && !is_last) continue;
      found = look();
      if (found.are_all || is_last) return found;
      next_look = std::min(most_, num_applied_ + std::max<Eigen::Index>(8, num_applied_ / 6));
    }
  }

 private:
  Eigen::Index size() const { return pencil_.size(); }

  /// The component of a state outside the space joins it. @param inside those within; may be null
  void append(Eigen::VectorXcd state, Complex* inside) {
    constexpr double long_enough = 0.01;  // to be orthogonal to 1e-14 after one round
    const double length = state.norm();
    const auto basis = basis_.leftCols(dim_);
    Eigen::VectorXcd with_room = Eigen::VectorXcd::Zero(dim_ + read_beyond_vectors);
    auto products = with_room.head(dim_);
    for (int round = 0; round < 2; ++round) {
      if (round > 0 && state.norm() > long_enough * length) break;
      products.noalias() = basis.adjoint() * state;
      state.noalias() -= basis * products;
      if (inside != nullptr) Eigen::Map<Eigen::VectorXcd>(inside, dim_) += products;
    }
    const double rest = state.norm();
    if (!(rest > shortest_addition * length) || dim_ == 2 * size()) return;
    if (inside != nullptr) inside[dim_] = rest;
    basis_.col(dim_++) = state / rest;
  }

  /// (A − σ)⁻¹ of the next vector.
  void step() {
    const auto state = basis_.col(num_applied_);
    const Eigen::VectorXcd x = state.head(size());
    const Eigen::VectorXcd v = scale_ * state.tail(size());
    Eigen::VectorXcd next(2 * size());
    next.head(size()) = factor_.solve(-pencil_.momentum(v + wanted_.shift * x, x));
    next.tail(size()) = (wanted_.shift * next.head(size()) + x) / scale_;
    append(next, projection_.col(num_applied_).data());
    ++num_applied_;
  }

  NearestPairs look() const {
    NearestPairs found;
    const auto square = projection_.topLeftCorner(num_applied_, num_applied_);
    if (!square.allFinite()) return found;
    const ComplexEigenpairs ritz = complex_eigenpairs(square);
    const auto below = projection_.block(num_applied_, 0, dim_ - num_applied_, num_applied_).eval();
    std::vector<std::pair<double, Eigen::Index>> order;
    found.are_all = true;
    for (Eigen::Index i = 0; i < num_applied_; ++i) {
      const Complex mu = ritz.values(i);
      const bool is_near = std::abs(mu) * wanted_.radius >= 1.0;
      const bool has_converged =
          (below * ritz.vectors.col(i)).norm() <= wanted_.tolerance * std::abs(mu);
      if (has_converged) order.emplace_back(-std::abs(mu), i);
      if (is_near && !has_converged) found.are_all = false;
    }
    std::sort(order.begin(), order.end());
    for (const auto& [unused, i] : order) {
      const Eigen::VectorXcd x = basis_.topLeftCorner(size(), num_applied_) * ritz.vectors.col(i);
      found.pairs.push_back({wanted_.shift + 1.0 / ritz.values(i), x.normalized()});
    }
    return found;
  }

  const SparsePencil& pencil_;
  const SparseFactor& factor_;
  NearestPairsWanted wanted_;
  double scale_;
  Eigen::Index most_;
  Eigen::MatrixXcd basis_;       ///< W, orthonormal
  Eigen::MatrixXcd projection_;  ///< Wᴴ (A − σ)⁻¹ W
  Eigen::Index dim_ = 0;
  Eigen::Index num_applied_ = 0;  ///< leading vectors of W whose images are known
};

}  // namespace

NearestPairs nearest_pairs(const SparsePencil& pencil, const SparseFactor& factor,
                           const NearestPairsWanted& wanted, const Eigen::MatrixXcd& start) {
  if (start.rows() != pencil.size() || start.cols() == 0)
    throw std::invalid_argument("nearest pairs: there is nothing to start from");
  return Arnoldi(pencil, factor, wanted, start).run();
}

}  // namespace stridor
