// Distance between two runs of a system, and choice of the setting that is worth its time.
#pragma once

#include <span>
#include <vector>

#include "analysis/band_pass.hpp"
#include "analysis/statistics.hpp"

namespace stridor {

/// Bare values of a run at common instants: sample i is at i·interval.
struct SampledRun {
  double interval = 0.0;                    ///< s
  std::vector<double> displacement;         ///< of the observed point, m
  std::vector<std::vector<double>> forces;  ///< per contact, N; as many samples each
};

/// Window, band and averaging length of the error norms of a run.
struct NormParameters {
  Window window;              ///< s
  Band band;                  ///< Hz, of the acceleration
  double smoothing = 1.0e-2;  ///< s, length over which the envelope averages
};

/// Relative errors of a run; NaN where it is too short, or where nothing moves in the reference.
struct RunErrors {
  double force;         ///< contact forces
  double acceleration;  ///< within the band; phase counts
  double envelope;      ///< r.m.s. envelope of that; phase does not count
};

/// Second differences of a series, (x_{i−1} − 2 x_i + x_{i+1})/dt², one value for every inner
/// sample.
/// @param interval dt in s, positive
/// @return two values less than samples, none for fewer than three
std::vector<double> second_differences(std::span<const double> samples, double interval);

/// Running r.m.s. value over 2 H + 1 samples about each, over those that there are near the ends.
/// @param half_length H
std::vector<double> running_rms(std::span<const double> samples, std::size_t half_length);

/// (Σ (x_i − y_i)²/Σ y_i²)^½; NaN where Σ y_i² is 0 or there is no sample.
/// @param samples, reference x and y, of equal length
/// @throws std::invalid_argument if the lengths differ
double relative_error(std::span<const double> samples, std::span<const double> reference);

/// The run that others are measured against. With ‖·‖ over the samples of the window:
///
///   force         (Σ_c ‖λ_c − λ_c,ref‖²/Σ_c ‖λ_c,ref‖²)^½ over the contacts c
///   acceleration  ‖a − a_ref‖/‖a_ref‖, a the band_pass() of second_differences() of the
///   displacement envelope      ‖e − e_ref‖/‖e_ref‖, e the running_rms() of a over `smoothing`
class ReferenceRun {
 public:
  /// @throws std::invalid_argument as band_pass()
  ReferenceRun(const SampledRun& run, const NormParameters& parameters);

  /// @param run sampled at the same interval
  /// @throws std::invalid_argument if interval or number of contacts differ
  RunErrors errors_of(const SampledRun& run) const;

 private:
  struct Signals {
    std::vector<double> forces;  ///< of all contacts, one after the other
    std::vector<double> acceleration;
    std::vector<double> envelope;
  };
  /// The signals within the window; empty unless the run is as long as the reference.
  Signals signals_of(const SampledRun& run) const;

  NormParameters parameters_;
  double interval_;
  std::size_t num_samples_;
  std::size_t num_contacts_;
  Signals signals_;
};

/// Slope of the line log y = a + b log x of least squares through the points.
///
///   b = Σ (u − ū)(v − v̄)/Σ (u − ū)²,  u = log x, v = log y
///
/// @param x, y of equal length; points that are not positive and finite are left out
/// @return NaN unless two points with different x are left
/// @throws std::invalid_argument if the lengths differ
double log_log_slope(std::span<const double> x, std::span<const double> y);

/// Which of several settings no other beats: none costs at most as much with at most the error, and
/// less in one of the two.
/// @param cost, error of equal length; a setting without a finite error is never on the front
/// @throws std::invalid_argument if the lengths differ
std::vector<bool> pareto_front(std::span<const double> cost, std::span<const double> error);

}  // namespace stridor
