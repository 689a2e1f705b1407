// Exact propagation against other ways to march the same sliding contact: Siconos (Moreau-Jean),
// SUNDIALS ARKODE (explicit Runge-Kutta, contact force eliminated) and a Moreau-Jean scheme of our
// own that is as fast as it can be made.
//
//   build/release/bench/solvers_compared [ROUNDS [FROM TO]]
//
// The window is 20 ms of the third burst of the leading scene, over a kink of the polyline, all
// methods from the same state with the same M, C, K of 243 coordinates. Errors are those of
// `stridor precision` over the whole window with 1 to 15 kHz, against ARKODE at 0.16 us. Times are
// processor time of one thread without set-up: of the cheap methods the least of ROUNDS (25) runs
// in turn, of the dear ones one run at the pace of its fastest twentieth.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>

#include "bench/arkode_run.hpp"
#include "bench/moreau_jean.hpp"
#include "bench/processor_clock.hpp"
#include "bench/siconos_run.hpp"
#include "bench/sliding_window.hpp"
#include "io/scene/channels.hpp"
#include "io/scene/scene.hpp"
#include "solvers/transient/simulation.hpp"

using namespace stridor;
using namespace stridor::bench;

namespace {

constexpr double interval = 1e-5;     ///< between samples, s
constexpr double asked_error = 1e-3;  ///< of the envelope

/// A method at one of its settings.
struct Setting {
  double step = 0.0;  ///< s
  std::function<WindowRun(Sampling)> run;
  bool is_cheap = false;
  RunErrors errors{};
  WindowRun last{};
  double least = std::numeric_limits<double>::infinity();
};

struct Method {
  std::string name;
  std::vector<Setting> settings;  ///< coarsest first
};

WindowRun run_stridor(const SlidingWindow& window, const TimeParameters& time, Sampling sampling) {
  const double start = processor_seconds();
  Simulation simulation(window.system, time);
  WindowRun run;
  run.samples.interval = window.interval;
  run.samples.forces.resize(1);
  const auto per_sample = static_cast<std::int64_t>(std::llround(window.interval / time.step));
  run.steps = window.num_samples * per_sample;
  const double begin = processor_seconds();
  run.setup = begin - start;
  const auto march = [&](std::int64_t to) {
    if (simulation.step_until(to) != StepOutcome::done)
      throw std::runtime_error(simulation.failure());
  };
  if (sampling == Sampling::none) march(run.steps);
  run.stepping = processor_seconds() - begin;
  if (sampling == Sampling::none) return run;
  for (std::int64_t k = 0; k <= window.num_samples; ++k) {
    march(k * per_sample);
    run.samples.displacement.push_back(
        simulation.displacement(window.observed.body, window.observed.row));
    run.samples.forces[0].push_back(simulation.contact_force(0));
  }
  return run;
}

ArkodeParameters fixed_step(ARKODE_ERKTableID table, int steps_per_sample) {
  ArkodeParameters parameters;
  parameters.table = table;
  // Of Baumgarte's terms: they amplify what the position of the contact is wrong by.
  parameters.drift_rate = 2e5;
  parameters.fixed_step = interval / steps_per_sample;
  return parameters;
}

WindowRun run_explicit(const SlidingWindow& window, const ArkodeParameters& parameters) {
  const ArkodeResult result =
      run_arkode(window.system, window.observed, window.interval, window.num_samples, parameters);
  return {result.samples, result.steps, result.setup, result.stepping};
}

std::vector<Method> methods_of(const SlidingWindow& window, const TimeParameters& scene) {
  std::vector<Method> methods;
  const auto exact = [&](const char* name, std::optional<double> retained) {
    Method method{name, {}};
    for (const int steps : {1, 2, 3, 4, 8, 16}) {
      const TimeParameters time =
          PrecisionMethod{Integrator::exact, retained, {}, {}}.at(steps, scene, interval);
      method.settings.push_back(
          {time.step, [&window, time](Sampling s) { return run_stridor(window, time, s); }, true});
    }
    methods.push_back(std::move(method));
  };
  exact("stridor, exact to 35 kHz", 35e3);
  exact("stridor, exact to 50 kHz", 50e3);
  exact("stridor, exact, all that the step resolves", {});
  Method own{"Moreau-Jean, modal, own", {}};
  for (const int steps : {1, 2, 4, 8, 16, 32}) {
    const MoreauJeanParameters parameters{interval / steps};
    own.settings.push_back(
        {parameters.step,
         [&window, parameters](Sampling s) { return run_moreau_jean(window, parameters, s); },
         true});
  }
  methods.push_back(std::move(own));
  const auto runge_kutta = [&](const char* name, ARKODE_ERKTableID table) {
    Method method{name, {}};
    for (const int steps : {20, 25, 28, 32}) {
      const ArkodeParameters parameters = fixed_step(table, steps);
      method.settings.push_back({parameters.fixed_step, [&window, parameters](Sampling) {
                                   return run_explicit(window, parameters);
                                 }});
    }
    methods.push_back(std::move(method));
  };
  runge_kutta("ARKODE, Bogacki-Shampine 3", ARKODE_BOGACKI_SHAMPINE_4_2_3);
  runge_kutta("ARKODE, Zonneveld 4", ARKODE_ZONNEVELD_5_3_4);
  runge_kutta("ARKODE, Dormand-Prince 5", ARKODE_DORMAND_PRINCE_7_4_5);
  Method siconos{"Siconos, Moreau-Jean", {}};
  for (const int steps : {1, 2, 4, 8}) {
    const double step = interval / steps;
    siconos.settings.push_back(
        {step, [&window, step](Sampling) { return run_siconos(window, step); }});
  }
  methods.push_back(std::move(siconos));
  return methods;
}

/// Runs a setting once; one that fails has errors that are not numbers.
void look_at(Setting& setting, const ReferenceRun& reference, const char* method) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  try {
    setting.last = setting.run(Sampling::every_interval);
    setting.errors = reference.errors_of(setting.last.samples);
    setting.least = setting.last.stepping;
  } catch (const std::runtime_error& error) {
    fmt::print("{} at {:.3g} s: {}\n", method, setting.step, error.what());
    setting.errors = {unknown, unknown, unknown};
  }
}

