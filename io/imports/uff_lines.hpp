// Datasets of a universal file, and numbers in their lines.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "io/imports/source_text.hpp"

namespace stridor {

/// A line with its place.
struct UffLine {
  std::string_view text;  ///< without its end
  TextPlace place;
};

/// Numbers behind the lines of a binary dataset, 58b.
struct UffBytes {
  bool is_big_endian = false;
  std::int64_t format = 2;  ///< of the numbers: IEEE 754 is 2
  std::string_view bytes;
};

struct UffDataset {
  int type = 0;  ///< 15, 55, ...
  TextPlace place;
  std::vector<UffLine> lines;    ///< behind that of the type
  std::optional<UffBytes> data;  ///< of a binary dataset
};

/// Divides a file into datasets.
///
/// Binary data end where their head says, if the dataset ends there; else at the next delimiter, or
/// with the file.
/// @throws ConfigError where no dataset begins
std::vector<UffDataset> uff_datasets(const SourceText& source);

/// Reads the lines of a dataset one after the other.
class UffReader {
 public:
  explicit UffReader(const UffDataset& dataset) : dataset_(dataset) {}

  bool is_at_end() const { return next_ == dataset_.lines.size(); }
  /// The next line. @param expected what it should hold, for the message
  /// @throws ConfigError where there is none
  const UffLine& line(const char* expected);
  void skip(std::size_t count, const char* expected);
  /// The text of the next line, which stays the next one; empty at the end.
  std::string_view ahead() const { return is_at_end() ? "" : dataset_.lines[next_].text; }
  /// Integers of the next line, in columns of 10 where blanks do not part them.
  /// @throws ConfigError if there are fewer than `least` or something else
  std::vector<std::int64_t> integers(std::size_t least, const char* expected);
  /// So many numbers from the next lines, in columns of `width` where blanks do not part them.
  std::vector<double> reals(std::size_t count, std::size_t width, const char* expected);

 private:
  const UffDataset& dataset_;
  std::size_t next_ = 0;
};

/// Numbers of a line in columns of these widths, repeated, where blanks do not part them.
/// @throws ConfigError naming what was expected
std::vector<double> uff_columns(const UffLine& line, std::span<const std::size_t> widths,
                                const char* expected);

/// Numbers of a text, in columns where blanks do not part them; nothing where there is something else.
std::optional<std::vector<double>> uff_numbers_in(std::string_view text, std::size_t width);

/// Numbers of a line, in columns where blanks do not part them.
/// @throws ConfigError naming what was expected
std::vector<double> uff_numbers(const UffLine& line, std::size_t width, const char* expected);

}  // namespace stridor
