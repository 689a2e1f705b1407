// Functions common to the verbs that follow one mass on a half-space from event to event.
#pragma once

#include "analysis/cycle_meter.hpp"
#include "analysis/limit_cycle.hpp"
#include "app/terminal/command.hpp"
#include "io/results/column_file.hpp"
#include "io/scene/scene.hpp"
#include "solvers/transient/sliding_oscillator.hpp"

namespace stridor {

/// The oscillator of a scene.
/// @param key names in messages what needs it, e.g. "time.integrator"
/// @throws ConfigError with the place of the key if the system is none, saying what it is instead
SlidingOscillator oscillator_of(const LoadedScene& loaded, const System& system,
                                const std::string& key);

/// Its steady sliding.
/// @throws NumericalError if there is none
SubstrateEquilibrium sliding_equilibrium(const SlidingOscillator& oscillator);

/// A scene whose limit cycle is sought.
struct CycleScene {
  SlidingOscillator oscillator;
  Eigen::Vector2d displacement;  ///< at the start, in units of the oscillator
  Eigen::Vector2d velocity;      ///< likewise
  CycleOptions options;          ///< likewise
};

/// @throws ConfigError with the place of the key if a scene has no section `cycle`
void require_cycle_section(const LoadedScene& loaded);

/// @param model is put into its initial state
/// @throws ConfigError with the place of the key if the scene has no section `cycle` or is of no
///         such system; FileError, NumericalError
CycleScene make_cycle_scene(const LoadedScene& loaded, Model& model);

/// When, why and what to do of a cycle that diverged.
std::string cycle_failure(const LimitCycle& cycle, const SlidingOscillator& oscillator);

/// The results of a limit cycle, SI.
Json cycle_json(const LimitCycle& cycle, const SlidingOscillator& oscillator);
/// Likewise {min, max, mean, rms} of the displacement along x.
Json displacement_json(const CycleMeter::Reading& seen, const SlidingOscillator& oscillator);

/// The largest indentation of a motion over the radius, and whether that is deeper than the law of
/// the contact was made for (PPH: small against the radius; 0.3 of it is taken as the end).
/// @param deepest m
Json indentation_json(double deepest, const SlidingMass& mass);
/// Says so on standard output where the law is exceeded.
void print_law_exceeded(const Json& results);

/// A motion sampled at equal distances, SI, as the channels of run files: relative to the frame of
/// the body, y out of the half-space.
struct CycleHistory {
  std::vector<double> time, x, y, vx, vy, slip, normal_force, friction_force, area, mode;
  void add(const SlidingOscillator& oscillator, const SubstrateMotion& motion);
  std::vector<Column> columns() const;
};

/// Draws displacement, slip velocity and contact area over time (PPH, Fig. 12).
void plot_history(const CycleHistory& history, const std::string& caption,
                  const std::string& figure);

/// The multipliers among the results of a cycle, as columns; none where there are none.
std::vector<Column> multiplier_columns(const Json& results);

}  // namespace stridor
