#include "analysis/error_norms.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace stridor {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

bool is_usable(double value) {
  return std::isfinite(value) && value > 0.0;
}

}  // namespace

std::vector<double> second_differences(std::span<const double> samples, double interval) {
  std::vector<double> differences;
  if (samples.size() < 3) return differences;
  differences.reserve(samples.size() - 2);
  for (std::size_t i = 1; i + 1 < samples.size(); ++i) {
    // As a difference of increments, which are smaller than the displacements themselves.
    const double after = samples[i + 1] - samples[i];
    const double before = samples[i] - samples[i - 1];
    differences.push_back((after - before) / (interval * interval));
  }
  return differences;
}

std::vector<double> running_rms(std::span<const double> samples, std::size_t half_length) {
  std::vector<double> values(samples.size());
  // Good to ε·n·(largest/least)²: nine digits where a burst is a thousand times the quiet before
  // it.
  std::vector<double> sums(samples.size() + 1, 0.0);
  for (std::size_t i = 0; i < samples.size(); ++i) sums[i + 1] = sums[i] + samples[i] * samples[i];
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::size_t begin = i > half_length ? i - half_length : 0;
    const std::size_t end = std::min(samples.size(), i + half_length + 1);
    values[i] =
        std::sqrt(std::max(0.0, sums[end] - sums[begin]) / static_cast<double>(end - begin));
  }
  return values;
}

double relative_error(std::span<const double> samples, std::span<const double> reference) {
  if (samples.size() != reference.size())
    throw std::invalid_argument("relative_error: the series differ in length");
  double difference = 0.0;
  double scale = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    difference += (samples[i] - reference[i]) * (samples[i] - reference[i]);
    scale += reference[i] * reference[i];
  }
  return scale > 0.0 ? std::sqrt(difference / scale) : unknown;
}

ReferenceRun::ReferenceRun(const SampledRun& run, const NormParameters& parameters)
    : parameters_(parameters),
      interval_(run.interval),
      num_samples_(run.displacement.size()),
      num_contacts_(run.forces.size()) {
  signals_ = signals_of(run);
}

ReferenceRun::Signals ReferenceRun::signals_of(const SampledRun& run) const {
  Signals signals;
  if (run.displacement.size() != num_samples_ || num_samples_ < 3) return signals;
  const IndexRange inside = samples_in(parameters_.window, 0.0, interval_, num_samples_);
  for (const std::vector<double>& force : run.forces) {
    const auto part = inside.of(force);
    signals.forces.insert(signals.forces.end(), part.begin(), part.end());
  }
  const std::vector<double> acceleration =
      band_pass(second_differences(run.displacement, interval_), interval_, parameters_.band);
  const auto half_length =
      static_cast<std::size_t>(std::lround(0.5 * parameters_.smoothing / interval_));
  const std::vector<double> envelope = running_rms(acceleration, half_length);
  const IndexRange inner =
      samples_in(parameters_.window, interval_, interval_, acceleration.size());
  const auto part_of = [&](const std::vector<double>& series) {
    const auto part = inner.of(series);
    return std::vector<double>(part.begin(), part.end());
  };
  signals.acceleration = part_of(acceleration);
  signals.envelope = part_of(envelope);
  return signals;
}

RunErrors ReferenceRun::errors_of(const SampledRun& run) const {
  if (run.interval != interval_)
    throw std::invalid_argument("ReferenceRun: the run is sampled at another interval");
  if (run.forces.size() != num_contacts_)
    throw std::invalid_argument("ReferenceRun: the run has another number of contacts");
  const auto is_finite = [](const std::vector<double>& series) {
    return std::all_of(series.begin(), series.end(), [](double x) { return std::isfinite(x); });
  };
  const bool is_whole = run.displacement.size() == num_samples_ && is_finite(run.displacement);
  if (!is_whole) return {unknown, unknown, unknown};
  const Signals signals = signals_of(run);
  return {relative_error(signals.forces, signals_.forces),
          relative_error(signals.acceleration, signals_.acceleration),
          relative_error(signals.envelope, signals_.envelope)};
}

double log_log_slope(std::span<const double> x, std::span<const double> y) {
  if (x.size() != y.size())
    throw std::invalid_argument("log_log_slope: the series differ in length");
  std::vector<double> u;
  std::vector<double> v;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!is_usable(x[i]) || !is_usable(y[i])) continue;
    u.push_back(std::log(x[i]));
    v.push_back(std::log(y[i]));
  }
  if (u.empty()) return unknown;
  double mean_u = 0.0;
  double mean_v = 0.0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    mean_u += u[i] / static_cast<double>(u.size());
    mean_v += v[i] / static_cast<double>(u.size());
  }
  double spread = 0.0;
  double product = 0.0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    spread += (u[i] - mean_u) * (u[i] - mean_u);
    product += (u[i] - mean_u) * (v[i] - mean_v);
  }
  const bool is_one_place =
      std::all_of(u.begin(), u.end(), [&](double value) { return value == u.front(); });
  return is_one_place ? unknown : product / spread;
}

std::vector<bool> pareto_front(std::span<const double> cost, std::span<const double> error) {
  if (cost.size() != error.size())
    throw std::invalid_argument("pareto_front: the series differ in length");
  std::vector<bool> is_on_front(cost.size(), false);
  for (std::size_t i = 0; i < cost.size(); ++i) {
    if (!std::isfinite(error[i]) || !std::isfinite(cost[i])) continue;
    bool is_beaten = false;
    for (std::size_t j = 0; j < cost.size() && !is_beaten; ++j) {
      is_beaten =
          cost[j] <= cost[i] && error[j] <= error[i] && (cost[j] < cost[i] || error[j] < error[i]);
    }
    is_on_front[i] = !is_beaten;
  }
  return is_on_front;
}

}  // namespace stridor
