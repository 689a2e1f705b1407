#include "solvers/eigenvalues/shift_invert.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;
using Complex = std::complex<double>;

/// Chains of n masses between held ends side by side, with damping proportional to stiffness.
SparseSystem chains(int count, int n, double beta) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int chain = 0; chain < count; ++chain) {
    for (int i = 0; i < n; ++i) {
      const int at = chain * n + i;
      entries.emplace_back(at, at, 2.0);
      if (i + 1 == n) continue;
      entries.emplace_back(at, at + 1, -1.0);
      entries.emplace_back(at + 1, at, -1.0);
    }
  }
  SparseSystem system;
  system.mass.resize(count * n, count * n);
  system.mass.setIdentity();
  system.position.resize(count * n, count * n);
  system.position.setFromTriplets(entries.begin(), entries.end());
  system.velocity = beta * system.position;
  return system;
}

/// s² + β ω² s + ω² = 0.
Complex damped(double omega, double beta) {
  const double decay = 0.5 * beta * omega * omega;
  return {-decay, std::sqrt(omega * omega - decay * decay)};
}

TEST(ShiftInvert, FindsAllWithinTheRadiusAndEachAsOftenAsItIs) {
  constexpr int n = 120;
  constexpr double beta = 0.05;
  for (const int count : {1, 2}) {
    const SparsePencil pencil(chains(count, n, beta));
    NearestPairsWanted wanted;
    wanted.shift = {0.01, 0.3};
    wanted.radius = 0.15;
    wanted.expected = 12 * count;
    wanted.most_steps = 200;
    Eigen::MatrixXcd start(count * n, 2);
    for (Eigen::Index i = 0; i < start.size(); ++i)
      start.data()[i] = {std::sin(1.0 + 3.0 * static_cast<double>(i * i)),
                         std::cos(5.0 * static_cast<double>(i))};
    const NearestPairs found = nearest_pairs(pencil, pencil.factorise(wanted.shift), wanted, start);
    EXPECT_TRUE(found.are_all);
    std::vector<Complex> expected;
    for (int k = 1; k <= n; ++k) {
      const Complex s = damped(2.0 * std::sin(0.5 * k * std::numbers::pi / (n + 1.0)), beta);
      if (std::abs(s - wanted.shift) <= wanted.radius)
        for (int chain = 0; chain < count; ++chain) expected.push_back(s);
    }
    std::sort(expected.begin(), expected.end(), [&](Complex a, Complex b) {
      return std::abs(a - wanted.shift) < std::abs(b - wanted.shift);
    });
    ASSERT_GE(found.pairs.size(), expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k) {
      EXPECT_LT(std::abs(found.pairs[k].s - expected[k]), 1e-10) << count << " " << k;
      EXPECT_LT(pencil.scaled_residual(found.pairs[k].s, found.pairs[k].x), 1e-8);
    }
    if (count == 2) {
      // Vectors of an eigenvalue that is double are independent.
      Eigen::MatrixXcd both(count * n, 2);
      both << found.pairs[0].x, found.pairs[1].x;
      EXPECT_GT(both.jacobiSvd().singularValues()(1), 1e-3);
    }
  }
}

TEST(ShiftInvert, ASpaceThatIsWholeEndsTheSearch) {
  const SparsePencil pencil(chains(1, 3, 0.1));
  NearestPairsWanted wanted;
  wanted.shift = {0.1, 1.0};
  wanted.radius = 100.0;
  wanted.expected = 6;
  wanted.most_steps = 50;
  const NearestPairs found = nearest_pairs(pencil, pencil.factorise(wanted.shift), wanted,
                                           Eigen::Vector3cd(1.0, 0.3, -0.2));
  EXPECT_TRUE(found.are_all);
  EXPECT_EQ(found.pairs.size(), 6U);
}

TEST(ShiftInvert, SaysWhatItLacks) {
  const SparsePencil pencil(chains(1, 30, 0.0));
  NearestPairsWanted wanted;
  wanted.shift = {0.01, 0.3};
  wanted.radius = 1.0;
  wanted.expected = 4;
  wanted.most_steps = 6;
  const SparseFactor factor = pencil.factorise(wanted.shift);
  EXPECT_FALSE(
      nearest_pairs(pencil, factor, wanted, Eigen::VectorXcd::LinSpaced(30, 1.0, 2.0)).are_all);
  EXPECT_EQ(message_of<std::invalid_argument>(
                [&] { nearest_pairs(pencil, factor, wanted, Eigen::MatrixXcd(30, 0)); }),
            "nearest pairs: there is nothing to start from");
}

}  // namespace
}  // namespace stridor
