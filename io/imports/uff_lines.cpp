#include "io/imports/uff_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>

namespace stridor {
namespace {

constexpr std::string_view uff_blanks = " \t\r\v\f";

std::vector<std::string_view> uff_words(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; (at = text.find_first_not_of(uff_blanks, at)) != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(uff_blanks, at), text.size());
    words.push_back(text.substr(at, end - at));
    at = end;
  }
  return words;
}

/// Lines of a file one after the other; ends are \n, \r\n or \r.
class Lines {
 public:
  explicit Lines(const SourceText& source) : source_(source) {}

  bool is_at_end() const { return at_ >= source_.text.size(); }
  std::size_t offset() const { return at_; }
  void go_to(std::size_t offset) { at_ = std::min(offset, source_.text.size()); }
  UffLine next() {
    const std::string_view text = source_.text;
    const std::size_t end = std::min(text.find_first_of("\r\n", at_), text.size());
    const UffLine line{text.substr(at_, end - at_), {&source_, at_}};
    at_ = end + 1;
    if (end + 1 < text.size() && text[end] == '\r' && text[end + 1] == '\n') ++at_;
    return line;
  }

 private:
  const SourceText& source_;
  std::size_t at_ = 0;
};

bool is_delimiter(const UffLine& line) {
  return trimmed(line.text) == "-1";
}

/// Whether a delimiter, or the end of the file, stands at a place or behind the blanks there.
bool ends_at(const std::string& text, std::size_t at) {
  const std::size_t word = text.find_first_not_of(" \t\r\n", at);
  if (word == std::string::npos) return true;
  const std::size_t behind = word + 2;
  return text.compare(word, 2, "-1") == 0 &&
         (behind >= text.size() || uff_blanks.find(text[behind]) != std::string_view::npos ||
          text[behind] == '\n');
}

/// Where binary data end. Programs announce no bytes, or half of them where the values are complex:
/// unless the dataset ends there, the next delimiter is looked for, in its six columns.
std::size_t end_of_bytes(const std::string& text, std::size_t begin, std::int64_t announced) {
  const auto rest = static_cast<std::int64_t>(text.size() - begin);
  if (announced <= rest && ends_at(text, begin + static_cast<std::size_t>(announced)))
    return begin + static_cast<std::size_t>(announced);
  constexpr std::string_view delimiter = "    -1";
  for (std::size_t at = begin; (at = text.find(delimiter, at)) != std::string::npos; ++at)
    if (ends_at(text, at)) return at;
  return text.size();
}

/// Takes the lines and the data of a dataset 58b: its head says how many of either follow.
void take_binary(const SourceText& source, const UffLine& head, Lines& lines,
                 UffDataset& dataset) {
  const std::vector<std::string_view> words = uff_words(head.text);
  const auto count = [&](std::size_t word) -> std::optional<std::int64_t> {
    return word < words.size() ? integer_in(words[word]) : std::nullopt;
  };
  const auto num_lines = count(3);
  const auto num_bytes = count(4);
  const auto size = static_cast<std::int64_t>(source.text.size());
  if (!num_lines || !num_bytes || *num_lines < 0 || *num_bytes < 0 || *num_lines > size) {
    refuse_at(head.place, fmt::format("expected the head of binary data: 58b, byte order, format, number "
                                      "of lines, number of bytes; got '{}'",
                                      shown(head.text)));
  }
  for (std::int64_t i = 0; i < *num_lines && !lines.is_at_end(); ++i)
    dataset.lines.push_back(lines.next());
  // Behind a last line without an end there is nothing.
  const std::size_t begin = std::min(lines.offset(), source.text.size());
  const std::size_t end = end_of_bytes(source.text, begin, *num_bytes);
  constexpr std::int64_t big_endian = 2;
  dataset.data = UffBytes{count(1) == big_endian, count(2).value_or(2),
                          std::string_view(source.text).substr(begin, end - begin)};
  lines.go_to(end);
}

}  // namespace

