#include "app/transient.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <tuple>

#include "app/burst_text.hpp"
#include "core/errors.hpp"
#include "core/version.hpp"
#include "io/initial_state.hpp"
#include "solvers/make_propagator.hpp"

namespace stridor {
namespace {

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
  for (const SystemBody& body : system.bodies) {
    const Eigen::Index moving = num_retained(body.modal, time);
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

Transient::Transient(const LoadedScene& loaded, const TransientOutput& output)
    : loaded_(&loaded), file_(output.file) {
  const Scene& scene = loaded.scene;
  check_output(file_, output.overwrite);
  model_ = build_model(loaded);
  try {
    set_initial_state(model_.system, scene);
    const bool has_ledger = scene.record && scene.record->energy;
    simulation_.emplace(model_.system, scene.time, has_ledger ? Accounts::energy : Accounts::none);
  } catch (const ConfigError& error) {
    throw loaded.located(error);
  }

  const double step = scene.time.step;
  const std::vector<Channel> channels =
      scene.record ? parse_channels(*scene.record, scene.model) : std::vector<Channel>{};
  const double interval = scene.record ? scene.record->interval : step;
  const auto file_start = Clock::now();
  writer_.emplace(file_, output.overwrite, make_header(loaded, output.command_line),
                  Recorder::series(model_, channels, step, interval));
  for (const SystemBody& body : model_.system.bodies) write_modes(*writer_, body);
  file_seconds_ = seconds_since(file_start);
  recorder_.emplace(model_, channels, step, interval, *writer_);

  end_step_ = static_cast<std::int64_t>(std::llround(scene.time.end / step));
  const auto to_step = [&](double time) {
    return static_cast<std::int64_t>(std::ceil(time / step - 1e-6));
  };
  MarchPlan plan;
  // The last sample needs the filter's look-ahead beyond the end.
  last_step_ = end_step_ + recorder_->latency();
  plan.last_step = last_step_;
  recorder_->limit_samples(static_cast<std::int64_t>(std::floor(scene.time.end / interval + 1e-6)) +
                           1);
  plan.measure_from = to_step(scene.measure.from);
  plan.measure_to = std::min(end_step_, scene.measure.to ? to_step(*scene.measure.to) : end_step_);
  plan.on_progress = [this](const Simulation& running) {
    const double end = loaded_->scene.time.end;
    if (report_) {
      report_(running.time() / end, fmt::format("t = {:.4g} of {:.4g} s", running.time(), end));
    }
    if (seconds_since(last_flush_) > 2.0) {
      writer_->flush();
      last_flush_ = Clock::now();
    }
  };
  march_.emplace(*simulation_, &*recorder_, std::move(plan));
  setup_seconds_ = seconds_since(setup_start_) - file_seconds_;
}

MarchEnd Transient::run_to_step(std::int64_t step) {
  // The final motion is that at the end asked for, not where the filters have seen enough.
  if (step > end_step_ && !has_final_motion_ && run_to_step(end_step_) != MarchEnd::finished)
    return end_;
  const auto start = Clock::now();
  const double writing_before = writer_->write_seconds();
  end_ = march_->run_until(step);
  march_seconds_ += seconds_since(start) - (writer_->write_seconds() - writing_before);
  // Losing the contact within the filter's look-ahead is no failure of the run that was asked for.
  if (end_ == MarchEnd::failed && simulation_->step_index() >= end_step_) end_ = MarchEnd::finished;
  if (simulation_->step_index() == end_step_ || end_ != MarchEnd::finished) store_final_motion();
  return end_;
}

MarchEnd Transient::run_until(double time) {
  return run_to_step(static_cast<std::int64_t>(std::llround(time / loaded_->scene.time.step)));
}

MarchEnd Transient::run_to_end() {
  return run_to_step(last_step_);
}

/// The motion of every body where the run has ended, for scenes that start from it.
void Transient::store_final_motion() {
  if (has_final_motion_) return;
  has_final_motion_ = true;
  const double time[] = {simulation_->time()};
  const double drive[] = {simulation_->drive_displacement()};
  writer_->write_static("/final/time", time, "s");
  writer_->write_static("/final/drive_displacement", drive, "m");
  for (std::size_t b = 0; b < model_.system.bodies.size(); ++b) {
    const SystemBody& body = model_.system.bodies[b];
    if (body.modal.size() == 0) continue;
    const Propagator::Motion motion = simulation_->reduced_motion(static_cast<int>(b));
    const auto as_span = [](const Eigen::VectorXd& vector) {
      return std::span<const double>(vector.data(), static_cast<std::size_t>(vector.size()));
    };
    writer_->write_static("/final/" + body.name + "/displacement", as_span(motion.displacement),
                          "m");
    writer_->write_static("/final/" + body.name + "/velocity", as_span(motion.velocity), "m/s");
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
                  {"step_limit", scene.time.integrator == Integrator::exact
                                     ? Json(nullptr)
                                     : number(step_limit(model_.system).step)},
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
