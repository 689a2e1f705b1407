#include "solvers/eigenvalues/system_span.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace stridor {
namespace {

constexpr std::size_t most_parts = 6;

/// a + factor b, without what is zero.
SparseMatrix sum(const SparseMatrix& a, double factor, const SparseMatrix& b) {
  if (b.nonZeros() == 0 || factor == 0.0) return a;
  SparseMatrix result = a + factor * b;
  result.prune(0.0, 0.0);
  return result;
}

SparseSystem sum(const SparseSystem& a, double factor, const SparseSystem& b) {
  return {sum(a.mass, factor, b.mass), sum(a.velocity, factor, b.velocity),
          sum(a.position, factor, b.position)};
}

bool have_same_places(const SparseMatrix& a, const SparseMatrix& b) {
  return a.isCompressed() && b.isCompressed() && a.nonZeros() == b.nonZeros() &&
         a.outerSize() == b.outerSize() &&
         std::equal(a.outerIndexPtr(), a.outerIndexPtr() + a.outerSize() + 1, b.outerIndexPtr()) &&
         std::equal(a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros(), b.innerIndexPtr());
}

/// a − b, without what is zero.
SparseMatrix difference(const SparseMatrix& a, const SparseMatrix& b) {
  if (!have_same_places(a, b)) return sum(a, -1.0, b);
  SparseMatrix result(a.rows(), a.cols());
  for (Eigen::Index j = 0; j < a.outerSize(); ++j) {
    result.startVec(j);
    for (SparseMatrix::StorageIndex k = a.outerIndexPtr()[j]; k < a.outerIndexPtr()[j + 1]; ++k) {
      const double rest = a.valuePtr()[k] - b.valuePtr()[k];
      if (rest != 0.0) result.insertBack(a.innerIndexPtr()[k], j) = rest;
    }
  }
  result.finalize();
  return result;
}

double entry_product(const SparseMatrix& a, const SparseMatrix& b) {
  if (a.nonZeros() == 0 || b.nonZeros() == 0) return 0.0;
  return a.cwiseProduct(b).sum();
}

}  // namespace

SystemSpan::SystemSpan(SparseSystem first)
    : mass_norm_(first.mass.norm()),
      velocity_norm_(0.0),
      position_norm_(first.position.norm()) {
  // P may be zero at first; between M and Q it has the size of the geometric mean.
  velocity_norm_ = std::max(first.velocity.norm(), 1e-6 * std::sqrt(mass_norm_ * position_norm_));
  parts_.push_back(std::move(first));
}

double SystemSpan::product(const SparseSystem& a, const SparseSystem& b) const {
  const auto weighted = [](double product, double norm) {
    return norm > 0.0 ? product / (norm * norm) : product;
  };
  return weighted(entry_product(a.mass, b.mass), mass_norm_) +
         weighted(entry_product(a.velocity, b.velocity), velocity_norm_) +
         weighted(entry_product(a.position, b.position), position_norm_);
}

std::optional<Eigen::VectorXd> SystemSpan::factors(const SparseSystem& system) {
  if (system.size() != parts_[0].size())
    throw std::invalid_argument("system span: the systems differ in size");
  constexpr double rounding = 2e-15;  // of the entries of a sum
  Eigen::VectorXd factors = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(parts_.size()));
  SparseSystem rest{difference(system.mass, parts_[0].mass),
                    difference(system.velocity, parts_[0].velocity),
                    difference(system.position, parts_[0].position)};
  for (std::size_t k = 1; k < parts_.size(); ++k) {
    const double factor = product(rest, parts_[k]) / product(parts_[k], parts_[k]);
    factors(static_cast<Eigen::Index>(k)) = factor;
    rest = sum(rest, -factor, parts_[k]);
  }
  const double scale = rounding * factors.cwiseAbs().sum();
  const bool is_within = rest.mass.norm() <= scale * mass_norm_ &&
                         rest.velocity.norm() <= scale * velocity_norm_ &&
                         rest.position.norm() <= scale * position_norm_;
  if (is_within) return factors;
  if (parts_.size() == most_parts) return std::nullopt;
  factors.conservativeResize(factors.size() + 1);
  factors(factors.size() - 1) = 1.0;
  parts_.push_back(std::move(rest));
  return factors;
}

}  // namespace stridor
