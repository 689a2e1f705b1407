#include "analysis/low_pass.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/clones.hpp"

namespace stridor {
namespace {

constexpr double attenuation_db = 80.0;
constexpr int largest_ratio = 100000;

// Modified Bessel function I₀ by its power series, which has positive terms only and so is
// accurate.
long double bessel_i0(long double x) {
  const long double quarter = x * x / 4.0L;
  long double term = 1.0L;
  long double sum = 1.0L;
  for (int k = 1; term > 1e-22L * sum; ++k) {
    term *= quarter / (static_cast<long double>(k) * static_cast<long double>(k));
    sum += term;
  }
  return sum;
}

// One half of the taps, [0] in the middle; sum over both halves is 1. Long double, because the
// derivatives below are differences of neighbouring taps.
std::vector<long double> low_pass_half(int ratio) {
  // Kaiser's formulas for length and shape; Δf = (0.6 − 0.4)/ratio in cycles per input sample.
  const double transition = 0.2 / ratio;
  const double beta = 0.1102 * (attenuation_db - 8.7);
  const int half =
      static_cast<int>(std::ceil((attenuation_db - 7.95) / (14.36 * transition) / 2.0));
  const long double cutoff = 0.5L / static_cast<long double>(ratio);
  const long double pi = std::numbers::pi_v<long double>;

  std::vector<long double> taps(static_cast<std::size_t>(half) + 1);
  long double sum = 0.0L;
  for (std::size_t k = taps.size(); k-- > 0;) {
    const auto x = static_cast<long double>(k);
    const long double edge = x / static_cast<long double>(half);
    const long double sinc = k == 0 ? 2.0L * cutoff : std::sin(2.0L * pi * cutoff * x) / (pi * x);
    taps[k] = sinc * bessel_i0(static_cast<long double>(beta) * std::sqrt(1.0L - edge * edge));
    sum += k == 0 ? taps[k] : 2.0L * taps[k];
  }
  for (long double& tap : taps) tap /= sum;
  return taps;
}

// Σ tᵢ (xᵢ − x₀) in 16 partial sums that the language keeps apart: enough to hide the latency of
// the additions, and a fixed order of summation.
STRIDOR_CLONES
double weighted_sum(const double* taps, const double* samples, double middle, std::size_t count) {
  constexpr std::size_t lanes = 16;
  double partial[lanes] = {};
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    for (std::size_t j = 0; j < lanes; ++j) partial[j] += taps[i + j] * (samples[i + j] - middle);
  }
  double sum = 0.0;
  for (; i < count; ++i) sum += taps[i] * (samples[i] - middle);
  for (std::size_t j = 0; j < lanes; ++j) sum += partial[j];
  return sum;
}

}  // namespace

DecimationFilter::DecimationFilter(double input_interval, int ratio)
    : input_interval_(input_interval), ratio_(ratio), half_length_(0) {
  if (!(input_interval > 0.0) || !std::isfinite(input_interval)) {
    throw std::invalid_argument("DecimationFilter: the input interval must be positive and finite");
  }
  if (ratio < 1 || ratio > largest_ratio) {
    throw std::invalid_argument(
        fmt::format("DecimationFilter: the ratio must be 1 to {}, not {}", largest_ratio, ratio));
  }
  const std::vector<long double> half =
      ratio == 1 ? std::vector<long double>{1.0L} : low_pass_half(ratio);
  const int stencil_half = std::max(2, ratio);
  half_length_ = static_cast<int>(half.size()) - 1 + stencil_half;

  const auto low_pass = [&half](int k) {
    const auto distance = static_cast<std::size_t>(std::abs(k));
    return distance < half.size() ? half[distance] : 0.0L;
  };
  const auto h = static_cast<long double>(input_interval);
  for (auto& taps : taps_) taps.resize(2 * static_cast<std::size_t>(half_length_) + 1);
  for (int k = -half_length_; k <= half_length_; ++k) {
    const auto i = static_cast<std::size_t>(k + half_length_);
    const long double near = low_pass(k - 1) - low_pass(k + 1);
    const long double far = low_pass(k - 2) - low_pass(k + 2);
    // (x₋₂ − 8x₋₁ + 8x₁ − x₂)/12h at the input interval h and (x₋₁ − 2x₀ + x₁)/(ratio·h)² at the
    // output interval, convolved with the taps.
    const long double bend = low_pass(k - ratio) + low_pass(k + ratio) - 2.0L * low_pass(k);
    taps_[0][i] = static_cast<double>(low_pass(k));
    taps_[1][i] = static_cast<double>((8.0L * near - far) / (12.0L * h));
    taps_[2][i] = static_cast<double>(
        bend / (static_cast<long double>(ratio) * h * static_cast<long double>(ratio) * h));
  }
}

