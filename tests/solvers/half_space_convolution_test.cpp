#include "solvers/half_space/half_space_convolution.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;
using ::testing::HasSubstr;

TEST(HalfSpaceConvolution, IsTheSumOverAllCellsAndTheirMirrorImages) {
  for (const std::size_t n : {2u, 4u, 8u, 18u}) {
    HalfSpaceConvolution half_space(n);
    const std::vector<SlidingCreep> creep{{0.4, 0.3}, {0.3, 5.0}};
    half_space.set_creep(creep, 0.5);
    const InfluenceTable table = half_space.influence().table(creep, 0.5);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    std::vector<double> p(half_space.num_values());
    for (double& value : p) value = uniform(random);
    std::vector<double> u(p.size());
    half_space.apply(p, u);
    const auto size = static_cast<int>(n);
    double largest = 0.0;
    for (int j = 0; j < size / 2; ++j) {
      for (int i = 0; i < size; ++i) {
        double sum = 0.0;
        for (int b = 0; b < size / 2; ++b) {
          for (int a = 0; a < size; ++a) {
            sum += p[static_cast<std::size_t>(b * size + a)] *
                   (table.at(i - a, j - b) + table.at(i - a, j + b + 1));
          }
        }
        largest = std::max(largest, std::abs(sum - u[static_cast<std::size_t>(j * size + i)]));
      }
    }
    // Sums of N² terms of size up to 3.5, each rounded.
    EXPECT_LT(largest, 1e-13 * static_cast<double>(n));
  }
}

TEST(HalfSpaceConvolution, WorksInPlace) {
  HalfSpaceConvolution half_space(8);
  std::vector<double> p(half_space.num_values(), 0.0);
  p[3] = 1.0;
  std::vector<double> u(p.size());
  half_space.apply(p, u);
  half_space.apply(p, p);
  EXPECT_EQ(p, u);
}

TEST(HalfSpaceConvolution, RefusesOddGridsAndImpossibleCreep) {
  EXPECT_THAT(message_of<std::invalid_argument>([] { HalfSpaceConvolution half_space(7); }),
              HasSubstr("7 cells a side are not even"));
  HalfSpaceConvolution half_space(4);
  const SlidingCreep creep{2.0, 1.0};
  EXPECT_THAT(message_of<std::invalid_argument>([&] {
                half_space.set_creep({&creep, 1}, 1.0);
              }),
              HasSubstr("sum to less than 1"));
}

}  // namespace
}  // namespace stridor
