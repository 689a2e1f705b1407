#include "app/runs/precision.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/results/pictures.hpp"
#include "app/runs/turns.hpp"
#include "core/errors.hpp"

namespace stridor {
namespace {

constexpr int most_turns = 100;
/// Shorter stretches would time the clock.
constexpr std::int64_t least_samples_per_turn = 50;
/// Beyond this a run has nothing to do with the reference.
constexpr double absurd_error = 1e3;

StudyParameters parameters_of(const PrecisionOptions& options, const Band& band) {
  StudyParameters parameters;
  parameters.points = options.points;
  for (const std::string& text : options.retain)
    parameters.retained.push_back(option_value("--retain", text, "Hz", Range::positive()));
  if (options.retain.empty()) {
    // 25, 50 and 100 kHz for a band up to 15 kHz.
    for (const double factor : {5.0, 10.0, 20.0})
      parameters.retained.push_back(factor / 3.0 * band.upper);
  }
  std::sort(parameters.retained.begin(), parameters.retained.end());
  for (const auto& [name, value] : assumption_names()) {
    const auto& asked = options.assumptions;
    if (asked.empty() || std::find(asked.begin(), asked.end(), name) != asked.end())
      parameters.assumptions.push_back(value);
  }
  return parameters;
}

PrecisionRow make_row(const PrecisionStudy& study, const PrecisionMethod& method, int steps,
                      Coordinates coordinates = Coordinates::modal,
                      std::optional<std::int64_t> num_samples = {}) {
  PrecisionRow row;
  row.method = method;
  row.coordinates = coordinates;
  row.steps_per_sample = steps;
  row.time = method.at(steps, *study.loaded.scene.time, study.interval);
  row.time.coordinates = coordinates;
  row.num_samples = num_samples.value_or(study.num_samples);
  row.modes = num_moving_modes(study.model.system, row.time);
  row.whole_steps = static_cast<double>(steps) * static_cast<double>(study.num_samples);
  row.run = std::make_unique<TimedRun>(with_assumption(study.model.system, method.assumption),
                                       row.time, study.observed, study.interval, row.num_samples);
  return row;
}

/// Runs all settings interleaved; the reference is the first.
void run_all(const PrecisionStudy& study, PrecisionRows& rows) {
  const int turns = static_cast<int>(
      std::clamp<std::int64_t>(study.num_samples / least_samples_per_turn, 1, most_turns));
  std::vector<double> weights;
  for (const PrecisionRow& row : rows) {
    const double per_step = row.is_measured() ? row.modes + 30.0
                            : row.coordinates == Coordinates::craig_bampton_fused
                                ? 30.0 * row.modes
                                : 100.0 * row.modes;
    weights.push_back(per_step * static_cast<double>(row.steps_per_sample) *
                      static_cast<double>(row.num_samples));
  }
  run_in_turns("precision", weights, turns, [&](std::size_t i, int turn) {
    PrecisionRow& row = rows[i];
    const MarchEnd end = row.run->run_until(row.num_samples * turn / turns);
    if (end == MarchEnd::stopped)
      throw Interrupted("nothing was measured; --until takes less of the run");
    if (i == 0 && end == MarchEnd::failed)
      throw NumericalError(row.run->refusal(), "the reference itself failed: " + row.run->failure());
    return fmt::format("step {:.3g} s", row.time.step);
  });
}

double chosen(const RunErrors& errors, const std::string& norm) {
  return norm == "force"          ? errors.force
         : norm == "acceleration" ? errors.acceleration
                                  : errors.envelope;
}

void judge(const PrecisionStudy& study, const PrecisionOptions& options, PrecisionResult& result) {
  PrecisionRows& rows = result.rows;
  const ReferenceRun reference(rows[0].run->samples(), study.norms);
  for (PrecisionRow& row : rows) {
    row.cost = row.run->cost();
    if (!row.is_measured()) continue;
    row.errors = reference.errors_of(row.run->samples());
    row.error = chosen(row.errors, options.norm);
    const double largest =
        std::max({row.errors.force, row.errors.acceleration, row.errors.envelope});
    row.is_stable = row.run->failure().empty() && std::isfinite(row.error) &&
                    (std::isnan(largest) || largest < absurd_error);
    if (!row.is_stable) row.error = std::numeric_limits<double>::quiet_NaN();
  }
  result.own_errors = rows[1].errors;
  result.own_error = rows[1].error;
  if (!std::isfinite(result.own_error)) {
    throw NumericalError(
        rows[1].run->failure().empty() ? Refusal::no_convergence : rows[1].run->refusal(),
        fmt::format("the {} of the reference is zero throughout the window, or its "
                    "check run failed: {}",
                    options.norm, rows[1].run->failure()));
  }
  // The published form computes the same numbers as its modal twin, to rounding.
  for (PrecisionRow& row : rows) {
    if (row.is_measured()) continue;
    const auto twin = std::find_if(rows.begin(), rows.end(), [&](const PrecisionRow& other) {
      return other.is_measured() && other.method.integrator == row.method.integrator &&
             !other.method.retained && other.method.assumption == row.method.assumption &&
             other.steps_per_sample == row.steps_per_sample;
    });
    row.is_stable = twin != rows.end() && twin->is_stable && row.run->failure().empty();
    if (!row.is_stable) continue;
    row.errors = twin->errors;
    row.error = twin->error;
  }
  std::vector<double> cost;
  std::vector<double> error;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const bool counts =
        i > 0 && rows[i].is_stable && rows[i].method.assumption == result.own_assumption;
    cost.push_back(rows[i].least_seconds());
    error.push_back(counts ? rows[i].error : std::numeric_limits<double>::quiet_NaN());
  }
  const std::vector<bool> front = pareto_front(cost, error);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].is_on_front = front[i];
}

}  // namespace

