// Keywords and data lines of Abaqus and CalculiX input, with included files.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/imports/source_text.hpp"

namespace stridor {

/// Reads a file that another one includes; its `name` is the path under which it is found.
using IncludeReader =
    std::function<SourceText(const std::string& including_file, const std::string& file)>;

struct InpParameter {
  std::string name;   ///< capital letters, single blanks
  std::string value;  ///< without quotes; empty without '='
};

/// "*NODE, NSET=all".
struct InpKeyword {
  std::string name;  ///< "NODE": capital letters, single blanks
  std::vector<InpParameter> parameters;
  TextPlace place;

  const InpParameter* find(std::string_view parameter) const;
};

/// What stands between two commas.
struct InpField {
  std::string_view text;  ///< without blanks at its ends and without quotes
  TextPlace place;
};

/// Splits a line at commas outside of quotes.
class InpFields {
 public:
  InpFields(std::string_view line, const TextPlace& place) : line_(line), place_(place) {}
  /// Empty ones too, but not behind the last comma.
  std::optional<InpField> next();

 private:
  std::string_view line_;
  TextPlace place_;
  std::size_t at_ = 0;
};

enum class InpLineKind { keyword, data, end };

/// Goes through a file and those that it includes. Comments and empty lines are passed over;
/// keyword lines that end with a comma are joined with the next one.
class InpLines {
 public:
  /// @param reader of included files; none: they are refused
  InpLines(SourceText source, IncludeReader reader);

  /// @throws ConfigError if a file cannot be included, is included by itself, or 16 deep
  InpLineKind next();
  const InpKeyword& keyword() const { return keyword_; }
  std::string_view data() const { return data_; }
  const TextPlace& place() const { return place_; }
  const SourceText& main_source() const { return sources_.front(); }
  /// Goes on in another file, and behind it here.
  void include(const std::string& file, const TextPlace& place);
  /// Keeps the places of what was read.
  std::deque<SourceText> release() { return std::move(sources_); }

 private:
  struct Level {
    const SourceText* source;
    std::string path;  ///< the same for all names of a file
    std::size_t offset;
  };
  std::optional<std::string_view> next_line();
  void read_keyword(std::string_view line);
  void open(SourceText source, std::string path);

  std::deque<SourceText> sources_;
  IncludeReader reader_;
  std::vector<Level> levels_;
  InpKeyword keyword_;
  std::string_view data_;
  TextPlace place_;
};

}  // namespace stridor
