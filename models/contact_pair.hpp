// Contact pairs of a scene with their names resolved.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "coupling/system/contact_parameters.hpp"
#include "models/model_body.hpp"

namespace stridor {

/// What presses and starts a pair.
struct PairDrive {
  double ramp = 0.0;  ///< over which its friction rises, s
  double load = 0.0;  ///< size of the load on it in the end, N
};

/// A contact pair with its names resolved to nodes. A master without end has no nodes, nor has a
/// face.
struct ContactPair {
  std::string name;
  std::string key;  ///< key path of its section
  const ContactParameters* parameters = nullptr;
  int slave_body = 0;
  std::vector<int> slave_nodes;
  std::string master_name;
  int master_body = 0;
  std::vector<int> master_nodes;
  bool is_on_face = false;    ///< the master is one of BodyMatrices::faces
  bool is_on_facets = false;  ///< the master is one of BodyMatrices::facets
  bool is_in_space = false;   ///< on facets, or on a rigid plane

  /// "contacts.NAME.start"
  std::string key_of(const char* below) const { return key + "." + below; }
  /// Name of the master without that of its body.
  std::string surface_name() const { return master_name.substr(master_name.find('.') + 1); }
  /// Name of a contact of the pair.
  std::string point_name(std::size_t k) const;
};

/// Whether a master is a straight line along +x without end, and no surface of a body.
bool is_endless_master(const std::string& master);

/// Resolves the names of a pair.
/// @param endless_master body that carries a master without end
/// @throws ConfigError for names of what is not there, two contacts at one node, and a body that
///         touches itself
ContactPair resolve_pair(const std::string& name, const std::string& key,
                         const ContactParameters& parameters, const std::vector<ModelBody>& bodies,
                         int endless_master);

/// Refuses two pairs with one slave node on one master.
void refuse_shared_nodes(const std::vector<ContactPair>& pairs);

/// Laws, names and times of a contact of a pair; its place is left to the kind of master.
ContactPoint make_contact_point(const ContactPair& pair, std::size_t k, const PairDrive& drive);

}  // namespace stridor
