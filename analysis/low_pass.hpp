// Linear-phase low-pass filter and decimation of sample streams, with their time derivatives.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/state.hpp"

namespace stridor {

/// Which time derivative of the low-passed input is asked for.
enum class Derivative { none, first, second };

/// Symmetric taps that low-pass a stream, and differentiate it, before it is thinned by `ratio`.
///
/// Kaiser-windowed sinc with the edges
///
///     pass band  f ≤ 0.4 / dt_out,   stop band  f ≥ 0.6 / dt_out,   80 dB,   dt_out = ratio·dt_in,
///
/// of odd length 2H+1. Content that folds back into the pass band lies above 0.6 / dt_out and so is
/// 80 dB down; content that folds onto 0.4…0.5 / dt_out is not, so the thinned signal is clean up
/// to 0.4 / dt_out. The first derivative convolves these taps with the 5-point central difference
/// at dt_in, whose relative error is (ω dt_in)⁴/30: at the edge of the pass band 8·10⁻⁶ for
/// ratio 50, 1.3·10⁻⁴ for ratio 10. The second derivative is the second difference of the thinned
/// signal,
///
///     (x(t + dt_out) − 2 x(t) + x(t − dt_out)) / dt_out²,
///
/// the acceleration that one would form from recorded displacements; it is low by the factor
/// (sin(ω dt_out/2)/(ω dt_out/2))², 3.6 % at a tenth of the output rate.
///
/// With ratio 1 there is no filter: `none` passes the samples through, derivatives are the bare
/// stencils. All three sets of taps have the same H (shorter ones are padded with zeros), so that
/// one buffer serves them all.
///
/// Immutable after construction; one object is meant to be shared by all channels of a run.
class DecimationFilter {
 public:
  /// @param input_interval dt_in in s, positive and finite
  /// @param ratio          dt_out / dt_in, 1 … 100000
  /// @throws std::invalid_argument if one of them is out of range
  DecimationFilter(double input_interval, int ratio);

  double input_interval() const { return input_interval_; }
  double output_interval() const { return input_interval_ * ratio_; }
  int ratio() const { return ratio_; }
  /// H in input samples: the output for an input sample is known H samples after it.
  int half_length() const { return half_length_; }
  /// The 2H+1 taps, in units of 1, 1/s, 1/s²; applied as a correlation (first tap: oldest sample).
  std::span<const double> taps(Derivative derivative) const {
    return taps_[static_cast<std::size_t>(derivative)];
  }
  /// One line for the attribute `filter` of a recorded channel.
  std::string description() const;

  /// Filtered value, or its derivative, at the middle of a window of 2H+1 samples, oldest first.
  ///
  /// Evaluated as g·x₀ + Σ tᵢ (xᵢ − x₀) with the middle sample x₀ and g = 1 (none) or 0
  /// (derivatives): a constant comes out exactly, whatever the rounding of the taps, and a large
  /// offset costs no accuracy. The order of summation is fixed, so the result depends on the
  /// samples only, not on where they lie in memory.
  ///
  /// Cost: 2H+1 multiply-adds, vectorised.
  double apply(std::span<const double> window, Derivative derivative) const;

 private:
  double input_interval_;
  int ratio_;
  int half_length_;
  std::array<std::vector<double>, 3> taps_;
};

/// Thins one scalar stream: filtered values and derivatives of every `ratio`-th sample.
///
///     Decimator tip(filter);
///     if (tip.push(displacement)) record(tip.value(Derivative::none),
///     tip.value(Derivative::second));
///
/// Output k belongs to input sample k·ratio, k = 0, 1, …; it is due when latency() further samples
/// have come in. Before the first sample the stream is taken to have been at rest at the value of
/// the first sample. The last latency() inputs of a run therefore get no output of their own: a run
/// that needs them goes on for that many steps.
///
/// A push that yields no output costs one store and one counter. The buffer is allocated at
/// construction; nothing is allocated later.
class Decimator {
 public:
  /// @throws std::invalid_argument if there is no filter
  explicit Decimator(std::shared_ptr<const DecimationFilter> filter);

  /// Takes the next input sample. @return whether output number `num_outputs() - 1` is now due
  bool push(double sample) {
    buffer_[end_++] = sample;
    if (--until_due_ > 0) return false;
    return due();
  }

  /// The output that is due, valid from a push() that returned true until the next push().
  ///
  /// Any number of derivatives may be asked for; each costs one pass over the window.
  double value(Derivative derivative) const;
  /// The unfiltered input sample of the due output, for quantities that must not be filtered
  /// (states, energies) but are recorded with filtered values of the same instant. Valid as
  /// value().
  double sample() const;

  /// Input samples that must follow a sample before its output is known.
  int latency() const { return filter_->half_length(); }
  /// Outputs that have become due so far.
  std::int64_t num_outputs() const { return num_outputs_; }

  /// Stores the window and the counters under `prefix`. After load() the filter resumes
  /// bit-identically to an uninterrupted run.
  void save(State& state, const std::string& prefix) const;
  /// @throws std::invalid_argument if an array is missing or comes from another filter; this object
  ///         is unchanged then.
  void load(const State& state, const std::string& prefix);

 private:
  bool due();
  std::size_t window_length() const { return 2 * static_cast<std::size_t>(latency()) + 1; }

  std::shared_ptr<const DecimationFilter> filter_;
  std::vector<double> buffer_;  // the last window_length() samples end at end_
  std::size_t end_ = 0;
  std::int64_t until_due_ = 1;  // pushes until due() has something to do
  std::int64_t num_outputs_ = 0;
  bool started_ = false;
};

}  // namespace stridor