std::vector<UffDataset> uff_datasets(const SourceText& source) {
  std::vector<UffDataset> datasets;
  Lines lines(source);
  while (!lines.is_at_end()) {
    UffLine line = lines.next();
    if (trimmed(line.text).empty()) continue;
    if (!is_delimiter(line)) {
      refuse_at(line.place, fmt::format("expected -1, which begins a dataset of a universal file, got '{}'",
                                        shown(line.text)));
    }
    if (lines.is_at_end()) break;
    const UffLine head = lines.next();
    const std::vector<std::string_view> words = uff_words(head.text);
    if (words.empty()) continue;
    if (is_delimiter(head)) {  // the one before it closed nothing
      lines.go_to(head.place.offset);
      continue;
    }
    std::string_view type = words.front();
    const bool is_binary = type.ends_with('b') || type.ends_with('B');
    if (is_binary) type.remove_suffix(1);
    const std::optional<std::int64_t> number = integer_in(type);
    if (!number || *number < 0 || *number > 1000000) {
      refuse_at(head.place,
                fmt::format("expected the number of a dataset, got '{}'", shown(head.text)));
    }
    UffDataset& dataset = datasets.emplace_back();
    dataset.type = static_cast<int>(*number);
    dataset.place = head.place;
    if (is_binary) take_binary(source, head, lines, dataset);
    while (!lines.is_at_end()) {
      const UffLine next = lines.next();
      if (is_delimiter(next)) break;
      if (!is_binary) dataset.lines.push_back(next);
    }
  }
  return datasets;
}

const UffLine& UffReader::line(const char* expected) {
  if (is_at_end()) {
    const TextPlace end =
        dataset_.lines.empty() ? dataset_.place : dataset_.lines.back().place;
    refuse_at(end, fmt::format("the dataset {} ends here; expected {}", dataset_.type, expected));
  }
  return dataset_.lines[next_++];
}

void UffReader::skip(std::size_t count, const char* expected) {
  for (std::size_t i = 0; i < count; ++i) (void)line(expected);
}

std::vector<std::int64_t> UffReader::integers(std::size_t least, const char* expected) {
  constexpr std::size_t width = 10;
  constexpr double largest = 9.0e15;
  const UffLine& from = line(expected);
  std::vector<std::int64_t> integers;
  for (const double number : uff_numbers(from, width, expected)) {
    const bool is_integer = number >= -largest && number <= largest &&
                            number == static_cast<double>(static_cast<std::int64_t>(number));
    if (!is_integer)
      refuse_at(from.place, fmt::format("expected {}, got '{}'", expected, shown(from.text)));
    integers.push_back(static_cast<std::int64_t>(number));
  }
  if (integers.size() < least) {
    refuse_at(from.place, fmt::format("expected {}: {} integers, got {}", expected, least,
                                      integers.size()));
  }
  return integers;
}

std::vector<double> UffReader::reals(std::size_t count, std::size_t width, const char* expected) {
  std::vector<double> numbers;
  while (numbers.size() < count) {
    const UffLine& from = line(expected);
    const std::vector<double> more = uff_numbers(from, width, expected);
    if (more.empty())
      refuse_at(from.place, fmt::format("expected {}, got an empty line", expected));
    numbers.insert(numbers.end(), more.begin(), more.end());
    if (numbers.size() > count) {
      refuse_at(from.place, fmt::format("expected {}: {} numbers, got {}", expected, count,
                                        numbers.size()));
    }
  }
  return numbers;
}

std::optional<std::vector<double>> uff_numbers_in(std::string_view text, std::size_t width) {
  std::vector<double> numbers;
  for (const std::string_view word : uff_words(text)) {
    const std::optional<double> number = real_in(word);
    // Digits beyond the column are those of the next integer.
    const bool run_together =
        word.size() > width && word.find_first_not_of("0123456789") == std::string_view::npos;
    if (!number || run_together) {
      numbers.clear();
      break;
    }
    numbers.push_back(*number);
  }
  if (!numbers.empty() || trimmed(text).empty()) return numbers;
  for (std::size_t at = 0; at < text.size(); at += width) {
    const std::string_view column = trimmed(text.substr(at, width));
    if (column.empty()) continue;
    const std::optional<double> number = real_in(column);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

std::vector<double> uff_columns(const UffLine& line, std::span<const std::size_t> widths,
                                const char* expected) {
  const std::size_t widest = *std::max_element(widths.begin(), widths.end());
  // Where blanks part the numbers, the widths say nothing.
  if (const auto parted = uff_numbers_in(line.text, std::max(widest, line.text.size())))
    return *parted;
  std::vector<double> numbers;
  for (std::size_t at = 0, i = 0; at < line.text.size(); at += widths[i++ % widths.size()]) {
    const std::string_view column = trimmed(line.text.substr(at, widths[i % widths.size()]));
    if (column.empty()) continue;
    const std::optional<double> number = real_in(column);
    if (!number)
      refuse_at(line.place, fmt::format("expected {}, got '{}'", expected, shown(line.text)));
    numbers.push_back(*number);
  }
  return numbers;
}

std::vector<double> uff_numbers(const UffLine& line, std::size_t width, const char* expected) {
  const auto numbers = uff_numbers_in(line.text, width);
  if (!numbers)
    refuse_at(line.place, fmt::format("expected {}, got '{}'", expected, shown(line.text)));
  return *numbers;
}

}  // namespace stridor
