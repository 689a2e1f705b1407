// Parameters of the state at t = 0 in a scene.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/schema.hpp"

namespace stridor {

enum class MotionKind { displacement, velocity };

/// A displacement (m) or velocity (m/s) that a body starts with.
template <MotionKind kind>
struct InitialMotionParameters {
  std::string at;  ///< "<body>.<point>", or "<body>" for all of it
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  static const Schema& schema();
};

/// An eigenvector of the linearised system, added to the state.
struct PerturbationParameters {
  std::int64_t eigenvalue = 1;  ///< number of the eigenvalue with positive frequency, lowest first
  double amplitude = 0.0;       ///< largest displacement of a contact or recorded point, m
  static const Schema& schema();
};

struct InitialParameters {
  static constexpr const char* rest = "rest";
  static constexpr const char* equilibrium = "equilibrium";

  std::string state = rest;  ///< rest, equilibrium, or a run file
  std::vector<InitialMotionParameters<MotionKind::displacement>> displacement;
  std::vector<InitialMotionParameters<MotionKind::velocity>> velocity;
  std::optional<PerturbationParameters> perturbation;
  /// Indentation of every viscoelastic contact over that in equilibrium.
  std::optional<double> indentation;
  static const Schema& schema();

  bool is_file() const { return state != rest && state != equilibrium; }
};

}  // namespace stridor
