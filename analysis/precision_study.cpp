#include "analysis/precision_study.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "analysis/step_guard.hpp"
#include "core/errors.hpp"
#include "solvers/integrators/make_propagator.hpp"
#include "solvers/integrators/retained_modes.hpp"

namespace stridor {
namespace {

/// Every how many samples one is timed: the clock itself takes about as long as a cheap step.
constexpr std::size_t timed_every = 32;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::vector<int> step_ladder(int coarsest, int finest, int count) {
  if (coarsest < 1 || finest < coarsest || count < 1)
    throw std::invalid_argument("step_ladder: not 1 <= coarsest <= finest with a positive count");
  std::vector<int> ladder;
  for (int i = 0; i < count; ++i) {
    const double part = count > 1 ? static_cast<double>(i) / (count - 1) : 0.0;
    const double wanted = coarsest * std::pow(static_cast<double>(finest) / coarsest, part);
    const int least = ladder.empty() ? coarsest : ladder.back() + 1;
    const int steps = std::max(least, static_cast<int>(std::lround(wanted)));
    if (steps > finest) break;
    ladder.push_back(steps);
  }
  return ladder;
}

int stable_steps_per_sample(const System& system, const TimeParameters& time, double interval) {
  const double limit = step_limit(system, time).step;
  // One part in 10⁹ below the limit, so that rounding does not lift a step above it.
  const double steps = std::ceil(interval / limit * (1.0 + 1e-9));
  if (!(steps <= 1e5)) {
    throw std::invalid_argument(
        "stable_steps_per_sample: the central difference takes more than 1e5 steps per sample");
  }
  return std::max(1, static_cast<int>(steps));
}

int num_moving_modes(const System& system, const TimeParameters& time) {
  Eigen::Index count = 0;
  for (const SystemBody& body : retained(system, time).bodies) count += body.modal.omega.size();
  return static_cast<int>(count);
}

System with_assumption(const System& system, ContactAssumption assumption) {
  System changed = system;
  for (ContactPoint& contact : changed.contacts) contact.assumption = assumption;
  return changed;
}

TimeParameters PrecisionMethod::at(int steps, const TimeParameters& time, double interval) const {
  TimeParameters changed = time;
  changed.integrator = integrator;
  changed.coordinates = Coordinates::modal;
  changed.step = interval / steps;
  changed.retain.reset();
  if (retained) changed.retain = RetainParameters{*retained, {}};
  return changed;
}

PrecisionPlan make_plan(const System& system, const TimeParameters& time, double interval,
                        const StudyParameters& parameters) {
  const ContactAssumption own =
      system.contacts.empty() ? ContactAssumption::subs_b : system.contacts.front().assumption;
  const int points = parameters.points;
  const auto ladder = [&](int coarsest, int finest) {
    return step_ladder(coarsest, std::max(finest, coarsest + points - 1), points);
  };
  const auto stable_steps = [&](std::optional<double> retained) {
    const PrecisionMethod central{Integrator::central_difference, retained, own, {}};
    return stable_steps_per_sample(system, central.at(1, time, interval), interval);
  };
  PrecisionPlan plan;
  plan.stable_steps = stable_steps({});
  const int scene_steps = static_cast<int>(std::lround(interval / time.step));
  const int half = std::max({4 * plan.stable_steps, scene_steps, 2 * points});
  plan.reference = {Integrator::exact, {}, own, {half, 2 * half}};

  PrecisionMethod central{Integrator::central_difference, {}, own, ladder(plan.stable_steps, half)};
  if (plan.stable_steps > 1)
    central.steps_per_sample.insert(central.steps_per_sample.begin(), plan.stable_steps - 1);
  plan.methods.push_back(central);
  plan.methods.push_back({Integrator::exact, {}, own, ladder(1, half)});
  const int all_modes = num_moving_modes(system, plan.reference.at(half, time, interval));
  std::vector<double> retained;
  for (const double frequency : parameters.retained) {
    PrecisionMethod method{Integrator::exact, frequency, own, ladder(1, plan.stable_steps / 2)};
    const int modes = num_moving_modes(system, method.at(half, time, interval));
    if (modes == 0 || modes == all_modes) continue;
    retained.push_back(frequency);
    plan.methods.push_back(method);
    const int stable = stable_steps(frequency);
    plan.methods.push_back({Integrator::central_difference, frequency, own,
                            ladder(stable, std::max(8 * stable, plan.stable_steps))});
  }
  for (const ContactAssumption assumption : parameters.assumptions) {
    if (assumption == own) continue;
    PrecisionMethod method{Integrator::exact, {}, assumption, ladder(1, plan.stable_steps / 2)};
    if (!retained.empty()) method.retained = retained[retained.size() / 2];
    plan.methods.push_back(method);
  }
  return plan;
}

void TimedRun::Sampler::sample(const Simulation& simulation) {
  next_step_ += stride_;
  SampledRun& samples = run_->samples_;
  const bool is_timed = samples.displacement.size() % timed_every == timed_every - 1;
  const auto start = is_timed ? Clock::now() : Clock::time_point();
  samples.displacement.push_back(
      simulation.displacement(run_->observed_.body, run_->observed_.row));
  for (std::size_t c = 0; c < samples.forces.size(); ++c)
    samples.forces[c].push_back(simulation.contact_force(static_cast<int>(c)));
  if (is_timed) run_->look_times_.push_back(seconds_since(start));
}

TimedRun::TimedRun(const System& system, const TimeParameters& time, ObservedRow observed,
                   double interval, std::int64_t num_samples)
    : observed_(observed),
      steps_per_sample_(static_cast<std::int64_t>(std::llround(interval / time.step))) {
  const auto start = Clock::now();
  samples_.interval = interval;
  samples_.displacement.reserve(static_cast<std::size_t>(num_samples) + 1);
  samples_.forces.resize(system.contacts.size());
  for (std::vector<double>& force : samples_.forces)
    force.reserve(static_cast<std::size_t>(num_samples) + 1);
  try {
    simulation_ = make_run_simulation(system, time);
  } catch (const ConfigError& error) {
    failure_ = error.what();
    refusal_ = error.problems().front().refusal;
    return;
  } catch (const NumericalError& error) {
    failure_ = error.what();
    refusal_ = error.refusal();
    return;
  }
  sampler_.emplace(*this, steps_per_sample_);
  MarchPlan plan;
  plan.last_step = num_samples * steps_per_sample_;
  plan.measure_from = plan.last_step;
  plan.measure_to = plan.last_step;
  march_.emplace(*simulation_, &*sampler_, std::move(plan));
  setup_seconds_ = seconds_since(start);
}

MarchEnd TimedRun::run_until(std::int64_t sample) {
  if (!failure_.empty()) return MarchEnd::failed;
  const std::int64_t steps_before = simulation_->step_index();
  const std::size_t samples_before = samples_.displacement.size();
  const auto start = Clock::now();
  const MarchEnd end = march_->run_until(sample * steps_per_sample_);
  stretches_.push_back({simulation_->step_index() - steps_before,
                        static_cast<std::int64_t>(samples_.displacement.size() - samples_before),
                        seconds_since(start)});
  march_seconds_ += stretches_.back().seconds;
  if (end == MarchEnd::failed) {
    failure_ = simulation_->failure();
    refusal_ = simulation_->refusal();
  }
  return end;
}

double TimedRun::look_time() const {
  return median(look_times_);
}

RunCost TimedRun::cost() const {
  RunCost cost;
  cost.setup = setup_seconds_;
  if (!simulation_) return cost;
  const double look = look_time();
  cost.steps = simulation_->step_index();
  cost.sampling =
      std::min(march_seconds_, look * static_cast<double>(samples_.displacement.size()));
  cost.stepping = march_seconds_ - cost.sampling;
  std::vector<double> per_step;
  for (const Stretch& stretch : stretches_) {
    if (stretch.steps == 0) continue;
    const double stepping =
        std::max(0.0, stretch.seconds - look * static_cast<double>(stretch.samples));
    per_step.push_back(stepping / static_cast<double>(stretch.steps));
  }
  if (per_step.empty()) return cost;
  cost.least_step = *std::min_element(per_step.begin(), per_step.end());
  cost.median_step = median(per_step);
  return cost;
}

}  // namespace stridor
