#include "io/scene/scene_tree.hpp"

#include <fmt/format.h>
#include <yaml-cpp/anchor.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "core/excerpt.hpp"
#include "core/utf8.hpp"
#include "io/hdf5/regular_file.hpp"

namespace stridor {
namespace {

const std::string set_option = "--set ";
constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

[[noreturn]] void fail(const Place& place, std::string key, std::string message) {
  throw ConfigError(std::vector<Problem>{problem_at(place, std::move(key), std::move(message))});
}

std::size_t count_nodes(const SceneNode& node) {
  std::size_t count = 1;
  for (const SceneEntry& entry : node.entries) count += count_nodes(entry.value);
  for (const SceneNode& item : node.items) count += count_nodes(item);
  return count;
}

/// Levels of maps and lists: 0 for a scalar.
std::size_t height(const SceneNode& node) {
  if (node.kind != SceneNode::Kind::map && node.kind != SceneNode::Kind::list) return 0;
  std::size_t tallest = 0;
  for (const SceneEntry& entry : node.entries) tallest = std::max(tallest, height(entry.value));
  for (const SceneNode& item : node.items) tallest = std::max(tallest, height(item));
  return tallest + 1;
}

/// Builds the tree from the events of the YAML parser.
///
/// Events, and not YAML::Node, because they come one by one: the limits stop a hostile text before
/// it is expanded, and an alias inside its own anchor is seen instead of making a cycle.
class TreeBuilder : public YAML::EventHandler {
 public:
  /// @param start place of the first character; without a line where the text has none
  /// @param end   place behind the last character
  TreeBuilder(Place start, Place end)
      : start_(std::move(start)), end_(std::move(end)), last_place_(start_) {}

