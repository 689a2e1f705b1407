#include "solvers/contact/sweep_acceleration.hpp"

#include <algorithm>

namespace stridor {

SweepAcceleration::SweepAcceleration(Eigen::Index size)
    : moved_(size, depth),
      changed_(size, depth),
      basis_(size, depth),
      last_(size),
      change_(size),
      left_(size),
      next_(size) {}

bool SweepAcceleration::add(const Eigen::VectorXd& x, const Eigen::VectorXd& g) {
  left_ = g - x;
  const int num_before = num_kept_++;
  if (num_before > 0) {
    const Eigen::Index column = (num_before - 1) % depth;
    moved_.col(column) = g - last_;
    changed_.col(column) = left_ - change_;
  }
  last_ = g;
  change_ = left_;
  if (num_before == 0) return false;

  // Orthonormal from the latest sweep on; what depends on later ones is left out.
  constexpr double dependent = 1e-6;
  const int num_columns = std::min(num_before, depth);
  std::array<std::array<double, depth>, depth> triangle{};
  std::array<double, depth> share{};
  std::array<Eigen::Index, depth> of{};
  std::size_t rank = 0;
  for (int k = 0; k < num_columns; ++k) {
    const Eigen::Index column = (num_before - 1 - k) % depth;
    auto direction = basis_.col(static_cast<Eigen::Index>(rank));
    direction = changed_.col(column);
    const double size = direction.norm();
    for (std::size_t j = 0; j < rank; ++j) {
      const auto other = basis_.col(static_cast<Eigen::Index>(j));
      triangle[j][rank] = other.dot(direction);
      direction -= triangle[j][rank] * other;
    }
    const double rest = direction.norm();
    if (!(rest > dependent * size)) continue;
    direction /= rest;
    triangle[rank][rank] = rest;
    share[rank] = direction.dot(left_);
    left_ -= share[rank] * direction;
    of[rank++] = column;
  }
  next_ = g;
  for (std::size_t i = rank; i-- > 0;) {
    double gamma = share[i];
    for (std::size_t j = i + 1; j < rank; ++j) gamma -= triangle[i][j] * share[j];
    share[i] = gamma / triangle[i][i];
    next_ -= share[i] * moved_.col(of[i]);
  }
  return rank > 0;
}

}  // namespace stridor
