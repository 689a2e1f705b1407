// Parameters of the time integration in a scene.
#pragma once

#include <cstdint>
#include <optional>

#include "core/schema.hpp"

namespace stridor {

enum class Integrator {
  central_difference,  ///< predictor-corrector of BDF: first order in h with damping
  exact,               ///< exact motion of every mode from step to step
  event_driven,        ///< adaptive, order 8, of a SlidingOscillator: no steps of a given length
};

/// Of the key `integrator`.
const ChoiceWords<Integrator>& integrator_words();

enum class Coordinates {
  modal,                ///< one recurrence per mode
  craig_bampton,        ///< the published dense form, line by line
  craig_bampton_fused,  ///< the same with constants folded in advance
};

/// Of the key `coordinates`.
const ChoiceWords<Coordinates>& coordinates_words();

/// Retained modes; the truncated ones become residual flexibility. Given by a frequency or by an
/// error, never both (see retained_frequency()).
struct RetainParameters {
  std::optional<double> frequency;  ///< modes up to this one are kept, Hz, > 0
  /// Largest relative error of the frequencies of the bodies in contact up to `upper`, > 0.
  std::optional<double> error;
  double upper = 15e3;  ///< Hz, > 0
  static const Schema& schema();
};

struct TimeParameters {
  Integrator integrator = Integrator::central_difference;
  Coordinates coordinates = Coordinates::modal;
  double step = 0.0;                       ///< h, s, > 0; 0 of the event-driven integrator
  double end = 0.0;                        ///< s, > 0
  std::optional<RetainParameters> retain;  ///< absent: all modes
  /// Largest change of a contact force in the last sweep over several contacts, relative to the
  /// largest force, > 0.
  double contact_tolerance = 1e-12;
  std::int64_t contact_sweeps = 1000;  ///< most sweeps over several contacts in a step, ≥ 1
  /// Error of a step of the event-driven integrator, relative to the size of the motion, > 0.
  double tolerance = 1e-12;

  bool is_event_driven() const { return integrator == Integrator::event_driven; }
  static const Schema& schema();
};

}  // namespace stridor
