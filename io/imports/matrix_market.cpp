#include "io/imports/matrix_market.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>
#include <stdexcept>

#include "core/errors.hpp"

namespace stridor {
namespace {

/// Words of one line with their columns.
struct Word {
  std::string text;
  int column = 0;
};

std::vector<Word> words_of(const std::string& line) {
  constexpr const char* blanks = " \t\r\f\v";
  std::vector<Word> words;
  std::size_t begin = line.find_first_not_of(blanks);
  while (begin != std::string::npos) {
    const std::size_t end = std::min(line.find_first_of(blanks, begin), line.size());
    words.push_back({line.substr(begin, end - begin), static_cast<int>(begin) + 1});
    begin = line.find_first_not_of(blanks, end);
  }
  return words;
}

template <class Number>
std::optional<Number> number_of(std::string text) {
  if (!text.empty() && text.front() == '+') text.erase(0, 1);
  Number value{};
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end) return std::nullopt;
  return value;
}

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) {
    return static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  });
  return text;
}

/// Products of three entries must not overflow.
constexpr double largest_entry = 1e100;

enum class Symmetry { general, symmetric, skew };

class MarketReader {
 public:
  MarketReader(std::istream& text, const std::string& source) : text_(text), source_(source) {}

  SparseMatrix read() {
    read_header();
    read_sizes();
    std::vector<Eigen::Triplet<double>> entries;
    is_array_ ? read_array(entries) : read_coordinates(entries);
    if (next_line()) fail("the matrix is complete, but the file goes on", words_.front().column);
    SparseMatrix matrix(static_cast<int>(rows_), static_cast<int>(columns_));
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
  }

 private:
  static constexpr long long largest_size = 1'000'000;

  [[noreturn]] void fail(const std::string& message, int column) const {
    throw ConfigError(
        std::vector<Problem>{{Refusal::wrong_text, "", message, source_, line_, column}});
  }

  /// The next line with words on it; comments are passed over.
  bool next_line() {
    std::string line;
    while (std::getline(text_, line)) {
      ++line_;
      words_ = words_of(line);
      if (!words_.empty() && words_.front().text.front() != '%') return true;
    }
    ++line_;
    return false;
  }

  void read_header() {
    std::string line;
    std::getline(text_, line);
    ++line_;
    words_ = words_of(line);
    const char* form =
        "expected '%%MatrixMarket matrix coordinate|array real|integer "
        "general|symmetric|skew-symmetric'";
    if (words_.size() != 5 || words_[0].text != "%%MatrixMarket" ||
        lower_case(words_[1].text) != "matrix") {
      fail(form, 1);
    }
    const std::string layout = lower_case(words_[2].text);
    const std::string field = lower_case(words_[3].text);
    const std::string symmetry = lower_case(words_[4].text);
    if (layout != "coordinate" && layout != "array") fail(form, words_[2].column);
    if (field != "real" && field != "integer")
      fail(fmt::format("a matrix of '{}' entries; {}", field, form), words_[3].column);
    if (symmetry != "general" && symmetry != "symmetric" && symmetry != "skew-symmetric")
      fail(form, words_[4].column);
    is_array_ = layout == "array";
    is_integer_ = field == "integer";
    symmetry_ = symmetry == "general"     ? Symmetry::general
                : symmetry == "symmetric" ? Symmetry::symmetric
                                          : Symmetry::skew;
  }

  long long integer(const Word& word, long long low, long long high, const char* what) const {
    const auto value = number_of<long long>(word.text);
    if (!value || *value < low || *value > high) {
      fail(fmt::format("expected {} from {} to {}, got '{}'", what, low, high, word.text),
           word.column);
    }
    return *value;
  }

  double real(const Word& word) const {
    const auto value = number_of<double>(word.text);
    if (!value || !std::isfinite(*value))
      fail(fmt::format("expected a finite number, got '{}'", word.text), word.column);
    if (is_integer_ && *value != std::trunc(*value)) {
      fail(fmt::format("expected a whole number, got '{}': the head of the file says 'integer'; "
                       "write 'real' there if it is meant",
                       word.text),
           word.column);
    }
    check_magnitude(*value, word);
    return *value;
  }

