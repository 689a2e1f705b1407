#include "io/imports/inp_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "core/errors.hpp"

namespace stridor {
namespace {

/// Capital letters, single blanks.
std::string in_capitals(std::string_view text) {
  std::string result;
  for (const char letter : trimmed(text)) {
    const bool is_blank = letter == ' ' || letter == '\t';
    if (is_blank && !result.empty() && result.back() == ' ') continue;
    if (is_blank) {
      result += ' ';
    } else {
      result += static_cast<char>(letter >= 'a' && letter <= 'z' ? letter - 'a' + 'A' : letter);
    }
  }
  return result;
}

std::string_view without_quotes(std::string_view text) {
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"')
    return text.substr(1, text.size() - 2);
  return text;
}

bool ends_with_comma(std::string_view line) {
  line = trimmed(line);
  return !line.empty() && line.back() == ',';
}

std::string one_path(const std::string& name) {
  std::error_code ignored;
  const std::filesystem::path path = std::filesystem::weakly_canonical(name, ignored);
  return ignored ? name : path.string();
}

}  // namespace

const InpParameter* InpKeyword::find(std::string_view parameter) const {
  const auto found =
      std::find_if(parameters.begin(), parameters.end(),
                   [&](const InpParameter& candidate) { return candidate.name == parameter; });
  return found == parameters.end() ? nullptr : &*found;
}

std::optional<InpField> InpFields::next() {
  if (trimmed(line_.substr(at_)).empty()) return std::nullopt;
  std::size_t end = at_;
  bool is_quoted = false;
  while (end < line_.size() && (is_quoted || line_[end] != ',')) {
    if (line_[end] == '"') is_quoted = !is_quoted;
    ++end;
  }
  const std::string_view text = trimmed(line_.substr(at_, end - at_));
  const auto shift = text.empty() ? at_ : static_cast<std::size_t>(text.data() - line_.data());
  at_ = std::min(end + 1, line_.size());
  return InpField{without_quotes(text), {place_.source, place_.offset + shift}};
}

InpLines::InpLines(SourceText source, IncludeReader reader) : reader_(std::move(reader)) {
  std::string path = one_path(source.name);
  open(std::move(source), std::move(path));
}

void InpLines::open(SourceText source, std::string path) {
  sources_.push_back(std::move(source));
  const SourceText& opened = sources_.back();
  const std::size_t strange = opened.text.find('\0');
  if (strange != std::string::npos)
    refuse_at({&opened, strange}, "a byte 0; expected an input of Abaqus or CalculiX, a text");
  levels_.push_back({&opened, std::move(path), 0});
}

void InpLines::include(const std::string& file, const TextPlace& place) {
  constexpr std::size_t deepest = 16;
  constexpr std::size_t most_files = 1000;
  if (file.empty()) refuse_at(place, "expected INPUT=FILE");
  if (!reader_) refuse_at(place, fmt::format("'{}' cannot be included here", shown(file)));
  if (levels_.size() >= deepest || sources_.size() >= most_files) {
    refuse_at(place, fmt::format("files are included {} deep or {} of them; expected fewer",
                                 deepest, most_files));
  }
  SourceText source;
  try {
    // Behind a comma too many at its end, the file that includes is left already.
    source = reader_(place.source->name, file);
  } catch (const FileError& error) {
    refuse_at(place, fmt::format("cannot include a file: {}", error.what()));
  }
  std::string path = one_path(source.name);
  bool includes_itself = one_path(place.source->name) == path;
  for (const Level& level : levels_) includes_itself |= level.path == path;
  if (includes_itself) refuse_at(place, fmt::format("'{}' includes itself", shown(source.name)));
  open(std::move(source), std::move(path));
}

std::optional<std::string_view> InpLines::next_line() {
  while (!levels_.empty()) {
    Level& level = levels_.back();
    const std::string_view text = level.source->text;
    if (level.offset >= text.size()) {
      levels_.pop_back();
      continue;
    }
    const std::size_t end = std::min(text.find('\n', level.offset), text.size());
    const std::string_view line = text.substr(level.offset, end - level.offset);
    place_ = {level.source, level.offset};
    level.offset = end + 1;
    const std::string_view words = trimmed(line);
    if (!words.empty() && words.substr(0, 2) != "**") return line;
  }
  return std::nullopt;
}

void InpLines::read_keyword(std::string_view line) {
  keyword_ = {};
  keyword_.place = {place_.source,
                    place_.offset + static_cast<std::size_t>(trimmed(line).data() - line.data())};
  std::string text(trimmed(line));
  while (ends_with_comma(text) && !levels_.empty()) {
    const Level before = levels_.back();
    const std::size_t depth = levels_.size();
    const auto more = next_line();
    if (!more || levels_.size() != depth || trimmed(*more).front() == '*') {
      // A comma too many; what was looked at is read again.
      if (more && levels_.size() == depth) levels_.back() = before;
      if (more && levels_.size() != depth) levels_.back().offset = place_.offset;
      break;
    }
    text += trimmed(*more);
  }
  InpFields fields(text, keyword_.place);
  bool is_name = true;
  while (const auto field = fields.next()) {
    if (std::exchange(is_name, false)) {
      keyword_.name = in_capitals(field->text.substr(1));
      continue;
    }
    if (field->text.empty()) continue;
    const std::size_t equals = field->text.find('=');
    InpParameter parameter{in_capitals(field->text.substr(0, equals)), ""};
    if (equals != std::string_view::npos)
      parameter.value = without_quotes(trimmed(field->text.substr(equals + 1)));
    if (keyword_.find(parameter.name) != nullptr)
      refuse_at(keyword_.place, fmt::format("{} stands twice", shown(parameter.name)));
    keyword_.parameters.push_back(std::move(parameter));
  }
}

InpLineKind InpLines::next() {
  while (const auto line = next_line()) {
    if (trimmed(*line).front() != '*') {
      data_ = *line;
      return InpLineKind::data;
    }
    read_keyword(*line);
    if (keyword_.name != "INCLUDE") return InpLineKind::keyword;
    const InpParameter* input = keyword_.find("INPUT");
    include(input == nullptr ? "" : input->value, keyword_.place);
  }
  return InpLineKind::end;
}

}  // namespace stridor
