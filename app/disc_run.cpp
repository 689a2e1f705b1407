#include "app/disc_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>

#include "analysis/low_pass.hpp"
#include "app/expectations.hpp"
#include "app/progress.hpp"
#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "core/version.hpp"
#include "io/linear_scene.hpp"
#include "io/run_file.hpp"
#include "solvers/dense_eigenvalues.hpp"
#include "solvers/face_contact_motion.hpp"
#include "solvers/linear_pencil.hpp"

namespace stridor {
namespace {

/// @throws ConfigError with what is missing or cannot be run
void check_run(const DiscScene& scene) {
  std::vector<Problem> problems;
  const auto need = [&](bool is_there, const char* key, const char* message) {
    if (!is_there) problems.push_back({key, message, {}, 0, 0});
  };
  need(scene.time.has_value(), "time", "is required for run: {step, end}");
  need(scene.initial.has_value(), "initial",
       "is required for run: {perturbation: {eigenvalue, amplitude}}");
  need(scene.record.has_value(), "record", "is required for run: {interval}");
  need(scene.model.contact.formulation == ContactFormulation::penalty, "contact.formulation",
       "must be `penalty` for run: rigid contacts that open would close with impacts, for which "
       "there is no law");
  need(scene.model.contact.preload != 0.0, "contact.preload",
       "must be positive for run, else the pads do not touch");
  need(scene.model.disc.speed > 0.0, "disc.speed",
       "must be positive for run: it says where friction acts");
  if (!problems.empty()) throw ConfigError(std::move(problems));
}

/// An eigenvalue and its motion at t = 0, scaled to an amplitude of the pads.
struct Perturbation {
  std::complex<double> s;
  Eigen::VectorXd displacement, velocity;
};

Perturbation perturbation_of(const DiscScene& scene, const DiscModel& model) {
  const Pencil pencil = make_pencil(model.system);
  const DenseSpectrum spectrum = dense_spectrum(pencil);
  const PerturbationParameters& asked = scene.initial->perturbation;
  std::int64_t number = 0;
  for (std::size_t i = 0; i < spectrum.eigenvalues.size(); ++i) {
    const std::complex<double> s = spectrum.eigenvalues[i].s;
    if (!(s.imag() > 0.0) || ++number != asked.eigenvalue) continue;
    Eigen::VectorXcd q = pencil.slots * spectrum.right.col(static_cast<Eigen::Index>(i));
    // The largest displacement of a pad is real, and is the amplitude.
    std::complex<double> largest = 0.0;
    for (const FaceContact& contact : model.contacts) {
      for (const Eigen::VectorXd* row : {&contact.pad_r, &contact.pad_phi, &contact.pad_z}) {
        const std::complex<double> moved = row->cast<std::complex<double>>().dot(q);
        if (std::abs(moved) > std::abs(largest)) largest = moved;
      }
    }
    if (largest == 0.0) {
      throw ConfigError("initial.perturbation.eigenvalue",
                        fmt::format("the pads do not move in mode {}", number));
    }
    q *= asked.amplitude / largest;
    return {s, q.real(), (s * q).real()};
  }
  throw ConfigError("initial.perturbation.eigenvalue",
                    fmt::format("there are {} modes, got {}", number, asked.eigenvalue));
}

/// What is looked at in every step, low-passed and thinned into a run file.
class DiscRecorder {
 public:
  DiscRecorder(const DiscModel& model, double step, double interval) : interval_(interval) {
    filter_ = std::make_shared<const DecimationFilter>(
        step, static_cast<int>(std::lround(interval / step)));
    const auto add_point = [&](const std::string& name, const Eigen::VectorXd& row) {
      streams_.push_back({row, -1, nullptr, Decimator(filter_)});
      const std::size_t stream = streams_.size() - 1;
      add(name + ".displacement", "m", stream, Derivative::none);
      add(name + ".velocity", "m/s", stream, Derivative::first);
      add(name + ".acceleration", "m/s^2", stream, Derivative::second);
    };
    for (std::size_t i = 0; i < model.contacts.size(); ++i) {
      const FaceContact& contact = model.contacts[i];
      const std::string name = contact_name(model, i);
      add_point("pad." + name + ".r", contact.pad_r);
      add_point("pad." + name + ".phi", contact.pad_phi);
      add_point("pad." + name + ".z", contact.pad_z);
      add_point("disc." + name + ".z", contact.plate.w);
      const auto add_quantity = [&](const char* quantity, const char* units,
                                    double FaceContactState::*member) {
        streams_.push_back({{}, static_cast<int>(i), member, Decimator(filter_)});
        SeriesSpec spec{"/contact/" + name + "/" + quantity, units, SeriesKind::real, {}};
        spec.attributes.emplace_back("filter", filter_->description());
        series_.push_back(spec);
        columns_.push_back({streams_.size() - 1, Derivative::none});
      };
      add_quantity("force", "N", &FaceContactState::force);
      add_quantity("friction_force", "N", &FaceContactState::friction_force);
      add_quantity("gap", "m", &FaceContactState::gap);
      add_quantity("slip_velocity", "m/s", &FaceContactState::slip_velocity);
      streams_.push_back({{}, static_cast<int>(i), nullptr, Decimator(filter_)});
      series_.push_back({"/contact/" + name + "/state",
                         "1",
                         SeriesKind::state,
                         {{"filter", "none"}, {"meaning", "0 open, 1 stick, 2 slip"}}});
      columns_.push_back({streams_.size() - 1, std::nullopt});
    }
    row_.resize(columns_.size());
  }

