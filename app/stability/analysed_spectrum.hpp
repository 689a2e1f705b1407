// The sliding equilibrium of a scene with its spectrum, by the method that suits it.
#pragma once

#include <limits>

#include "app/stability/found_spectrum.hpp"
#include "app/stability/sliding_state.hpp"
#include "app/stability/stability.hpp"

namespace stridor {

/// Sliding state and spectrum of a scene.
struct Analysis {
  SceneFamily::Member member;
  SlidingState state;  ///< empty where the model is sparse
  FoundSpectrum found;
  double trusted = std::numeric_limits<double>::infinity();  ///< Hz

  bool is_sparse() const { return member.model->sparse.has_value(); }
  bool has_contacts() const { return !member.model->system.contacts.empty(); }
};

/// Finds both. @throws NumericalError if there is no equilibrium, or eigenvalues may be missing
Analysis analyse(const StabilityOptions& options, const LoadedScene& loaded,
                 const SceneFamily::Member& member);

}  // namespace stridor
