// What the set-up of a scene takes, before anything is allocated for it.
#pragma once

#include <string>
#include <vector>

#include "core/memory.hpp"
#include "coupling/laws/sliding_contact_parameters.hpp"
#include "models/model.hpp"
#include "substructures/reduction/reduction_size.hpp"

namespace stridor {

/// A part of the memory that is held at the same time as the others.
struct MemoryPart {
  std::string key;     ///< that makes it large
  std::string what;    ///< with the numbers it comes from
  std::string remedy;  ///< what to change
  double bytes = 0.0;
};

/// Memory and work of a set-up. Formulas count the large arrays; see set_up_estimate.cpp for what
/// was measured.
struct SetUpEstimate {
  std::vector<MemoryPart> parts;
  double operations = 0.0;  ///< multiplications and additions

  double bytes() const;
  /// Time by the operations of one thread, s; good to a factor of about three.
  double seconds() const;
};

/// Of a reduction.
/// @param key of the body, e.g. "substructures.plate"
SetUpEstimate estimate_reduction(const ReductionSize& size, const std::string& key,
                                 const SizeKey& of_size);

/// Of beams; of bodies by matrices only once these are read. Names that lead nowhere count nothing.
SetUpEstimate estimate_set_up(const ModelParameters& model);
/// Of boundary elements.
/// @param key of their settings, e.g. "contact.normal.solver"
SetUpEstimate estimate_set_up(const SlidingContactParameters& contact, const std::string& key);

/// @throws ConfigError naming the largest part, if all of them do not fit
void require_memory(const SetUpEstimate& estimate, const MemoryLimit& limit);
/// The same for results that are held until the end.
/// @throws ConfigError naming the key of the part, if it does not fit
void require_memory_for(const MemoryPart& results, const MemoryLimit& limit);

}  // namespace stridor
