#include "app/runs/event_precision.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>

#include "app/results/output_folder.hpp"
#include "app/results/pictures.hpp"
#include "app/runs/cycle_motion.hpp"
#include "app/runs/precision_file.hpp"
#include "app/terminal/progress.hpp"
#include "app/terminal/remark.hpp"
#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "io/figures/panel_plot.hpp"
#include "io/run_file/initial_state.hpp"
#include "solvers/transient/simulation.hpp"

namespace stridor {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double reference_tolerance = 1e-13;
constexpr double check_tolerance = 1e-12;
constexpr int num_repeats = 3;  ///< the fastest counts

/// x at the samples of a scene, m; shorter where the motion failed.
using Samples = std::vector<double>;

struct Setting {
  Integrator integrator = Integrator::event_driven;
  double tolerance = nan;    ///< of the event-driven integrator
  int steps_per_sample = 0;  ///< of the others
  Samples x;
  double seconds = std::numeric_limits<double>::infinity();
  double error = nan;
  bool is_on_front = false;  ///< no other setting has both less time and a smaller error

  bool is_event_driven() const { return integrator == Integrator::event_driven; }
};

struct Study {
  const LoadedScene* loaded;
  Model model;
  SlidingOscillator oscillator;
  double interval = 0.0;  ///< s
  std::size_t num_samples = 0;

  double step(const Setting& setting) const { return interval / setting.steps_per_sample; }
};

Study make_study(const LoadedScene& loaded) {
  Study study{&loaded, build_model(loaded), {}};
  (void)set_initial_state(study.model.system, loaded);
  study.oscillator = oscillator_of(loaded, study.model.system, "time.integrator");
  (void)sliding_equilibrium(study.oscillator);
  const Scene& scene = loaded.scene;
  if (!scene.record) {
    throw loaded.located(ConfigError(Refusal::missing, "record",
                                     "missing: errors are taken at every multiple of "
                                     "record.interval"));
  }
  study.interval = scene.record->interval;
  study.num_samples = static_cast<std::size_t>(scene.time->end / study.interval * (1.0 + 1e-12));
  if (study.num_samples < 2) {
    throw loaded.located(ConfigError(Refusal::wrong_value, "time.end",
                                     "holds less than two samples of record.interval"));
  }
  return study;
}

/// @param failure says why the motion failed, where it does
Samples run_events(const Study& study, double tolerance, std::string* failure = nullptr) {
  const SlidingOscillator& units = study.oscillator;
  const System& system = study.model.system;
  SubstrateMotion motion(units.oscillator, tolerance);
  motion.start(units.initial_displacement(system), units.initial_velocity(system));
  Samples x;
  for (std::size_t k = 1; k <= study.num_samples && !stop_requested(); ++k) {
    if (motion.advance(static_cast<double>(k) * study.interval / units.time, false) !=
        SubstrateMotion::Stop::end) {
      if (failure != nullptr)
        *failure =
            fmt::format("after t = {:.6g} s {}", units.time * motion.time(), motion.failure());
      break;
    }
    x.push_back(units.direction * units.length * motion.state()[0]);
  }
  return x;
}

Samples run_steps(const Study& study, const Setting& setting) {
  TimeParameters time = *study.loaded->scene.time;
  time.integrator = setting.integrator;
  time.step = study.step(setting);
  Samples x;
  try {
    Simulation simulation(study.model.system, time);
    const int row = study.model.system.contacts.front().slave_rows.x;
    for (std::size_t k = 1; k <= study.num_samples && !stop_requested(); ++k) {
      if (simulation.step_until(static_cast<std::int64_t>(k) * setting.steps_per_sample) !=
          StepOutcome::done)
        break;
      x.push_back(simulation.displacement(study.oscillator.mass.body, row));
    }
  } catch (const ConfigError&) {
    x.clear();  // the step is beyond the limit of the springs
  } catch (const NumericalError&) {
    x.clear();  // or beyond that of the half-space
  }
  return x;
}

void measure(const Study& study, Setting& setting) {
  using Clock = std::chrono::steady_clock;
  for (int i = 0; i < num_repeats; ++i) {
    const auto start = Clock::now();
    setting.x = setting.is_event_driven() ? run_events(study, setting.tolerance)
                                          : run_steps(study, setting);
    setting.seconds =
        std::min(setting.seconds, std::chrono::duration<double>(Clock::now() - start).count());
    if (stop_requested()) throw Interrupted("nothing has been written");
  }
}

/// r.m.s. of the difference in x over that of x about its mean; NaN where the motion failed.
double relative_error(const Samples& x, const Samples& reference) {
  if (x.size() != reference.size()) return nan;
  double mean = 0.0;
  for (const double value : reference) mean += value / static_cast<double>(reference.size());
  double difference = 0.0;
  double size = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    difference += (x[i] - reference[i]) * (x[i] - reference[i]);
    size += (reference[i] - mean) * (reference[i] - mean);
  }
  const double error = std::sqrt(difference / size);
  return std::isfinite(error) ? error : nan;
}

