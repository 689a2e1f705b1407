// Iterates of Ehrlich and Aberth's search for all zeros of a real polynomial.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "solvers/algebra/aligned_array.hpp"

namespace stridor {

/// Iterates of which some are followed by their conjugates (docs/theory.md, 7.3).
class ZeroIterates {
 public:
  /// @param upper those whose conjugates are iterates as well
  /// @param alone the others
  ZeroIterates(const std::vector<std::complex<double>>& upper,
               const std::vector<std::complex<double>>& alone);

  /// Iterates that are moved, first those of `upper`: all but the conjugates.
  std::size_t num_free() const { return size_ - num_upper_; }
  std::complex<double> operator[](std::size_t free) const {
    return {re_[index(free)], im_[index(free)]};
  }
  void set(std::size_t free, std::complex<double> value);
  /// With the conjugates.
  std::vector<std::complex<double>> all() const;

  /// Σ 1/(z_j − z_i) over all others, and the distance of the nearest. One that equals z_j counts
  /// as itself.
  struct Surroundings {
    std::complex<double> repulsion;
    double spacing;
  };
  Surroundings around(std::size_t free) const;

 private:
  std::size_t index(std::size_t free) const { return free < num_upper_ ? free : num_upper_ + free; }

  std::size_t num_upper_;
  std::size_t size_;
  AlignedArray re_, im_;  ///< upper, their conjugates, the rest; padded with places far away
};

}  // namespace stridor
