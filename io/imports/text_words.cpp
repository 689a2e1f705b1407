#include "io/imports/text_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace stridor {
namespace {

constexpr std::string_view separators = " \t\r\f\v,";

}  // namespace

bool TextLines::next_raw() {
  const std::string_view text = source_.text;
  begin_ = std::min(next_, text.size());
  if (begin_ == text.size()) {
    line_ = text.substr(begin_);
    return false;
  }
  const std::size_t end = std::min(text.find('\n', begin_), text.size());
  line_ = text.substr(begin_, end - begin_);
  if (!line_.empty() && line_.back() == '\r') line_.remove_suffix(1);
  next_ = end + 1;
  return true;
}

bool TextLines::next() {
  while (next_raw()) {
    if (line_.find_first_not_of(separators) == std::string_view::npos) continue;
    if (!comment_.empty() && trimmed(line_).substr(0, comment_.size()) == comment_) continue;
    return true;
  }
  return false;
}

const std::vector<std::string_view>& TextLines::words() {
  words_.clear();
  std::size_t begin = line_.find_first_not_of(separators);
  while (begin != std::string_view::npos) {
    const std::size_t end = std::min(line_.find_first_of(separators, begin), line_.size());
    words_.push_back(line_.substr(begin, end - begin));
    begin = line_.find_first_not_of(separators, end);
  }
  return words_;
}

std::int64_t TextLines::integer(std::string_view word, std::int64_t low, std::int64_t high,
                                const char* what) const {
  const auto value = integer_in(word);
  if (!value || *value < low || *value > high) {
    fail(word,
         fmt::format("expected {} from {} to {}, got '{}'", what, low, high, shown(word)));
  }
  return *value;
}

double TextLines::real(std::string_view word, const char* what) const {
  constexpr double largest = 1e100;
  const auto value = real_in(word);
  if (!value || !(std::abs(*value) <= largest)) {
    fail(word, fmt::format("expected {}, a number of up to {:g} in magnitude, got '{}'", what,
                           largest, shown(word)));
  }
  return *value;
}

}  // namespace stridor
