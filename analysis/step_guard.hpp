// Refusal of runs whose time step grows by itself.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/step_stability.hpp"
#include "solvers/transient/simulation.hpp"

namespace stridor {

/// Contacts held at a place on the path of a run, in one state.
struct HeldContacts {
  std::string name;  ///< which contacts, in what state and where
  Pencil rows;
};

/// States in which the step of a run is checked (docs/theory.md, 3.7): at most nine places on the
/// path, three where bodies have coupled terms, no closer than half a segment of a master.
///
/// At each, all contacts slide in the direction of the drive, in their sliding equilibrium or,
/// where there is none with a closed contact, on the undeformed masters; where some may lift off,
/// every one of several, of more than eight up to eight of them, slides alone as well. Where bodies
/// have coupled terms, contacts that may
/// stick do so as well: of other bodies that is stable. Empty without contacts and where one has a
/// substrate.
std::vector<HeldContacts> held_contacts(const System& system, const TimeParameters& time);

/// Growth of a step in a motion with which the bodies do not grow, or by less than a tenth of
/// ln|z|/h: more than half of that, and enough for a tenth until the end of the run. Where the
/// bodies grow too, the step only makes growth faster that is there.
struct OwnGrowth {
  std::string name;  ///< HeldContacts::name
  StepStability stability;
};

/// The largest growth of the step itself; nothing where it has none. Contacts that jam are passed
/// over.
std::optional<OwnGrowth> own_growth(const System& system, const TimeParameters& time,
                                    const std::vector<HeldContacts>& contacts);

/// Settings with which the step of a run has no growth of its own. The last two are sought where
/// neither of the first helps.
struct StepRemedy {
  std::optional<double> step;            ///< largest of time.step/2, /4, /5, /8, ... /100, s
  std::optional<double> retained;        ///< time.retain.frequency for the same step, Hz
  std::optional<double> with_all_modes;  ///< step without time.retain, s
  std::optional<double>
      with_central_difference;  ///< step with time.integrator, without time.retain, s

  bool is_empty() const {
    return !step && !retained && !with_all_modes && !with_central_difference;
  }
};
StepRemedy step_remedy(const System& system, const TimeParameters& time,
                       const std::vector<HeldContacts>& contacts);

/// @throws NumericalError naming contact, place, growth, step and remedy where the step of a run
///         grows by itself
/// Cost: for n modes that move, as long as nothing grows, about as much as 50 n² steps of one mode
/// per place; more for bodies with coupled terms.
void require_no_own_growth(const System& system, const TimeParameters& time);

/// A simulation for a run: refused where its step grows by itself.
/// @throws as Simulation::Simulation() and require_no_own_growth()
Simulation make_run_simulation(const System& system, const TimeParameters& time,
                               Accounts accounts = Accounts::none);

}  // namespace stridor
