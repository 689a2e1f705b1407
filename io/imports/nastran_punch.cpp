#include "io/imports/nastran_punch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "io/imports/matrix_entries.hpp"
#include "io/imports/text_words.hpp"

namespace stridor {
namespace {

/// A line of bulk data in its fields.
struct BulkLine {
  std::string name;                      ///< of the entry, in small letters, without '*'; "" goes on
  std::vector<std::string_view> fields;  ///< four or eight of them
};

/// A matrix that DMIG entries give.
struct PunchedMatrix {
  TextPlace place;
  bool is_usable = true;  ///< real and square
  LabelledEntries entries;
};

class PunchReader {
 public:
  explicit PunchReader(const SourceText& source) : source_(source), lines_(source) {
    lines_.skip_lines_with("$");
  }

  LabelledMatrix read(MatrixPurpose purpose) {
    while (lines_.next()) {
      const BulkLine line = split();
      if (line.name == "enddata") break;
      if (line.name == "dmig") {
        entry_ = Entry::matrix;
        begin_matrix(line);
      } else if (line.name == "grid") {
        entry_ = Entry::grid;
        read_grid(line);
      } else if (!line.name.empty()) {
        entry_ = Entry::other;
      } else if (entry_ == Entry::matrix) {
        add_entries(line.fields);
      } else if (entry_ == Entry::grid && is_grid_open_) {
        finish_grid(line.fields);
      }
    }
    return finish(purpose);
  }

 private:
  enum class Entry { other, matrix, grid };

  static constexpr std::int64_t largest_label = 2'000'000'000;

  BulkLine split() {
    const std::string_view line = lines_.line();
    BulkLine result;
    if (line.find(',') != std::string_view::npos) {
      split_free(line, result);
    } else {
      const bool is_wide = line.substr(0, 8).find('*') != std::string_view::npos;
      const std::size_t width = is_wide ? 16 : 8;
      result.name = lower_case_of(trimmed(line.substr(0, 8)));
      for (std::size_t at = 8; at < line.size() && at < 72; at += width)
        result.fields.push_back(trimmed(line.substr(at, std::min(width, 72 - at))));
    }
    std::erase(result.name, '*');
    if (!result.name.empty() && result.name.front() == '+') result.name.clear();
    result.fields.resize(std::max<std::size_t>(result.fields.size(), 8));
    return result;
  }

  void split_free(std::string_view line, BulkLine& result) {
    bool is_first = true;
    while (true) {
      const std::size_t comma = std::min(line.find(','), line.size());
      const std::string_view field = trimmed(line.substr(0, comma));
      if (is_first) {
        result.name = lower_case_of(field);
      } else {
        result.fields.push_back(field);
      }
      is_first = false;
      if (comma == line.size()) return;
      line.remove_prefix(comma + 1);
    }
  }

  std::int64_t integer(std::string_view field, std::int64_t low, std::int64_t high,
                       const char* what) const {
    if (field.empty()) lines_.fail(fmt::format("a field is empty, expected {}", what));
    return lines_.integer(field, low, high, what);
  }

  /// Exponents with D, or without a letter: "1.5-3".
  double real(std::string_view field, const char* what) const {
    if (field.empty()) lines_.fail(fmt::format("a field is empty, expected {}", what));
    const std::size_t sign = field.find_first_of("+-", 1);
    const bool has_bare_exponent = sign != std::string_view::npos &&
                                   std::string_view("0123456789.").find(field[sign - 1]) !=
                                       std::string_view::npos;
    if (has_bare_exponent) {
      std::string text(field.substr(0, sign));
      text += 'e';
      text += field.substr(sign);
      const auto value = real_in(text);
      if (value && std::abs(*value) <= 1e100) return *value;
    }
    return lines_.real(field, what);
  }

  NodeUnknown unknown(std::string_view node, std::string_view component) const {
    return {integer(node, 1, largest_label, "the number of a grid point"),
            static_cast<int>(component.empty()
                                 ? 0
                                 : lines_.integer(component, 0, 6, "a component"))};
  }

  void begin_matrix(const BulkLine& line) {
    const std::string name = lower_case_of(line.fields[0]);
    if (name.empty()) lines_.fail("a DMIG entry without the name of its matrix");
    if (line.fields[1] == "0") return begin_named(name, line);
    const auto found = matrices_.find(name);
    if (found == matrices_.end()) {
      lines_.fail(fmt::format("a column of the matrix '{}', of which no entry says the form; expected "
                              "'DMIG {} 0 6 ...' before it",
                              shown(name), shown(name)));
    }
    matrix_ = &found->second;
    column_ = unknown(line.fields[1], line.fields[2]);
    // In narrow fields rows follow in the same line.
    add_entries({line.fields.begin() + 4, line.fields.end()});
  }

  void begin_named(const std::string& name, const BulkLine& line) {
    const auto [found, is_new] = matrices_.emplace(name, PunchedMatrix{lines_.place(), true, {}});
    if (!is_new) lines_.fail(fmt::format("the form of the matrix '{}' is said twice", shown(name)));
    const std::int64_t form = integer(line.fields[2], 1, 9, "the form of a matrix");
    const std::int64_t type = integer(line.fields[3], 1, 4, "the type of a matrix");
    found->second.is_usable = (form == 6 || form == 1) && type <= 2;
    matrix_ = nullptr;
    names_.push_back(name);
  }

