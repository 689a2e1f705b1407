#include "io/imports/gmsh_cursor.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>

namespace stridor {
namespace {

static_assert(std::endian::native == std::endian::little, "bytes of binary meshes are copied");

bool is_gap(char letter) {
  return letter == ' ' || letter == '\t' || letter == '\r' || letter == '\f' || letter == '\v';
}

}  // namespace

void GmshCursor::refuse(std::size_t offset, const std::string& message) const {
  refuse_at({&source_, offset}, message);
}

bool GmshCursor::skip_blank() {
  const std::string& text = source_.text;
  while (offset_ < text.size() && (is_gap(text[offset_]) || text[offset_] == '\n')) ++offset_;
  return offset_ < text.size();
}

std::string_view GmshCursor::line() {
  const std::string_view rest = std::string_view(source_.text).substr(offset_);
  const std::size_t end = rest.find('\n');
  if (end == std::string_view::npos) {
    offset_ = source_.text.size();
    return trimmed(rest);
  }
  offset_ += end + 1;
  return trimmed(rest.substr(0, end));
}

void GmshCursor::skip_section(std::string_view name, std::size_t begin) {
  const std::string end = fmt::format("\n$End{}", name);
  std::size_t from = offset_ > 0 ? offset_ - 1 : 0;  // an empty section ends on its second line
  while (true) {
    const std::size_t found = source_.text.find(end, from);
    if (found == std::string::npos)
      refuse(begin, fmt::format("section ${} has no $End{}", shown(name), shown(name)));
    offset_ = from = found + 1;
    if (line().size() == end.size() - 1) return;
  }
}

void GmshCursor::end_section(std::string_view name) {
  const std::size_t before = offset_;
  if (!skip_blank()) refuse(before, fmt::format("the file ends, expected $End{}", name));
  const std::size_t begin = offset_;
  const std::string_view found = line();
  if (found == fmt::format("$End{}", name)) return;
  refuse(begin, fmt::format("expected $End{} after as many records as declared, got '{}'", name,
                            shown(found)));
}

std::string_view GmshCursor::word(const char* what) {
  const std::string& text = source_.text;
  while (offset_ < text.size() && is_gap(text[offset_])) ++offset_;
  std::size_t end = offset_;
  while (end < text.size() && !is_gap(text[end]) && text[end] != '\n') ++end;
  if (end == offset_) {
    refuse(offset_,
           fmt::format("the {} ends, expected {}", end < text.size() ? "line" : "file", what));
  }
  const std::string_view found = std::string_view(text).substr(offset_, end - offset_);
  offset_ = end;
  return found;
}

const char* GmshCursor::bytes(std::size_t count, const char* what) {
  if (remaining() < count) refuse(offset_, fmt::format("the file ends, expected {}", what));
  const char* begin = source_.text.data() + offset_;
  offset_ += count;
  return begin;
}

std::int64_t GmshCursor::text_integer(const char* what) {
  const std::string_view found = word(what);
  const auto value = integer_in(found);
  if (!value) {
    refuse(offset_ - found.size(),
           fmt::format("expected {}, an integer, got '{}'", what, shown(found)));
  }
  return *value;
}

std::int64_t GmshCursor::integer(const char* what) {
  if (!is_binary_) return text_integer(what);
  std::int32_t value = 0;
  std::memcpy(&value, bytes(sizeof value, what), sizeof value);
  return value;
}

std::int64_t GmshCursor::size(const char* what) {
  std::int64_t value = 0;
  if (is_binary_) {
    std::memcpy(&value, bytes(sizeof value, what), sizeof value);
    if (value < 0)
      refuse(offset_ - sizeof value, fmt::format("expected {}, got more than 2^63", what));
    return value;
  }
  value = text_integer(what);
  if (value < 0)
    refuse(offset_, fmt::format("expected {}, which is not negative, got {}", what, value));
  return value;
}

double GmshCursor::real(const char* what) {
  if (is_binary_) {
    double value = 0.0;
    std::memcpy(&value, bytes(sizeof value, what), sizeof value);
    if (std::isfinite(value)) return value;
    refuse(offset_ - sizeof value,
           fmt::format("expected {}, a finite number, got {}", what, value));
  }
  const std::string_view found = word(what);
  const auto value = real_in(found);
  if (!value) {
    refuse(offset_ - found.size(),
           fmt::format("expected {}, a finite number, got '{}'", what, shown(found)));
  }
  return *value;
}

void GmshCursor::skip_real(const char* what) {
  if (is_binary_) {
    bytes(sizeof(double), what);
  } else {
    word(what);
  }
}

void GmshCursor::end_record(const char* what) {
  if (is_binary_) return;
  const std::string& text = source_.text;
  while (offset_ < text.size() && is_gap(text[offset_])) ++offset_;
  if (offset_ == text.size()) return;
  if (text[offset_] != '\n')
    refuse(offset_, fmt::format("expected the end of the line after {}", what));
  ++offset_;
}

std::size_t GmshCursor::checked_count(std::int64_t count, std::size_t least_bytes,
                                      std::size_t offset, const char* what) const {
  if (count < 0) refuse(offset, fmt::format("expected a number of {}, got {}", what, count));
  const auto number = static_cast<std::size_t>(count);
  if (number > remaining() / least_bytes) {
    refuse(offset,
           fmt::format("{} {} are declared, but only {} bytes follow; is the file complete?", count,
                       what, remaining()));
  }
  return number;
}

}  // namespace stridor