std::vector<Setting> settings_of(int points) {
  std::vector<Setting> settings;
  for (int k = 0; k < points; ++k) {
    Setting one;
    one.tolerance = std::pow(10.0, -3.0 - 8.0 * k / (points - 1));
    settings.push_back(one);
  }
  for (const Integrator integrator : {Integrator::exact, Integrator::central_difference}) {
    for (int k = 0; k < points; ++k) {
      Setting one;
      one.integrator = integrator;
      one.steps_per_sample = 2 << k;
      settings.push_back(one);
    }
  }
  return settings;
}

Json row_json(const Study& study, const Setting& setting) {
  const bool is_stable = std::isfinite(setting.error);
  return {{"method", word_of(integrator_words(), setting.integrator)},
          {"integrator", word_of(integrator_words(), setting.integrator)},
          {"modes", 2},
          {"step", setting.is_event_driven() ? Json(nullptr) : number(study.step(setting))},
          {"tolerance", setting.is_event_driven() ? number(setting.tolerance) : Json(nullptr)},
          {"wall_s", number(setting.seconds)},
          {"least_wall_s", number(setting.seconds)},
          {"error", is_stable ? number(setting.error) : Json(nullptr)},
          {"stable", is_stable},
          {"on_front", setting.is_on_front},
          {"status", is_stable ? "done" : "useless"}};
}

void draw(const Study& study, const std::vector<Setting>& settings,
          const std::filesystem::path& figure) {
  DiagramPanel panel;
  panel.x_label = "run time (s)";
  panel.y_label = "relative error of x";
  panel.x_kind = panel.y_kind = AxisKind::logarithmic;
  int colour = 0;
  for (const Integrator integrator :
       {Integrator::event_driven, Integrator::exact, Integrator::central_difference}) {
    PanelCurve line{word_of(integrator_words(), integrator), {}, {}, Mark::line, colour};
    for (const Setting& setting : settings) {
      if (setting.integrator != integrator || !(setting.error > 0.0)) continue;
      line.x.push_back(setting.seconds);
      line.y.push_back(setting.error);
    }
    PanelCurve points = line;
    points.label.clear();
    points.mark = Mark::points;
    panel.curves.push_back(std::move(line));
    panel.curves.push_back(std::move(points));
    ++colour;
  }
  plot_panels(
      {panel},
      fmt::format("Error over {:g} s against the time that it takes; reference: event-driven at "
                  "{:g}. {}, scene {}.",
                  study.loaded->scene.time->end, reference_tolerance,
                  std::filesystem::path(study.loaded->path).filename().string(),
                  study.loaded->hash()),
      figure);
}

/// @throws ConfigError if an option is of scenes with fixed steps
void refuse_options_of_steps(const PrecisionOptions& options) {
  const char* reason = "is for scenes with time.step, and this one has integrator: event_driven";
  if (options.until)
    throw ConfigError(Refusal::contradiction, "--until",
                      fmt::format("{}; here time.end says how far", reason));
  if (!options.retain.empty()) throw ConfigError(Refusal::wrong_value, "--retain", reason);
  if (!options.assumptions.empty())
    throw ConfigError(Refusal::wrong_value, "--assumptions", reason);
  if (options.points > 20)
    throw ConfigError(Refusal::wrong_value, "--points", "is at most 20 with event_driven");
}

/// The settings measured, and what came of them.
struct EventPrecision {
  std::vector<Setting> settings;
  double own_error = 0.0;          ///< of the reference
  const Setting* tuned = nullptr;  ///< the cheapest within what was asked
};

