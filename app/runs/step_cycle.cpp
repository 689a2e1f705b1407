#include "app/runs/step_cycle.hpp"

#include <fmt/format.h>

#include <utility>

#include "core/errors.hpp"
#include "io/figures/panel_plot.hpp"
#include "io/run_file/initial_state.hpp"

namespace stridor {
namespace {

const ContactPoint& observed_contact(const PeriodicMotion& cycle) {
  return cycle.at_turn.contacts[static_cast<std::size_t>(cycle.observed.contact)];
}

std::string observed_name(const PeriodicMotion& cycle) {
  return fmt::format("{} of the slave at {}", cycle.observed.is_x ? "x" : "y",
                     observed_contact(cycle).name);
}

}  // namespace

PeriodicMotion find_scene_cycle(const LoadedScene& loaded, Model& model) {
  const Scene& scene = loaded.scene;
  loaded.require_section("time", "cycle");
  if (const auto why = why_not_periodic(model.system))
    throw loaded.located(
        ConfigError(Refusal::wrong_value, "cycle", "the motion cannot repeat itself: " + *why));
  (void)set_initial_state(model.system, loaded);
  try {
    PeriodicMotion found =
        find_periodic_motion(model.system, *scene.time, {.settle = scene.cycle->settle});
    if (found.at_turn.contacts.empty()) found.at_turn = model.system;
    return found;
  } catch (const ConfigError& error) {
    throw loaded.located(error);
  }
}

Json step_cycle_json(const PeriodicMotion& cycle) {
  const bool is_periodic = cycle.status == CycleStatus::periodic;
  const CycleMeter::Reading& seen = cycle.seen;
  Json multipliers = Json::array();
  for (const std::complex<double>& m : cycle.multipliers)
    multipliers.push_back({m.real(), m.imag()});
  return {{"status", cycle_status_text(cycle.status)},
          {"period", is_periodic ? number(cycle.period) : Json(nullptr)},
          {"observed", observed_name(cycle)},
          {"x",
           {{"min", number(seen.smallest)},
            {"max", number(seen.largest)},
            {"mean", number_or_null(seen.mean)},
            {"rms", number_or_null(seen.rms)}}},
          {"stick_fraction", number_or_null(seen.stick_fraction)},
          {"free_fraction", number_or_null(seen.free_fraction)},
          {"multipliers", multipliers},
          {"residual", cycle.multipliers.empty() ? Json(nullptr) : number(cycle.residual)},
          {"steps", is_periodic ? Json(cycle.num_steps) : Json(nullptr)},
          {"step", is_periodic ? number(cycle.step) : Json(nullptr)}};
}

std::vector<Column> step_cycle_columns(const PeriodicMotion& cycle, const TimeParameters& time) {
  std::vector<Column> columns{{"/time", "s", {}, {}, true},
                              {"/channels/observed.displacement", "m", {}}};
  for (const ContactPoint& contact : cycle.at_turn.contacts) {
    const std::string group = "/contact/" + contact.name + "/";
    columns.push_back({group + "force", "N", {}});
    columns.push_back({group + "friction_force", "N", {}});
    columns.push_back({group + "slip_velocity", "m/s", {}});
    columns.push_back({group + "state", "1", {}});
  }
  constexpr std::int64_t most_rows = 1000;
  const std::int64_t stride = (cycle.num_steps + most_rows - 1) / most_rows;
  follow_cycle(cycle, time, [&](const Simulation& simulation) {
    const std::int64_t step = simulation.step_index();
    if (step % stride != 0 && step != cycle.num_steps) return;
    std::size_t k = 0;
    const auto put = [&](double value) { columns[k++].values.push_back(value); };
    put(simulation.time());
    put(observed_displacement(cycle, simulation));
    for (int i = 0; i < simulation.num_contacts(); ++i) {
      put(simulation.contact_force(i));
      put(simulation.friction_force(i));
      put(simulation.slip_velocity(i));
      put(static_cast<double>(simulation.contact_state(i)));
    }
  });
  return columns;
}

void plot_step_cycle(const PeriodicMotion& cycle, const std::vector<Column>& columns,
                     const std::string& caption, const std::string& figure) {
  const std::size_t first = 2 + 4 * static_cast<std::size_t>(cycle.observed.contact);
  const auto panel = [&](const std::string& label, std::size_t column, double unit) {
    DiagramPanel one;
    one.x_label = "time (s)";
    one.y_label = label;
    one.curves = {{"", columns[0].values, columns[column].values, Mark::line, 0}};
    for (double& value : one.curves.front().y) value /= unit;
    return one;
  };
  plot_panels({panel(fmt::format("{} (mm)", cycle.observed.is_x ? "x" : "y"), 1, 1e-3),
               panel("slip velocity (mm/s)", first + 2, 1e-3), panel("force (N)", first, 1.0)},
              caption, figure);
}

}  // namespace stridor