  /// "upper", "lower"; with an index where a pad has several points.
  static std::string contact_name(const DiscModel& model, std::size_t i) {
    const std::size_t per_pad = model.contacts.size() / 2;
    const std::string pad = model.contacts[i].side > 0 ? "upper" : "lower";
    return per_pad == 1 ? pad : fmt::format("{}_{}", pad, i % per_pad);
  }

  const std::vector<SeriesSpec>& series() const { return series_; }
  std::int64_t latency() const { return filter_->half_length(); }

  /// @param last number of the last sample that is wanted
  void sample(const FaceContactMotion& motion, RunFileWriter& writer, std::int64_t last) {
    bool is_due = false;
    for (Stream& stream : streams_) is_due = stream.decimator.push(value(stream, motion));
    if (!is_due) return;
    const std::int64_t number = streams_.front().decimator.num_outputs() - 1;
    if (number > last) return;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const Decimator& decimator = streams_[columns_[i].stream].decimator;
      row_[i] =
          columns_[i].derivative ? decimator.value(*columns_[i].derivative) : decimator.sample();
    }
    writer.append(static_cast<double>(number) * interval_, row_);
  }

 private:
  struct Stream {
    Eigen::VectorXd row;  ///< of a displacement; empty: of a contact
    int contact = 0;
    double FaceContactState::*member = nullptr;  ///< null: the state
    Decimator decimator;
  };
  struct Column {
    std::size_t stream;
    std::optional<Derivative> derivative;
  };

  void add(const std::string& name, const char* units, std::size_t stream, Derivative derivative) {
    series_.push_back(
        {"/channels/" + name, units, SeriesKind::real, {{"filter", filter_->description()}}});
    columns_.push_back({stream, derivative});
  }

  static double value(const Stream& stream, const FaceContactMotion& motion) {
    if (stream.row.size() > 0) return stream.row.dot(motion.displacement());
    const FaceContactState contact = motion.contact(stream.contact);
    return stream.member != nullptr ? contact.*stream.member : static_cast<double>(contact.state);
  }

  double interval_;
  std::shared_ptr<const DecimationFilter> filter_;
  std::vector<Stream> streams_;
  std::vector<Column> columns_;
  std::vector<SeriesSpec> series_;
  std::vector<double> row_;
};

/// What a run says of itself: over the whole of it, and over its second half.
class DiscStatistics {
 public:
  DiscStatistics(const DiscModel& model, double half) : model_(&model), half_(half) {
    forces_.assign(model.contacts.size(), {inf, -inf});
  }

