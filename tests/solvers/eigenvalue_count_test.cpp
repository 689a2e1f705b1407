#include "solvers/eigenvalues/eigenvalue_count.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace stridor {
namespace {

using Complex = std::complex<double>;

/// A polynomial with given zeros and their conjugates.
std::function<Complex(Complex)> polynomial(std::vector<Complex> zeros) {
  return [zeros = std::move(zeros)](Complex s) {
    Complex phase = 1.0;
    for (const Complex& zero : zeros) {
      phase *= zero.imag() > 0.0 ? (s - zero) * (s - std::conj(zero)) : s - zero;
      phase /= std::abs(phase);
    }
    return phase;
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

}  // namespace
}  // namespace stridor
