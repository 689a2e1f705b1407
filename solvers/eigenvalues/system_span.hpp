// Sparse systems along a parameter as sums of few.
#pragma once

#include <optional>
#include <vector>

#include "substructures/matrices/sparse_system.hpp"

namespace stridor {

/// Systems S = S₀ + Σ c_k S_k: those of a parameter that enters as a factor, or of one that enters
/// as several functions.
class SystemSpan {
 public:
  explicit SystemSpan(SparseSystem first);

  std::size_t num_parts() const { return parts_.size(); }
  /// The parts but the first have M, P and Q only where these change.
  const SparseSystem& part(std::size_t k) const { return parts_[k]; }

  /// The factors of a system, 1 for the first part; what it has outside of the span becomes a part.
  /// @return nothing where there would be more than 6 parts
  /// @throws std::invalid_argument if the size is another
  std::optional<Eigen::VectorXd> factors(const SparseSystem& system);

 private:
  double product(const SparseSystem& a, const SparseSystem& b) const;

  std::vector<SparseSystem> parts_;  ///< but the first, orthogonal
  double mass_norm_, velocity_norm_, position_norm_;  ///< of entries, as weights
};

}  // namespace stridor
