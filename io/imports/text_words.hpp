// Lines and words of texts that programs write as tables of numbers.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/imports/source_text.hpp"

namespace stridor {

/// Goes through the lines of a text that hold anything.
class TextLines {
 public:
  explicit TextLines(const SourceText& source) : source_(source) {}

  /// The next line that holds a word (see words()); comments (see skip_lines_with()) are passed
  /// over, and so are lines of commas alone, which spreadsheets write for empty rows.
  bool next();
  /// The next line whatever it holds.
  bool next_raw();
  /// Lines that begin so are passed over; nothing: none are.
  void skip_lines_with(std::string_view beginning) { comment_ = beginning; }

  std::string_view line() const { return line_; }
  /// Where the line begins; at the end of the text, that end.
  TextPlace place() const { return {&source_, begin_}; }
  /// Where a part of the line stands.
  TextPlace place_of(std::string_view part) const {
    return {&source_, static_cast<std::size_t>(part.data() - source_.text.data())};
  }
  /// Words of the line between blanks and commas.
  const std::vector<std::string_view>& words();

  /// Words as numbers. @throws ConfigError saying what was expected
  std::int64_t integer(std::string_view word, std::int64_t low, std::int64_t high,
                       const char* what) const;
  /// Up to 1e100 in magnitude, so that products of some do not overflow.
  double real(std::string_view word, const char* what) const;
  [[noreturn]] void fail(const std::string& message) const { refuse_at(place(), message); }
  [[noreturn]] void fail(std::string_view word, const std::string& message) const {
    refuse_at(place_of(word), message);
  }

 private:
  const SourceText& source_;
  std::string_view comment_;
  std::string_view line_;
  std::size_t begin_ = 0;
  std::size_t next_ = 0;
  std::vector<std::string_view> words_;
};

}  // namespace stridor
