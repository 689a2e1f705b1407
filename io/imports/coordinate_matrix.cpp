#include "io/imports/coordinate_matrix.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "io/imports/matrix_entries.hpp"
#include "io/imports/text_words.hpp"

namespace stridor {

LabelledMatrix read_coordinate_matrix(const SourceText& source) {
  TextLines lines(source);
  MatrixEntries entries;
  std::int64_t size = 0;
  while (lines.next()) {
    const auto& words = lines.words();
    if (words.size() != 3)
      lines.fail(fmt::format("expected 'row column value', got {} words", words.size()));
    const std::int64_t row = lines.integer(words[0], 1, largest_matrix, "the number of a row");
    const std::int64_t column = lines.integer(words[1], 1, largest_matrix, "the number of a column");
    const double value = lines.real(words[2], "an entry");
    size = std::max({size, row, column});
    entries.add(static_cast<int>(row) - 1, static_cast<int>(column) - 1, value);
  }
  if (entries.is_empty()) lines.fail("the file ends without an entry; expected 'row column value'");
  // As many rows as this have entries of their own in a matrix of a program; a slip of the pen is
  // not to take all memory.
  constexpr std::int64_t always = 1'000'000;
  if (size > always && size > 10 * static_cast<std::int64_t>(source.text.size()))
    refuse_at({&source, 0}, fmt::format("a row {} in a file as short as this", size));
  return std::move(entries).finish(static_cast<int>(size), "rows and columns by number",
                                   {&source, 0});
}

LabelledMatrix read_abaqus_matrix(const SourceText& source) {
  TextLines lines(source);
  lines.skip_lines_with("*");
  LabelledEntries entries;
  constexpr std::int64_t largest = std::numeric_limits<std::int64_t>::max();
  const auto unknown = [&](std::string_view node, std::string_view direction) {
    // Internal nodes, of Lagrange multipliers and the like, have numbers <= 0.
    return NodeUnknown{lines.integer(node, -largest, largest, "the number of a node"),
                       static_cast<int>(lines.integer(direction, 1, 1'000, "a degree of freedom"))};
  };
  while (lines.next()) {
    const auto& words = lines.words();
    if (words.size() != 5) {
      lines.fail(fmt::format("expected 'node, degree of freedom, node, degree of freedom, value', "
                             "got {} words",
                             words.size()));
    }
    NodeUnknown row = unknown(words[0], words[1]);
    NodeUnknown column = unknown(words[2], words[3]);
    const double value = lines.real(words[4], "an entry");
    entries.add(row, column, value);
  }
  if (entries.is_empty())
    lines.fail("the file ends without an entry; expected 'node, dof, node, dof, value'");
  return std::move(entries).finish("Abaqus matrix input", {&source, 0});
}

}  // namespace stridor
