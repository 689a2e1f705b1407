// Writes small meshes as Gmsh does, in every version and form that is read.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace stridor::test {

/// A mesh as Gmsh sees it: nodes, elements in blocks of entities, physical groups of entities.
struct GmshModel {
  struct Node {
    std::int64_t tag;
    std::array<double, 3> position;
  };
  struct Block {
    int dimension, entity, type;
    std::vector<std::pair<std::int64_t, std::vector<std::int64_t>>> elements;  ///< tag and nodes
  };
  std::vector<Node> nodes;
  std::vector<Block> blocks;
  std::map<std::pair<int, int>, std::vector<int>> groups;          ///< tags by dimension and entity
  std::vector<std::pair<std::pair<int, int>, std::string>> names;  ///< by dimension and tag
};

enum class GmshForm { text, binary };

namespace gmsh_detail {

template <class Number>
std::string bytes_of(Number number) {
  std::string bytes(sizeof number, '\0');
  std::memcpy(bytes.data(), &number, sizeof number);
  return bytes;
}

/// Collects numbers of a file of either form.
class NumberText {
 public:
  explicit NumberText(GmshForm form) : form_(form) {}
  void integer(std::int64_t value) { add(static_cast<std::int32_t>(value), value); }
  void size(std::int64_t value) { add(value, value); }
  void real(double value) { add(value, value); }
  void end() {
    if (form_ == GmshForm::text) text += '\n';
  }
  std::string text;

 private:
  template <class Stored, class Shown>
  void add(Stored stored, Shown shown) {
    text += form_ == GmshForm::binary ? bytes_of(stored) : fmt::format("{} ", shown);
  }
  GmshForm form_;
};

inline std::string head_of(const GmshModel& model, const char* version, GmshForm form) {
  const bool is_binary = form == GmshForm::binary;
  std::string text = fmt::format("$MeshFormat\n{} {} 8\n", version, is_binary ? 1 : 0);
  if (is_binary) text += bytes_of(std::int32_t{1}) + "\n";
  text += "$EndMeshFormat\n";
  if (model.names.empty()) return text;
  text += fmt::format("$PhysicalNames\n{}\n", model.names.size());
  for (const auto& [group, name] : model.names)
    text += fmt::format("{} {} \"{}\"\n", group.first, group.second, name);
  return text + "$EndPhysicalNames\n";
}

inline std::vector<int> groups_of(const GmshModel& model, const GmshModel::Block& block) {
  const auto found = model.groups.find({block.dimension, block.entity});
  return found == model.groups.end() ? std::vector<int>{} : found->second;
}

}  // namespace gmsh_detail

/// Version 4.1.
/// @param parametric whether nodes have parametric coordinates
inline std::string gmsh_41(const GmshModel& model, GmshForm form, int parametric = 0) {
  gmsh_detail::NumberText out(form);
  const char* line_end = form == GmshForm::binary ? "\n" : "";
  out.text = gmsh_detail::head_of(model, "4.1", form) + "$Entities\n";
  std::array<std::map<int, std::vector<int>>, 4> entities;
  for (const GmshModel::Block& block : model.blocks)
    entities.at(static_cast<std::size_t>(block.dimension))[block.entity] =
        gmsh_detail::groups_of(model, block);
  for (const auto& list : entities) out.size(static_cast<std::int64_t>(list.size()));
  out.end();
  for (std::size_t dimension = 0; dimension < 4; ++dimension) {
    for (const auto& [tag, groups] : entities.at(dimension)) {
      out.integer(tag);
      for (int k = 0; k < (dimension == 0 ? 3 : 6); ++k) out.real(0.5 * k);
      out.size(static_cast<std::int64_t>(groups.size()));
      for (const int group : groups) out.integer(group);
      if (dimension > 0) {
        out.size(2);
        out.integer(1);
        out.integer(-2);
      }
      out.end();
    }
  }
  out.text += std::string(line_end) + "$EndEntities\n$Nodes\n";

  // Two blocks, one of them with the first node alone.
  const auto count = static_cast<std::int64_t>(model.nodes.size());
  for (const std::int64_t number : {std::int64_t{2}, count, std::int64_t{1}, std::int64_t{99}})
    out.size(number);
  out.end();
  for (const bool is_first : {true, false}) {
    out.integer(is_first ? 0 : 2);
    out.integer(1);
    out.integer(parametric);
    out.size(is_first ? 1 : count - 1);
    out.end();
    const std::size_t begin = is_first ? 0 : 1;
    const std::size_t end = is_first ? 1 : model.nodes.size();
    for (std::size_t k = begin; k < end; ++k) {
      out.size(model.nodes[k].tag);
      out.end();
    }
    for (std::size_t k = begin; k < end; ++k) {
      for (const double coordinate : model.nodes[k].position) out.real(coordinate);
      for (int extra = 0; extra < (is_first ? 0 : 2 * parametric); ++extra) out.real(7.0);
      out.end();
    }
  }
  out.text += std::string(line_end) + "$EndNodes\n$Elements\n";

  std::int64_t num_elements = 0;
  for (const GmshModel::Block& block : model.blocks)
    num_elements += static_cast<std::int64_t>(block.elements.size());
  out.size(static_cast<std::int64_t>(model.blocks.size()));
  for (const std::int64_t number : {num_elements, std::int64_t{1}, std::int64_t{99}})
    out.size(number);
  out.end();
  for (const GmshModel::Block& block : model.blocks) {
    out.integer(block.dimension);
    out.integer(block.entity);
    out.integer(block.type);
    out.size(static_cast<std::int64_t>(block.elements.size()));
    out.end();
    for (const auto& [tag, nodes] : block.elements) {
      out.size(tag);
      for (const std::int64_t node : nodes) out.size(node);
      out.end();
    }
  }
  return out.text + line_end + "$EndElements\n";
}

/// Version 2.2, which writes an element once for every group that it is in.
inline std::string gmsh_22(const GmshModel& model, GmshForm form) {
  gmsh_detail::NumberText out(form);
  const char* line_end = form == GmshForm::binary ? "\n" : "";
  out.text =
      gmsh_detail::head_of(model, "2.2", form) + fmt::format("$Nodes\n{}\n", model.nodes.size());
  for (const GmshModel::Node& node : model.nodes) {
    out.integer(node.tag);
    for (const double coordinate : node.position) out.real(coordinate);
    out.end();
  }
  std::int64_t copies = 0;
  gmsh_detail::NumberText records(form);
  std::int64_t copy_tag = 100'000;
  for (const GmshModel::Block& block : model.blocks) {
    std::vector<int> groups = gmsh_detail::groups_of(model, block);
    if (groups.empty()) groups.push_back(0);
    for (const auto& [tag, nodes] : block.elements) {
      for (const int group : groups) {
        ++copies;
        const std::int64_t number = group == groups.front() ? tag : ++copy_tag;
        if (form == GmshForm::binary) {
          records.integer(block.type);
          records.integer(1);
          records.integer(2);
          records.integer(number);
        } else {
          records.integer(number);
          records.integer(block.type);
          records.integer(2);
        }
        records.integer(group);
        records.integer(block.entity);
        for (const std::int64_t node : nodes) records.integer(node);
        records.end();
      }
    }
  }
  out.text += fmt::format("{}$EndNodes\n$Elements\n{}\n", line_end, copies) + records.text;
  return out.text + line_end + "$EndElements\n";
}

}  // namespace stridor::test
