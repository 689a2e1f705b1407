#include "solvers/eigenvalues/eigenvalue_count.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace stridor {
namespace {

using Complex = std::complex<double>;

/// The logarithm of a polynomial with given zeros and their conjugates, on its principal branch;
/// and how often it was asked for.
std::function<Complex(Complex)> polynomial(std::vector<Complex> zeros, int* asked = nullptr) {
  return [zeros = std::move(zeros), asked](Complex s) {
    if (asked != nullptr) ++*asked;
    Complex sum = 0.0;
    for (const Complex& zero : zeros)
      sum += std::log(zero.imag() > 0.0 ? (s - zero) * (s - std::conj(zero)) : s - zero);
    return Complex(sum.real(), std::remainder(sum.imag(), 2.0 * std::numbers::pi));
  };
}

TEST(EigenvalueCount, CountsWhatLiesInsideWhateverIsKnown) {
  // Inside: two pairs and a real zero; outside on every side, one of them close.
  const std::vector<Complex> zeros{{-0.1, 1.0}, {0.2, 3.999}, {-0.5, 0.0}, {-0.1, 4.001},
                                   {6.0, 1.0},  {-3.0, 0.0},  {0.0, 40.0}};
  const auto phase = polynomial(zeros);
  const auto count = [&](const std::vector<Complex>& known) {
    return count_in_rectangle(phase, -2.0, 5.0, 4.0, known);
  };
  EXPECT_EQ(count({}), 5);
  EXPECT_EQ(count(zeros), 5);
  EXPECT_EQ(count({zeros[0]}), 5);
  EXPECT_EQ(count({zeros[2], zeros[4]}), 5);
  // A zero that is passed as known and is none.
  EXPECT_EQ(count({zeros[0], {0.3, 2.0}}), 5);
}

TEST(EigenvalueCount, CountsMultipleZeros) {
  const auto phase = polynomial({{0.0, 1.0}, {0.0, 1.0}, {0.0, 1.0}});
  EXPECT_EQ(count_in_rectangle(phase, -1.0, 1.0, 2.0, {}), 6);
}

TEST(EigenvalueCount, SaysWhereAZeroLiesOnTheRectangle) {
  EXPECT_EQ(count_in_rectangle(polynomial({{0.5, 2.0}}), -1.0, 1.0, 2.0, {}), std::nullopt);
}

/// Zeros above the rectangle turn f by many times a turn within a step; a polynomial tells of them.
TEST(EigenvalueCount, ManyZerosOutsideCostNothing) {
  std::vector<Complex> zeros;
  for (int k = 0; k < 2000; ++k) zeros.emplace_back(-0.002 * k, 1.6 + 0.01 * k);
  int asked = 0;
  EXPECT_EQ(count_in_rectangle(polynomial(zeros, &asked), -0.5, 1.25, 1.0, {}), 0);
  EXPECT_LT(asked, 40);
  // Two of them inside.
  zeros.emplace_back(0.01, 0.4);
  zeros.emplace_back(-0.01, 0.9);
  EXPECT_EQ(count_in_rectangle(polynomial(zeros), -0.5, 1.25, 1.0, {}), 4);
  asked = 0;
  const std::vector<Complex> known{{0.01, 0.4}, {-0.01, 0.9}};
  EXPECT_EQ(count_in_rectangle(polynomial(zeros, &asked), -0.5, 1.25, 1.0, known), 4);
  EXPECT_LT(asked, 40);
}

/// Two zeros close to a step together turn the phase by as good as a whole turn within it, which
/// cannot be seen in the phase of its ends.
TEST(EigenvalueCount, NoneHidesWithinAStep) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int round = 0; round < 300; ++round) {
    std::vector<Complex> zeros;
    const int num_outside = 40 * static_cast<int>(3.0 * share(generator));
    for (int k = 0; k < num_outside; ++k)
      zeros.emplace_back(0.2 * share(generator) - 0.1, 1.5 + 3.0 * share(generator));
    const double closeness = std::pow(10.0, -1.0 - 5.0 * share(generator));
    const int num_close = 1 + static_cast<int>(4.0 * share(generator));
    const double way = 3.75 * share(generator);
    Complex place(way - 1.5, 1.0);  // on the top
    Complex inwards(0.0, -1.0);
    if (way < 1.0) place = {1.25, way}, inwards = -1.0;  // on the right
    if (way > 2.75) place = {-0.5, way - 2.75}, inwards = 1.0;
    if (place.imag() < 0.01) continue;
    int inside = 0;
    for (int k = 0; k < num_close; ++k) {
      const bool is_inside = share(generator) < 0.7;
      const Complex near = place + (is_inside ? 1.0 : -1.0) * closeness * (1.0 + 0.2 * k) * inwards;
      zeros.push_back(near);
      if (is_inside) inside += 2;
    }
    const auto counted = count_in_rectangle(polynomial(zeros), -0.5, 1.25, 1.0, {});
    ASSERT_TRUE(counted.has_value()) << round;
    EXPECT_EQ(*counted, inside) << "round " << round << ", closeness " << closeness;
  }
}

}  // namespace
}  // namespace stridor