  SceneNode take_root() { return std::move(root_); }
  /// Of the scalar read last: where to look when the parser only notices a fault at the end.
  const Place& last_place() const { return last_place_; }
  /// Of the map or list that was begun last and is not complete.
  const Place& open_place() const { return frames_.empty() ? start_ : frames_.back().node.place; }
  const Place& end() const { return end_; }
  /// Never behind the end, where the parser is given more than the text.
  Place place_at(const YAML::Mark& mark) const {
    if (mark.is_null()) return {start_.source, 0, 0};
    Place place{start_.source, mark.line + 1, mark.column + 1};
    if (start_.line == 0) {
      if (mark.line > 0) return end_;
      place = {start_.source, 0, start_.column + mark.column};
    }
    return std::pair(place.line, place.column) < std::pair(end_.line, end_.column) ? place : end_;
  }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (num_documents_++ > 0) {
      fail(
          place_at(mark), "",
          "a second YAML document, or text after the end of the first; a scene is one map of keys");
    }
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    attach(make_node(SceneNode::Kind::null, mark, "?"), anchor);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    SceneNode node = make_node(SceneNode::Kind::scalar, mark, tag);
    node.text = value;
    last_place_ = node.place;
    node.is_quoted = tag == "!";
    attach(std::move(node), anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchors_.find(anchor);
    if (found == anchors_.end()) {
      fail(place_at(mark), path(), "an alias inside the value that it stands for");
    }
    count(found->second.num_nodes, place_at(mark));
    if (frames_.size() + found->second.height > SceneLimits::levels) fail_depth(mark);
    attach(found->second.node, 0);
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(SceneNode::Kind::list, mark, tag, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(SceneNode::Kind::map, mark, tag, anchor);
  }
  void OnMapEnd() override { close(); }

 private:
  struct Anchored {
    SceneNode node;
    std::size_t num_nodes = 0;
    std::size_t height = 0;
  };
  /// A map or list that is not complete yet.
  struct Frame {
    SceneNode node;
    YAML::anchor_t anchor = 0;
    bool expects_value = false;     ///< of a map: its key has been read
    std::optional<SceneEntry> key;  ///< of a map: empty where that key is dropped
    std::unordered_map<std::string, int> lines_of_keys;
  };

  SceneNode make_node(SceneNode::Kind kind, const YAML::Mark& mark, const std::string& tag) {
    count(1, place_at(mark));
    SceneNode node;
    node.kind = kind;
    node.place = place_at(mark);
    if (!tag.empty() && tag != "?" && tag != "!") {
      node.problems.push_back(
          problem_at(node.place, "",
                     fmt::format("the YAML tag '{}' has no meaning in a scene; remove it", tag)));
    }
    return node;
  }

  void count(std::size_t num_nodes, const Place& place) {
    num_nodes_ += num_nodes;
    if (num_nodes_ > SceneLimits::nodes) {
      fail(place, path(),
           fmt::format(
               "more than {} values (aliases expanded); put large tables into a file of their own",
               SceneLimits::nodes));
    }
  }

  [[noreturn]] void fail_depth(const YAML::Mark& mark) const {
    fail(place_at(mark), path(),
         fmt::format("maps and lists are nested deeper than {} levels", SceneLimits::levels));
  }

  void open(SceneNode::Kind kind, const YAML::Mark& mark, const std::string& tag,
            YAML::anchor_t anchor) {
    if (frames_.size() >= SceneLimits::levels) fail_depth(mark);
    Frame frame;
    frame.node = make_node(kind, mark, tag);
    frame.anchor = anchor;
    frames_.push_back(std::move(frame));
  }

  void close() {
    Frame frame = std::move(frames_.back());
    frames_.pop_back();
    attach(std::move(frame.node), frame.anchor);
  }

  /// Puts a complete node where it belongs: into the map or list around it, or at the top.
  void attach(SceneNode node, YAML::anchor_t anchor) {
    if (anchor != 0) {
      // The copy counts, or anchors inside anchors would multiply memory unseen.
      const std::size_t num_nodes = count_nodes(node);
      count(num_nodes, node.place);
      anchors_[anchor] = Anchored{node, num_nodes, height(node)};
    }
    if (frames_.empty()) {
      root_ = std::move(node);
      return;
    }
    Frame& frame = frames_.back();
    if (frame.node.kind == SceneNode::Kind::list) {
      frame.node.items.push_back(std::move(node));
    } else if (!frame.expects_value) {
      frame.expects_value = true;
      take_key(frame, node);
    } else {
      frame.expects_value = false;
      if (!frame.key) return;
      const bool is_block = !node.items.empty() || !node.entries.empty();
      if (is_block && node.place.line > frame.key->place.line) node.place = frame.key->place;
      frame.key->value = std::move(node);
      frame.node.entries.push_back(std::move(*frame.key));
      frame.key.reset();
    }
  }

  void take_key(Frame& frame, const SceneNode& node) {
    frame.key.reset();
    std::vector<Problem>& problems = frame.node.problems;
    const bool has_control = std::any_of(node.text.begin(), node.text.end(), [](char c) {
      return static_cast<unsigned char>(c) < 0x20;
    });
    if (node.kind != SceneNode::Kind::scalar || !node.problems.empty() || has_control) {
      problems.push_back(problem_at(
          node.place, "", "a key must be a plain name, without brackets, tags or line breaks"));
      return;
    }
    if (node.text == "<<" && !node.is_quoted) {
      problems.push_back(
          problem_at(node.place, node.text,
                     "merge keys are not read; write the keys out, or use an alias for a "
                     "whole value"));
      return;
    }
    const auto [first, is_new] = frame.lines_of_keys.emplace(node.text, node.place.line);
    if (!is_new) {
      const std::string before =
          first->second > 0 ? fmt::format(", first in line {}", first->second) : "";
      problems.push_back(problem_at(node.place, node.text,
                                    fmt::format("is given twice{}; remove one of them", before)));
      return;
    }
    frame.key = SceneEntry{node.text, node.place, {}};
  }

  /// Key path of what is being read.
  std::string path() const {
    std::string joined;
    for (const Frame& frame : frames_) {
      if (frame.node.kind == SceneNode::Kind::list) {
        joined = join_path(joined, std::to_string(frame.node.items.size()));
      } else if (frame.key) {
        joined = join_path(joined, frame.key->key);
      }
    }
    return joined;
  }

  Place start_;
  Place end_;
  SceneNode root_;
  Place last_place_;
  std::vector<Frame> frames_;
  std::map<YAML::anchor_t, Anchored> anchors_;
  std::size_t num_nodes_ = 0;
  int num_documents_ = 0;
};

/// Refuses what is not text: yaml-cpp ends silently at a byte 4, and a message with broken UTF-8 in
/// it could not be written as JSON.
/// @param place of the first character
void check_characters(const std::string& text, Place place) {
  for (std::size_t i = text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0;
       i < text.size();) {
    const Utf8Character character = utf8_at(text, i);
    const auto byte = static_cast<unsigned char>(text[i]);
    const bool is_control =
        (byte < 0x20 && byte != '\t' && byte != '\n' && byte != '\r') || byte == 0x7F;
    if (character.length == 0 || is_control) {
      fail(place, "",
           character.length == 0
               ? fmt::format("byte 0x{:02X} is not UTF-8; save the text as UTF-8", byte)
               : fmt::format("control character 0x{:02X}; a scene is plain text in UTF-8", byte));
    }
    if (byte == '\n' && place.line > 0) {
      ++place.line;
      place.column = 1;
    } else {
      place.column += static_cast<int>(character.length);
    }
    i += character.length;
  }
}

/// Without the bytes that a message in one line of UTF-8 cannot hold; yaml-cpp quotes single bytes.
std::string printable(std::string text) {
  for (char& c : text) {
    if (c < 0x20 || c > 0x7E) c = '?';
  }
  return text;
}

/// What yaml-cpp says, in words that tell what to do.
std::string explain(const std::string& said) {
  using namespace YAML;
  const auto is = [&](const char* message) { return said == message; };
  if (is(ErrorMsg::TAB_IN_INDENTATION)) return "a tab in the indentation; indent with spaces";
  if (is(ErrorMsg::END_OF_MAP))
    return "the map does not go on like this; check indentation, colons and quotes";
  if (is(ErrorMsg::END_OF_SEQ))
    return "the list does not go on like this; check indentation and dashes";
  if (is(ErrorMsg::FLOW_END)) return "a closing bracket without its opening one";
  if (is(ErrorMsg::MAP_VALUE)) return "a ':' where no key can be; quote a text that holds ': '";
  if (is(ErrorMsg::MAP_KEY)) return "a key where none can be; check the indentation";
  if (is(ErrorMsg::BLOCK_ENTRY)) return "a '-' where no list can be; check the indentation";
  if (said.starts_with(ErrorMsg::UNKNOWN_ANCHOR))
    return printable(said) + "; write '&name' before it is used";
  return "not YAML: " + printable(said);
}

/// Just behind the last line of a text.
Place end_of(const std::string& text, const Place& start) {
  if (start.line == 0) return {start.source, 0, start.column + static_cast<int>(text.size())};
  const std::size_t size = text.ends_with('\n') ? text.size() - 1 : text.size();
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(size);
  const auto num_breaks = std::count(text.begin(), end, '\n');
  const auto line_begin = std::find(std::make_reverse_iterator(end), text.rend(), '\n').base();
  return {start.source, start.line + static_cast<int>(num_breaks),
          static_cast<int>(end - line_begin) + 1};
}

/// The first tab in the indentation of a line or of the one before it: yaml-cpp reports what the tab
/// makes of the text, as a rule one line late.
std::optional<Place> tab_before(const std::string& text, const Place& place) {
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; number <= place.line && std::getline(lines, line); ++number) {
    if (number + 1 < place.line) continue;
    const std::size_t tab = line.find('\t');
    if (tab != std::string::npos && tab < line.find_first_not_of(" \t"))
      return Place{place.source, number, static_cast<int>(tab) + 1};
  }
  return std::nullopt;
}

[[noreturn]] void fail_to_parse(const YAML::Exception& error, const TreeBuilder& builder,
                                const std::string& text) {
  using namespace YAML;
  if (const auto tab = tab_before(text, builder.place_at(error.mark)))
    fail(*tab, "", explain(ErrorMsg::TAB_IN_INDENTATION));
  if (error.msg == ErrorMsg::DOC_IN_SCALAR || error.msg == ErrorMsg::EOF_IN_SCALAR) {
    fail(builder.last_place(), "", "a quote opened after here is never closed");
  }
  const Place place = builder.place_at(error.mark);
  const bool is_map = error.msg == ErrorMsg::END_OF_MAP_FLOW;
  if (is_map || error.msg == ErrorMsg::END_OF_SEQ_FLOW) {
    const std::string what = is_map ? "map" : "list";
    const char bracket = is_map ? '}' : ']';
    const Place& open = builder.open_place();
    if (place == builder.end()) {
      fail(open, "", fmt::format("the {} that begins here is never closed by '{}'", what, bracket));
    }
    const std::string line = open.line > 0 ? fmt::format(" of line {}", open.line) : "";
    fail(place, "",
         fmt::format("a ',' or '{}' is missing before this in the {}{}", bracket, what, line));
  }
  fail(place, "", explain(error.msg));
}

/// @param start place of the first character; without a line for a text of one line
SceneNode parse(const std::string& text, const Place& start) {
  check_characters(text, start);
  TreeBuilder builder(start, end_of(text, start));
  try {
    // yaml-cpp 0.7 takes the end of the text for the end of a quote that was never closed, and so
    // swallows the rest of a scene; at an explicit end of the document it notices.
    std::istringstream stream(text + (text.ends_with('\n') ? "...\n" : "\n...\n"));
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::Exception& error) {
    fail_to_parse(error, builder, text);
  }
  return builder.take_root();
}

/// Whether a text is a number as programs write it, "-1.5e-7": YAML has it as it is, and verbs that
/// vary a key set thousands of them.
bool is_plain_number(const std::string& text) {
  std::size_t i = text.starts_with('-') ? 1 : 0;
  const auto skip_digits = [&] {
    const std::size_t first = i;
    while (i < text.size() && text[i] >= '0' && text[i] <= '9') ++i;
    return i > first;
  };
  if (!skip_digits()) return false;
  if (i < text.size() && text[i] == '.' && (++i, !skip_digits())) return false;
  if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
    ++i;
    if (i < text.size() && (text[i] == '+' || text[i] == '-')) ++i;
    if (!skip_digits()) return false;
  }
  return i == text.size();
}

SceneNode scalar_of(const std::string& text, const Place& place) {
  SceneNode node;
  node.kind = SceneNode::Kind::scalar;
  node.text = text;
  node.place = place;
  return node;
}

SceneNode parse_scene(const std::string& text, const std::string& source) {
  SceneNode root = parse(text, {source, 1, 1});
  if (root.kind == SceneNode::Kind::null) {
    fail({source, 1, 1}, "", "the scene is empty; expected a map of keys");
  }
  if (root.kind != SceneNode::Kind::map) {
    fail(root.place, "",
         fmt::format("expected a map of keys ('key: value', with a space after the colon), got {}",
                     root.kind == SceneNode::Kind::list ? "a list" : "a single value"));
  }
  return root;
}

std::vector<std::string_view> lines_of(std::string_view text) {
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    lines.push_back(line);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

void add_excerpts(std::vector<Problem>& problems, const std::string& source,
                  std::string_view text) {
  const std::vector<std::string_view> lines = lines_of(text);
  for (Problem& problem : problems) {
    if (problem.source != source || problem.line < 1 || !problem.excerpt.empty()) continue;
    const auto index = static_cast<std::size_t>(problem.line) - 1;
    if (index >= lines.size() || lines[index].empty()) continue;
    problem.excerpt = excerpt_of(lines[index], problem.line, problem.column);
  }
}

std::vector<std::string> split(const std::string& path) {
  std::vector<std::string> names;
  std::size_t begin = 0;
  while (true) {
    const std::size_t dot = path.find('.', begin);
    names.push_back(path.substr(begin, dot - begin));
    if (dot == std::string::npos) return names;
    begin = dot + 1;
  }
}

/// The index that a path element names, if it is one of a list of this size.
std::optional<std::size_t> list_index(const std::string& name, std::size_t size) {
  std::size_t index = 0;
  const char* end = name.data() + name.size();
  const auto [stop, status] = std::from_chars(name.data(), end, index);
  if (status != std::errc() || stop != end || index >= size) return std::nullopt;
  return index;
}

struct Found {
  const SceneNode* node;
  bool is_exact;
};

Found find_nearest(const SceneNode& root, const std::string& path) {
  const SceneNode* node = &root;
  if (path.empty()) return {node, true};
  for (const std::string& name : split(path)) {
    if (const SceneEntry* entry = node->entry(name)) {
      node = &entry->value;
    } else if (const auto index = list_index(name, node->items.size())) {
      node = &node->items[*index];
    } else {
      return {node, false};
    }
  }
  return {node, true};
}

}  // namespace

const SceneEntry* SceneNode::entry(const std::string& key) const {
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [&](const SceneEntry& one) { return one.key == key; });
  return found == entries.end() ? nullptr : &*found;
}