  void add_entries(const std::vector<std::string_view>& fields) {
    for (std::size_t i = 0; i + 2 < fields.size(); i += 4) {
      if (fields[i].empty()) continue;
      if (matrix_ == nullptr) lines_.fail("an entry behind the form of a matrix, not a column");
      matrix_->entries.add(unknown(fields[i], fields[i + 1]), column_,
                           real(fields[i + 2], "an entry"));
    }
  }

  void read_grid(const BulkLine& line) {
    const std::int64_t label = integer(line.fields[0], 1, largest_label, "the number of a grid point");
    if (!line.fields[1].empty() && line.fields[1] != "0") {
      lines_.fail(line.fields[1],
                  fmt::format("grid point {} is placed in coordinate system {}; expected the basic "
                              "one",
                              label, shown(line.fields[1])));
    }
    labels_.push_back(label);
    places_.push_back({coordinate(line.fields[2]), coordinate(line.fields[3]), 0.0});
    const bool is_wide = lines_.line().substr(0, 8).find('*') != std::string_view::npos;
    if (is_wide) {
      is_grid_open_ = true;
    } else {
      places_.back()[2] = coordinate(line.fields[4]);
      check_displacements(line.fields[5]);
      is_grid_open_ = false;
    }
  }

  double coordinate(std::string_view field) const {
    return field.empty() ? 0.0 : real(field, "a coordinate");
  }

  void finish_grid(const std::vector<std::string_view>& fields) {
    places_.back()[2] = coordinate(fields[0]);
    check_displacements(fields[1]);
    is_grid_open_ = false;
  }

  void check_displacements(std::string_view field) const {
    if (field.empty() || field == "0") return;
    lines_.fail(field, fmt::format("grid point {} has its displacements in coordinate system {}; "
                                   "expected the basic one",
                                   labels_.back(), shown(field)));
  }

  bool is_meant(const std::string& name, MatrixPurpose purpose) const {
    switch (purpose) {
      case MatrixPurpose::any: return true;
      case MatrixPurpose::mass: return name[0] == 'm';
      case MatrixPurpose::damping: return name[0] == 'b';
      case MatrixPurpose::stiffness: return name[0] == 'k' && name.substr(0, 2) != "k4";
    }
    return false;
  }

  LabelledMatrix finish(MatrixPurpose purpose) {
    std::vector<std::string> meant;
    for (const std::string& name : names_)
      if (is_meant(name, purpose)) meant.push_back(name);
    const char* expected = purpose == MatrixPurpose::mass      ? "one whose name begins with M"
                           : purpose == MatrixPurpose::damping ? "one whose name begins with B"
                           : purpose == MatrixPurpose::stiffness
                               ? "one whose name begins with K, but not with K4"
                               : "one only";
    if (meant.size() != 1) {
      refuse_at({&source_, 0},
                fmt::format("{} matrices of DMIG entries come into question; expected {} (there "
                            "are: {})",
                            meant.size(), expected,
                            names_.empty() ? std::string("none") : shown_names()));
    }
    PunchedMatrix& matrix = matrices_.at(meant.front());
    if (!matrix.is_usable) {
      refuse_at(matrix.place,
                fmt::format("the matrix '{}' is complex or not square; expected form 6 or 1 and "
                            "type 1 or 2",
                            shown(meant.front())));
    }
    if (matrix.entries.is_empty())
      refuse_at(matrix.place, fmt::format("the matrix '{}' has no entry", shown(meant.front())));
    LabelledMatrix read = std::move(matrix.entries).finish("Nastran DMIG", matrix.place);
    read.nodes.labels = labels_;
    read.nodes.positions.resize(static_cast<Eigen::Index>(places_.size()), 3);
    for (std::size_t i = 0; i < places_.size(); ++i)
      read.nodes.positions.row(static_cast<Eigen::Index>(i)) << places_[i][0], places_[i][1],
          places_[i][2];
    return read;
  }

  std::string shown_names() const {
    std::string all;
    for (const std::string& name : names_) all += (all.empty() ? "" : ", ") + shown(name);
    return all;
  }

  const SourceText& source_;
  TextLines lines_;
  Entry entry_ = Entry::other;
  bool is_grid_open_ = false;  ///< its second line is to come
  std::map<std::string, PunchedMatrix> matrices_;
  std::vector<std::string> names_;  ///< in the order of the file
  PunchedMatrix* matrix_ = nullptr;
  NodeUnknown column_;
  std::vector<std::int64_t> labels_;
  std::vector<std::array<double, 3>> places_;
};

}  // namespace

bool is_nastran_bulk(std::string_view text) {
  const std::string beginning = lower_case_of(trimmed(text.substr(0, 16)));
  for (const std::string_view word : {"$", "grid", "dmig", "begin", "assign", "spoint", "dti"})
    if (beginning.substr(0, word.size()) == word) return beginning.substr(0, 12) != "$meshformat";
  return false;
}

LabelledMatrix read_nastran_punch(const SourceText& source, MatrixPurpose purpose) {
  return PunchReader(source).read(purpose);
}

}  // namespace stridor
