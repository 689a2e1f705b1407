// Growth of the small motions of one mass on a half-space, in closed form.
#pragma once

#include <memory>
#include <vector>

#include "analysis/growth_field.hpp"
#include "io/scene/scene_family.hpp"

namespace stridor {

/// The growth of a scene over one or two of its keys, 1/s.
/// @return null where its system is another, or a key needs more (OscillatorFamily)
std::unique_ptr<GrowthField> make_growth_field(const LoadedScene& loaded,
                                               const std::vector<NumericKey>& keys);

}  // namespace stridor
