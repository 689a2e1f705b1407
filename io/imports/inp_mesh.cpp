#include "io/imports/inp_mesh.hpp"

#include <fmt/format.h>

#include <map>
#include <utility>

#include "io/imports/inp_contents.hpp"

namespace stridor {
namespace {

void refuse_formats_beside_inp(const SourceText& source) {
  std::string foreign = foreign_format(source.text);
  if (source.text.rfind("$MeshFormat", 0) == 0) foreign = "a Gmsh mesh; name it .msh";
  if (foreign.empty()) return;
  refuse_at({&source, 0},
            fmt::format("this is {}; expected an input of Abaqus or CalculiX", foreign));
}

/// From 0.
int side_number(const InpSurface::Sides& sides, ElementShape shape, bool is_shell) {
  const std::string& name = sides.side;
  const int count = static_cast<int>(facts_of(shape).sides.size());
  const char letter = is_shell ? 'E' : 'S';
  const bool is_side =
      name.size() == 2 && name[0] == letter && name[1] > '0' && name[1] - '0' <= count;
  if (is_side) return name[1] - '1';
  refuse_at(
      sides.place,
      fmt::format("expected a side from {0}1 to {0}{1} of elements like {2}{3}, got '{4}'", letter,
                  count, facts_of(shape).name, is_shell ? " (a shell)" : "", shown(name)));
}

std::vector<ElementSide> sides_of(const InpSurface& surface, const InpContents& contents,
                                  const AssembledMesh& assembled,
                                  const std::vector<std::vector<int>>& element_sets) {
  std::vector<ElementSide> result;
  const auto add = [&](const InpSurface::Sides& sides, int element) {
    const auto e = static_cast<std::size_t>(element);
    result.push_back({element, side_number(sides, assembled.mesh.shapes[e], contents.is_shell[e])});
  };
  for (const InpSurface::Sides& sides : surface.sides) {
    if (sides.is_set) {
      for (const int element : element_sets[static_cast<std::size_t>(sides.element)])
        add(sides, element);
      continue;
    }
    const int element = assembled.elements.find(sides.element);
    if (element < 0) {
      refuse_at(sides.place, fmt::format("element {} of surface '{}' is not defined in this file",
                                         sides.element, shown(surface.name)));
    }
    add(sides, element);
  }
  sort_unique(result);
  return result;
}

void add_surfaces(const InpContents& contents, AssembledMesh& assembled,
                  const std::vector<std::vector<int>>& element_sets) {
  std::map<std::pair<std::string, InpScope>, const InpSurface*> by_name;
  for (const InpSurface& surface : contents.surfaces) {
    if (by_name.emplace(std::pair(lower_case_of(surface.name), surface.scope), &surface).second)
      continue;
    refuse_at(surface.place,
              fmt::format("surface '{}' stands twice; expected another name", shown(surface.name)));
  }
  for (const auto& [key, surface] : by_name) {
    const bool is_doubled =
        key.second == InpScope::part && by_name.contains({key.first, InpScope::assembly});
    const std::string name = is_doubled ? contents.instance + "." + surface->name : surface->name;
    assembled.mesh.surfaces.emplace(name, sides_of(*surface, contents, assembled, element_sets));
  }
}

}  // namespace

ImportedMesh read_inp_mesh(SourceText source, IncludeReader reader) {
  refuse_formats_beside_inp(source);
  InpLines lines(std::move(source), std::move(reader));
  InpContents contents = read_inp_contents(lines);
  AssembledMesh assembled = assemble_mesh(
      std::move(contents.draft), lines.main_source(),
      "shells on volumes are not supported: delete them; of a mesh of Gmsh, save the .msh instead");

  const std::vector<std::vector<int>> element_sets =
      contents.element_sets.members(assembled.elements);
  const std::vector<std::vector<int>> node_sets = contents.node_sets.members(assembled.nodes);
  add_surfaces(contents, assembled, element_sets);
  const std::vector<std::string> element_names = contents.element_sets.names(contents.instance);
  for (std::size_t k = 0; k < element_sets.size(); ++k)
    assembled.mesh.element_sets[element_names[k]] = element_sets[k];
  const std::vector<std::string> node_names = contents.node_sets.names(contents.instance);
  for (std::size_t k = 0; k < node_sets.size(); ++k)
    assembled.mesh.node_sets[node_names[k]] = rows_of(assembled, node_sets[k]);

  ImportedMesh result{std::move(assembled.mesh), {}};
  result.summary =
      summary_of(result.mesh, assembled, "Abaqus or CalculiX", std::move(contents.skipped));
  return result;
}

}  // namespace stridor