const std::vector<std::pair<std::string, ContactAssumption>>& assumption_names() {
  static const std::vector<std::pair<std::string, ContactAssumption>> names{
      {"subs_a", ContactAssumption::subs_a},
      {"subs_b", ContactAssumption::subs_b},
      {"subs_c", ContactAssumption::subs_c},
      {"film", ContactAssumption::film}};
  return names;
}

PrecisionStudy make_precision_study(const PrecisionOptions& options, LoadedScene loaded) {
  PrecisionStudy study{study_scene(std::move(loaded), options.until), {}, {}};
  study.parameters = parameters_of(options, study.norms.band);
  try {
    study.plan =
        make_plan(study.model.system, *study.loaded.scene.time, study.interval, study.parameters);
  } catch (const std::invalid_argument& error) {
    throw study.loaded.located(ConfigError(Refusal::wrong_value, "record.interval", error.what()));
  }
  return study;
}

PrecisionResult measure_precision(const PrecisionStudy& study, const PrecisionOptions& options) {
  PrecisionResult result;
  result.own_assumption = study.plan.reference.assumption;
  for (auto steps = study.plan.reference.steps_per_sample.rbegin();
       steps != study.plan.reference.steps_per_sample.rend(); ++steps) {
    result.rows.push_back(make_row(study, study.plan.reference, *steps));
  }
  for (const PrecisionMethod& method : study.plan.methods) {
    for (const int steps : method.steps_per_sample)
      result.rows.push_back(make_row(study, method, steps));
  }
  if (options.published_window > 0.0) {
    const auto samples = std::clamp<std::int64_t>(
        std::llround(options.published_window / study.interval), 1, study.num_samples);
    for (const Coordinates coordinates :
         {Coordinates::craig_bampton, Coordinates::craig_bampton_fused}) {
      result.rows.push_back(make_row(study, study.plan.methods.front(), study.plan.stable_steps,
                                     coordinates, samples));
    }
  }
  run_all(study, result.rows);
  judge(study, options, result);
  return result;
}

std::optional<std::size_t> cheapest_within(const PrecisionResult& result, double wanted) {
  std::optional<std::size_t> best;
  for (std::size_t i = 1; i < result.rows.size(); ++i) {
    const PrecisionRow& row = result.rows[i];
    if (!row.is_stable || !row.is_measured() || row.method.assumption != result.own_assumption ||
        !(row.error + result.own_error <= wanted)) {
      continue;
    }
    if (!best || row.least_seconds() < result.rows[*best].least_seconds()) best = i;
  }
  return best;
}

}  // namespace stridor
