#include "app/disc_transient.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "solvers/dense_eigenvalues.hpp"
#include "solvers/linear_pencil.hpp"

namespace stridor {
namespace {

/// @throws ConfigError with what is missing or cannot be run
void check_run(const LoadedDiscScene& loaded) {
  const DiscScene& scene = loaded.scene;
  std::vector<Problem> problems;
  const auto need = [&](bool is_there, const char* key, const char* message) {
    if (!is_there) problems.push_back({key, message, {}, 0, 0});
  };
  need(scene.time.has_value(), "time", "is required for run: {step, end}");
  need(scene.initial.has_value(), "initial",
       "is required for run: {perturbation: {eigenvalue, amplitude}}");
  need(scene.record.has_value(), "record", "is required for run: {interval}");
  need(scene.model.contact.preload != 0.0, "contact.preload",
       "must be positive for run, else the pads do not touch");
  need(scene.model.disc.speed > 0.0, "disc.speed",
       "must be positive for run: it says where friction acts");
  if (problems.empty()) return;
  locate(problems, loaded.tree);
  throw ConfigError(std::move(problems));
}

/// The largest of the displacements of all pads at their contact points.
std::complex<double> largest_pad_displacement(const DiscModel& model, const Eigen::VectorXcd& q) {
  std::complex<double> largest;
  for (const FaceContact& contact : model.contacts) {
    for (const Eigen::VectorXd* row : {&contact.pad_r, &contact.pad_phi, &contact.pad_z}) {
      const std::complex<double> moved = row->cast<std::complex<double>>().dot(q);
      // Pads that mirror each other move alike but for rounding: the first of them counts, or the
      // sign of the motion would be that of rounding.
      if (std::abs(moved) > (1.0 + 1e-9) * std::abs(largest)) largest = moved;
    }
  }
  return largest;
}

}  // namespace

DiscStatistics::DiscStatistics(const DiscModel& model, double half)
    : half_(half),
      least_(model.contacts.size(), std::numeric_limits<double>::infinity()),
      most_(model.contacts.size(), -std::numeric_limits<double>::infinity()) {}

void DiscStatistics::add(const FaceContactMotion& motion, double time) {
  for (int i = 0; i < motion.num_contacts(); ++i) {
    const FaceContactState contact = motion.contact(i);
    ++steps_;
    sticking_ += contact.state == ContactState::stick ? 1 : 0;
    open_ += contact.state == ContactState::open ? 1 : 0;
    if (time < half_) continue;
    double& least = least_[static_cast<std::size_t>(i)];
    double& most = most_[static_cast<std::size_t>(i)];
    least = std::min(least, contact.force);
    most = std::max(most, contact.force);
  }
  double& slot = time < half_ ? before_ : after_;
  for (int i = 0; i < motion.num_contacts(); ++i) {
    for (const FacePort port : {FacePort::pad_r, FacePort::pad_phi, FacePort::pad_z})
      slot = std::max(slot, std::abs(motion.moved(i, port)));
  }
}

void DiscStatistics::report(Json& results) const {
  results["contacts"] = Json::object();
  for (std::size_t i = 0; i < least_.size(); ++i) {
    results["contacts"][disc_contact_name(i, least_.size() / 2)]["contact_force"] = {
        {"min", number(least_[i])}, {"max", number(most_[i])}};
  }
  results["pad_displacement"] = {{"first_half", number(before_)}, {"second_half", number(after_)}};
  const auto share = [&](std::int64_t count) {
    return steps_ > 0 ? number(static_cast<double>(count) / static_cast<double>(steps_))
                      : Json(nullptr);
  };
  results["stick_fraction"] = share(sticking_);
  results["free_fraction"] = share(open_);
}

void DiscStatistics::save(State& state, const std::string& prefix) const {
  state.put(prefix + "least", least_);
  state.put(prefix + "most", most_);
  const double counts[] = {before_, after_, static_cast<double>(steps_),
                           static_cast<double>(sticking_), static_cast<double>(open_)};
  state.put(prefix + "counts", counts);
}

void DiscStatistics::load(const State& state, const std::string& prefix) {
  state.get(prefix + "least", least_);
  state.get(prefix + "most", most_);
  double counts[5];
  state.get(prefix + "counts", counts);
  before_ = counts[0];
  after_ = counts[1];
  steps_ = static_cast<std::int64_t>(counts[2]);
  sticking_ = static_cast<std::int64_t>(counts[3]);
  open_ = static_cast<std::int64_t>(counts[4]);
}

DiscTransient::DiscTransient(const LoadedDiscScene& loaded, const RunOutput& output)
    : loaded_(&loaded), file_(output.file) {
  check_output(file_, output.overwrite);
  check_run(loaded);
  make_model();
  const Perturbation start = perturbation();
  eigenvalue_ = start.s;
  motion_->start(start.displacement, start.velocity);
  writer_.emplace(file_, output.overwrite,
                  run_header(output.command_line, loaded.tree.document, loaded.resolved(),
                             std::vector<SceneFile>()),
                  recorder_->series());
  recorder_->sample(*motion_, *writer_, last_sample_);
  write_checkpoint();
  setup_seconds_ = keeper_.seconds();
}

DiscTransient::DiscTransient(const LoadedDiscScene& loaded, const InterruptedRun& interrupted)
    : loaded_(&loaded), file_(interrupted.file) {
  check_run(loaded);
  make_model();
  try {
    writer_.emplace(RunFileWriter::resume(file_, recorder_->series(), interrupted.checkpoint));
    load(interrupted.checkpoint.state);
  } catch (const std::invalid_argument& error) {
    throw_unfit_checkpoint(file_, error.what());
  }
  setup_seconds_ = keeper_.seconds();
}

void DiscTransient::make_model() {
  keeper_ = RunKeeper(scene().checkpoint.every);
  const double step = scene().time->step;
  const double end = scene().time->end;
  model_ = loaded_->model();
  try {
    motion_ = make_face_contact_motion(model_->bodies, model_->contacts, model_->law, model_->state,
                                       step);
  } catch (const std::invalid_argument& error) {
    std::vector<Problem> problems{{"time.step", error.what(), {}, 0, 0}};
    locate(problems, loaded_->tree);
    throw ConfigError(std::move(problems));
  }
  recorder_.emplace(*model_, scene().record->channels, step, scene().record->interval);
  statistics_.emplace(*model_, 0.5 * end);
  end_step_ = static_cast<std::int64_t>(std::llround(end / step));
  last_sample_ =
      static_cast<std::int64_t>(std::floor(end / scene().record->interval * (1.0 + 1e-12)));
}

DiscTransient::Perturbation DiscTransient::perturbation() const {
  const Pencil pencil = make_pencil(model_->system);
  const DenseSpectrum spectrum = dense_spectrum(pencil);
  const PerturbationParameters& asked = scene().initial->perturbation;
  const auto refuse = [&](const std::string& message) {
    std::vector<Problem> problems{{"initial.perturbation.eigenvalue", message, {}, 0, 0}};
    locate(problems, loaded_->tree);
    throw ConfigError(std::move(problems));
  };
  std::int64_t number = 0;
  for (std::size_t i = 0; i < spectrum.eigenvalues.size(); ++i) {
    const std::complex<double> s = spectrum.eigenvalues[i].s;
    if (!(s.imag() > 0.0) || ++number != asked.eigenvalue) continue;
    Eigen::VectorXcd q = pencil.slots * spectrum.right.col(static_cast<Eigen::Index>(i));
    // The largest displacement of a pad is real, and is the amplitude.
    const std::complex<double> largest = largest_pad_displacement(*model_, q);
    if (largest == 0.0) refuse(fmt::format("the pads do not move in mode {}", number));
    q *= asked.amplitude / largest;
    return {s, q.real(), (s * q).real()};
  }
  refuse(fmt::format("there are {} modes, got {}", number, asked.eigenvalue));
  return {};
}

State DiscTransient::save() const {
  State state;
  motion_->save(state, "motion/");
  recorder_->save(state, "recorder/");
  statistics_->save(state, "statistics/");
  state.put("step", static_cast<double>(step_));
  state.put("march_seconds", march_seconds_);
  const double s[] = {eigenvalue_.real(), eigenvalue_.imag()};
  state.put("eigenvalue", s);
  return state;
}

void DiscTransient::load(const State& state) {
  motion_->load(state, "motion/");
  recorder_->load(state, "recorder/");
  statistics_->load(state, "statistics/");
  step_ = static_cast<std::int64_t>(state.get("step"));
  march_seconds_ = state.get("march_seconds");
  double s[2];
  state.get("eigenvalue", s);
  eigenvalue_ = {s[0], s[1]};
}

double DiscTransient::time() const {
  return static_cast<double>(std::min(step_, end_step_)) * scene().time->step;
}

void DiscTransient::write_checkpoint() {
  keeper_.write_checkpoint(*writer_, save());
}

/// Whether the run can go on from a step; says in failure_ why not. Contacts that are springs say
/// nothing of a pad that has gone through the middle of the disc.
bool DiscTransient::is_sound(bool has_converged) {
  const double depth = 0.5 * scene().model.disc.plate.thickness;
  const std::string when = fmt::format("at t = {:.6g} s", time());
  if (!has_converged && !std::isfinite(motion_->displacement().sum())) {
    failure_ = fmt::format(
        "the motion has grown beyond all bounds {}; a shorter time.step or a "
        "smaller initial.perturbation.amplitude may help",
        when);
    return false;
  }
  for (int i = 0; i < motion_->num_contacts(); ++i) {
    const double gap = motion_->contact(i).gap;
    if (!(gap < -depth)) continue;
    const auto num_pad_contacts = static_cast<std::size_t>(motion_->num_contacts()) / 2;
    failure_ = fmt::format(
        "contact {} has gone {:.4g} m into the disc {}, more than half its thickness; a smaller "
        "initial.perturbation.amplitude, a larger contact.penalty or a shorter time.step may help",
        disc_contact_name(static_cast<std::size_t>(i), num_pad_contacts), -gap, when);
    return false;
  }
  if (!has_converged) {
    failure_ =
        fmt::format("the contact forces have not converged {}; a shorter time.step may help", when);
  }
  return has_converged;
}

MarchEnd DiscTransient::run_to_step(std::int64_t last) {
  constexpr std::int64_t steps_between_looks = 256;
  const auto start = std::chrono::steady_clock::now();
  const double writing_before = writer_->write_seconds();
  end_ = is_sound(true) ? MarchEnd::finished : MarchEnd::failed;
  while (step_ < last && end_ == MarchEnd::finished) {
    if (step_ % steps_between_looks == 0) {
      if (stop_requested()) {
        end_ = MarchEnd::stopped;
        break;
      }
      if (keeper_.is_due())
        keeper_.look_after(time(), scene().time->end, *writer_, [this] { return save(); });
    }
    const bool has_converged = motion_->step();
    ++step_;
    if (!is_sound(has_converged)) {
      // Within the filters' look-ahead it is no failure of the run that was asked for.
      end_ = step_ <= end_step_ ? MarchEnd::failed : MarchEnd::finished;
      break;
    }
    recorder_->sample(*motion_, *writer_, last_sample_);
    if (step_ <= end_step_) statistics_->add(*motion_, time());
  }
  march_seconds_ += seconds_since(start) - (writer_->write_seconds() - writing_before);
  return end_;
}

MarchEnd DiscTransient::run_until(double time) {
  return run_to_step(static_cast<std::int64_t>(std::llround(time / scene().time->step)));
}

MarchEnd DiscTransient::run_to_end() {
  return run_to_step(end_step_ + recorder_->latency());
}

Json DiscTransient::finish() {
  Json results = {{"status", end_ == MarchEnd::finished  ? "done"
                             : end_ == MarchEnd::stopped ? "stopped"
                                                         : "failed"}};
  results.update(effort_json(std::min(step_, end_step_), scene().time->step, nullptr,
                             {setup_seconds_, march_seconds_, writer_->write_seconds()}));
  results["perturbation"] = {{"frequency", eigenvalue_.imag() / (2.0 * std::numbers::pi)},
                             {"growth", eigenvalue_.real()}};
  statistics_->report(results);
  // Results of beams only.
  for (const char* name : {"free_end_acceleration", "bursts", "violations", "energy_error"})
    results[name] = nullptr;
  results["file"] = file_;
  store_results(*writer_, results);
  writer_->close();
  return results;
}

}  // namespace stridor
