#include "core/state.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <vector>

#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;
using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;

using Limits = std::numeric_limits<double>;

std::vector<std::uint64_t> bits(const std::vector<double>& values) {
  std::vector<std::uint64_t> patterns;
  for (const double value : values) patterns.push_back(std::bit_cast<std::uint64_t>(value));
  return patterns;
}

TEST(State, ReturnsWhatWasPutBitForBit) {
  const std::vector<double> values{0.0,
                                   -0.0,
                                   Limits::denorm_min(),
                                   -Limits::denorm_min(),
                                   0.5 * Limits::min(),
                                   Limits::min(),
                                   Limits::max(),
                                   Limits::lowest(),
                                   Limits::infinity(),
                                   -Limits::infinity(),
                                   Limits::epsilon(),
                                   1.0 / 3.0,
                                   std::bit_cast<double>(std::uint64_t{0x7ff8000000000123})};
  State state;
  state.put("a", values);
  std::vector<double> read(values.size(), 7.0);
  state.get("a", read);
  EXPECT_EQ(bits(read), bits(values));
  EXPECT_EQ(bits(state.array("a")), bits(values));
}

TEST(State, SingleNumberIsAnArrayOfOne) {
  State state;
  state.put("t", -0.0);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(state.get("t")), std::bit_cast<std::uint64_t>(-0.0));
  EXPECT_EQ(state.array("t").size(), 1u);
}

TEST(State, HoldsIntegersUpToTwoToThe53Exactly) {
  constexpr std::int64_t largest = std::int64_t{1} << 53;
  State state;
  for (const std::int64_t integer : {largest, largest - 1, -largest, -largest + 1}) {
    state.put("n", static_cast<double>(integer));
    EXPECT_EQ(static_cast<std::int64_t>(state.get("n")), integer);
  }
}

TEST(State, KeepsItsOwnCopy) {
  std::vector<double> values{1.0, 2.0};
  State state;
  state.put("a", values);
  values[0] = 9.0;
  EXPECT_THAT(state.array("a"), ElementsAre(1.0, 2.0));
}

TEST(State, LaterPutReplacesArrayAndLength) {
  State state;
  state.put("a", std::vector<double>{1.0, 2.0, 3.0});
  state.put("a", std::vector<double>{4.0});
  EXPECT_THAT(state.array("a"), ElementsAre(4.0));
  EXPECT_EQ(state.arrays().size(), 1u);
}

TEST(State, HoldsEmptyArrays) {
  State state;
  state.put("nothing", std::vector<double>{});
  EXPECT_THAT(state.array("nothing"), IsEmpty());
  std::vector<double> none;
  EXPECT_NO_THROW(state.get("nothing", none));
}

TEST(State, PrefixesKeepPartsApart) {
  State state;
  state.put("bodies/oblique/increment", 1.0);
  state.put("bodies/cantilever/increment", 2.0);
  EXPECT_EQ(state.get("bodies/oblique/increment"), 1.0);
  EXPECT_EQ(state.get("bodies/cantilever/increment"), 2.0);
}

TEST(State, EqualityComparesNamesAndValues) {
  State a;
  State b;
  EXPECT_EQ(a, b);
  a.put("x", 1.0);
  EXPECT_NE(a, b);
  b.put("y", 1.0);
  EXPECT_NE(a, b);
  b = a;
  EXPECT_EQ(a, b);
  b.put("x", 2.0);
  EXPECT_NE(a, b);
}

TEST(State, MissingArrayThrowsWithItsName) {
  State state;
  state.put("a", 1.0);
  EXPECT_EQ(message_of<std::invalid_argument>([&] { state.get("b"); }), "state: no array 'b'");
  EXPECT_EQ(message_of<std::invalid_argument>([&] { state.array("b"); }), "state: no array 'b'");
  std::vector<double> values(3, 7.0);
  EXPECT_EQ(message_of<std::invalid_argument>([&] { state.get("b", values); }),
            "state: no array 'b'");
  EXPECT_THAT(values, Each(7.0));
}

TEST(State, OtherLengthThrowsAndLeavesTheTargetUntouched) {
  State state;
  state.put("a", std::vector<double>{1.0, 2.0});
  for (const std::size_t length : {std::size_t{0}, std::size_t{1}, std::size_t{3}}) {
    std::vector<double> values(length, 7.0);
    EXPECT_EQ(message_of<std::invalid_argument>([&] { state.get("a", values); }),
              "state: array 'a' has 2 entries, expected " + std::to_string(length));
    EXPECT_THAT(values, Each(7.0));
  }
}

TEST(State, ArrayReadAsNumberThrows) {
  State state;
  state.put("a", std::vector<double>{1.0, 2.0});
  EXPECT_EQ(message_of<std::invalid_argument>([&] { state.get("a"); }),
            "state: array 'a' has 2 entries, expected 1");
}

}  // namespace
}  // namespace stridor