std::string join_path(const std::string& path, const std::string& key) {
  if (path.empty()) return key;
  return key.empty() ? path : path + "." + key;
}

SceneNode read_scene_text(const std::string& text, const std::string& source_name) {
  try {
    SceneNode root = parse_scene(text, source_name);
    root.document = text;
    return root;
  } catch (const ConfigError& error) {
    std::vector<Problem> problems = error.problems();
    add_excerpts(problems, source_name, text);
    throw ConfigError(std::move(problems));
  }
}

SceneNode read_scene_file(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    throw FileError(path, "", "does not exist; give the path of a scene file");
  }
  if (status.type() == std::filesystem::file_type::directory) {
    throw FileError(path, "", "is a directory; give the path of a scene file");
  }
  const std::string irregular = irregular_kind(path);
  if (!irregular.empty())
    throw FileError(path, "", "is " + irregular + "; give the path of a scene file");
  const OpenFile file(std::fopen(path.c_str(), "rb"));
  if (!file) throw FileError(path, "", fmt::format("cannot be opened: {}", std::strerror(errno)));

  // Read up to the limit rather than trust the size: files of /proc tell none.
  std::string text;
  std::vector<char> part(64 * 1024);
  std::size_t size = 1;
  while (size > 0 && text.size() <= SceneLimits::bytes) {
    size = std::fread(part.data(), 1, part.size(), file.get());
    text.append(part.data(), size);
  }
  if (std::ferror(file.get()) != 0) {
    throw FileError(path, "", fmt::format("cannot be read: {}", std::strerror(errno)));
  }
  if (text.starts_with("\x89HDF\r\n\x1a\n")) {
    fail({path, 0, 0}, "",
         "is an HDF5 file, not a scene (YAML); `stridor info` says what a run file holds, and its "
         "scene is the text in /scene/text");
  }
  if (text.size() > SceneLimits::bytes) {
    throw FileError(
        path, "",
        fmt::format("is larger than {} MiB, which no scene is; put large tables into files "
                    "of their own",
                    SceneLimits::bytes / (1024 * 1024)));
  }
  return read_scene_text(text, path);
}

