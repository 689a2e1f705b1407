// Sets of nodes or of elements of Abaqus and CalculiX input.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "io/imports/label_index.hpp"
#include "io/imports/source_text.hpp"

namespace stridor {

/// Where a name is known: in the part (or a file without parts), or in the assembly.
enum class InpScope { part, assembly };

/// Sets as they are written down, and their members once all labels are known. Names are the same
/// in capital and small letters; a set keeps the letters with which it first stands.
class InpSets {
 public:
  /// @param kind "node" or "element", for messages
  explicit InpSets(std::string kind) : kind_(std::move(kind)) {}

  /// Begins the set, or goes on with it where there is one of this name. What is added then belongs
  /// to it.
  int define(InpScope scope, const std::string& name);
  /// -1 if there is none.
  int find(InpScope scope, const std::string& name) const;

  void add_label(int set, std::int64_t label, const TextPlace& place);
  /// Labels first, first + step, ..., last, as far as they exist; at least one must.
  void add_range(int set, std::int64_t first, std::int64_t last, std::int64_t step,
                 const TextPlace& place);
  /// What the other set holds at this point of the file.
  void add_set(int set, int other, const TextPlace& place);
  /// The nodes or elements from `begin` to before `end` in the order of the file.
  void add_positions(int set, std::size_t begin, std::size_t end);

  /// Members of each set: positions, ascending, each once.
  /// @throws ConfigError if one does not exist
  std::vector<std::vector<int>> members(const LabelIndex& index) const;

  /// A name for each set: that of the assembly where both scopes have it, and then "PREFIX.name"
  /// for that of the part.
  std::vector<std::string> names(const std::string& prefix) const;
  std::size_t size() const { return names_.size(); }

 private:
  enum class EntryKind { label, range, set, positions };
  struct Entry {
    int set;
    EntryKind kind;
    std::int64_t first, last, step;
    TextPlace place;
  };
  void add_to(const Entry& entry, const LabelIndex& index,
              std::vector<std::vector<int>>& members) const;

  std::string kind_;
  std::vector<std::string> names_;
  std::map<std::pair<InpScope, std::string>, int> by_name_;
  std::vector<Entry> entries_;
};

}  // namespace stridor
