// Finds nodes and elements by the numbers that a file gives them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace stridor {

/// From labels, which need neither be in order nor without gaps, to positions in the list that it
/// was made from. Memory: at most 48 bytes a label. Time: O(n log n) to make, O(1) or O(log n) to
/// find.
class LabelIndex {
 public:
  LabelIndex() = default;
  /// @param labels not negative, at most 2^31 - 1 of them
  explicit LabelIndex(std::span<const std::int64_t> labels);

  /// The position of a label, -1 if there is none; the first one where it stands twice.
  int find(std::int64_t label) const;
  /// The first two positions with the same label, if any.
  std::optional<std::pair<int, int>> repeated() const;
  /// Appends the positions of labels first, first + step, ... up to last; labels that do not exist
  /// are passed over. Cost: of what exists between first and last, however large the range.
  /// @param step at least 1
  void append_range(std::int64_t first, std::int64_t last, std::int64_t step,
                    std::vector<int>& positions) const;

 private:
  struct Entry {
    std::int64_t label;
    int position;
    auto operator<=>(const Entry&) const = default;
  };
  std::vector<Entry> sorted_;
  std::vector<int> dense_;  ///< position of label lowest + k, or -1; empty where gaps are large
};

}  // namespace stridor
