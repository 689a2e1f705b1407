// stridor run: transient simulation of a scene.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <tuple>

#include "app/command.hpp"
#include "app/progress.hpp"
#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "core/version.hpp"
#include "io/recorder.hpp"
#include "io/run_summary.hpp"
#include "solvers/make_propagator.hpp"
#include "solvers/march.hpp"

namespace stridor {
namespace {

using Clock = std::chrono::steady_clock;

struct RunOptions {
  CommonOptions common;
  std::string scene;
  std::string output;
  bool verify = false;
  std::string command_line;
};

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

RunFileHeader make_header(const LoadedScene& loaded, const std::string& command_line) {
  RunFileHeader header;
  header.version = version;
  header.commit = commit;
  header.command = command_line;
  header.scene_hash = loaded.hash();
  header.date = utc_now();
  header.scene_text = loaded.text;
  header.scene_resolved = loaded.resolved();
  return header;
}

/// Frequencies and damping ratios of a reduced body; the damping is the one after its schedule.
void write_modes(RunFileWriter& writer, const SystemBody& body) {
  const ModalBody& modal = body.modal;
  std::vector<double> frequency;
  std::vector<double> damping_ratio;
  for (const double omega : modal.omega) {
    frequency.push_back(omega / (2.0 * std::numbers::pi));
    damping_ratio.push_back(
        omega > 0.0 ? 0.5 * (modal.damping.alpha / omega + modal.damping.beta * omega) : 0.0);
  }
  writer.write_static("/modal/" + body.name + "/frequency", frequency, "Hz");
  writer.write_static("/modal/" + body.name + "/damping_ratio", damping_ratio, "1");
}

/// Writes the numbers and texts of a JSON object under dotted names.
void store_results(RunFileWriter& writer, const std::string& prefix, const Json& object) {
  for (const auto& [name, value] : object.items()) {
    if (value.is_object()) store_results(writer, prefix + name + ".", value);
    if (value.is_number()) writer.write_result(prefix + name, value.get<double>());
    if (value.is_string()) writer.write_result(prefix + name, value.get<std::string>());
  }
}

Json bursts_json(const std::vector<Burst>& bursts) {
  Json list = Json::array();
  for (const Burst& burst : bursts) {
    list.push_back({{"start", burst.start},
                    {"end", burst.end},
                    {"frequency", burst.frequency},
                    {"peak", burst.peak},
                    {"gain", burst.gain}});
  }
  return list;
}

/// One array per property of the bursts, so that any reader of HDF5 can take them.
void store_bursts(RunFileWriter& writer, const std::vector<Burst>& bursts) {
  const std::vector<std::tuple<const char*, double Burst::*, const char*>> properties{
      {"start", &Burst::start, "s"},
      {"end", &Burst::end, "s"},
      {"frequency", &Burst::frequency, "Hz"},
      {"peak", &Burst::peak, "m/s^2"},
      {"gain", &Burst::gain, "1"}};
  for (const auto& [name, member, units] : properties) {
    std::vector<double> values;
    for (const Burst& burst : bursts) values.push_back(burst.*member);
    writer.write_static(std::string("/bursts/") + name, values, units);
  }
}

Json extremes_json(const std::optional<std::pair<double, double>>& extremes) {
  if (!extremes) return {{"min", nullptr}, {"max", nullptr}};
  return {{"min", number(extremes->first)}, {"max", number(extremes->second)}};
}

Json contact_json(const Simulation& simulation, const System& system,
                  const ForceExtremes& extremes) {
  if (extremes.size() == 1) return {{"contact_force", extremes_json(extremes[0])}};
  Json contacts = Json::object();
  for (std::size_t i = 0; i < extremes.size(); ++i) {
    const ViolationCount& violations = simulation.violations(static_cast<int>(i));
    contacts[system.contacts[i].name] = {{"contact_force", extremes_json(extremes[i])},
                                         {"violations", violations.total()}};
  }
  return {{"contacts", contacts}};
}

Json violations_json(const Simulation& simulation) {
  ViolationCount sum;
  for (int i = 0; i < simulation.num_contacts(); ++i) {
    const ViolationCount& one = simulation.violations(i);
    sum.negative_force += one.negative_force;
    sum.reversed_sliding += one.reversed_sliding;
    sum.before_armed += one.before_armed;
    sum.last_time = std::max(sum.last_time, one.last_time);
  }
  return {{"violations", sum.total()},
          {"violation_details",
           {{"negative_force", sum.negative_force},
            {"reversed_sliding", sum.reversed_sliding},
            {"before_armed", sum.before_armed},
            {"last_time", sum.total() > 0 ? number(sum.last_time) : Json(nullptr)}}}};
}

/// A number at "a.b.c" of a JSON object; nothing where there is none.
std::optional<double> number_at(const Json& object, const std::string& path) {
  const Json* node = &object;
  std::size_t from = 0;
  while (true) {
    const std::size_t dot = path.find('.', from);
    const std::string key = path.substr(from, dot == std::string::npos ? dot : dot - from);
    if (!node->is_object() || !node->contains(key)) return std::nullopt;
    node = &(*node)[key];
    if (dot == std::string::npos) break;
    from = dot + 1;
  }
  if (!node->is_number()) return std::nullopt;
  return node->get<double>();
}

/// Compares the results with the scene's `expect` block. @returns the failures, one line each
std::vector<std::string> unmet_expectations(const std::vector<Expectation>& expectations,
                                            const Json& results) {
  std::vector<std::string> failures;
  for (const Expectation& expectation : expectations) {
    const auto value = number_at(results, expectation.result);
    if (!value) {
      failures.push_back(fmt::format("{}: expected {:g}, but the run has no such number",
                                     expectation.result, expectation.value));
    } else if (!(std::abs(*value - expectation.value) <= expectation.tolerance)) {
      failures.push_back(fmt::format("{}: expected {:g} within {:g}, got {:.9g}",
                                     expectation.result, expectation.value, expectation.tolerance,
                                     *value));
    }
  }
  return failures;
}

void print_summary(const Json& results, const std::string& output) {
  const auto text = [](const Json& value) {
    if (value.is_null()) return std::string("-");
    return value.is_number() ? fmt::format("{:.5g}", value.get<double>())
                             : value.get<std::string>();
  };
  fmt::print("{:<24}{}\n", "status", text(results["status"]));
  fmt::print("{:<24}{} of {:g} s (largest stable {:.4g} s)\n", "steps",
             results["steps"].get<std::int64_t>(), results["step"].get<double>(),
             results["step_limit"].get<double>());
  fmt::print("{:<24}{:.3g} s stepping ({:.0f} ns a step), {:.3g} s set-up, {:.3g} s output\n",
             "time taken", results["wall_s"].get<double>(), results["step_ns"].get<double>(),
             results["setup_s"].get<double>(), results["output_s"].get<double>());
  const auto print_force = [&](const std::string& name, const Json& force) {
    fmt::print("{:<24}{} to {} N\n", name, text(force["min"]), text(force["max"]));
  };
  if (results.contains("contact_force")) print_force("contact force", results["contact_force"]);
  if (results.contains("contacts")) {
    for (const auto& [name, contact] : results["contacts"].items())
      print_force("contact force " + name, contact["contact_force"]);
  }
  if (!results["free_end_acceleration"].is_null()) {
    const Json& acceleration = results["free_end_acceleration"];
    fmt::print("{:<24}peak {} m/s^2, r.m.s. in band {} m/s^2\n", "free-end acceleration",
               text(acceleration["peak"]), text(acceleration["rms"]));
  }
  if (!results["bursts"].is_null() && results["bursts"].empty()) {
    fmt::print("{:<24}none\n", "bursts");
  }
  for (const Json& burst : results["bursts"]) {
    fmt::print("{:<24}{:.3f} to {:.3f} s, {:.0f} Hz, peak {:.4g} m/s^2, gain {:.2f}\n", "burst",
               burst["start"].get<double>(), burst["end"].get<double>(),
               burst["frequency"].get<double>(), burst["peak"].get<double>(),
               burst["gain"].get<double>());
  }
  fmt::print("{:<24}{} steps ({} of them before the contacts were armed)\n", "sliding violated",
             results["violations"].get<std::int64_t>(),
             results["violation_details"]["before_armed"].get<std::int64_t>());
  fmt::print("{:<24}{}\n", "run file", output);
}

ExitCode run(const RunOptions& options) {
  const auto setup_start = Clock::now();
  const LoadedScene loaded = load_scene(options.scene, options.common.sets);
  const Scene& scene = loaded.scene;
  const Overwrite overwrite = options.common.force ? Overwrite::yes : Overwrite::no;
  check_output(options.output, overwrite);
  const Model model = build_model(loaded);
  std::optional<Simulation> simulation;
  try {
    simulation.emplace(model.system, scene.time);
  } catch (const ConfigError& error) {
    throw loaded.located(error);
  }

  const double step = scene.time.step;
  const std::vector<Channel> channels =
      scene.record ? parse_channels(*scene.record, scene.model) : std::vector<Channel>{};
  const double interval = scene.record ? scene.record->interval : step;
  const auto file_start = Clock::now();
  RunFileWriter writer(options.output, overwrite, make_header(loaded, options.command_line),
                       Recorder::series(model, channels, step, interval));
  for (const SystemBody& body : model.system.bodies) write_modes(writer, body);
  double output_seconds = seconds_since(file_start);
  Recorder recorder(model, channels, step, interval, writer);

  const auto end_step = static_cast<std::int64_t>(std::llround(scene.time.end / step));
  const auto to_step = [&](double time) {
    return static_cast<std::int64_t>(std::ceil(time / step - 1e-6));
  };
  MarchPlan plan;
  // The last sample needs the filter's look-ahead beyond the end.
  plan.last_step = end_step + recorder.latency();
  recorder.limit_samples(static_cast<std::int64_t>(std::floor(scene.time.end / interval + 1e-6)) +
                         1);
  plan.measure_from = to_step(scene.measure.from);
  plan.measure_to = std::min(end_step, scene.measure.to ? to_step(*scene.measure.to) : end_step);
  Progress progress("run");
  auto last_flush = Clock::now();
  plan.on_progress = [&](const Simulation& running) {
    progress.report(running.time() / scene.time.end,
                    fmt::format("t = {:.4g} of {:.4g} s", running.time(), scene.time.end));
    if (seconds_since(last_flush) > 2.0) {
      writer.flush();
      last_flush = Clock::now();
    }
  };

  const double setup_seconds = seconds_since(setup_start) - output_seconds;
  const auto march_start = Clock::now();
  const MarchResult march_result = march(*simulation, &recorder, plan);
  const double march_seconds = seconds_since(march_start) - writer.write_seconds();
  progress.finish();
  // Losing the contact within the filter's look-ahead is no failure of the run that was asked for.
  const bool is_finished =
      march_result.end == MarchEnd::finished || simulation->step_index() >= end_step;
  const bool is_stopped = !is_finished && march_result.end == MarchEnd::stopped;

  writer.flush();
  output_seconds += writer.write_seconds();
  const auto acceleration = summarise_acceleration(RunFileReader(options.output), scene.measure);

  const std::int64_t steps = simulation->step_index();
  Json results = {{"status", is_finished  ? "done"
                             : is_stopped ? "stopped"
                                          : "failed"},
                  {"steps", steps},
                  {"step", step},
                  {"step_limit", number(step_limit(model.system).step)},
                  {"wall_s", march_seconds},
                  {"setup_s", setup_seconds},
                  {"output_s", output_seconds},
                  {"step_ns", steps > 0 ? number(march_seconds * 1e9 / static_cast<double>(steps))
                                        : Json(nullptr)}};
  results.update(contact_json(*simulation, model.system, march_result.force_extremes));
  results["free_end_acceleration"] = nullptr;
  if (acceleration) {
    results["free_end_acceleration"] = {{"peak", number(acceleration->peak)},
                                        {"rms", number(acceleration->rms)},
                                        {"channel", acceleration->channel}};
  }
  results.update(violations_json(*simulation));
  results["bursts"] = nullptr;
  if (acceleration && acceleration->bursts) results["bursts"] = bursts_json(*acceleration->bursts);
  results["energy_error"] = nullptr;
  results["file"] = options.output;
  store_results(writer, "", results);
  if (acceleration && acceleration->bursts && !acceleration->bursts->empty()) {
    store_bursts(writer, *acceleration->bursts);
  }
  writer.close();

  if (options.common.json) {
    fmt::print("{}\n", results.dump(2));
  } else {
    print_summary(results, options.output);
  }
  std::fflush(stdout);

  if (is_stopped) {
    throw Interrupted(fmt::format(
        "at t = {:.6g} of {:.6g} s; {} holds everything up to then, but cannot be resumed yet",
        simulation->time(), scene.time.end, options.output));
  }
  if (!is_finished) {
    throw NumericalError(
        fmt::format("{}\n{} holds everything up to then", simulation->failure(), options.output));
  }
  if (options.verify) {
    const std::vector<std::string> failures = unmet_expectations(scene.expect, results);
    if (!failures.empty())
      throw NumericalError(fmt::format("expectations not met:\n{}", fmt::join(failures, "\n")));
    fmt::print(stderr, "{} expectation(s) met\n", scene.expect.size());
  }
  return ExitCode::done;
}

}  // namespace

void add_run_command(CLI::App& program, Action& action, const std::string& command_line) {
  auto options = std::make_shared<RunOptions>();
  options->command_line = command_line;
  CLI::App* verb = program.add_subcommand("run", "Transient simulation of a scene");
  verb->add_option("scene", options->scene, "Scene file (YAML)")->required();
  verb->add_option("-o,--output", options->output, "Run file to write (HDF5)")->required();
  verb->add_flag("--verify", options->verify,
                 "Compare the results with the scene's `expect` block; exit 3 where they differ");
  add_scene_options(*verb, options->common);
  add_json_option(*verb, options->common);
  add_force_option(*verb, options->common);
  verb->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace stridor
