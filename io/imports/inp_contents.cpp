#include "io/imports/inp_contents.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <utility>

#include "io/imports/inp_assembly.hpp"
#include "io/imports/inp_types.hpp"

namespace stridor {
namespace {

/// These make or move nodes or elements.
constexpr std::array<std::string_view, 11> making_keywords{"NGEN",
                                                           "NFILL",
                                                           "NCOPY",
                                                           "NMAP",
                                                           "ELGEN",
                                                           "ELCOPY",
                                                           "SYSTEM",
                                                           "IMPERFECTION",
                                                           "IMPORT",
                                                           "ORPHAN MESH",
                                                           "SYMMETRIC MODEL GENERATION"};

class InpReader {
 public:
  explicit InpReader(InpLines& lines) : lines_(lines) {}

  InpContents read() {
    for (InpLineKind kind = lines_.next(); kind != InpLineKind::end; kind = lines_.next()) {
      if (kind == InpLineKind::data) {
        read_data();
      } else {
        finish_element();
        begin_keyword(lines_.keyword());
      }
    }
    finish_element();
    contents_.instance = assembly_.instance();
    return std::move(contents_);
  }

 private:
  enum class Block {
    none,
    skipped,
    instance,
    nodes,
    elements,
    node_set,
    element_set,
    surface,
    node_surface
  };

  void begin_keyword(const InpKeyword& keyword) {
    set_ = -1;
    if (assembly_.enter(keyword)) {
      block_ = keyword.name == "INSTANCE" ? Block::instance : Block::none;
    } else if (keyword.name == "NODE") {
      begin_nodes(keyword);
    } else if (keyword.name == "ELEMENT") {
      begin_elements(keyword);
    } else if (keyword.name == "NSET") {
      begin_set(keyword, contents_.node_sets, Block::node_set);
    } else if (keyword.name == "ELSET") {
      begin_set(keyword, contents_.element_sets, Block::element_set);
    } else if (keyword.name == "SURFACE") {
      begin_surface(keyword);
    } else if (std::find(making_keywords.begin(), making_keywords.end(), keyword.name) !=
               making_keywords.end()) {
      refuse_at(keyword.place,
                fmt::format("*{} makes or moves nodes or elements; expected them as *NODE and "
                            "*ELEMENT: write the input anew from the finished mesh",
                            keyword.name));
    } else {
      skip("*" + shown(keyword.name));
    }
  }

  void skip(const std::string& what) {
    block_ = Block::skipped;
    if (std::find(contents_.skipped.begin(), contents_.skipped.end(), what) ==
        contents_.skipped.end())
      contents_.skipped.push_back(what);
  }

  void check_parameters(const InpKeyword& keyword,
                        std::initializer_list<std::string_view> known) const {
    for (const InpParameter& parameter : keyword.parameters) {
      if (std::find(known.begin(), known.end(), parameter.name) != known.end()) continue;
      std::string list;
      for (const std::string_view name : known)
        list += fmt::format("{}{}", list.empty() ? "" : ", ", name);
      refuse_at(keyword.place, fmt::format("*{} with {} is not supported; expected {}",
                                           keyword.name, shown(parameter.name), list));
    }
  }

  std::string required(const InpKeyword& keyword, std::string_view parameter) const {
    const InpParameter* found = keyword.find(parameter);
    if (found == nullptr || found->value.empty())
      refuse_at(keyword.place, fmt::format("*{} without {}=", keyword.name, parameter));
    return found->value;
  }

  void begin_input(const InpKeyword& keyword) {
    if (const InpParameter* input = keyword.find("INPUT"))
      lines_.include(input->value, keyword.place);
  }

  void begin_nodes(const InpKeyword& keyword) {
    check_parameters(keyword, {"NSET", "INPUT", "SYSTEM"});
    if (const InpParameter* system = keyword.find("SYSTEM");
        system != nullptr && system->value != "R" && system->value != "r") {
      refuse_at(keyword.place, fmt::format("*NODE with SYSTEM={} is not supported; expected "
                                           "rectangular coordinates",
                                           shown(system->value)));
    }
    begin_input(keyword);
    if (assembly_.is_between_instances()) {
      skip("*NODE of the assembly");
      return;
    }
    block_ = Block::nodes;
    if (keyword.find("NSET") != nullptr)
      set_ = contents_.node_sets.define(assembly_.scope(), required(keyword, "NSET"));
  }

  void begin_elements(const InpKeyword& keyword) {
    check_parameters(keyword, {"TYPE", "ELSET", "INPUT"});
    std::string name = required(keyword, "TYPE");
    std::transform(name.begin(), name.end(), name.begin(), [](char letter) {
      return static_cast<char>(letter >= 'a' && letter <= 'z' ? letter - 'a' + 'A' : letter);
    });
    const auto type = inp_type(name);
    if (!type) refuse_at(keyword.place, refused_inp_type(name));
    type_ = *type;
    type_name_ = name;
    begin_input(keyword);
    block_ = Block::elements;
    if (keyword.find("ELSET") != nullptr)
      set_ = contents_.element_sets.define(assembly_.scope(), required(keyword, "ELSET"));
  }

