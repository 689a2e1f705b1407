#include "io/imports/unknown_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "io/imports/label_index.hpp"
#include "io/imports/matrix_entries.hpp"
#include "io/imports/text_words.hpp"

namespace stridor {
namespace {

constexpr std::int64_t largest_label = 1'000'000'000'000;
constexpr const char* unknown_formats =
    "which rows are which nodes: .dof of CalculiX, .mapping of ANSYS, or a table 'node, direction'";
constexpr const char* node_formats = "a table of nodes: 'node, x, y, z' a line";

std::optional<int> direction_of(std::string_view word) {
  static const std::map<std::string, int, std::less<>> names{
      {"x", 1},  {"y", 2},  {"z", 3},  {"ux", 1}, {"uy", 2},   {"uz", 3},   {"rx", 4},
      {"ry", 5}, {"rz", 6}, {"1", 1},  {"2", 2},  {"3", 3},    {"4", 4},    {"5", 5},
      {"6", 6},  {"t1", 1}, {"t2", 2}, {"t3", 3}, {"rotx", 4}, {"roty", 5}, {"rotz", 6}};
  const auto found = names.find(lower_case_of(word));
  return found == names.end() ? std::nullopt : std::optional(found->second);
}

/// Places of nodes, each of which may stand in several lines.
class Places {
 public:
  void add(std::int64_t label, const std::array<double, 3>& place) {
    labels_.push_back(label);
    places_.push_back(place);
  }
  std::size_t size() const { return labels_.size(); }
  /// The first two lines of one node at different places.
  std::optional<std::size_t> contradiction() const {
    std::map<std::int64_t, std::size_t> first;
    for (std::size_t i = 0; i < labels_.size(); ++i) {
      const auto [found, is_new] = first.emplace(labels_[i], i);
      if (!is_new && places_[found->second] != places_[i]) return i;
    }
    return std::nullopt;
  }
  NodeTable table() const {
    std::map<std::int64_t, std::array<double, 3>> each;
    for (std::size_t i = 0; i < labels_.size(); ++i) each.emplace(labels_[i], places_[i]);
    NodeTable table;
    table.positions.resize(static_cast<Eigen::Index>(each.size()), 3);
    for (const auto& [label, place] : each) {
      table.positions.row(static_cast<Eigen::Index>(table.labels.size())) << place[0], place[1],
          place[2];
      table.labels.push_back(label);
    }
    return table;
  }

 private:
  std::vector<std::int64_t> labels_;
  std::vector<std::array<double, 3>> places_;
};

void refuse_repeated(const std::vector<NodeUnknown>& unknowns, const std::vector<TextPlace>& places) {
  std::map<NodeUnknown, std::size_t> first;
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    const auto [found, is_new] = first.emplace(unknowns[i], i);
    if (is_new) continue;
    refuse_at(places[i], fmt::format("node {} has direction {} already, in row {}; expected each of "
                                     "them once",
                                     unknowns[i].node, unknowns[i].direction, found->second + 1));
  }
}

class UnknownReader {
 public:
  explicit UnknownReader(const SourceText& source) : source_(source), lines_(source) {
    lines_.skip_lines_with("#");
  }

  UnknownTable read() {
    bool is_first = true;
    while (lines_.next()) {
      const auto& words = lines_.words();
      if (is_first && !integer_in(words.front()) && !is_dotted(words.front())) {
        is_first = false;
        read_head(words);
        continue;
      }
      is_first = false;
      if (is_mapping_) {
        add_equation(words);
      } else if (words.size() == 1) {
        add_dotted(words.front());
      } else {
        add_line(words);
      }
    }
    if (table_.unknowns.empty()) lines_.fail(fmt::format("the file ends, expected {}", unknown_formats));
    if (is_mapping_) order_equations();
    refuse_repeated(table_.unknowns, places_);
    if (const auto line = nodes_.contradiction())
      refuse_at(places_[*line], "the node stands at another place further up");
    table_.nodes = nodes_.table();
    return std::move(table_);
  }

 private:
  static bool is_dotted(std::string_view word) {
    const std::size_t dot = word.find('.');
    return dot != std::string_view::npos && dot > 0 && integer_in(word.substr(0, dot)) &&
           integer_in(word.substr(dot + 1));
  }

  void read_head(const std::vector<std::string_view>& words) {
    const std::string first = lower_case_of(words.front());
    is_mapping_ = first == "matrix";
    if (is_mapping_ || first == "node" || first == "nodes" || first == "label") return;
    lines_.fail(fmt::format("the file begins with '{}'; expected {}", shown(lines_.line()),
                            unknown_formats));
  }

  int direction(std::string_view word) const {
    const auto direction = direction_of(word);
    if (!direction) {
      lines_.fail(word, fmt::format("expected a direction, 1 to 6 or x, y, z, rx, ry, rz, got '{}'",
                                    shown(word)));
    }
    return *direction;
  }

  void add(std::int64_t node, int direction) {
    table_.unknowns.push_back({node, direction});
    places_.push_back(lines_.place());
  }

