#include "solvers/group_diagonal.hpp"

namespace stridor {

GroupDiagonal::GroupDiagonal(const Eigen::MatrixXd& dense,
                             const std::vector<CoordinateGroup>& groups)
    : size_(dense.rows()) {
  constexpr Eigen::Index large = 6;
  for (const auto& [first, size] : groups) {
    if (size > 1) {
      blocks_.push_back({first, dense.block(first, first, size, size), {}});
      if (size >= large) blocks_.back().padded = PaddedMatrix(blocks_.back().entries);
      continue;
    }
    const auto end_of = [](const Run& run) {
      return run.first + static_cast<Eigen::Index>(run.entries.size());
    };
    if (runs_.empty() || end_of(runs_.back()) != first) runs_.push_back({first, {}});
    runs_.back().entries.push_back(dense(first, first));
  }
}

void GroupDiagonal::add_product(const double* x, double* y) const {
  for (const Run& run : runs_) {
    const double* from = x + run.first;
    double* to = y + run.first;
    for (std::size_t i = 0; i < run.entries.size(); ++i) to[i] += run.entries[i] * from[i];
  }
  for (const Block& block : blocks_) {
    const Eigen::Index size = block.entries.rows();
    if (block.padded.rows() > 0) {
      block.padded.add_product(x + block.first, y + block.first);
      continue;
    }
    for (Eigen::Index j = 0; j < size; ++j) {
      const double share = x[block.first + j];
      for (Eigen::Index i = 0; i < size; ++i) y[block.first + i] += block.entries(i, j) * share;
    }
  }
}

Eigen::MatrixXd GroupDiagonal::dense() const {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size_, size_);
  for (const Run& run : runs_)
    for (std::size_t i = 0; i < run.entries.size(); ++i) {
      const Eigen::Index k = run.first + static_cast<Eigen::Index>(i);
      matrix(k, k) = run.entries[i];
    }
  for (const Block& block : blocks_)
    matrix.block(block.first, block.first, block.entries.rows(), block.entries.rows()) =
        block.entries;
  return matrix;
}

}  // namespace stridor
