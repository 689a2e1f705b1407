// The mesh of a body as its scene names the parts of it.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/suggestion.hpp"
#include "substructures/bodies/mesh_body.hpp"
#include "substructures/bodies/nodal_matrices.hpp"
#include "substructures/elements/assembly.hpp"

namespace stridor {

/// Distance up to which a place is that of a node, of the extent of a mesh.
inline constexpr double share_of_extent = 1e-6;

/// A mesh in metres, turned into the frame of its body, with the surfaces that its scene adds.
/// References the parameters.
class NamedMesh {
 public:
  /// @param given matrices from elsewhere, not owned; null: those of the elements. Of a mesh without
  ///              elements the surfaces are node sets then
  /// @throws ConfigError with key paths below the body; std::invalid_argument if no mesh was read, or
  ///         the matrices are of another one
  explicit NamedMesh(const MeshBodyParameters& parameters, const NodalMatrices* given = nullptr);

  Mesh mesh;
  int dimension = 2;
  Eigen::Matrix2d turn;  ///< from the frame of the mesh to that of the body

  /// A place or direction of the scene in the frame of the body.
  Eigen::Vector3d turned(const std::vector<double>& given) const;
  /// A place of the body in the frame of the mesh, for messages.
  Eigen::RowVector3d in_file(const Eigen::Vector3d& place) const;
  std::string place_text(int node) const;

  /// Materials: first that of the body, then those of `materials`, in the order of their names.
  /// @throws ConfigError
  MeshSections sections() const;
  /// Surfaces and node sets.
  std::vector<std::string> known_names() const;
  /// Nodes of surfaces or node sets, with repetitions.
  /// @throws ConfigError at `key` where there is none of a name
  std::vector<int> nodes_on(const std::vector<std::string>& names, const std::string& key) const;
  /// @throws ConfigError at `key` where there is no such surface
  const std::vector<ElementSide>& surface(const std::string& name, const std::string& key) const;
  /// Parts of an even load on a surface; none where there is no such surface.
  NodeShares even_shares(const std::string& name) const;

  /// Null where the elements give them.
  const NodalMatrices* given() const { return given_; }

 private:
  void find_dimension();
  void add_surfaces();
  void add_node_sets();
  [[noreturn]] void refuse_empty(const std::string& key, const char* what) const;

  const MeshBodyParameters& parameters_;
  const NodalMatrices* given_;
};

template <class Map>
std::vector<std::string> names_of(const Map& map) {
  std::vector<std::string> names;
  for (const auto& entry : map) names.push_back(entry.first);
  return names;
}

/// ", did you mean ...? (there are: ...)".
inline std::string known(const std::string& written, const std::vector<std::string>& names) {
  if (names.empty()) return " (there are none)";
  return fmt::format("{} (there are: {})", did_you_mean(written, names), fmt::join(names, ", "));
}

}  // namespace stridor
