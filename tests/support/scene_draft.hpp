// Scenes made from nothing but the declared keys: every key of a schema, written as text, with the
// place of each.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/schema.hpp"
#include "io/scene/scene_tree.hpp"

namespace stridor::test {

/// A value that is yet to be written.
struct Draft {
  enum class Form { text, map, list };

  Form form = Form::text;
  std::string text;             ///< in YAML, of a value that is written as it stands
  std::vector<Draft> children;  ///< of a map or list
  std::string name;             ///< under which it stands in its map
  const Key* key = nullptr;     ///< where it is the value of a declared key
  /// Its key path with NAME for the names of sections and N for the indices of lists.
  std::string pattern;
  const Schema* schema = nullptr;    ///< of a map with declared keys
  std::vector<std::string> allowed;  ///< of a map: the names that it may hold

  Draft* child(const std::string& child_name) {
    const auto found = std::find_if(children.begin(), children.end(),
                                    [&](const Draft& one) { return one.name == child_name; });
    return found == children.end() ? nullptr : &*found;
  }
};

inline Draft text_draft(std::string text) {
  Draft draft;
  draft.text = std::move(text);
  return draft;
}

inline Draft list_draft(const std::vector<std::string>& texts) {
  Draft draft;
  draft.form = Draft::Form::list;
  for (const std::string& text : texts) draft.children.push_back(text_draft(text));
  return draft;
}

inline Draft table_draft(const std::vector<std::string>& times,
                         const std::vector<std::string>& values) {
  Draft draft;
  draft.form = Draft::Form::map;
  draft.allowed = {"times", "values"};
  draft.children = {list_draft(times), list_draft(values)};
  draft.children[0].name = "times";
  draft.children[1].name = "values";
  return draft;
}

/// A number as a scene holds it; whole ones without exponent, since an integer takes none.
inline std::string number_text(double value) {
  const bool is_whole = value == std::trunc(value) && std::abs(value) < 1e15;
  return is_whole ? fmt::format("{:.0f}", value) : fmt::format("{}", value);
}

/// Numbers that a key allows.
inline std::vector<double> allowed_numbers(const Key& key) {
  std::vector<double> numbers;
  const auto add = [&](double value) {
    const bool is_whole = value == std::trunc(value);
    if (key.kind == KeyKind::integer && (!is_whole || !key.storable.contains(value))) return;
    if (key.range.contains(value)) numbers.push_back(value);
  };
  for (const double value : {1.0, 2.0, 0.5, 0.1, 10.0, 0.01, 100.0, 1e-3, 0.0, -1.0}) {
    add(value);
  }
  add(key.range.low);
  add(key.range.high);
  if (numbers.empty()) add(0.5 * (key.range.low + key.range.high));
  if (numbers.empty()) add(std::ceil(key.range.low));
  return numbers;
}

/// Each once, in the order in which they come.
inline std::vector<std::string> words_of(const std::string& sentence) {
  std::vector<std::string> words(1);
  for (const char c : sentence) {
    if ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_') {
      words.back() += c;
    } else if (!words.back().empty()) {
      words.emplace_back();
    }
  }
  if (words.back().empty()) words.pop_back();
  std::set<std::string> known;
  std::erase_if(words, [&](const std::string& word) { return !known.insert(word).second; });
  return words;
}

/// Whether a list of texts may be two words of the documentation with a dot between: there are
/// thousands.
enum class WordPairs { tried, left_out };