std::string DecimationFilter::description() const {
  if (ratio_ == 1) return "none";
  return fmt::format(
      "linear phase, Kaiser-windowed sinc of {} taps, pass band to {:.6g} Hz, stop band from "
      "{:.6g} Hz, "
      "{:.0f} dB",
      2 * (half_length_ - 2) + 1, 0.4 / output_interval(), 0.6 / output_interval(), attenuation_db);
}

double DecimationFilter::apply(std::span<const double> window, Derivative derivative) const {
  const std::span<const double> weights = taps(derivative);
  if (window.size() != weights.size()) {
    throw std::invalid_argument(fmt::format(
        "DecimationFilter: the window has {} samples, expected {}", window.size(), weights.size()));
  }
  const double middle = window[static_cast<std::size_t>(half_length_)];
  const double sum = weighted_sum(weights.data(), window.data(), middle, weights.size());
  return derivative == Derivative::none ? middle + sum : sum;
}

Decimator::Decimator(std::shared_ptr<const DecimationFilter> filter) : filter_(std::move(filter)) {
  if (!filter_) throw std::invalid_argument("Decimator: no filter");
  // Room for one more window, so that moving the window back to the front costs little per sample.
  buffer_.resize(2 * window_length() + static_cast<std::size_t>(filter_->ratio()));
}

bool Decimator::due() {
  const auto half = static_cast<std::size_t>(latency());
  if (!started_) {
    started_ = true;
    const double first = buffer_[end_ - 1];
    std::fill_n(buffer_.begin(), half + 1, first);
    end_ = half + 1;
    until_due_ = latency();  // at least 2: the stencil
    return false;
  }
  const auto ratio = static_cast<std::size_t>(filter_->ratio());
  if (end_ + ratio > buffer_.size()) {
    const auto begin = buffer_.begin() + static_cast<std::ptrdiff_t>(end_ - window_length());
    std::copy(begin, begin + static_cast<std::ptrdiff_t>(window_length()), buffer_.begin());
    end_ = window_length();
  }
  until_due_ = filter_->ratio();
  ++num_outputs_;
  return true;
}

double Decimator::sample() const {
  if (num_outputs_ == 0) throw std::invalid_argument("Decimator: no output is due yet");
  return buffer_[end_ - 1 - static_cast<std::size_t>(latency())];
}

double Decimator::value(Derivative derivative) const {
  if (num_outputs_ == 0) throw std::invalid_argument("Decimator: no output is due yet");
  return filter_->apply({buffer_.data() + (end_ - window_length()), window_length()}, derivative);
}

void Decimator::save(State& state, const std::string& prefix) const {
  const std::size_t kept = std::min(end_, window_length());
  state.put(prefix + "/window", std::span<const double>(buffer_).subspan(end_ - kept, kept));
  state.put(prefix + "/until_due", static_cast<double>(until_due_));
  state.put(prefix + "/num_outputs", static_cast<double>(num_outputs_));
  state.put(prefix + "/ratio", static_cast<double>(filter_->ratio()));
  state.put(prefix + "/input_interval", filter_->input_interval());
}

void Decimator::load(const State& state, const std::string& prefix) {
  const std::vector<double>& window = state.array(prefix + "/window");
  const double until_due = state.get(prefix + "/until_due");
  const double num_outputs = state.get(prefix + "/num_outputs");
  if (state.get(prefix + "/ratio") != static_cast<double>(filter_->ratio()) ||
      state.get(prefix + "/input_interval") != filter_->input_interval()) {
    throw std::invalid_argument("Decimator: state '" + prefix + "' comes from another filter");
  }
  const int longest_wait = std::max(latency(), filter_->ratio());
  const bool started = !window.empty();
  // A window that is not full yet must be so when the next output is due.
  const bool in_time = started ? static_cast<double>(window.size()) + until_due >=
                                     static_cast<double>(window_length())
                               : until_due == 1.0 && num_outputs == 0.0;
  if (window.size() > window_length() || !in_time ||
      !(until_due >= 1.0 && until_due <= longest_wait) || !(num_outputs >= 0.0)) {
    throw std::invalid_argument("Decimator: state '" + prefix + "' is damaged");
  }
  std::copy(window.begin(), window.end(), buffer_.begin());
  end_ = window.size();
  until_due_ = static_cast<std::int64_t>(until_due);
  num_outputs_ = static_cast<std::int64_t>(num_outputs);
  started_ = started;
}

}  // namespace stridor
