// Names of recorded channels.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/low_pass.hpp"
#include "io/scene.hpp"

namespace stridor {

enum class ContactQuantity { force, gap, slip_velocity, position };

/// One recorded channel: the motion of a point, or a quantity of a contact pair.
struct Channel {
  std::string name;  ///< as written in the scene
  std::string key;   ///< its key path, for messages

  std::optional<PointName> point;  ///< of a motion
  bool is_vertical = false;        ///< y, not x
  Derivative derivative = Derivative::none;

  std::string pair;  ///< of a contact quantity
  ContactQuantity quantity = ContactQuantity::force;

  std::string units() const;
};

/// Reads the channel names of a scene. Bodies and pairs are looked up; points are left to
/// make_model.
/// @throws ConfigError with all wrong names, and with names given twice
std::vector<Channel> parse_channels(const RecordParameters& record, const ModelParameters& model);

}  // namespace stridor