void time_cheap(std::vector<Method>& methods, int rounds) {
  for (Method& method : methods) {
    for (Setting& setting : method.settings) {
      if (setting.is_cheap) setting.least = std::numeric_limits<double>::infinity();
    }
  }
  for (int round = 0; round < rounds; ++round) {
    for (Method& method : methods) {
      for (Setting& setting : method.settings) {
        if (!setting.is_cheap || !std::isfinite(setting.errors.envelope)) continue;
        const WindowRun run = setting.run(Sampling::none);
        setting.least = std::min(setting.least, run.stepping);
        setting.last.setup = run.setup;
      }
    }
  }
}

/// Time at the error asked for, between two settings on a straight line of both logarithms; the
/// time of the coarsest usable setting where that is already more precise; infinite where the error
/// is not reached.
double time_at(const Method& method, double error) {
  const Setting* coarser = nullptr;
  for (const Setting& setting : method.settings) {
    if (!(setting.errors.envelope < 0.1)) continue;  // unstable
    if (setting.errors.envelope <= error) {
      if (coarser == nullptr) return setting.least;
      const double share = std::log(coarser->errors.envelope / error) /
                           std::log(coarser->errors.envelope / setting.errors.envelope);
      return coarser->least * std::pow(setting.least / coarser->least, share);
    }
    coarser = &setting;
  }
  return std::numeric_limits<double>::infinity();
}

void print(const std::vector<Method>& methods) {
  fmt::print(
      "\n| method | step, µs | steps | force | acceleration | envelope | set-up, ms | time, ms |\n"
      "|---|---|---|---|---|---|---|---|\n");
  for (const Method& method : methods) {
    for (const Setting& s : method.settings) {
      if (std::isnan(s.errors.envelope)) {
        fmt::print("| {} | {:.3g} | | not stable | | | | |\n", method.name, s.step * 1e6);
        continue;
      }
      fmt::print("| {} | {:.3g} | {} | {:.1e} | {:.1e} | {:.1e} | {:.3g} | {:.4g} |\n", method.name,
                 s.step * 1e6, s.last.steps, s.errors.force, s.errors.acceleration,
                 s.errors.envelope, s.last.setup * 1e3, s.least * 1e3);
    }
  }
  double best = std::numeric_limits<double>::infinity();
  for (const Method& method : methods) {
    if (method.name.starts_with("stridor")) best = std::min(best, time_at(method, asked_error));
  }
  fmt::print("\n| method | time at an envelope error of {:g}, ms | ratio to stridor |\n",
             asked_error);
  fmt::print("|---|---|---|\n");
  for (const Method& method : methods) {
    const double time = time_at(method, asked_error);
    fmt::print("| {} | {:.4g} | {:.4g} |\n", method.name, time * 1e3, time / best);
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 25;
  const double from = argc > 3 ? std::atof(argv[2]) : 2.07;
  const double to = argc > 3 ? std::atof(argv[3]) : 2.09;
  const LoadedScene loaded = load_scene(STRIDOR_SOURCE_DIR "/scenes/beam_on_beam_leading.yaml", {});
  const Model model = build_model(loaded);
  const Model::Point& point = model.points.at({"cantilever", "free_end"});
  const SlidingWindow window =
      make_sliding_window(model, {point.body, point.rows.y}, from, to, interval);

  const auto fine = [&](ARKODE_ERKTableID table) {
    return run_arkode(window.system, window.observed, interval, window.num_samples,
                      fixed_step(table, 64));
  };
  const ArkodeResult arkode = fine(ARKODE_DORMAND_PRINCE_7_4_5);
  const ReferenceRun reference(arkode.samples, {{0.0, to - from}, {1e3, 15e3}});
  fmt::print("reference: {} steps, {} evaluations, {} kinks, largest gap {:.1e} m\n", arkode.steps,
             arkode.evaluations, arkode.kinks, arkode.worst_gap);
  const auto [least, most] =
      std::minmax_element(arkode.samples.forces[0].begin(), arkode.samples.forces[0].end());
  fmt::print("contact force {:.5f} .. {:.5f} N\n", *least, *most);
  const RunErrors check = reference.errors_of(fine(ARKODE_ZONNEVELD_5_3_4).samples);
  fmt::print("Zonneveld 4 at its step: force {:.1e}, acceleration {:.1e}, envelope {:.1e}\n",
             check.force, check.acceleration, check.envelope);

  std::vector<Method> methods = methods_of(window, *loaded.scene.time);
  for (Method& method : methods) {
    for (Setting& setting : method.settings) look_at(setting, reference, method.name.c_str());
  }
  time_cheap(methods, rounds);
  print(methods);
}