  void add(const FaceContactMotion& motion, double time) {
    for (int i = 0; i < motion.num_contacts(); ++i) {
      const FaceContactState contact = motion.contact(i);
      ++steps_;
      sticking_ += contact.state == ContactState::stick ? 1 : 0;
      open_ += contact.state == ContactState::open ? 1 : 0;
      if (time < half_) continue;
      auto& [low, high] = forces_[static_cast<std::size_t>(i)];
      low = std::min(low, contact.force);
      high = std::max(high, contact.force);
    }
    double largest = 0.0;
    for (const FaceContact& contact : model_->contacts) {
      for (const Eigen::VectorXd* row : {&contact.pad_r, &contact.pad_phi, &contact.pad_z})
        largest = std::max(largest, std::abs(row->dot(motion.displacement())));
    }
    double& slot = time < half_ ? before_ : after_;
    slot = std::max(slot, largest);
  }

  void report(Json& results) const {
    results["contacts"] = Json::object();
    for (std::size_t i = 0; i < forces_.size(); ++i) {
      results["contacts"][DiscRecorder::contact_name(*model_, i)]["contact_force"] = {
          {"min", number(forces_[i].first)}, {"max", number(forces_[i].second)}};
    }
    results["pad_displacement"] = {{"first_half", number(before_)},
                                   {"second_half", number(after_)}};
    const auto share = [&](std::int64_t count) {
      return steps_ > 0 ? number(static_cast<double>(count) / static_cast<double>(steps_))
                        : Json(nullptr);
    };
    results["stick_fraction"] = share(sticking_);
    results["free_fraction"] = share(open_);
  }

 private:
  static constexpr double inf = std::numeric_limits<double>::infinity();
  const DiscModel* model_;
  double half_;
  std::vector<std::pair<double, double>> forces_ = {};
  double before_ = 0.0, after_ = 0.0;  ///< largest displacement of a pad, m
  std::int64_t steps_ = 0, sticking_ = 0, open_ = 0;
};

void print_results(const Json& results, const std::string& file) {
  fmt::print("{:<24}{}\n", "status", results["status"].get<std::string>());
  fmt::print("{:<24}{} of {:g} s, {:.3g} s stepping\n", "steps",
             results["steps"].get<std::int64_t>(), results["step"].get<double>(),
             results["wall_s"].get<double>());
  fmt::print("{:<24}{:.6g} Hz, growth {:.6g} 1/s\n", "perturbed mode",
             results["perturbation"]["frequency"].get<double>(),
             results["perturbation"]["growth"].get<double>());
  for (const auto& [name, contact] : results["contacts"].items()) {
    const Json& force = contact["contact_force"];
    if (force["min"].is_null()) continue;
    fmt::print("{:<24}{:.6g} to {:.6g} N in the second half\n", "contact force " + name,
               force["min"].get<double>(), force["max"].get<double>());
  }
  fmt::print("{:<24}{:.4g} m, in the first half {:.4g} m\n", "pads move by",
             results["pad_displacement"]["second_half"].get<double>(),
             results["pad_displacement"]["first_half"].get<double>());
  if (!results["free_fraction"].is_null()) {
    fmt::print("{:<24}{:.4g} % of the time, lifted off {:.4g} %\n", "sticking",
               100.0 * results["stick_fraction"].get<double>(),
               100.0 * results["free_fraction"].get<double>());
  }
  fmt::print("{:<24}{}\n", "run file", file);
}

}  // namespace

