// Memory of simulations that step in the lanes of a vector.
#pragma once

#include <cstddef>

#include "solvers/algebra/aligned_array.hpp"
#include "solvers/transient/lane_kernel.hpp"

namespace stridor {

/// Sizes common to simulations in the same lanes, and the assumption of their contacts.
struct LaneShape {
  bool has_feedthrough;
  ContactAssumption assumption;
  std::size_t slave_modes;
  std::size_t master_modes;
  bool slave_residual;
  bool master_residual;
  auto operator<=>(const LaneShape&) const = default;
};

/// The arrays of a group of lanes, one after the other in whole cache lines.
class LaneStorage {
 public:
  /// Steps that the kernel does in one call where rows are watched; their data stay in the cache.
  static constexpr std::size_t max_traced = 256;

  explicit LaneStorage(const LaneShape& shape);

  /// Lanes of a vector.
  std::size_t width() const { return width_; }
  Lanes& lanes() { return lanes_; }
  const Lanes& lanes() const { return lanes_; }
  /// As of step_lanes().
  double* flagged() const { return flagged_; }
  /// Of the displacement watched in a lane, after one of the steps in the last call of the kernel.
  double traced(std::size_t lane, std::size_t step) const {
    return lanes_.trace[step * width_ + lane];
  }

 private:
  /// Gives every array its place from `data` on. @return numbers needed
  std::size_t assign(double* data);

  std::size_t width_;
  Lanes lanes_;
  AlignedArray numbers_;
  double* flagged_ = nullptr;
};

}  // namespace stridor
