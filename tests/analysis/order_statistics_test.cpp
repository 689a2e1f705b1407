#include "analysis/order_statistics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "tests/support/rejection.hpp"

namespace stridor {
namespace {

/// Passes values on in pieces of several lengths and counts the passes.
struct Pieces {
  std::vector<double> values;
  int passes = 0;

  EachValue each() {
    return [this](const TakeValues& take) {
      ++passes;
      std::size_t length = 1;
      for (std::size_t i = 0; i < values.size(); i += length, length = length % 97 + 1) {
        length = std::min(length, values.size() - i);
        take(std::span<const double>(values).subspan(i, length));
      }
    };
  }
};

std::vector<double> over_decades(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> exponent(-320.0, 300.0);
  std::vector<double> values(count);
  for (double& value : values) value = std::pow(10.0, exponent(generator));
  return values;
}

void expect_sorted_values(Pieces pieces, std::size_t room, int most_passes) {
  std::vector<double> sorted = pieces.values;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t last = sorted.size() - 1;
  const std::vector<std::size_t> ranks{0, last / 10, last / 4, last / 2, last};
  const std::vector<double> found = order_statistics(pieces.each(), sorted.size(), ranks, room);
  ASSERT_EQ(found.size(), ranks.size());
  for (std::size_t i = 0; i < ranks.size(); ++i) EXPECT_EQ(found[i], sorted[ranks[i]]) << room;
  EXPECT_LE(pieces.passes, most_passes) << room;
}

TEST(OrderStatistics, AreThoseOfTheSortedValuesWhateverRoomThereIs) {
  std::vector<double> special = over_decades(3000, 1);
  special.insert(special.end(), 2000, 0.0);
  special.insert(special.end(), 500, -0.0);
  special.insert(special.end(), 3, std::numeric_limits<double>::infinity());
  special.insert(special.end(), 3, std::numeric_limits<double>::denorm_min());
  std::vector<double> close(4000);
  for (std::size_t i = 0; i < close.size(); ++i)
    close[i] = 1.0 + static_cast<double>(i * 1543 % 4000) * std::numeric_limits<double>::epsilon();
  for (const std::vector<double>& values : {special, close, over_decades(1, 2)}) {
    expect_sorted_values({values}, values.size(), 1);
    for (const std::size_t room : {1, 2, 7, 100, 1000}) expect_sorted_values({values}, room, 4);
  }
}

TEST(OrderStatistics, MostlyTakeTwoPasses) {
  std::mt19937_64 generator(5);
  std::normal_distribution<double> normal;
  Pieces pieces{std::vector<double>(200000)};
  for (double& value : pieces.values) value = std::abs(normal(generator));
  expect_sorted_values(std::move(pieces), 5000, 2);
}

TEST(OrderStatistics, ARankBeyondTheValuesIsRejected) {
  Pieces pieces{{1.0, 2.0}};
  test::expect_rejection([&] { order_statistics(pieces.each(), 2, {2}); },
                         "a rank is out of range");
}

}  // namespace
}  // namespace stridor