  /// "12.3": CalculiX.
  void add_dotted(std::string_view word) {
    if (!is_dotted(word))
      lines_.fail(fmt::format("expected 'node.direction' such as 12.3, got '{}'", shown(word)));
    const std::size_t dot = word.find('.');
    add(lines_.integer(word.substr(0, dot), 1, largest_label, "the number of a node"),
        direction(word.substr(dot + 1)));
  }

  void add_line(const std::vector<std::string_view>& words) {
    if (words.size() != 2 && words.size() != 5) {
      lines_.fail(fmt::format("expected 'node, direction' or 'node, direction, x, y, z', got {} words",
                              words.size()));
    }
    const std::int64_t node = lines_.integer(words[0], 1, largest_label, "the number of a node");
    if (words.size() == 5) {
      if (nodes_.size() != table_.unknowns.size())
        lines_.fail("a line with a place behind one without; expected all or none to have one");
      nodes_.add(node, {lines_.real(words[2], "a coordinate"), lines_.real(words[3], "a coordinate"),
                        lines_.real(words[4], "a coordinate")});
    } else if (nodes_.size() > 0) {
      lines_.fail("a line without a place behind one with it; expected all or none to have one");
    }
    add(node, direction(words[1]));
  }

  /// Equation, node, label: ANSYS.
  void add_equation(const std::vector<std::string_view>& words) {
    if (words.size() != 3)
      lines_.fail(fmt::format("expected 'equation node label', got {} words", words.size()));
    equations_.push_back(lines_.integer(words[0], 1, largest_matrix, "the number of an equation"));
    const std::int64_t node = lines_.integer(words[1], 0, largest_label, "the number of a node");
    const auto known = direction_of(words[2]);
    // Pressures, temperatures and the like have no place among displacements.
    add(known ? node : -equations_.back(), known.value_or(0));
  }

  void order_equations() {
    const std::size_t n = table_.unknowns.size();
    std::vector<NodeUnknown> ordered(n);
    std::vector<TextPlace> places(n);
    std::vector<bool> is_known(n);
    for (std::size_t i = 0; i < n; ++i) {
      const auto row = static_cast<std::size_t>(equations_[i]) - 1;
      if (row >= n || is_known[row]) {
        refuse_at(places_[i], fmt::format("equation {} {}; expected the numbers from 1 to {}, each "
                                          "once",
                                          equations_[i], row >= n ? "is too large" : "stands twice",
                                          n));
      }
      is_known[row] = true;
      ordered[row] = table_.unknowns[i];
      places[row] = places_[i];
    }
    table_.unknowns = std::move(ordered);
    places_ = std::move(places);
  }

  const SourceText& source_;
  TextLines lines_;
  bool is_mapping_ = false;
  UnknownTable table_;
  std::vector<TextPlace> places_;  ///< of the unknowns
  std::vector<std::int64_t> equations_;
  Places nodes_;
};

SourceText read_table_text(const std::string& path, const char* expected) {
  SourceText source = read_source_text(path, expected);
  const std::string foreign = foreign_format(source.text);
  if (!foreign.empty())
    refuse_at({&source, 0}, fmt::format("this is {}; expected {}", foreign, expected));
  return source;
}

}  // namespace

UnknownTable read_unknown_table(const SourceText& source) {
  return UnknownReader(source).read();
}

NodeTable read_node_table(const SourceText& source) {
  TextLines lines(source);
  lines.skip_lines_with("#");
  Places places;
  std::vector<TextPlace> where;
  while (lines.next()) {
    const auto& words = lines.words();
    // Heads, which lists of ANSYS repeat.
    if (lower_case_of(words.front()) == "node") continue;
    if (words.size() < 3 || words.size() == 5 || words.size() == 6 || words.size() > 7)
      lines.fail(fmt::format("expected 'node, x, y, z', got {} words", words.size()));
    const std::int64_t label = lines.integer(words[0], 1, largest_label, "the number of a node");
    std::array<double, 3> place{};
    for (std::size_t i = 1; i < std::min<std::size_t>(words.size(), 4); ++i)
      place[i - 1] = lines.real(words[i], "a coordinate");
    for (std::size_t i = 4; i < words.size(); ++i) {
      if (lines.real(words[i], "an angle") != 0.0) {
        lines.fail(words[i], fmt::format("node {} has displacements in directions of its own; "
                                         "expected those of the global axes",
                                         label));
      }
    }
    places.add(label, place);
    where.push_back(lines.place());
  }
  if (places.size() == 0) lines.fail(fmt::format("the file ends, expected {}", node_formats));
  if (const auto line = places.contradiction())
    refuse_at(where[*line], "the node stands at another place further up");
  return places.table();
}

UnknownTable read_unknown_file(const std::string& path) {
  return read_unknown_table(read_table_text(path, unknown_formats));
}

NodeTable read_node_file(const std::string& path) {
  return read_node_table(read_table_text(path, node_formats));
}

}  // namespace stridor
