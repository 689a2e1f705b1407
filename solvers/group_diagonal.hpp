// Matrices with blocks on the diagonal, many of them of one entry.
#pragma once

#include <vector>

#include "solvers/padded_matrix.hpp"

namespace stridor {

/// Coordinates from `first` on that a matrix couples with each other and with no others.
struct CoordinateGroup {
  Eigen::Index first = 0;
  Eigen::Index size = 0;
};

/// n x n with a block for every group of coordinates.
class GroupDiagonal {
 public:
  GroupDiagonal() = default;
  /// @param dense  n x n; what it has between groups is left out
  /// @param groups one after another, of all n coordinates
  GroupDiagonal(const Eigen::MatrixXd& dense, const std::vector<CoordinateGroup>& groups);

  Eigen::Index size() const { return size_; }
  /// y += A x.
  /// @param y padded_size(size()) numbers, apart from x
  void add_product(const double* x, double* y) const;
  Eigen::MatrixXd dense() const;

 private:
  struct Run {
    Eigen::Index first = 0;
    std::vector<double> entries;  ///< of groups of one coordinate, side by side
  };
  struct Block {
    Eigen::Index first = 0;
    Eigen::MatrixXd entries;
    PaddedMatrix padded;  ///< of large blocks
  };
  Eigen::Index size_ = 0;
  std::vector<Run> runs_;
  std::vector<Block> blocks_;
};

}  // namespace stridor
