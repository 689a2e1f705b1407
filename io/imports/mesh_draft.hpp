// What a file says of nodes and elements, and the mesh made from it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "io/imports/label_index.hpp"
#include "io/imports/source_text.hpp"
#include "substructures/elements/mesh.hpp"

namespace stridor {

/// What was read, for the user to compare with what was meant.
struct MeshSummary {
  std::string format;                               ///< "Gmsh 4.1, binary"
  std::size_t num_nodes = 0;                        ///< of elements
  std::size_t dropped_nodes = 0;                    ///< which no element uses
  std::map<ElementShape, std::size_t> elements;     ///< how many of each shape
  std::map<std::string, std::size_t> node_sets;     ///< nodes of each
  std::map<std::string, std::size_t> element_sets;  ///< elements of each
  std::map<std::string, std::size_t> surfaces;      ///< sides of each
  std::vector<std::string> skipped;  ///< keywords or sections not used, each once, in file order
  /// Corners of the box around the nodes, in lengths of the file. The plane of a planar mesh, where
  /// `Mesh` has z = 0, has the z of the file here.
  std::array<double, 3> lowest{}, highest{};
};

/// A mesh, and a summary of the file that it was read from.
struct ImportedMesh {
  Mesh mesh;
  MeshSummary summary;
};

/// Nodes and elements in the order of the file, before labels are resolved.
struct MeshDraft {
  struct Nodes {
    std::vector<std::int64_t> labels;  ///< not negative
    std::vector<std::array<double, 3>> positions;
    std::vector<TextPlace> places;

    void add(std::int64_t label, const std::array<double, 3>& position, const TextPlace& place);
    std::size_t size() const { return labels.size(); }
  };
  struct Elements {
    std::vector<std::int64_t> labels;  ///< not negative
    std::vector<ElementShape> shapes;
    std::vector<TextPlace> places;
    std::vector<std::int64_t> connectivity;  ///< labels of nodes, in the order of the shape

    void add(ElementShape shape, std::int64_t label, std::span<const std::int64_t> node_labels,
             const TextPlace& place);
    std::size_t size() const { return labels.size(); }
  };
  Nodes nodes;
  Elements elements;
};

/// The mesh of a draft, with what it takes to resolve sets.
struct AssembledMesh {
  Mesh mesh;              ///< without sets and surfaces
  LabelIndex nodes;       ///< positions in the draft
  LabelIndex elements;    ///< elements of the mesh
  std::vector<int> rows;  ///< of `mesh.nodes`, for each node of the draft; -1 for dropped ones
  std::size_t dropped_nodes = 0;
  double plane = 0.0;  ///< z of a planar mesh in the file
};

/// Resolves labels, drops nodes that no element uses and checks: there are elements; no label
/// stands twice; nodes of elements exist and differ; all elements are planar or none is; planar
/// ones lie in one plane z = const, up to 1e-9 of their extent.
/// @param whole the file, for errors that have no place
/// @param mixed_remedy what to do about planar elements beside volumes
/// @throws ConfigError with the place
AssembledMesh assemble_mesh(MeshDraft draft, const SourceText& whole,
                            const std::string& mixed_remedy);

/// Rows of nodes of the mesh, ascending, each once, from positions in the draft; dropped nodes are
/// left out.
std::vector<int> rows_of(const AssembledMesh& assembled, std::span<const int> positions);

/// Ascending, each once.
template <class Value>
void sort_unique(std::vector<Value>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

/// @param assembled of which `mesh` may have been moved away
MeshSummary summary_of(const Mesh& mesh, const AssembledMesh& assembled, std::string format,
                       std::vector<std::string> skipped);

}  // namespace stridor