void set_value(SceneNode& root, const std::string& assignment) {
  const auto column = [](std::size_t i) { return static_cast<int>(set_option.size() + i) + 1; };
  if (assignment.size() > SceneLimits::assignment) {
    fail({set_option + printable(assignment.substr(0, 40)) + "...", 0, 0}, "",
         fmt::format("is longer than {} KiB; write it into the scene",
                     SceneLimits::assignment / 1024));
  }
  check_characters(assignment, {set_option + printable(assignment), 0, column(0)});
  const std::size_t line_break = assignment.find_first_of("\r\n");
  if (line_break != std::string::npos) {
    fail({set_option + printable(assignment), 0, column(line_break)}, "",
         "has a line break; write --set key.path=value in one line");
  }
  const auto at = [source = set_option + assignment, &column](std::size_t i) {
    return Place{source, 0, column(i)};
  };
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos) {
    fail(at(assignment.size()), "", "has no '='; write --set key.path=value");
  }
  const std::string path = assignment.substr(0, equals);
  const std::vector<std::string> names = split(path);
  if (std::any_of(names.begin(), names.end(), [](const std::string& name) {
        return name.empty() || name.find_first_of(" \t") != std::string::npos;
      })) {
    fail(at(0), "", fmt::format("'{}' is not a key path; write --set key.path=value", path));
  }
  const std::string written = assignment.substr(equals + 1);
  if (written.find_first_not_of(" \t") == std::string::npos) {
    fail(at(assignment.size()), path, "has no value; write --set key.path=value");
  }
  SceneNode value = is_plain_number(written) ? scalar_of(written, at(equals + 1))
                                             : parse(written, at(equals + 1));
  if (names.size() + height(value) > SceneLimits::levels) {
    fail(at(0), path,
         fmt::format("maps and lists are nested deeper than {} levels", SceneLimits::levels));
  }

  // Nothing can go wrong any more once the path has left what exists, so a throw leaves no trace.
  SceneNode* node = &root;
  std::string walked;
  std::size_t begin = 0;  // of the name in the assignment
  for (const std::string& name : names) {
    const Place place = at(begin);
    if (node->kind == SceneNode::Kind::scalar) {
      fail(place, path, fmt::format("'{}' is a single value and holds no key '{}'", walked, name));
    }
    if (node->kind == SceneNode::Kind::list) {
      const auto index = list_index(name, node->items.size());
      if (!index) {
        fail(place, path,
             node->items.empty()
                 ? fmt::format("'{}' is an empty list and has no entry '{}'", walked, name)
                 : fmt::format("'{}' is a list; expected an index from 0 to {}, got '{}'", walked,
                               node->items.size() - 1, name));
      }
      node = &node->items[*index];
    } else {
      if (node->kind == SceneNode::Kind::null) {
        node->kind = SceneNode::Kind::map;
        node->place = place;
      }
      const bool is_last = &name == &names.back();
      auto entry = std::find_if(node->entries.begin(), node->entries.end(),
                                [&](const SceneEntry& one) { return one.key == name; });
      if (entry == node->entries.end()) {
        entry = node->entries.insert(entry, SceneEntry{name, place, {}});
        entry->value.place = place;
        if (!is_last) entry->value.kind = SceneNode::Kind::map;
      } else if (is_last) {
        entry->place = place;
      }
      node = &entry->value;
    }
    walked = join_path(walked, name);
    begin += name.size() + 1;
  }
  *node = std::move(value);
}

