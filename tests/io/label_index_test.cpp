#include "io/imports/label_index.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <unordered_map>

namespace stridor {
namespace {

TEST(LabelIndex, FindsLabelsWithAndWithoutGaps) {
  // Seeded; dense for the narrow range, sorted for the wide one.
  for (const std::int64_t widest : {std::int64_t{3000}, std::numeric_limits<std::int64_t>::max()}) {
    std::mt19937_64 random(1);
    std::uniform_int_distribution<std::int64_t> any(0, widest);
    std::vector<std::int64_t> labels;
    std::unordered_map<std::int64_t, int> expected;
    while (labels.size() < 1000) {
      const std::int64_t label = any(random);
      if (expected.emplace(label, static_cast<int>(labels.size())).second) labels.push_back(label);
    }
    const LabelIndex index(labels);
    EXPECT_EQ(index.repeated(), std::nullopt);
    for (int k = 0; k < 5000; ++k) {
      const std::int64_t label = k < 1000 ? labels[static_cast<std::size_t>(k)] : any(random);
      const auto found = expected.find(label);
      ASSERT_EQ(index.find(label), found == expected.end() ? -1 : found->second);
    }
  }
  EXPECT_EQ(LabelIndex().find(1), -1);
}

TEST(LabelIndex, FindsRepeatedLabelsInTheOrderOfTheList) {
  const LabelIndex index(std::vector<std::int64_t>{7, 3, 9, 3, 3});
  EXPECT_EQ(index.repeated(), (std::pair{1, 3}));
  EXPECT_EQ(index.find(3), 1);
}

TEST(LabelIndex, RangesPassOverWhatDoesNotExist) {
  const LabelIndex index(std::vector<std::int64_t>{50, 10, 20, 30, 15});
  std::vector<int> positions{99};
  index.append_range(10, std::numeric_limits<std::int64_t>::max(), 10, positions);
  EXPECT_EQ(positions, (std::vector<int>{99, 1, 2, 3, 0}));
}

}  // namespace
}  // namespace stridor