/// What the value of a key that holds no maps may be; a check between keys may want another than
/// the first.
inline std::vector<Draft> candidates(const Key& key, WordPairs pairs = WordPairs::tried) {
  std::vector<Draft> drafts;
  switch (key.kind) {
    case KeyKind::flag:
      return {text_draft("true"), text_draft("false")};
    case KeyKind::integer:
    case KeyKind::real:
      for (const double value : allowed_numbers(key)) {
        drafts.push_back(text_draft(number_text(value)));
      }
      return drafts;
    case KeyKind::text:
      drafts = {text_draft("a"), text_draft("a.b"), text_draft("a.b.x.c")};
      // Words that mean something are named in the documentation.
      for (const std::string& word : words_of(key.doc)) drafts.push_back(text_draft(word));
      return drafts;
    case KeyKind::choice:
      for (const std::string& choice : key.choices) drafts.push_back(text_draft(choice));
      return drafts;
    case KeyKind::real_list: {
      if (key.doc.find("ascending from 0") != std::string::npos)
        drafts.push_back(list_draft({"0", "1", "2"}));
      for (const double value : allowed_numbers(key)) {
        if (key.range.contains(2.0 * value)) {
          drafts.push_back(list_draft({number_text(value), number_text(2.0 * value)}));
        }
      }
      const std::string number = number_text(allowed_numbers(key).at(0));
      drafts.push_back(list_draft({number}));
      drafts.push_back(list_draft({number, number, number}));  // one for each direction
      if (key.range.contains(0.5)) drafts.push_back(list_draft({"0.5", "0.5"}));  // shares
      return drafts;
    }
    case KeyKind::text_list:
      drafts = {list_draft({"a", "b"}), list_draft({"a.b", "c.d"}), list_draft({"a"}),
                text_draft("a")};
      for (const std::string& word : words_of(key.doc)) drafts.push_back(list_draft({word}));
      if (pairs == WordPairs::left_out) return drafts;
      for (const std::string& first : words_of(key.doc)) {
        for (const std::string& second : words_of(key.doc))
          drafts.push_back(list_draft({first + "." + second}));
      }
      return drafts;
    case KeyKind::curve:
      for (const double value : allowed_numbers(key)) {
        const std::string text = number_text(value);
        drafts.push_back(text_draft(text));
        drafts.push_back(table_draft({"0", "1"}, {text, text}));
      }
      return drafts;
    case KeyKind::parameters: {
      Draft draft;
      draft.form = Draft::Form::map;
      draft.children = {text_draft("2 mm"), text_draft("=2*one")};
      draft.children[0].name = "one";
      draft.children[1].name = "two";
      return {draft};
    }
    case KeyKind::section:
    case KeyKind::named_sections:
    case KeyKind::section_list:
      break;
  }
  return drafts;
}

Draft complete_draft(const Schema& schema, const std::string& pattern);

/// A key with everything below it: a named section of each alternative, two entries in a list of
/// sections.
inline Draft complete_draft(const Key& key, const std::string& map_pattern) {
  const std::string pattern = join_path(map_pattern, key.name);
  Draft draft;
  switch (key.kind) {
    case KeyKind::section:
      draft = complete_draft(key.alternatives[0].schema(), pattern);
      break;
    case KeyKind::named_sections:
      draft.form = Draft::Form::map;
      for (const Alternative& alternative : key.alternatives) {
        const std::string name =
            alternative.name.empty() ? "NAME" : fmt::format("NAME({})", alternative.name);
        Draft entry = complete_draft(alternative.schema(), join_path(pattern, name));
        entry.name = fmt::format("name_{}", draft.children.size());
        if (!key.discriminator.empty()) {
          Draft type = text_draft(alternative.name);
          type.name = key.discriminator;
          type.pattern = join_path(entry.pattern, type.name);
          entry.children.insert(entry.children.begin(), type);
          entry.allowed.push_back(key.discriminator);
        }
        draft.children.push_back(entry);
      }
      break;
    case KeyKind::section_list:
      draft.form = Draft::Form::list;
      draft.children.assign(2,
                            complete_draft(key.alternatives[0].schema(), join_path(pattern, "N")));
      break;
    default:
      draft = candidates(key).at(0);
  }
  draft.name = key.name;
  draft.key = &key;
  draft.pattern = pattern;
  return draft;
}

/// A map with every key that it may hold.
inline Draft complete_draft(const Schema& schema, const std::string& pattern) {
  Draft draft;
  draft.form = Draft::Form::map;
  draft.pattern = pattern;
  draft.schema = &schema;
  for (const Key& key : schema.keys) {
    draft.children.push_back(complete_draft(key, pattern));
    draft.allowed.push_back(key.name);
  }
  return draft;
}

/// Everything below a draft and the draft itself, with key paths.
inline void visit(const Draft& draft, const std::string& path,
                  const std::function<void(const Draft&, const std::string&)>& see) {
  see(draft, path);
  for (std::size_t i = 0; i < draft.children.size(); ++i) {
    const Draft& child = draft.children[i];
    visit(child, join_path(path, child.name.empty() ? std::to_string(i) : child.name), see);
  }
}

