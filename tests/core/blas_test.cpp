#include "core/blas.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <thread>
#include <vector>

namespace stridor {
namespace {

/// Products of several sizes, as BLAS forms them.
std::vector<double> products() {
  std::vector<double> all;
  for (Eigen::Index n = 20; n < 120; n += 7) {
    const Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(
        n, n,
        [](Eigen::Index i, Eigen::Index j) { return 1.0 / static_cast<double>(i + 2 * j + 1); });
    const Eigen::MatrixXd square = a * a.transpose();
    all.insert(all.end(), square.data(), square.data() + square.size());
  }
  return all;
}

TEST(Threads, GetOfBlasWhatOneAloneGets) {
  const std::vector<double> expected = products();
  std::vector<int> wrong(4, -1);
  std::vector<std::thread> threads;
  for (int& count : wrong) {
    threads.emplace_back([&] {
      keep_blas_in_this_thread();
      count = 0;
      for (int round = 0; round < 20; ++round) {
        const BlasGuard guard;
        if (products() != expected) ++count;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const int count : wrong) EXPECT_EQ(count, 0);
}

}  // namespace
}  // namespace stridor
