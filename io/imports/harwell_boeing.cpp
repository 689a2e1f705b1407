#include "io/imports/harwell_boeing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <utility>
#include <vector>

#include "io/imports/matrix_entries.hpp"
#include "io/imports/text_words.hpp"

namespace stridor {
namespace {

/// Numbers of a Fortran format such as "(16I5)" or "(1P,3D25.16)".
struct FieldFormat {
  std::size_t per_line = 1;
  std::size_t width = 0;
};

std::optional<FieldFormat> field_format(std::string_view text) {
  FieldFormat format;
  std::size_t number = 0;
  bool has_number = false;
  bool is_width = false;
  for (const char c : text) {
    const auto letter = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    if (letter >= '0' && letter <= '9') {
      if (number > 1000) return std::nullopt;
      number = 10 * number + static_cast<std::size_t>(letter - '0');
      has_number = true;
    } else if (letter == 'P') {  // a scale, of which input with exponents takes no notice
      number = 0;
      has_number = false;
    } else if (std::string_view("IEDFG").find(letter) != std::string_view::npos && !is_width) {
      format.per_line = has_number ? number : 1;
      number = 0;
      has_number = false;
      is_width = true;
    } else if (is_width) {
      break;  // digits behind the point, or the end
    } else if (std::string_view("( ,").find(letter) == std::string_view::npos) {
      return std::nullopt;
    }
  }
  format.width = number;
  const bool is_usable = is_width && format.per_line > 0 && format.width > 0;
  return is_usable ? std::optional(format) : std::nullopt;
}

std::string_view line_of(std::string_view text, int number) {
  for (int i = 1; i < number; ++i) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return {};
    text.remove_prefix(end + 1);
  }
  return text.substr(0, text.find('\n'));
}

class HarwellBoeingReader {
 public:
  explicit HarwellBoeingReader(const SourceText& source) : source_(source), lines_(source) {}

  LabelledMatrix read() {
    read_head();
    const auto columns = static_cast<std::size_t>(size_);
    const auto count = static_cast<std::size_t>(num_entries_);
    std::vector<std::int64_t> begins, rows;
    read_numbers(columns + 1, pointers_, [&](std::string_view word) {
      begins.push_back(lines_.integer(word, 1, num_entries_ + 1, "where a column begins"));
      const bool is_in_order =
          begins.size() == 1 ? begins[0] == 1 : begins.back() >= begins[begins.size() - 2];
      if (!is_in_order) lines_.fail(word, "columns begin at 1 and go upwards");
    });
    if (begins.back() != num_entries_ + 1) {
      lines_.fail(fmt::format("the last column ends at {}, expected {} behind the {} entries",
                              begins.back(), num_entries_ + 1, num_entries_));
    }
    rows.reserve(std::min<std::size_t>(count, source_.text.size()));
    read_numbers(count, indices_, [&](std::string_view word) {
      rows.push_back(lines_.integer(word, 1, size_, "the number of a row"));
    });
    MatrixEntries entries;
    std::size_t k = 0;
    std::size_t column = 0;
    read_numbers(count, values_, [&](std::string_view word) {
      while (static_cast<std::size_t>(begins[column + 1]) <= k + 1) ++column;
      entries.add(static_cast<int>(rows[k++]) - 1, static_cast<int>(column),
                  lines_.real(word, "an entry"));
    });
    LabelledMatrix read =
        std::move(entries).finish(static_cast<int>(size_), "Harwell-Boeing", {&source_, 0});
    read.is_open = false;
    return read;
  }

 private:
  void expect_line(const char* what) {
    if (!lines_.next_raw()) lines_.fail(fmt::format("the file ends, expected {}", what));
  }

  void read_head() {
    expect_line("a title");
    expect_line("the numbers of lines");
    const std::vector<std::string_view> counts = lines_.words();
    if (counts.size() < 4 || counts.size() > 5)
      lines_.fail("expected the numbers of lines: in all, of columns, of rows, of values");
    expect_line("the type of the matrix");
    const std::vector<std::string_view> words = lines_.words();
    if (words.size() < 4) lines_.fail("expected the type, rows, columns and entries");
    const std::string type = lower_case_of(words[0]);
    if (type != "rsa" && type != "rua") {
      lines_.fail(words[0], fmt::format("a matrix of type '{}'; expected RSA (real, symmetric) or "
                                        "RUA (real), assembled",
                                        shown(words[0])));
    }
    size_ = lines_.integer(words[1], 1, largest_matrix, "the number of rows");
    if (lines_.integer(words[2], 1, largest_matrix, "the number of columns") != size_)
      lines_.fail(words[2], fmt::format("expected as many columns as rows, {}", size_));
    num_entries_ = lines_.integer(words[3], 1, 2'000'000'000, "the number of entries");
    // What the head promises must fit into the file before memory is taken for it.
    const auto length = static_cast<std::int64_t>(source_.text.size());
    if (size_ > length || num_entries_ > length)
      lines_.fail("the file is too short for as many rows and entries");
    read_formats();
    if (counts.size() == 5 && lines_.integer(counts[4], 0, largest_matrix,
                                             "the number of lines of right-hand sides") > 0)
      expect_line("the type of the right-hand sides");
  }

  void read_formats() {
    expect_line("the formats of the numbers");
    const std::string_view line = lines_.line();
    std::array<FieldFormat*, 3> formats{&pointers_, &indices_, &values_};
    std::size_t at = 0;
    for (FieldFormat* format : formats) {
      const std::size_t begin = line.find('(', at);
      const std::size_t end = line.find(')', std::min(begin, line.size()));
      const auto found = end == std::string_view::npos
                             ? std::nullopt
                             : field_format(line.substr(begin, end - begin + 1));
      if (!found)
        lines_.fail("expected three Fortran formats such as (16I5), (16I5) and (3E25.16)");
      *format = *found;
      at = end + 1;
    }
  }

  template <class Take>
  void read_numbers(std::size_t count, const FieldFormat& format, Take&& take) {
    for (std::size_t k = 0; k < count;) {
      expect_line("more numbers");
      const std::string_view line = lines_.line();
      for (std::size_t i = 0; i < format.per_line && k < count; ++i, ++k) {
        const std::size_t at = i * format.width;
        const std::string_view word =
            at < line.size() ? trimmed(line.substr(at, format.width)) : std::string_view();
        if (word.empty())
          lines_.fail(fmt::format("the line has {} numbers, expected {}", i,
                                  std::min(format.per_line, i + count - k)));
        take(word);
      }
    }
  }

  const SourceText& source_;
  TextLines lines_;
  std::int64_t size_ = 0, num_entries_ = 0;
  FieldFormat pointers_, indices_, values_;
};

}  // namespace

bool is_harwell_boeing(std::string_view text) {
  const std::string_view type = trimmed(line_of(text, 3).substr(0, 14));
  if (type.size() < 3 || line_of(text, 4).find('(') == std::string_view::npos) return false;
  const std::string lower = lower_case_of(type.substr(0, 3));
  return std::string_view("rcp").find(lower[0]) != std::string_view::npos &&
         std::string_view("suhzr").find(lower[1]) != std::string_view::npos &&
         std::string_view("ae").find(lower[2]) != std::string_view::npos;
}

LabelledMatrix read_harwell_boeing(const SourceText& source) {
  return HarwellBoeingReader(source).read();
}

}  // namespace stridor