/// The draft at a key path, or nullptr.
inline Draft* find_draft(Draft& root, const std::string& path) {
  Draft* draft = &root;
  for (std::size_t begin = 0; draft != nullptr && begin < path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    const std::string name = path.substr(begin, end - begin);
    if (draft->form == Draft::Form::list) {
      std::size_t index = draft->children.size();
      std::from_chars(name.data(), name.data() + name.size(), index);
      draft = index < draft->children.size() ? &draft->children[index] : nullptr;
    } else {
      draft = draft->child(name);
    }
    begin = end + 1;
  }
  return draft;
}

/// "a.b" of "a.b.c".
inline std::string parent_path(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string::npos ? std::string() : path.substr(0, dot);
}

/// "c" of "a.b.c".
inline std::string last_name(const std::string& path) {
  return path.substr(path.rfind('.') + 1);
}

/// How maps and lists are written: block gives every key of a map a line of its own, flow only
/// those at the top.
enum class YamlStyle { block, flow };

/// A draft as text, and where in it everything stands.
class WrittenScene {
 public:
  struct Spot {
    std::string path;
    Place key;    ///< of the name; line 0 in a list
    Place value;  ///< as SceneNode::place has it
  };

  WrittenScene(const Draft& root, YamlStyle style) : style_(style) {
    spots_.push_back({"", {}, here()});
    write_entries(root, "", 0);
  }

  const std::string& text() const { return text_; }

  /// The last with this path: of a doubled key the second.
  const Spot& spot(const std::string& path) const {
    const auto found = std::find_if(spots_.rbegin(), spots_.rend(),
                                    [&](const Spot& spot) { return spot.path == path; });
    if (found == spots_.rend()) throw std::logic_error("nothing was written at " + path);
    return *found;
  }

 private:
  Place here() const { return {"s.yaml", line_, column_}; }

  void put(const std::string& text) {
    text_ += text;
    for (const char c : text) {
      column_ = c == '\n' ? 1 : column_ + 1;
      if (c == '\n') ++line_;
    }
  }

  static bool holds_text_only(const Draft& list) {
    return std::all_of(list.children.begin(), list.children.end(),
                       [](const Draft& child) { return child.form == Draft::Form::text; });
  }

  bool is_block(const Draft& draft) const {
    if (style_ == YamlStyle::flow || draft.children.empty()) return false;
    return draft.form == Draft::Form::map ||
           (draft.form == Draft::Form::list && !holds_text_only(draft));
  }

  /// The entries of a map, a line each; the first goes on in a line that is begun.
  void write_entries(const Draft& map, const std::string& path, std::size_t indent) {
    for (const Draft& child : map.children) {
      if (column_ == 1) put(std::string(indent, ' '));
      write_entry(child, path, indent);
      if (column_ != 1) put("\n");
    }
  }

  void write_entry(const Draft& child, const std::string& map_path, std::size_t indent) {
    const std::size_t index = spots_.size();
    const std::string path = join_path(map_path, child.name);
    spots_.push_back({path, here(), here()});
    put(child.name + ":");
    if (is_block(child)) {
      put("\n");
      if (child.form == Draft::Form::map) {
        write_entries(child, path, indent + 2);
      } else {
        write_items(child, path, indent + 2);
      }
      return;
    }
    put(" ");
    spots_[index].value = here();
    write_flow(child, path);
  }

  void write_items(const Draft& list, const std::string& path, std::size_t indent) {
    for (std::size_t i = 0; i < list.children.size(); ++i) {
      const Draft& item = list.children[i];
      put(std::string(indent, ' ') + "- ");
      const std::string item_path = join_path(path, std::to_string(i));
      spots_.push_back({item_path, {}, here()});
      if (is_block(item)) {
        write_entries(item, item_path, indent + 2);
      } else {
        write_flow(item, item_path);
        put("\n");
      }
    }
  }

  void write_flow(const Draft& draft, const std::string& path) {
    if (draft.form == Draft::Form::text) {
      put(draft.text);
      return;
    }
    const bool is_map = draft.form == Draft::Form::map;
    put(is_map ? "{" : "[");
    for (std::size_t i = 0; i < draft.children.size(); ++i) {
      if (i > 0) put(", ");
      if (is_map) {
        write_entry(draft.children[i], path, 0);
      } else {
        const std::string item_path = join_path(path, std::to_string(i));
        spots_.push_back({item_path, {}, here()});
        write_flow(draft.children[i], item_path);
      }
    }
    put(is_map ? "}" : "]");
  }

  YamlStyle style_;
  std::string text_;
  int line_ = 1;
  int column_ = 1;
  std::vector<Spot> spots_;
};

}  // namespace stridor::test