ExitCode run_disc(const DiscRunOptions& options) {
  using Clock = std::chrono::steady_clock;
  const auto seconds = [](Clock::time_point from) {
    return std::chrono::duration<double>(Clock::now() - from).count();
  };
  const auto setup_start = Clock::now();
  const Overwrite overwrite = options.common.overwrite();
  check_output(options.output, overwrite);
  const LoadedLinearScene loaded = load_linear_scene(options.scene, options.common.sets);
  const DiscScene* scene = std::get_if<DiscScene>(&loaded.scene);
  if (scene == nullptr)
    throw ConfigError("substructures", "a body given by matrices has no contacts to run with");
  check_run(*scene);
  const LinearModel linear = loaded.model();
  const DiscModel& model = *linear.disc;
  const Perturbation perturbation = perturbation_of(*scene, model);
  const double step = scene->time->step;
  FaceContactMotion motion(model.bodies, model.contacts, model.law, model.state, step);
  motion.start(perturbation.displacement, perturbation.velocity);
  DiscRecorder recorder(model, step, scene->record->interval);
  RunFileWriter writer(options.output, overwrite,
                       {std::string(version), std::string(commit), options.command_line,
                        loaded.hash(), utc_now(), loaded.resolved(), loaded.resolved()},
                       recorder.series());
  const auto num_steps = static_cast<std::int64_t>(std::llround(scene->time->end / step));
  const auto last = static_cast<std::int64_t>(
      std::floor(scene->time->end / scene->record->interval * (1.0 + 1e-12)));
  DiscStatistics statistics(model, 0.5 * scene->time->end);
  Progress progress("run");
  const double setup_s = seconds(setup_start);

  const auto start = Clock::now();
  std::int64_t done = 0;
  bool has_failed = false;
  recorder.sample(motion, writer, last);
  // Some steps beyond the end, until the last samples are through the low-pass.
  for (std::int64_t n = 1; n <= num_steps + recorder.latency() && !has_failed; ++n) {
    if (n % 1024 == 0) {
      if (stop_requested()) break;
      progress.report(std::min(1.0, static_cast<double>(n) / static_cast<double>(num_steps)),
                      fmt::format("t = {:.6g} s", static_cast<double>(n) * step));
    }
    has_failed = !motion.step();
    if (has_failed) break;
    recorder.sample(motion, writer, last);
    if (n > num_steps) continue;
    statistics.add(motion, static_cast<double>(n) * step);
    done = n;
  }
  progress.finish();
  const double wall_s = seconds(start);
  const bool is_stopped = !has_failed && done < num_steps;

  Json results = {{"status", has_failed   ? "failed"
                             : is_stopped ? "stopped"
                                          : "finished"},
                  {"steps", done},
                  {"step", step},
                  {"step_limit", nullptr},
                  {"setup_s", setup_s},
                  {"wall_s", wall_s - writer.write_seconds()},
                  {"output_s", writer.write_seconds()},
                  {"step_ns", 1e9 * wall_s / static_cast<double>(std::max<std::int64_t>(1, done))},
                  {"perturbation",
                   {{"frequency", perturbation.s.imag() / (2.0 * std::numbers::pi)},
                    {"growth", perturbation.s.real()}}}};
  statistics.report(results);
  // What is for beams only.
  for (const char* name : {"free_end_acceleration", "bursts", "violations", "energy_error"})
    results[name] = nullptr;
  results["file"] = options.output;
  writer.write_result("status", results["status"].get<std::string>());
  writer.write_result("pad_displacement", results["pad_displacement"]["second_half"].get<double>());
  writer.close();
  if (options.common.json) {
    fmt::print("{}\n", results.dump(2));
  } else {
    print_results(results, options.output);
  }
  std::fflush(stdout);
  const double reached = static_cast<double>(done) * step;
  if (has_failed) {
    throw NumericalError(
        fmt::format("the contact forces have not converged after t = {:.6g} s; a shorter time.step "
                    "may help. {} "
                    "holds everything up to then",
                    reached, options.output));
  }
  if (is_stopped) {
    throw Interrupted(
        fmt::format("at t = {:.6g} of {:.6g} s; {} holds everything up to then, it "
                    "cannot be resumed",
                    reached, scene->time->end, options.output));
  }
  if (options.verify) check_expectations(scene->expect, results);
  return ExitCode::done;
}

}  // namespace stridor
