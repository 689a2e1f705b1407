// The unit in which a user thinks of a key, for the axes of pictures.
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "io/scene/scene_family.hpp"

namespace stridor {

/// A unit and its value in SI.
struct AxisUnit {
  std::string name;  ///< "mm"; "1" where dimensionless
  double in_si = 1.0;

  double number(double value) const { return value / in_si; }
  std::vector<double> numbers(std::vector<double> values) const {
    for (double& value : values) value = number(value);
    return values;
  }
};

/// The unit that was written with the first of some values ("30mm"), else the one with which the
/// scene gives the key ("start: 30 mm"), else that of the SI.
/// @param written values of the key on the command line
/// @param scene   null where there is no tree to look into
AxisUnit axis_unit(const NumericKey& key, std::initializer_list<std::string> written,
                   const SceneNode* scene);

}  // namespace stridor
