// Names of recorded channels.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/low_pass.hpp"
#include "io/scene/scene.hpp"
#include "solvers/transient/energy_ledger.hpp"

namespace stridor {

enum class ContactQuantity {
  force,
  gap,
  slip_velocity,
  position,
  friction_force,
  state,
  area,
  friction_across,  ///< along the second tangent
  slip_across,      ///< likewise
};
const std::string& name_of(ContactQuantity quantity);

/// An entry of the energy ledger as it is recorded.
struct EnergyEntry {
  const char* name;
  double EnergyBalance::*value;
  const char* definition;
};

/// One recorded channel: the motion of a point, a quantity of a contact pair, or an entry of the
/// energy ledger.
struct Channel {
  std::string name;  ///< as written in the scene
  std::string key;   ///< its key path, for messages

  std::optional<PointName> point;  ///< of a motion
  int direction = 0;               ///< of it: x (0), y (1) or z (2)
  Derivative derivative = Derivative::none;

  std::string pair;  ///< of a contact quantity
  ContactQuantity quantity = ContactQuantity::force;

  const EnergyEntry* energy = nullptr;  ///< of the ledger

  std::string units() const;
  /// Whether the series of its own name is low-passed. Not so states, which mean nothing between
  /// their values, energies, whose sums must hold in every row, and contact forces, which would
  /// lose their zeros and impacts.
  bool is_filtered() const;
};

/// One channel by its name. Bodies and pairs are looked up; points are left to make_model().
/// @param key where the name was written
/// @throws ConfigError at `key`
Channel parse_channel(const std::string& name, const std::string& key,
                      const ModelParameters& model);

/// Reads the channel names of a scene, and adds the entries of the energy ledger where it is to be
/// recorded. Bodies and pairs are looked up; points are left to make_model.
/// @throws ConfigError with all wrong names, and with names given twice
std::vector<Channel> parse_channels(const RecordParameters& record, const ModelParameters& model);

}  // namespace stridor
