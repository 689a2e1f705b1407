#include "core/excerpt.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "core/utf8.hpp"

namespace stridor {
namespace {

// With the margin, a terminal of 80 columns is filled.
constexpr int widest = 72;
/// Of a line that is cut on both sides: columns shown before the caret.
constexpr int most_before = 44;
/// Bytes looked at on either side of the caret; longer lines cost no more.
constexpr std::size_t reach = 1024;
constexpr int tab_width = 4;
constexpr std::string_view ellipsis = "...";

/// One character as the terminal shows it.
struct Cell {
  std::string text;
  int width = 1;
};

/// Characters that move the cursor, ring, or turn the direction of writing.
bool is_unsafe(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7F && code < 0xA0) || (code >= 0x200E && code <= 0x200F) ||
         (code >= 0x2028 && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
}

/// The character at `line[i]`; `i` is moved behind it.
Cell take_cell(std::string_view line, std::size_t& i) {
  const Utf8Character character = utf8_at(line, i);
  const std::size_t begin = i;
  i += std::max<std::size_t>(character.length, 1);
  if (character.length > 0 && character.code == '\t')
    return {std::string(tab_width, ' '), tab_width};
  if (character.length == 0 || is_unsafe(character.code)) return {"?", 1};
  return {std::string(line.substr(begin, character.length)), terminal_width(character.code)};
}

bool continues_character(char c) {
  return (static_cast<unsigned char>(c) & 0xC0u) == 0x80u;
}

/// A line, or the part of it that is shown.
struct Cells {
  std::vector<Cell> cells;
  std::size_t marked = 0;  ///< cells before the caret
  bool is_cut_before = false;
  bool is_cut_after = false;
};

/// @param at byte of the character that is marked, or any inside it
Cells cells_around(std::string_view line, std::size_t at) {
  std::size_t i = at > reach ? at - reach : 0;
  while (i > 0 && i < at && continues_character(line[i])) ++i;
  Cells result;
  result.is_cut_before = i > 0;
  while (i < line.size() && i < at + reach) {
    result.cells.push_back(take_cell(line, i));
    if (i <= at) result.marked = result.cells.size();
  }
  result.is_cut_after = i < line.size();
  return result;
}

int width_of(std::span<const Cell> cells) {
  int sum = 0;
  for (const Cell& cell : cells) sum += cell.width;
  return sum;
}

/// Leaves of the cells those around the caret that fit between the dots.
Cells cut(const Cells& all) {
  const std::span<const Cell> cells(all.cells);
  int before = width_of(cells.first(all.marked));
  int width = before + width_of(cells.subspan(all.marked));
  if (!all.is_cut_before && !all.is_cut_after && width <= widest) return all;

  const int dots = static_cast<int>(ellipsis.size());
  const int allowed_before =
      all.is_cut_after ? most_before : std::max(most_before, widest - dots - (width - before));
  std::size_t first = 0;
  // A mark without the character that carries it would be put on the dots.
  while (before > allowed_before || (first > 0 && first < all.marked && cells[first].width == 0)) {
    before -= cells[first].width;
    width -= cells[first].width;
    ++first;
  }
  const bool is_cut_before = all.is_cut_before || first > 0;
  const int room = widest - (is_cut_before ? dots : 0);
  std::size_t last = cells.size();
  const bool is_cut_after = all.is_cut_after || width > room;
  while (is_cut_after && width > room - dots) width -= cells[--last].width;
  return {{all.cells.begin() + static_cast<std::ptrdiff_t>(first),
           all.cells.begin() + static_cast<std::ptrdiff_t>(last)},
          all.marked - first,
          is_cut_before,
          is_cut_after};
}

}  // namespace

std::string excerpt_of(std::string_view line, int number, int column) {
  const std::size_t at =
      column > 0 ? std::min(static_cast<std::size_t>(column) - 1, line.size()) : 0;
  const Cells shown = cut(cells_around(line, at));
  const std::string_view dots_before = shown.is_cut_before ? ellipsis : "";
  const std::string margin = number > 0 ? fmt::format("{:>5}", number) : std::string(5, ' ');
  std::string excerpt = fmt::format("{} | {}", margin, dots_before);
  for (const Cell& cell : shown.cells) excerpt += cell.text;
  if (shown.is_cut_after) excerpt += ellipsis;
  if (column > 0) {
    const int before = width_of(std::span(shown.cells).first(shown.marked));
    excerpt += fmt::format("\n{:{}} | {:{}}^", "", margin.size(), "",
                           dots_before.size() + static_cast<std::size_t>(before));
  }
  return excerpt;
}

}  // namespace stridor
