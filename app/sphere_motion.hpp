// Functions common to the verbs that follow a sphere on a viscoelastic substrate in time.
#pragma once

#include "analysis/limit_cycle.hpp"
#include "app/command.hpp"
#include "io/column_file.hpp"
#include "io/sphere_scene.hpp"

namespace stridor {

/// Start of a motion of the scene: its equilibrium, pressed in or lifted a little.
/// @throws NumericalError if there is no equilibrium
Eigen::Vector2d initial_displacement(const SphereScene& scene,
                                     const SubstrateOscillator& oscillator);

CycleOptions cycle_options(const SphereScene& scene);

/// The results of a limit cycle, in units of the motion; `dimensional` in SI.
Json cycle_json(const LimitCycle& cycle, const SphereNumbers& numbers);

/// The largest indentation of a motion over the radius, and whether that is deeper than the law of
/// the contact was made for (PPH: small against the radius; 0.3 of it is taken as the end).
/// @param deepest in units of the motion
Json indentation_json(double deepest, const SphereNumbers& numbers);
/// Says so on standard output where the law is exceeded.
void print_law_exceeded(const Json& results);

/// A motion sampled at equal distances.
struct SphereHistory {
  std::vector<double> time, x, y, vx, vy, slip, normal_force, friction_force, area, mode;
  void add(const SubstrateOscillator& oscillator, const SubstrateMotion& motion);
  void add(const SubstrateOscillator& oscillator, double at, const Eigen::Vector2d& displacement,
           const Eigen::Vector2d& velocity, SubstrateMode how, double normal, double friction);
  std::vector<Column> columns() const;
};

/// Draws displacement, slip velocity and contact area over time (PPH, Fig. 12).
void plot_history(const SphereHistory& history, const std::string& caption,
                  const std::string& figure);

/// Attributes of every file of such a verb.
Attributes sphere_attributes(const LoadedSphereScene& loaded, const std::string& command_line);

}  // namespace stridor