EventPrecision measure_all(const Study& study, int points, std::optional<double> wanted) {
  std::string failure;
  const Samples reference = run_events(study, reference_tolerance, &failure);
  if (stop_requested()) throw Interrupted("nothing has been written");
  if (reference.size() != study.num_samples)
    throw NumericalError(Refusal::no_convergence, "the reference motion, event-driven: " + failure);
  EventPrecision found;
  found.own_error = relative_error(run_events(study, check_tolerance), reference);
  found.settings = settings_of(points);
  Progress progress("precision");
  for (std::size_t i = 0; i < found.settings.size(); ++i) {
    Setting& setting = found.settings[i];
    measure(study, setting);
    setting.error = relative_error(setting.x, reference);
    progress.report(static_cast<double>(i + 1) / static_cast<double>(found.settings.size()),
                    word_of(integrator_words(), setting.integrator));
  }
  progress.finish();
  for (Setting& setting : found.settings) {
    setting.is_on_front =
        std::isfinite(setting.error) &&
        std::none_of(found.settings.begin(), found.settings.end(), [&](const Setting& other) {
          return other.seconds < setting.seconds && other.error < setting.error;
        });
  }
  for (const Setting& setting : found.settings) {
    const bool is_within = wanted && setting.error + found.own_error <= *wanted;
    if (is_within && (found.tuned == nullptr || setting.seconds < found.tuned->seconds))
      found.tuned = &setting;
  }
  return found;
}

void print_settings(const Study& study, const EventPrecision& found) {
  fmt::print("{:<20}{:>12}{:>12}{:>14}{:>12}\n", "integrator", "step", "tolerance", "run time (s)",
             "error");
  for (const Setting& setting : found.settings) {
    const bool is_event_driven = setting.is_event_driven();
    fmt::print("{:<20}{:>12}{:>12}{:>14.4g}{:>12.3g}{}\n",
               word_of(integrator_words(), setting.integrator),
               is_event_driven ? "-" : fmt::format("{:.4g}", study.step(setting)),
               is_event_driven ? fmt::format("{:.1e}", setting.tolerance) : "-", setting.seconds,
               setting.error, &setting == found.tuned ? "  cheapest" : "");
  }
  fmt::print("the reference, event-driven at {:g}, differs from the same at {:g} by {:.2g}\n",
             reference_tolerance, check_tolerance, found.own_error);
}

}  // namespace

ExitCode precision_of_events(const PrecisionOptions& options, const LoadedScene& loaded) {
  refuse_options_of_steps(options);
  std::optional<double> wanted;
  if (options.tune) wanted = option_value("--tune", *options.tune, "", Range::inside(0.0, 1.0));
  const Study study = make_study(loaded);
  const bool is_kept = !options.folder.empty();
  if (is_kept) {
    prepare_folder(options.folder,
                   {precision_figure_name, precision_json_name, precision_file_name},
                   options.common.overwrite());
  }
  const EventPrecision found = measure_all(study, options.points, wanted);

  Json object{{"scene", options.scene},
              {"reference",
               {{"integrator", "event_driven"},
                {"tolerance", reference_tolerance},
                {"error", number(found.own_error)},
                {"error_is", fmt::format("difference from the same at {:g}", check_tolerance)}}},
              {"rows", Json::array()}};
  for (const Setting& setting : found.settings) object["rows"].push_back(row_json(study, setting));
  if (wanted) {
    object["tune"] = found.tuned != nullptr ? row_json(study, *found.tuned) : Json(nullptr);
    if (found.tuned != nullptr) object["tune"]["wanted"] = *wanted;
  }
  if (is_kept) {
    const std::filesystem::path folder = options.folder;
    draw(study, found.settings, folder / precision_figure_name);
    write_json(folder / precision_json_name, object);
    write_precision_file(folder / precision_file_name, object, options, loaded);
  }
  if (options.common.json) {
    print_json(object);
  } else {
    print_settings(study, found);
    if (is_kept)
      fmt::print("{}, {} and {} in {}\n", precision_figure_name, precision_json_name,
                 precision_file_name, options.folder);
  }
  if (wanted && found.tuned == nullptr) {
    print_remark("stridor: no setting measured is within {:g}\n", *wanted);
    return ExitCode::numbers_failed;
  }
  return ExitCode::done;
}

}  // namespace stridor
