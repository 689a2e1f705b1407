#include "io/imports/label_index.hpp"

#include <algorithm>

namespace stridor {

LabelIndex::LabelIndex(std::span<const std::int64_t> labels) {
  sorted_.reserve(labels.size());
  for (const std::int64_t label : labels)
    sorted_.push_back({label, static_cast<int>(sorted_.size())});
  if (!std::is_sorted(sorted_.begin(), sorted_.end())) std::sort(sorted_.begin(), sorted_.end());
  if (sorted_.empty()) return;
  const auto width = static_cast<std::uint64_t>(sorted_.back().label - sorted_.front().label) + 1;
  if (width > 8 * labels.size()) return;
  dense_.assign(width, -1);
  for (const Entry& entry : sorted_) {
    int& position = dense_[static_cast<std::size_t>(entry.label - sorted_.front().label)];
    if (position < 0) position = entry.position;
  }
}

int LabelIndex::find(std::int64_t label) const {
  if (sorted_.empty() || label < sorted_.front().label || label > sorted_.back().label) return -1;
  if (!dense_.empty()) return dense_[static_cast<std::size_t>(label - sorted_.front().label)];
  const auto entry = std::lower_bound(sorted_.begin(), sorted_.end(), Entry{label, -1});
  return entry->label == label ? entry->position : -1;
}

std::optional<std::pair<int, int>> LabelIndex::repeated() const {
  const auto twice = std::adjacent_find(
      sorted_.begin(), sorted_.end(),
      [](const Entry& one, const Entry& next) { return one.label == next.label; });
  if (twice == sorted_.end()) return std::nullopt;
  return std::pair(twice->position, std::next(twice)->position);
}

void LabelIndex::append_range(std::int64_t first, std::int64_t last, std::int64_t step,
                              std::vector<int>& positions) const {
  auto entry = std::lower_bound(sorted_.begin(), sorted_.end(), Entry{first, -1});
  for (; entry != sorted_.end() && entry->label <= last; ++entry) {
    if ((entry->label - first) % step == 0) positions.push_back(entry->position);
  }
}

}  // namespace stridor
