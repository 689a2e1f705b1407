#include "app/transient.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <tuple>

#include "app/burst_text.hpp"
#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "core/version.hpp"
#include "io/initial_state.hpp"
#include "solvers/make_propagator.hpp"
#include "solvers/retained_modes.hpp"

namespace stridor {
namespace {

constexpr const char* checkpoint_group = "/checkpoint";

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
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

Json force_json(const std::optional<ContactStatistics>& statistics) {
  if (!statistics) return {{"min", nullptr}, {"max", nullptr}};
  return {{"min", number(statistics->force_min)}, {"max", number(statistics->force_max)}};
}

Json fraction(std::int64_t part, std::int64_t whole) {
  return whole > 0 ? Json(static_cast<double>(part) / static_cast<double>(whole)) : Json(nullptr);
}

Json contact_json(const Simulation& simulation, const System& system,
                  const MeasuredContacts& measured) {
  Json results = Json::object();
  ContactStatistics sum;
  Json contacts = Json::object();
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const ContactStatistics one = measured[i].value_or(ContactStatistics{});
    sum.steps += one.steps;
    sum.sticking += one.sticking;
    sum.open += one.open;
    contacts[system.contacts[i].name] = {
        {"contact_force", force_json(measured[i])},
        {"violations", simulation.violations(static_cast<int>(i)).total()},
        {"stick_fraction", fraction(one.sticking, one.steps)},
        {"free_fraction", fraction(one.open, one.steps)}};
  }
  if (measured.size() == 1) {
    results["contact_force"] = force_json(measured[0]);
  } else {
    results["contacts"] = contacts;
  }
  results["stick_fraction"] = fraction(sum.sticking, sum.steps);
  results["free_fraction"] = fraction(sum.open, sum.steps);
  return results;
}

/// How many modes of every body move and how many are left to their static residual.
Json modes_json(const System& system, const TimeParameters& time) {
  Json bodies = Json::object();
  const double highest = retained_frequency(system, time);
  for (const SystemBody& body : system.bodies) {
    const Eigen::Index moving = (body.modal.omega.array() <= highest).count();
    bodies[body.name] = {{"moving", moving}, {"residual", body.modal.size() - moving}};
  }
  return bodies;
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

}  // namespace

InterruptedRun find_interrupted_run(const std::string& file) {
  const RunFileReader reader(file);
  const RunFileHeader& header = reader.header();
  if (header.version != version || header.commit != commit) {
    throw FileError(file, "",
                    fmt::format("was written by stridor {} ({}), this is {} ({}); only the program "
                                "that began a run goes on with it bitwise",
                                header.version, header.commit, version, commit));
  }
  const auto results = reader.results();
  const auto status = results.find("status");
  const std::string* text =
      status == results.end() ? nullptr : std::get_if<std::string>(&status->second);
  if (text != nullptr && *text == "done")
    throw FileError(file, "", "holds a whole run, there is nothing to go on with");
  if (text != nullptr && *text == "failed") {
    throw FileError(file, "",
                    "holds a run that failed, and would again; change the scene and run it anew");
  }
  std::optional<Checkpoint> checkpoint = reader.checkpoint();
  if (!checkpoint) {
    throw FileError(file, checkpoint_group,
                    "there is no whole checkpoint to go on from; run the scene anew");
  }
  return {file, header.scene_resolved, *std::move(checkpoint)};
}

Transient::Transient(const LoadedScene& loaded, const TransientOutput& output)
    : loaded_(&loaded), file_(output.file) {
  const Scene& scene = loaded.scene;
  check_output(file_, output.overwrite);
  model_ = build_model(loaded);
  try {
    set_initial_state(model_.system, scene);
    make_simulation();
  } catch (const ConfigError& error) {
    throw loaded.located(error);
  }
  const auto file_start = Clock::now();
  writer_.emplace(file_, output.overwrite, make_header(loaded, output.command_line), series());
  for (const SystemBody& body : model_.system.bodies) write_modes(*writer_, body);
  make_march();
  write_checkpoint();
  file_seconds_ = seconds_since(file_start);
  setup_seconds_ = seconds_since(setup_start_) - file_seconds_;
}

Transient::Transient(const LoadedScene& loaded, const InterruptedRun& interrupted)
    : loaded_(&loaded), file_(interrupted.file) {
  model_ = build_model(loaded);
  make_simulation();
  try {
    const auto file_start = Clock::now();
    writer_.emplace(RunFileWriter::resume(file_, series(), interrupted.checkpoint));
    file_seconds_ = seconds_since(file_start);
    make_march();
    load(interrupted.checkpoint.state);
  } catch (const std::invalid_argument& error) {
    throw FileError(file_, checkpoint_group,
                    fmt::format("does not fit the scene in the file: {}", error.what()));
  }
  setup_seconds_ = seconds_since(setup_start_) - file_seconds_;
}

void Transient::make_simulation() {
  const Scene& scene = loaded_->scene;
  const bool has_ledger = scene.record && scene.record->energy;
  simulation_.emplace(model_.system, scene.time, has_ledger ? Accounts::energy : Accounts::none);
  if (scene.record) channels_ = parse_channels(*scene.record, scene.model);
  interval_ = scene.record ? scene.record->interval : scene.time.step;
}

std::vector<SeriesSpec> Transient::series() const {
  return Recorder::series(model_, channels_, loaded_->scene.time.step, interval_);
}

void Transient::make_march() {
  const Scene& scene = loaded_->scene;
  const double step = scene.time.step;
  recorder_.emplace(model_, channels_, step, interval_, *writer_);
  end_step_ = static_cast<std::int64_t>(std::llround(scene.time.end / step));
  const auto to_step = [&](double time) {
    return static_cast<std::int64_t>(std::ceil(time / step - 1e-6));
  };
  MarchPlan plan;
  // The last sample needs the filter's look-ahead beyond the end.
  last_step_ = end_step_ + recorder_->latency();
  plan.last_step = last_step_;
  recorder_->limit_samples(
      static_cast<std::int64_t>(std::floor(scene.time.end / interval_ + 1e-6)) + 1);
  plan.measure_from = to_step(scene.measure.from);
  plan.measure_to = std::min(end_step_, scene.measure.to ? to_step(*scene.measure.to) : end_step_);
  plan.on_progress = [this](const Simulation& running) { look_after(running); };
  march_.emplace(*simulation_, &*recorder_, std::move(plan));
}

/// Between steps, about four times a second.
void Transient::look_after(const Simulation& running) {
  const double end = loaded_->scene.time.end;
  if (report_)
    report_(running.time() / end, fmt::format("t = {:.4g} of {:.4g} s", running.time(), end));
  if (seconds_since(last_checkpoint_) > loaded_->scene.checkpoint.every) {
    write_checkpoint();
  } else if (seconds_since(last_flush_) > 2.0) {
    writer_->flush();
    last_flush_ = Clock::now();
  }
  if (seconds_since(setup_start_) > wall_limit_) request_stop();
}

State Transient::save() const {
  State state = simulation_->save();
  recorder_->save(state, "recorder/");
  march_->save(state, "march/");
  state.put("march_seconds", march_seconds_);
  for (const auto& [path, values] : final_motion_.arrays()) state.put("final/" + path, values);
  return state;
}

void Transient::load(const State& state) {
  simulation_->load(state);
  recorder_->load(state, "recorder/");
  march_->load(state, "march/");
  march_seconds_ = state.get("march_seconds");
  const std::string prefix = "final/";
  for (const auto& [name, values] : state.arrays()) {
    if (name.starts_with(prefix)) final_motion_.put(name.substr(prefix.size()), values);
  }
}

void Transient::write_checkpoint() {
  writer_->write_checkpoint(save());
  last_checkpoint_ = last_flush_ = Clock::now();
}

MarchEnd Transient::run_to_step(std::int64_t step) {
  // The final motion is that at the end asked for, not where the filters have seen enough.
  if (step > end_step_ && final_motion_.arrays().empty() &&
      run_to_step(end_step_) != MarchEnd::finished)
    return end_;
  const auto start = Clock::now();
  const double writing_before = writer_->write_seconds();
  end_ = march_->run_until(step);
  march_seconds_ += seconds_since(start) - (writer_->write_seconds() - writing_before);
  // Losing the contact within the filter's look-ahead is no failure of the run that was asked for.
  if (end_ == MarchEnd::failed && simulation_->step_index() >= end_step_) end_ = MarchEnd::finished;
  if (simulation_->step_index() == end_step_) keep_final_motion();
  return end_;
}

MarchEnd Transient::run_until(double time) {
  return run_to_step(static_cast<std::int64_t>(std::llround(time / loaded_->scene.time.step)));
}

MarchEnd Transient::run_to_end() {
  return run_to_step(last_step_);
}

/// The motion of every body where the run has ended, for scenes that start from it.
void Transient::keep_final_motion() {
  if (!final_motion_.arrays().empty()) return;
  final_motion_.put("time", simulation_->time());
  final_motion_.put("drive_displacement", simulation_->drive_displacement());
  for (std::size_t b = 0; b < model_.system.bodies.size(); ++b) {
    const SystemBody& body = model_.system.bodies[b];
    if (body.modal.size() == 0) continue;
    const Propagator::Motion motion = simulation_->reduced_motion(static_cast<int>(b));
    const auto keep = [&](const char* name, const Eigen::VectorXd& vector) {
      final_motion_.put(body.name + name, {vector.data(), static_cast<std::size_t>(vector.size())});
    };
    keep("/displacement", motion.displacement);
    keep("/velocity", motion.velocity);
  }
}

void Transient::write_final_motion() {
  for (const auto& [path, values] : final_motion_.arrays()) {
    const bool is_velocity = path.ends_with("/velocity");
    writer_->write_static("/final/" + path, values,
                          path == "time" ? "s" : (is_velocity ? "m/s" : "m"));
  }
}

Json Transient::finish() {
  const Scene& scene = loaded_->scene;
  writer_->flush();
  const auto acceleration = summarise_acceleration(RunFileReader(file_), scene.measure);
  const std::int64_t steps = simulation_->step_index();
  Json results = {{"status", end_ == MarchEnd::finished  ? "done"
                             : end_ == MarchEnd::stopped ? "stopped"
                                                         : "failed"},
                  {"steps", steps},
                  {"step", scene.time.step},
                  {"step_limit", number(step_limit(model_.system, scene.time).step)},
                  {"wall_s", march_seconds_},
                  {"setup_s", setup_seconds_},
                  {"output_s", file_seconds_ + writer_->write_seconds()},
                  {"step_ns", steps > 0 ? number(march_seconds_ * 1e9 / static_cast<double>(steps))
                                        : Json(nullptr)}};
  results["modes"] = modes_json(model_.system, scene.time);
  results.update(contact_json(*simulation_, model_.system, march_->statistics()));
  results["free_end_acceleration"] = nullptr;
  if (acceleration) {
    results["free_end_acceleration"] = {{"peak", number(acceleration->peak)},
                                        {"rms", number(acceleration->rms)},
                                        {"channel", acceleration->channel}};
  }
  results.update(violations_json(*simulation_));
  results["bursts"] = nullptr;
  if (acceleration && acceleration->bursts) results["bursts"] = bursts_json(*acceleration->bursts);
  const EnergyLedger* energy = simulation_->energy();
  results["energy_error"] = energy != nullptr ? number(energy->relative_error()) : Json(nullptr);
  results["file"] = file_;
  keep_final_motion();
  write_final_motion();
  store_results(*writer_, "", results);
  if (acceleration && acceleration->bursts && !acceleration->bursts->empty()) {
    store_bursts(*writer_, *acceleration->bursts);
  }
  writer_->close();
  return results;
}

void print_bursts(const Json& results) {
  if (results["bursts"].is_null()) return;
  if (results["bursts"].empty()) fmt::print("{:<24}none\n", "bursts");
  for (const Json& burst : results["bursts"]) {
    fmt::print("{:<24}{}\n", "burst", burst_text(burst));
  }
}

}  // namespace stridor