  void check_magnitude(double value, const Word& word) const {
    if (std::abs(value) <= largest_entry) return;
    fail(fmt::format("'{}' is beyond what can be computed with, up to {:g} in magnitude", word.text,
                     largest_entry),
         word.column);
  }

  void expect_words(std::size_t count, const char* what) {
    if (!next_line()) fail(fmt::format("the file ends, expected {}", what), 1);
    if (words_.size() != count) fail(fmt::format("expected {}", what), words_.front().column);
  }

  void read_sizes() {
    expect_words(is_array_ ? 2 : 3, is_array_ ? "the numbers of rows and columns"
                                              : "the numbers of rows, columns and entries");
    rows_ = integer(words_[0], 1, largest_size, "a number of rows");
    columns_ = integer(words_[1], 1, largest_size, "a number of columns");
    if (symmetry_ != Symmetry::general && rows_ != columns_)
      fail("a symmetric matrix must be square", words_[0].column);
    if (!is_array_) entries_ = integer(words_[2], 0, rows_ * columns_, "a number of entries");
  }

  void add(std::vector<Eigen::Triplet<double>>& entries, long long row, long long column,
           double value) const {
    const int i = static_cast<int>(row);
    const int j = static_cast<int>(column);
    entries.emplace_back(i, j, value);
    if (i == j || symmetry_ == Symmetry::general) return;
    entries.emplace_back(j, i, symmetry_ == Symmetry::skew ? -value : value);
  }

  void read_coordinates(std::vector<Eigen::Triplet<double>>& entries) {
    std::set<std::pair<long long, long long>> seen;
    for (long long k = 0; k < entries_; ++k) {
      expect_words(3, "row, column and value of an entry");
      const long long row = integer(words_[0], 1, rows_, "a row") - 1;
      const long long column = integer(words_[1], 1, columns_, "a column") - 1;
      if (symmetry_ != Symmetry::general && column > row)
        fail("an entry above the diagonal of a symmetric matrix", words_[0].column);
      if (symmetry_ == Symmetry::skew && column == row)
        fail("an entry on the diagonal of a skew-symmetric matrix", words_[0].column);
      if (!seen.emplace(row, column).second) fail("this entry stands twice", words_[0].column);
      add(entries, row, column, real(words_[2]));
    }
  }

  void read_array(std::vector<Eigen::Triplet<double>>& entries) {
    for (long long column = 0; column < columns_; ++column) {
      const long long first = symmetry_ == Symmetry::general     ? 0
                              : symmetry_ == Symmetry::symmetric ? column
                                                                 : column + 1;
      for (long long row = first; row < rows_; ++row) {
        expect_words(1, "one value");
        const double value = real(words_[0]);
        if (value != 0.0) add(entries, row, column, value);
      }
    }
  }

  std::istream& text_;
  std::string source_;
  int line_ = 0;
  std::vector<Word> words_;
  bool is_array_ = false;
  bool is_integer_ = false;
  Symmetry symmetry_ = Symmetry::general;
  long long rows_ = 0, columns_ = 0, entries_ = 0;
};

}  // namespace

SparseMatrix read_matrix_market(std::istream& text, const std::string& source) {
  return MarketReader(text, source).read();
}

SparseMatrix parse_matrix_rows(const std::vector<std::string>& rows) {
  const auto size = static_cast<int>(rows.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < size; ++i) {
    const std::vector<Word> words = words_of(rows[static_cast<std::size_t>(i)]);
    if (words.size() != rows.size()) {
      throw std::invalid_argument(
          fmt::format("row {} has {} numbers, expected {}", i + 1, words.size(), size));
    }
    for (int j = 0; j < size; ++j) {
      const std::string& word = words[static_cast<std::size_t>(j)].text;
      const auto value = number_of<double>(word);
      if (!value || !std::isfinite(*value)) {
        throw std::invalid_argument(
            fmt::format("row {}: expected a finite number, got '{}'", i + 1, word));
      }
      if (!(std::abs(*value) <= largest_entry)) {
        throw std::invalid_argument(
            fmt::format("row {}: '{}' is beyond what can be computed with, up to {:g} in magnitude",
                        i + 1, word, largest_entry));
      }
      if (*value != 0.0) entries.emplace_back(i, j, *value);
    }
  }
  SparseMatrix matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace stridor
