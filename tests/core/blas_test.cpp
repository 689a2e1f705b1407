#include "core/blas.hpp"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdlib>
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

TEST(BlasKernels, AreAskedForWhereTheLibraryDoesNotKnowTheProcessor) {
  EXPECT_EQ(blas_kernels_to_ask_for("Prescott", true, true), "SkylakeX");
  EXPECT_EQ(blas_kernels_to_ask_for("Prescott", true, false), "Haswell");
  EXPECT_EQ(blas_kernels_to_ask_for("Prescott", false, false), "");  // such a processor
  for (const char* known : {"Haswell", "Zen", "SkylakeX", "SapphireRapids", "a later one"})
    EXPECT_EQ(blas_kernels_to_ask_for(known, true, true), "");
}

#if defined(__x86_64__)
TEST(BlasKernels, AreWideInEveryProgram) {
  using Name = const char*();
  const auto taken = reinterpret_cast<Name*>(dlsym(RTLD_DEFAULT, "openblas_get_corename"));
  if (taken == nullptr) GTEST_SKIP() << "no OpenBLAS";
  if (!__builtin_cpu_supports("avx2")) GTEST_SKIP() << "no vectors of four numbers";
  const char* asked = std::getenv("OPENBLAS_CORETYPE");
  if (asked != nullptr) {
    EXPECT_STRCASEEQ(taken(), asked);
  } else {
    EXPECT_STRNE(taken(), "Prescott");
  }
}
#endif

}  // namespace
}  // namespace stridor
