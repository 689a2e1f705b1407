#include "solvers/algebra/block_products.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <limits>

namespace stridor {

void BlockProducts::add(const Eigen::Ref<const Eigen::MatrixXd>& before,
                        const Eigen::MatrixXd& block,
                        const Eigen::Ref<const Eigen::MatrixXd>& after) {
  if (block.isZero(0.0)) return;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors(block);
  factors.setThreshold(std::numeric_limits<double>::epsilon());
  const Eigen::Index rank = factors.rank();
  const Eigen::MatrixXd Q = factors.householderQ() * Eigen::MatrixXd::Identity(block.rows(), rank);
  const Eigen::MatrixXd R = factors.matrixQR().topRows(rank).triangularView<Eigen::Upper>();
  const Eigen::MatrixXd weights = R * factors.colsPermutation().inverse();
  if (rank_ + rank > left_.cols()) {
    const Eigen::Index space = std::max<Eigen::Index>(2 * left_.cols(), rank_ + 64 + rank);
    left_.conservativeResize(Eigen::NoChange, space);
    right_.conservativeResize(space, Eigen::NoChange);
  }
  left_.middleCols(rank_, rank).noalias() = before * Q;
  right_.middleRows(rank_, rank).noalias() = weights * after;
  rank_ += rank;
}

Eigen::MatrixXd BlockProducts::sum() const {
  if (is_zero()) return Eigen::MatrixXd::Zero(left_.rows(), right_.cols());
  return left_.leftCols(rank_) * right_.topRows(rank_);
}

}  // namespace stridor