const SceneNode* find(const SceneNode& root, const std::string& path) {
  const Found found = find_nearest(root, path);
  return found.is_exact ? found.node : nullptr;
}

Place place_of(const SceneNode& root, const std::string& path) {
  return find_nearest(root, path).node->place;
}

Problem problem_at(const Place& place, std::string key, std::string message) {
  if (place.line > 0) {
    return {std::move(key), std::move(message), place.source, place.line, place.column};
  }
  return {std::move(key),
          std::move(message),
          place.source,
          0,
          0,
          place.column > 0 ? excerpt_of(place.source, 0, place.column) : ""};
}

std::string path_of_file(const SceneNode& root, const std::string& key, const std::string& name) {
  const Place place = place_of(root, key);
  if (place.line == 0) return name;
  return (std::filesystem::path(place.source).parent_path() / name).string();
}

void add_excerpts(std::vector<Problem>& problems, const SceneNode& root) {
  add_excerpts(problems, root.place.source, root.document);
}

void locate(std::vector<Problem>& problems, const SceneNode& root) {
  for (Problem& problem : problems) {
    if (!problem.source.empty()) continue;
    const Place place = place_of(root, problem.key);
    if (problem.key.empty()) {
      problem.source = place.source;
    } else {
      problem = problem_at(place, std::move(problem.key), std::move(problem.message));
    }
  }
  add_excerpts(problems, root);
}

void sort_by_place(std::vector<Problem>& problems) {
  // A file always has a line where it has a place; what has none goes after it.
  const auto rank = [](const Problem& problem) {
    return std::make_pair(problem.line == 0 ? 1 : 0, std::make_pair(problem.line, problem.column));
  };
  std::stable_sort(problems.begin(), problems.end(),
                   [&](const Problem& a, const Problem& b) { return rank(a) < rank(b); });
}

void collect_text_problems(const SceneNode& node, const std::string& path,
                           std::vector<Problem>& problems) {
  for (Problem problem : node.problems) {
    problem.key = join_path(path, problem.key);
    problems.push_back(std::move(problem));
  }
  for (const SceneEntry& entry : node.entries) {
    collect_text_problems(entry.value, join_path(path, entry.key), problems);
  }
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    collect_text_problems(node.items[i], join_path(path, std::to_string(i)), problems);
  }
}

}  // namespace stridor
