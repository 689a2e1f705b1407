// A body on its way from the keys of a scene to the coupled system.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "coupling/system/system.hpp"
#include "models/body_cache.hpp"
#include "substructures/bodies/body_parameters.hpp"

namespace stridor {

/// Matrices of a body, its place, and what its reduction is to keep and to give rows for.
struct ModelBody {
  std::string name;
  const BodyParameters* parameters = nullptr;  ///< null for a master without end
  BodyMatrices matrices;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< of its frame, m
  bool is_mirrored = false;    ///< its frame is that of a place on the lower face of a plate
  bool is_placed = false;
  bool is_touched = false;     ///< by a contact
  int drive = -1;              ///< index of the one that its supports, or the master, follow
  std::vector<int> interface;  ///< DoFs kept
  std::vector<DofSum> rows;    ///< displacements with a row, in the order of the rows

  /// Row of a displacement; 0 of it is held.
  int row_of(const DofSum& displacement);
  /// Rows of a node; no z where it does not move along it.
  PointRows rows_of(int node);
  /// Whether nothing is to be reduced of it.
  bool is_whole() const {
    return parameters != nullptr && !parameters->num_modes() &&
           (!is_touched || matrices.is_modal);
  }
  Eigen::Vector3d place_of(int node) const { return matrices.nodes.row(node).transpose() + place; }
  /// x and y of a node.
  Eigen::Vector2d position(int node) const { return place_of(node).head<2>(); }
  void keep(int dof);
  void keep_node(int node);
  /// Key path of its section.
  std::string key() const { return "substructures." + name; }
};

/// Assembles the bodies of a scene.
/// @throws ConfigError as BodyParameters::make(), and for names that are those of masters
std::vector<ModelBody> make_bodies(const Substructures& substructures, BodyCache& cache);

/// Computes what reduce_body() will want of several bodies and the cache has not, at the same time.
/// @throws ConfigError as reduce_body() for a body that is too large to be kept whole
void prepare_bodies(std::span<ModelBody* const> bodies, BodyCache& cache);
/// Refuses a reduction to more modes than there are unknowns inside, or of the interface.
/// @throws ConfigError with the key
void check_reduction(const ModelBody& body, int num_modes);
/// Reduces a body, or keeps it whole, with a row for each of ModelBody::rows.
/// @throws ConfigError where it cannot be reduced
BodyCache::Reduction reduce_body(ModelBody& body, BodyCache& cache);

/// Whether the bodies of which every unknown is kept are too large for dense matrices.
bool is_large(const std::vector<ModelBody>& bodies);

/// Refuses circulatory terms of a body in contact that some motion of it is free of.
void check_coupled(const SystemBody& body, const std::string& key);

/// "<body>.<name>" split at the first dot; the body looked up.
/// @throws ConfigError at `key` if there is none
std::pair<int, std::string> split_name(const std::string& name,
                                       const std::vector<ModelBody>& bodies,
                                       const std::string& key);

/// A node of a body by the name of its point.
/// @throws ConfigError at `key` if there is none
int node_at(const ModelBody& body, const std::string& point, const std::string& key);

/// Names of a map, and a list of names for a message.
template <class Map>
std::vector<std::string> names_in_map(const Map& map) {
  std::vector<std::string> names;
  names.reserve(map.size());
  for (const auto& entry : map) names.push_back(entry.first);
  return names;
}
std::string listed_names(const std::vector<std::string>& names);

}  // namespace stridor
