// Bodies of a scene where it puts them, before anything of them is reduced.
#pragma once

#include <vector>

#include "coupling/system/system.hpp"
#include "models/contact_pair.hpp"
#include "models/model_body.hpp"

namespace stridor {

class BodyCache;
struct ModelParameters;

struct PlacedModel {
  /// In the order of their names, then those that carry masters without end, which have no nodes.
  std::vector<ModelBody> bodies;
  std::vector<std::vector<BodyLoad>> loads;  ///< of drives, by body; rows are ModelBody::rows
  std::vector<ContactPair> pairs;
  System system;  ///< contacts, surfaces and drives; no bodies
};

/// Assembles and places the bodies and connects them, as make_model() does.
/// @param parameters must outlive the result
/// @throws ConfigError as make_model(), but for what only a reduction shows
PlacedModel place_model(const ModelParameters& parameters, BodyCache& cache);

}  // namespace stridor