  void begin_set(const InpKeyword& keyword, InpSets& sets, Block block) {
    const char* own = block == Block::node_set ? "NSET" : "ELSET";
    if (block == Block::node_set) {
      check_parameters(keyword, {"NSET", "GENERATE", "INSTANCE", "INTERNAL", "UNSORTED"});
    } else {
      check_parameters(keyword, {"ELSET", "GENERATE", "INSTANCE", "INTERNAL", "UNSORTED"});
    }
    set_ = sets.define(assembly_.scope(), required(keyword, own));
    is_generated_ = keyword.find("GENERATE") != nullptr;
    assembly_.check_instance(keyword);
    block_ = block;
    names_instance_ = keyword.find("INSTANCE") != nullptr;
    is_of_assembly_ = assembly_.is_between_instances() && !names_instance_;
  }

  void begin_surface(const InpKeyword& keyword) {
    const InpParameter* type = keyword.find("TYPE");
    const std::string kind = type == nullptr ? "element" : lower_case_of(type->value);
    if (kind != "element" && kind != "node") {
      skip(fmt::format("*SURFACE, TYPE={}", shown(type->value)));
      return;
    }
    check_parameters(keyword, {"NAME", "TYPE", "INTERNAL"});
    const std::string name = required(keyword, "NAME");
    is_of_assembly_ = false;
    is_generated_ = false;
    names_instance_ = false;
    if (kind == "node") {
      if (contents_.node_sets.find(assembly_.scope(), name) >= 0) {
        refuse_at(keyword.place,
                  fmt::format("the surface '{}' of nodes has the name of a node set; "
                              "expected another name",
                              shown(name)));
      }
      set_ = contents_.node_sets.define(assembly_.scope(), name);
      block_ = Block::node_surface;
      return;
    }
    block_ = Block::surface;
    contents_.surfaces.push_back({assembly_.scope(), name, keyword.place, {}});
  }

  void read_data() {
    InpFields fields(lines_.data(), lines_.place());
    switch (block_) {
      case Block::none:
        refuse_at(lines_.place(), fmt::format("expected a keyword such as *NODE, got '{}'",
                                              shown(trimmed(lines_.data()))));
      case Block::skipped:
        return;
      case Block::instance:
        assembly_.check_position(fields, lines_.place());
        return;
      case Block::nodes:
        read_node(fields);
        return;
      case Block::elements:
        read_element(fields);
        return;
      case Block::node_set:
        read_members(fields, contents_.node_sets);
        return;
      case Block::element_set:
        read_members(fields, contents_.element_sets);
        return;
      case Block::node_surface:
        // A weight may follow the node or the set.
        if (const auto field = fields.next()) add_member(*field, contents_.node_sets);
        return;
      case Block::surface:
        read_sides(fields);
        return;
    }
  }

  std::int64_t label_of(const InpField& field, const char* what) const {
    const auto label = integer_in(field.text);
    if (!label || *label < 1) {
      refuse_at(field.place,
                fmt::format("expected {}, an integer from 1, got '{}'", what, shown(field.text)));
    }
    return *label;
  }

  void read_node(InpFields& fields) {
    const TextPlace place = lines_.place();
    const auto first = fields.next();
    const std::int64_t label = label_of(*first, "the number of a node");
    std::array<double, 3> position{};
    std::size_t k = 0;
    while (const auto field = fields.next()) {
      // Direction cosines of a normal may follow.
      if (k >= 6) refuse_at(field->place, "expected the number of a node and three coordinates");
      const auto value = field->text.empty() ? std::optional(0.0) : real_in(field->text);
      if (!value) {
        refuse_at(field->place, fmt::format("expected a coordinate, a finite number, got '{}'",
                                            shown(field->text)));
      }
      if (k < 3) position[k] = *value;
      ++k;
    }
    contents_.draft.nodes.add(label, position, place);
    if (set_ >= 0) {
      const std::size_t end = contents_.draft.nodes.size();
      contents_.node_sets.add_positions(set_, end - 1, end);
    }
  }

  void read_element(InpFields& fields) {
    const auto wanted = static_cast<std::size_t>(facts_of(type_.shape).num_nodes);
    const bool is_continued = is_open_;
    if (is_continued && !goes_on_) finish_element();
    if (!is_continued) {
      element_place_ = lines_.place();
      element_label_ = label_of(*fields.next(), "the number of an element");
      num_nodes_ = 0;
      is_open_ = true;
    }
    while (const auto field = fields.next()) {
      if (num_nodes_ == wanted)
        refuse_at(field->place, fmt::format("element {} ({}) has more than {} nodes",
                                            element_label_, type_name_, wanted));
      element_nodes_[num_nodes_++] = label_of(*field, "the number of a node");
    }
    goes_on_ = trimmed(lines_.data()).back() == ',';
    if (num_nodes_ < wanted) return;
    is_open_ = false;
    contents_.draft.elements.add(type_.shape, element_label_, {element_nodes_.data(), wanted},
                                 element_place_);
    contents_.is_shell.push_back(type_.is_shell);
    if (set_ >= 0) {
      const std::size_t end = contents_.draft.elements.size();
      contents_.element_sets.add_positions(set_, end - 1, end);
    }
  }

