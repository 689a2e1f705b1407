#include "io/scene/yaml_text.hpp"

#include <fmt/format.h>
#include <yaml-cpp/anchor.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <sstream>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/utf8.hpp"
#include "io/scene/scene_problems.hpp"

namespace stridor {
namespace {

std::size_t count_nodes(const SceneNode& node) {
  std::size_t count = 1;
  for (const SceneEntry& entry : node.entries) count += count_nodes(entry.value);
  for (const SceneNode& item : node.items) count += count_nodes(item);
  return count;
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
      fail_at(
          Refusal::not_yaml, place_at(mark), "",
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
      fail_at(Refusal::not_yaml, place_at(mark), path(),
              "an alias inside the value that it stands for");
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
          problem_at(Refusal::not_yaml, node.place, "",
                     fmt::format("the YAML tag '{}' has no meaning in a scene; remove it", tag)));
    }
    return node;
  }

  void count(std::size_t num_nodes, const Place& place) {
    num_nodes_ += num_nodes;
    if (num_nodes_ > SceneLimits::nodes) {
      fail_at(
          Refusal::not_yaml, place, path(),
          fmt::format(
              "more than {} values (aliases expanded); put large tables into a file of their own",
              SceneLimits::nodes));
    }
  }

  [[noreturn]] void fail_depth(const YAML::Mark& mark) const {
    fail_at(Refusal::not_yaml, place_at(mark), path(),
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
      anchors_[anchor] = Anchored{node, num_nodes, num_levels(node)};
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
      problems.push_back(
          problem_at(Refusal::not_yaml, node.place, "",
                     "a key must be a plain name, without brackets, tags or line breaks"));
      return;
    }
    if (node.text == "<<" && !node.is_quoted) {
      problems.push_back(
          problem_at(Refusal::not_yaml, node.place, node.text,
                     "merge keys are not read; write the keys out, or use an alias for a "
                     "whole value"));
      return;
    }
    const auto [first, is_new] = frame.lines_of_keys.emplace(node.text, node.place.line);
    if (!is_new) {
      const std::string before =
          first->second > 0 ? fmt::format(", first in line {}", first->second) : "";
      problems.push_back(problem_at(Refusal::doubled_name, node.place, node.text,
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

/// The first tab in the indentation of a line or of the one before it: yaml-cpp reports what the
/// tab makes of the text, as a rule one line late.
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
    fail_at(Refusal::not_yaml, *tab, "", explain(ErrorMsg::TAB_IN_INDENTATION));
  if (error.msg == ErrorMsg::DOC_IN_SCALAR || error.msg == ErrorMsg::EOF_IN_SCALAR) {
    fail_at(Refusal::not_yaml, builder.last_place(), "",
            "a quote opened after here is never closed");
  }
  const Place place = builder.place_at(error.mark);
  const bool is_map = error.msg == ErrorMsg::END_OF_MAP_FLOW;
  if (is_map || error.msg == ErrorMsg::END_OF_SEQ_FLOW) {
    const std::string what = is_map ? "map" : "list";
    const char bracket = is_map ? '}' : ']';
    const Place& open = builder.open_place();
    if (place == builder.end()) {
      fail_at(Refusal::not_yaml, open, "",
              fmt::format("the {} that begins here is never closed by '{}'", what, bracket));
    }
    const std::string line = open.line > 0 ? fmt::format(" of line {}", open.line) : "";
    fail_at(Refusal::not_yaml, place, "",
            fmt::format("a ',' or '{}' is missing before this in the {}{}", bracket, what, line));
  }
  fail_at(Refusal::not_yaml, place, "", explain(error.msg));
}

}  // namespace

void check_characters(const std::string& text, Place place) {
  for (std::size_t i = text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0;
       i < text.size();) {
    const Utf8Character character = utf8_at(text, i);
    const auto byte = static_cast<unsigned char>(text[i]);
    const bool is_control =
        (byte < 0x20 && byte != '\t' && byte != '\n' && byte != '\r') || byte == 0x7F;
    if (character.length == 0 || is_control) {
      fail_at(
          Refusal::not_yaml, place, "",
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

std::string printable(std::string text) {
  for (char& c : text) {
    if (c < 0x20 || c > 0x7E) c = '?';
  }
  return text;
}

SceneNode parse_yaml(const std::string& text, const Place& start) {
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

}  // namespace stridor
