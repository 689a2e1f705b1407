#include "io/imports/inp_sets.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "io/imports/mesh_draft.hpp"

namespace stridor {

int InpSets::define(InpScope scope, const std::string& name) {
  const auto next = static_cast<int>(names_.size());
  const auto [found, is_new] = by_name_.emplace(std::pair(scope, lower_case_of(name)), next);
  if (is_new) names_.push_back(name);
  return found->second;
}

int InpSets::find(InpScope scope, const std::string& name) const {
  const auto found = by_name_.find({scope, lower_case_of(name)});
  return found == by_name_.end() ? -1 : found->second;
}

void InpSets::add_label(int set, std::int64_t label, const TextPlace& place) {
  entries_.push_back({set, EntryKind::label, label, label, 1, place});
}

void InpSets::add_range(int set, std::int64_t first, std::int64_t last, std::int64_t step,
                        const TextPlace& place) {
  entries_.push_back({set, EntryKind::range, first, last, step, place});
}

void InpSets::add_set(int set, int other, const TextPlace& place) {
  entries_.push_back({set, EntryKind::set, other, 0, 0, place});
}

void InpSets::add_positions(int set, std::size_t begin, std::size_t end) {
  // Lines of one block follow each other.
  if (!entries_.empty() && entries_.back().set == set &&
      entries_.back().kind == EntryKind::positions &&
      static_cast<std::size_t>(entries_.back().last) == begin) {
    entries_.back().last = static_cast<std::int64_t>(end);
    return;
  }
  entries_.push_back({set,
                      EntryKind::positions,
                      static_cast<std::int64_t>(begin),
                      static_cast<std::int64_t>(end),
                      1,
                      {}});
}

void InpSets::add_to(const Entry& entry, const LabelIndex& index,
                     std::vector<std::vector<int>>& members) const {
  std::vector<int>& target = members[static_cast<std::size_t>(entry.set)];
  const std::string& name = names_[static_cast<std::size_t>(entry.set)];
  switch (entry.kind) {
    case EntryKind::label: {
      const int position = index.find(entry.first);
      if (position < 0) {
        refuse_at(entry.place, fmt::format("{} {} of set '{}' is not defined in this file", kind_,
                                           entry.first, shown(name)));
      }
      target.push_back(position);
      return;
    }
    case EntryKind::range: {
      const std::size_t before = target.size();
      index.append_range(entry.first, entry.last, entry.step, target);
      if (target.size() == before) {
        refuse_at(entry.place,
                  fmt::format("no {} from {} to {} of set '{}' is defined in this file", kind_,
                              entry.first, entry.last, shown(name)));
      }
      return;
    }
    case EntryKind::set: {
      std::vector<int>& other = members[static_cast<std::size_t>(entry.first)];
      sort_unique(other);
      target.insert(target.end(), other.begin(), other.end());
      return;
    }
    case EntryKind::positions:
      for (std::int64_t k = entry.first; k < entry.last; ++k) target.push_back(static_cast<int>(k));
      return;
  }
}

std::vector<std::vector<int>> InpSets::members(const LabelIndex& index) const {
  constexpr std::size_t most_members = 200'000'000;
  std::vector<std::vector<int>> result(names_.size());
  std::size_t total = 0;
  for (const Entry& entry : entries_) {
    std::vector<int>& target = result[static_cast<std::size_t>(entry.set)];
    const std::size_t before = target.size();
    add_to(entry, index, result);
    total += target.size() - before;
    // What a set holds twice is removed before it takes much room.
    if (target.size() > 2 * before && target.size() > 1000) sort_unique(target);
    if (total > most_members && entry.place.source != nullptr)
      refuse_at(entry.place, fmt::format("sets of more than {} members", most_members));
  }
  for (std::vector<int>& set : result) sort_unique(set);
  return result;
}

std::vector<std::string> InpSets::names(const std::string& prefix) const {
  std::vector<std::string> result = names_;
  for (const auto& [key, set] : by_name_) {
    if (key.first == InpScope::part && by_name_.contains({InpScope::assembly, key.second})) {
      std::string& name = result[static_cast<std::size_t>(set)];
      name = prefix + "." + name;
    }
  }
  return result;
}

}  // namespace stridor