  /// Refuses an element that lacks nodes.
  void finish_element() {
    if (!is_open_) return;
    refuse_at(element_place_,
              fmt::format("element {} ({}) has {} nodes, expected {}; a line that goes on in the "
                          "next one ends with a comma",
                          element_label_, type_name_, num_nodes_, facts_of(type_.shape).num_nodes));
  }

  void read_members(InpFields& fields, InpSets& sets) {
    if (!is_generated_) {
      while (const auto field = fields.next()) {
        if (!field->text.empty()) add_member(*field, sets);
      }
      return;
    }
    std::array<std::int64_t, 3> numbers{1, 0, 1};
    std::size_t k = 0;
    while (const auto field = fields.next()) {
      if (k == 3) refuse_at(field->place, "expected first, last and step after GENERATE");
      numbers[k++] = label_of(*field, "first, last and step after GENERATE");
    }
    if (k < 2 || numbers[0] > numbers[1])
      refuse_at(lines_.place(),
                "expected first, last and step after GENERATE, first not beyond last");
    if (is_of_assembly_) return skip_set_of_assembly();
    sets.add_range(set_, numbers[0], numbers[1], numbers[2], lines_.place());
  }

  void add_member(const InpField& field, InpSets& sets) {
    InpAssembly::Name name = assembly_.resolved(field);
    name.is_prefixed = name.is_prefixed || names_instance_;
    if (const auto label = integer_in(name.text)) {
      // Numbers without an instance are nodes of the assembly, which is none of the mesh.
      if (is_of_assembly_ && !name.is_prefixed) return skip_set_of_assembly();
      sets.add_label(set_, label_of({name.text, field.place}, "a number or the name of a set"),
                     field.place);
      return;
    }
    const int other = defined_set(name, field, sets);
    if (other == set_)
      refuse_at(field.place, fmt::format("the set '{}' within itself", shown(field.text)));
    sets.add_set(set_, other, field.place);
  }

  void skip_set_of_assembly() {
    const Block block = block_;
    skip(block == Block::node_set ? "*NSET of nodes of the assembly"
                                  : "*ELSET of elements of the assembly");
    block_ = block;
  }

  int defined_set(const InpAssembly::Name& name, const InpField& field, const InpSets& sets) const {
    int found = -1;
    if (!name.is_prefixed && assembly_.scope() == InpScope::assembly)
      found = sets.find(InpScope::assembly, std::string(name.text));
    if (found < 0) found = sets.find(InpScope::part, std::string(name.text));
    if (found < 0 && !name.is_prefixed)
      found = sets.find(InpScope::assembly, std::string(name.text));
    if (found < 0) {
      refuse_at(field.place, fmt::format("expected a number, or the name of a set that is defined "
                                         "above this line, got '{}'",
                                         shown(field.text)));
    }
    return found;
  }

  void read_sides(InpFields& fields) {
    const auto first = fields.next();
    const auto side = fields.next();
    if (!side || side->text.empty()) {
      refuse_at(first->place,
                "expected an element or a set of elements and the name of a side: S1 to S6");
    }
    const InpAssembly::Name name = assembly_.resolved(*first);
    InpSurface::Sides sides;
    sides.place = first->place;
    sides.side = std::string(side->text);
    std::transform(sides.side.begin(), sides.side.end(), sides.side.begin(), [](char letter) {
      return static_cast<char>(letter >= 'a' && letter <= 'z' ? letter - 'a' + 'A' : letter);
    });
    sides.is_set = !integer_in(name.text).has_value();
    sides.element = sides.is_set ? defined_set(name, *first, contents_.element_sets)
                                 : label_of({name.text, first->place}, "the number of an element");
    contents_.surfaces.back().sides.push_back(std::move(sides));
  }

  InpLines& lines_;
  InpContents contents_;
  InpAssembly assembly_;
  Block block_ = Block::none;
  int set_ = -1;
  bool is_generated_ = false;
  bool is_of_assembly_ = false;
  bool names_instance_ = false;
  InpType type_;
  std::string type_name_;
  // An element whose nodes may go on in the next line.
  bool is_open_ = false;
  bool goes_on_ = false;
  std::int64_t element_label_ = 0;
  std::size_t num_nodes_ = 0;
  std::array<std::int64_t, 20> element_nodes_{};
  TextPlace element_place_;
};

}  // namespace

InpContents read_inp_contents(InpLines& lines) {
  return InpReader(lines).read();
}

}  // namespace stridor
