#include "solvers/algebra/block_products.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace stridor {
namespace {

TEST(BlockProducts, SumBlocksOfAnyRank) {
  constexpr Eigen::Index rows = 9, columns = 7;
  BlockProducts products(rows, columns);
  EXPECT_TRUE(products.is_zero());
  EXPECT_EQ(products.sum(), Eigen::MatrixXd::Zero(rows, columns));
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(rows, columns);
  // More than one allocation of columns.
  for (int i = 0; i < 200; ++i) {
    const Eigen::Index width = 3 + i % 5;
    const Eigen::Index rank = i % 3;
    const Eigen::MatrixXd before = Eigen::MatrixXd::Random(rows, width);
    const Eigen::MatrixXd after = Eigen::MatrixXd::Random(width, columns);
    Eigen::MatrixXd block = Eigen::MatrixXd::Zero(width, width);
    if (rank > 0) {
      const Eigen::MatrixXd left = Eigen::MatrixXd::Random(width, rank);
      const Eigen::MatrixXd right = Eigen::MatrixXd::Random(rank, width);
      block = left * right;
    }
    products.add(before, block, after);
    expected += before * block * after;
  }
  EXPECT_LT((products.sum() - expected).cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace stridor
