#include "app/sphere_motion.hpp"

#include <fmt/format.h>

#include "app/sphere_stability.hpp"
#include "core/version.hpp"
#include "io/panel_plot.hpp"

namespace stridor {

Eigen::Vector2d initial_displacement(const SphereScene& scene,
                                     const SubstrateOscillator& oscillator) {
  const Eigen::Vector2d rest = sphere_equilibrium(oscillator).displacement;
  return {rest.x(), scene.time.initial_indentation * rest.y()};
}

CycleOptions cycle_options(const SphereScene& scene) {
  CycleOptions options;
  options.settle = scene.time.settle;
  options.tolerance = scene.time.tolerance;
  return options;
}

Json cycle_json(const LimitCycle& cycle, const SphereNumbers& numbers) {
  const bool is_periodic = cycle.status == CycleStatus::periodic;
  const auto x_json = [&](double unit) {
    return Json{{"min", number(unit * cycle.x_min)},
                {"max", number(unit * cycle.x_max)},
                {"mean", number(unit * cycle.x_mean)},
                {"rms", number(unit * cycle.x_rms)}};
  };
  Json multipliers = Json::array();
  for (const std::complex<double>& m : cycle.multipliers)
    multipliers.push_back({m.real(), m.imag()});
  Json results{{"status", cycle_status_text(cycle.status)},
               {"period", is_periodic ? number(cycle.period) : Json(nullptr)},
               {"loops", cycle.loops},
               {"x", x_json(1.0)},
               {"stick_fraction", number(cycle.stick_fraction)},
               {"free_fraction", number(cycle.free_fraction)},
               {"multipliers", multipliers},
               {"residual", is_periodic ? number(cycle.residual) : Json(nullptr)},
               {"dimensional",
                {{"period", is_periodic ? number(cycle.period * numbers.time_unit) : Json(nullptr)},
                 {"x", x_json(numbers.length_unit)}}}};
  results.update(indentation_json(cycle.y_max, numbers));
  return results;
}

Json indentation_json(double deepest, const SphereNumbers& numbers) {
  const double over_radius = deepest / numbers.radius_ratio;
  return {{"largest_indentation", number(over_radius)}, {"law_exceeded", over_radius > 0.3}};
}

void print_law_exceeded(const Json& results) {
  if (!results["law_exceeded"].get<bool>()) return;
  fmt::print("the indentation exceeds what the contact law was made for (y/R > 0.3)\n");
}

void SphereHistory::add(const SubstrateOscillator& oscillator, const SubstrateMotion& motion) {
  const SubstrateMotion::State& s = motion.state();
  const SubstrateContact& contact = oscillator.contact;
  const double v = s[2] - oscillator.substrate_speed;
  const double direction = motion.mode() == SubstrateMode::slip_forward ? 1.0 : -1.0;
  const bool sticks = motion.mode() == SubstrateMode::stick;
  const SubstrateForces forces = contact.at(s[1], sticks ? 0.0 : v, direction);
  double friction = forces.tangential.value;
  if (sticks) {
    friction = oscillator.damping(0, 0) * s[2] + oscillator.damping(0, 1) * s[3] +
               oscillator.stiffness(0, 0) * s[0] + oscillator.stiffness(0, 1) * s[1] -
               oscillator.load.x();
  }
  add(oscillator, motion.time(), {s[0], s[1]}, {s[2], s[3]}, motion.mode(), forces.normal.value,
      friction);
}

void SphereHistory::add(const SubstrateOscillator& oscillator, double at,
                        const Eigen::Vector2d& displacement, const Eigen::Vector2d& velocity,
                        SubstrateMode how, double normal, double friction) {
  const SubstrateContact& contact = oscillator.contact;
  const double v = how == SubstrateMode::stick ? 0.0 : velocity.x() - oscillator.substrate_speed;
  time.push_back(at);
  x.push_back(displacement.x());
  y.push_back(displacement.y());
  vx.push_back(velocity.x());
  vy.push_back(velocity.y());
  slip.push_back(v);
  normal_force.push_back(normal);
  friction_force.push_back(friction);
  area.push_back(
      contact.law->at(displacement.y() / contact.indentation_unit, v / contact.speed_unit)
          .area.value);
  mode.push_back(static_cast<double>(how));
}

std::vector<Column> SphereHistory::columns() const {
  return {{"/time", "1", time},
          {"/channels/sphere.x.displacement", "1", x},
          {"/channels/sphere.y.displacement", "1", y},
          {"/channels/sphere.x.velocity", "1", vx},
          {"/channels/sphere.y.velocity", "1", vy},
          {"/contact/contact/force", "1", normal_force},
          {"/contact/contact/friction_force", "1", friction_force},
          {"/contact/contact/slip_velocity", "1", slip},
          {"/contact/contact/area", "1", area},
          {"/contact/contact/state", "1", mode}};
}

void plot_history(const SphereHistory& history, const std::string& caption,
                  const std::string& figure) {
  const auto panel = [&](const char* label, const std::vector<double>& values) {
    DiagramPanel one;
    one.x_label = "time ω_nx t";
    one.y_label = label;
    one.curves = {{"", history.time, values, Mark::line, 0}};
    return one;
  };
  plot_panels({panel("displacement x/x₀", history.x),
               panel("slip velocity (ẋ − v_d)/(x₀ ω_nx)", history.slip),
               panel("contact area A/R²", history.area)},
              caption, figure);
}

Attributes sphere_attributes(const LoadedSphereScene& loaded, const std::string& command_line) {
  return {{"scene", loaded.path},
          {"scene_hash", loaded.hash()},
          {"scene_resolved", loaded.resolved()},
          {"length_unit_m", sphere_numbers(loaded.scene.model.sphere).length_unit},
          {"time_unit_s", sphere_numbers(loaded.scene.model.sphere).time_unit},
          {"force_unit_N", sphere_numbers(loaded.scene.model.sphere).force_unit},
          {"command", command_line},
          {"version", std::string(version)},
          {"commit", std::string(commit)},
          {"date", utc_now()}};
}

}  // namespace stridor
