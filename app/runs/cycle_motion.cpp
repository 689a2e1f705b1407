#include "app/runs/cycle_motion.hpp"

#include <fmt/format.h>

#include "core/errors.hpp"
#include "io/figures/panel_plot.hpp"
#include "io/run_file/initial_state.hpp"

namespace stridor {
namespace {

/// {min, max, mean, rms} of a displacement along the x of the oscillator.
Json extremes_json(double smallest, double largest, const Json& mean, const Json& rms,
                   const SlidingOscillator& oscillator) {
  const bool is_mirrored = oscillator.direction < 0.0;
  const double unit = oscillator.direction * oscillator.length;
  const auto scaled_json = [](const Json& value, double by) {
    return value.is_null() ? Json(nullptr) : number(by * value.get<double>());
  };
  return {{"min", number(unit * (is_mirrored ? largest : smallest))},
          {"max", number(unit * (is_mirrored ? smallest : largest))},
          {"mean", scaled_json(mean, unit)},
          {"rms", scaled_json(rms, oscillator.length)}};
}

}  // namespace

SlidingOscillator oscillator_of(const LoadedScene& loaded, const System& system,
                                const std::string& key) {
  std::string why;
  std::optional<SlidingOscillator> found = as_oscillator(system, &why);
  if (found) return *std::move(found);
  throw loaded.located(ConfigError(
      Refusal::missing, key,
      fmt::format("needs one body of two unknowns, the displacements x and y of one mass, on "
                  "a half_space that slides under it at a constant speed: {}",
                  why)));
}

SubstrateEquilibrium sliding_equilibrium(const SlidingOscillator& oscillator) {
  const SubstrateOscillator& of = oscillator.oscillator;
  SubstrateEquilibrium found = find_equilibrium(of, 1e-2 * of.contact.indentation_unit);
  if (!found.converged) {
    throw NumericalError(Refusal::no_equilibrium,
                         fmt::format("no sliding equilibrium: Newton's method with bisection did "
                                     "not converge in {} evaluations "
                                     "of the contact law; the load into the half_space is {:g} N",
                                     found.evaluations, oscillator.force * of.load.y()));
  }
  return found;
}

void require_cycle_section(const LoadedScene& loaded) {
  if (loaded.scene.cycle) return;
  throw loaded.located(
      ConfigError(Refusal::missing, "cycle",
                  "missing: a limit cycle is sought after `cycle.settle`, the time that the motion "
                  "takes to settle"));
}

CycleScene make_cycle_scene(const LoadedScene& loaded, Model& model) {
  const Scene& scene = loaded.scene;
  require_cycle_section(loaded);
  (void)set_initial_state(model.system, loaded);
  CycleScene made{oscillator_of(loaded, model.system, "cycle"), {}, {}, {}};
  (void)sliding_equilibrium(made.oscillator);
  made.displacement = made.oscillator.initial_displacement(model.system);
  made.velocity = made.oscillator.initial_velocity(model.system);
  made.options.settle = scene.cycle->settle / made.oscillator.time;
  made.options.tolerance = scene.time.value_or(TimeParameters{}).tolerance;
  return made;
}

std::string cycle_failure(const LimitCycle& cycle, const SlidingOscillator& oscillator) {
  return fmt::format("after t = {:.6g} s {}", oscillator.time * cycle.failure_time, cycle.failure);
}

Json cycle_json(const LimitCycle& cycle, const SlidingOscillator& oscillator) {
  const bool is_periodic = cycle.status == CycleStatus::periodic;
  Json multipliers = Json::array();
  for (const std::complex<double>& m : cycle.multipliers)
    multipliers.push_back({m.real(), m.imag()});
  Json results{{"status", cycle_status_text(cycle.status)},
               {"period", is_periodic ? number(oscillator.time * cycle.period) : Json(nullptr)},
               {"loops", cycle.loops},
               {"x", extremes_json(cycle.x_min, cycle.x_max, number(cycle.x_mean),
                                   number(cycle.x_rms), oscillator)},
               {"stick_fraction", number(cycle.stick_fraction)},
               {"free_fraction", number(cycle.free_fraction)},
               {"multipliers", multipliers},
               {"residual", is_periodic ? number(cycle.residual) : Json(nullptr)}};
  results.update(indentation_json(oscillator.length * cycle.y_max, oscillator.mass));
  return results;
}

Json displacement_json(const CycleMeter::Reading& seen, const SlidingOscillator& oscillator) {
  return extremes_json(seen.smallest, seen.largest, number_or_null(seen.mean),
                       number_or_null(seen.rms), oscillator);
}

Json indentation_json(double deepest, const SlidingMass& mass) {
  const double over_radius = deepest / mass.contact.indentation_unit;
  return {{"largest_indentation", number(over_radius)}, {"law_exceeded", over_radius > 0.3}};
}

void print_law_exceeded(const Json& results) {
  if (!results["law_exceeded"].get<bool>()) return;
  fmt::print("the indentation exceeds what the contact law was made for (y/R > 0.3)\n");
}

void CycleHistory::add(const SlidingOscillator& oscillator, const SubstrateMotion& motion) {
  const SubstrateMotion::State& s = motion.state();
  const Eigen::Vector2d place = oscillator.to_si({s[0], s[1]}, oscillator.length);
  const Eigen::Vector2d velocity = oscillator.to_si({s[2], s[3]}, oscillator.velocity_unit());
  const SubstrateForces forces = motion.forces();
  const bool sticks = motion.mode() == SubstrateMode::stick;
  time.push_back(oscillator.time * motion.time());
  x.push_back(place.x());
  y.push_back(place.y());
  vx.push_back(velocity.x());
  vy.push_back(velocity.y());
  slip.push_back(sticks ? 0.0 : velocity.x() - oscillator.mass.speed);
  normal_force.push_back(oscillator.force * forces.normal.value);
  friction_force.push_back(-oscillator.direction * oscillator.force * forces.tangential.value);
  area.push_back(oscillator.mass.contact.area(-place.y(), slip.back()));
  mode.push_back(motion.mode() == SubstrateMode::free ? 0.0 : sticks ? 1.0 : 2.0);
}

std::vector<Column> CycleHistory::columns() const {
  return {{"/time", "s", time, {}, true},
          {"/channels/x.displacement", "m", x},
          {"/channels/y.displacement", "m", y},
          {"/channels/x.velocity", "m/s", vx},
          {"/channels/y.velocity", "m/s", vy},
          {"/contact/contact/force", "N", normal_force},
          {"/contact/contact/friction_force", "N", friction_force},
          {"/contact/contact/slip_velocity", "m/s", slip},
          {"/contact/contact/area", "m^2", area},
          {"/contact/contact/state", "1", mode}};
}

void plot_history(const CycleHistory& history, const std::string& caption,
                  const std::string& figure) {
  const auto panel = [&](const char* label, const std::vector<double>& values, double unit) {
    DiagramPanel one;
    one.x_label = "time (s)";
    one.y_label = label;
    one.curves = {{"", history.time, values, Mark::line, 0}};
    for (double& value : one.curves.front().y) value /= unit;
    return one;
  };
  plot_panels({panel("displacement x (mm)", history.x, 1e-3),
               panel("slip velocity (mm/s)", history.slip, 1e-3),
               panel("contact area (mm²)", history.area, 1e-6)},
              caption, figure);
}

std::vector<Column> multiplier_columns(const Json& results) {
  const Json& multipliers = results["multipliers"];
  if (multipliers.empty()) return {};
  Column real{"/multipliers/real", "1", {}};
  Column imaginary{"/multipliers/imaginary", "1", {}};
  for (const Json& m : multipliers) {
    real.values.push_back(m[0].get<double>());
    imaginary.values.push_back(m[1].get<double>());
  }
  return {std::move(real), std::move(imaginary)};
}

}  // namespace stridor
