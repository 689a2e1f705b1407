#include "analysis/spectrogram.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

#include "core/fft_plan.hpp"
#include "core/schema.hpp"

namespace stridor {
namespace {

// A signal cut into windowed pieces, each with its amplitudes.
class Pieces {
 public:
  Pieces(const char* caller, std::span<const double> samples, double interval,
         const SpectrogramParameters& parameters)
      : samples_(samples),
        window_(checked_window(caller, samples, interval, parameters)),
        fft_(parameters.length) {
    const double n = static_cast<double>(parameters.length);
    hop_ = static_cast<std::size_t>(std::llround(n * (1.0 - parameters.overlap)));
    count_ = 1 + (samples.size() - parameters.length) / hop_;

    double squares = 0.0;
    double moment = 0.0;
    for (std::size_t i = 0; i < window_.size(); ++i) {
      sum_ += window_[i];
      squares += window_[i] * window_[i];
      moment += static_cast<double>(i) * window_[i];
    }
    centre_ = moment / sum_;
    noise_bandwidth_ = squares / (sum_ * sum_ * interval);
  }

  std::size_t count() const { return count_; }
  std::size_t num_lines() const { return window_.size() / 2 + 1; }
  double noise_bandwidth() const { return noise_bandwidth_; }
  bool ends_at_nyquist() const { return window_.size() % 2 == 0; }
  // In samples from the first of the signal.
  double centre(std::size_t piece) const { return static_cast<double>(piece * hop_) + centre_; }

  std::vector<double> frequencies(double interval) const {
    std::vector<double> result(num_lines());
    const double n = static_cast<double>(window_.size());
    for (std::size_t k = 0; k < result.size(); ++k) {
      result[k] = static_cast<double>(k) / (n * interval);
    }
    return result;
  }

  void amplitudes(std::size_t piece, std::span<double> result) {
    const auto input = fft_.input();
    const auto part = samples_.subspan(piece * hop_, window_.size());
    for (std::size_t i = 0; i < part.size(); ++i) input[i] = window_[i] * part[i];
    fft_.execute();
    const auto lines = fft_.output();
    for (std::size_t k = 0; k < lines.size(); ++k) result[k] = 2.0 / sum_ * std::abs(lines[k]);
    result.front() *= 0.5;
    if (ends_at_nyquist()) result.back() *= 0.5;
  }

 private:
  static std::vector<double> checked_window(const char* caller, std::span<const double> samples,
                                            double interval,
                                            const SpectrogramParameters& parameters) {
    if (!(interval > 0.0) || !std::isfinite(interval)) {
      throw std::invalid_argument(
          fmt::format("{}: the sampling interval must be positive and finite", caller));
    }
    if (parameters.length < 2) {
      throw std::invalid_argument(fmt::format("{}: the window must have at least 2 samples, not {}",
                                              caller, parameters.length));
    }
    const double n = static_cast<double>(parameters.length);
    if (!(parameters.overlap >= 0.0 && parameters.overlap < 1.0 &&
          std::llround(n * (1.0 - parameters.overlap)) >= 1)) {
      throw std::invalid_argument(fmt::format(
          "{}: the overlap {:g} is not 0 to {:.10g} (a window of {} samples moved on by "
          "at least one)",
          caller, parameters.overlap, 1.0 - 1.0 / n, parameters.length));
    }
    if (samples.size() < parameters.length) {
      throw std::invalid_argument(
          fmt::format("{}: the signal of {} samples ({:g} s) is shorter than one window of {} "
                      "samples ({:g} s)",
                      caller, samples.size(), static_cast<double>(samples.size()) * interval,
                      parameters.length, n * interval));
    }
    if (!std::all_of(samples.begin(), samples.end(), [](double x) { return std::isfinite(x); })) {
      throw std::invalid_argument(fmt::format("{}: the samples must be finite", caller));
    }
    return make_window(parameters.window, parameters.length);
  }

  std::span<const double> samples_;
  std::vector<double> window_;
  RealFft fft_;
  std::size_t hop_ = 1;
  std::size_t count_ = 0;
  double sum_ = 0.0;
  double centre_ = 0.0;
  double noise_bandwidth_ = 0.0;
};

// S = weight·A²/B.
double density_weight(std::size_t line, std::size_t num_lines, bool ends_at_nyquist) {
  return line == 0 || (ends_at_nyquist && line + 1 == num_lines) ? 1.0 : 0.5;
}

}  // namespace

const std::vector<std::pair<std::string, WindowKind>>& window_names() {
  static const std::vector<std::pair<std::string, WindowKind>> names{
      {"hann", WindowKind::hann},
      {"blackman_harris", WindowKind::blackman_harris},
      {"rectangular", WindowKind::rectangular}};
  return names;
}

std::string window_name(WindowKind kind) {
  return word_of(window_names(), kind);
}

std::size_t main_lobe_lines(WindowKind kind) {
  switch (kind) {
    case WindowKind::hann:
      return 2;
    case WindowKind::blackman_harris:
      return 4;
    case WindowKind::rectangular:
      break;
  }
  return 1;
}

std::vector<double> make_window(WindowKind kind, std::size_t length) {
  if (length < 2) {
    throw std::invalid_argument(
        fmt::format("make_window: the window must have at least 2 samples, not {}", length));
  }
  std::vector<double> window(length);
  for (std::size_t i = 0; i < length; ++i) {
    const double x = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(length);
    switch (kind) {
      case WindowKind::hann:
        window[i] = 0.5 - 0.5 * std::cos(x);
        break;
      case WindowKind::blackman_harris:
        window[i] = 0.35875 - 0.48829 * std::cos(x) + 0.14128 * std::cos(2.0 * x) -
                    0.01168 * std::cos(3.0 * x);
        break;
      case WindowKind::rectangular:
        window[i] = 1.0;
        break;
    }
  }
  return window;
}

Spectrogram make_spectrogram(std::span<const double> samples, double interval,
                             const SpectrogramParameters& parameters, double first) {
  if (!std::isfinite(first)) {
    throw std::invalid_argument("make_spectrogram: the time of the first sample must be finite");
  }
  Pieces pieces("make_spectrogram", samples, interval, parameters);
  Spectrogram result;
  result.frequencies = pieces.frequencies(interval);
  result.noise_bandwidth = pieces.noise_bandwidth();
  result.ends_at_nyquist = pieces.ends_at_nyquist();
  result.times.resize(pieces.count());
  result.amplitude.resize(static_cast<Eigen::Index>(pieces.num_lines()),
                          static_cast<Eigen::Index>(pieces.count()));
  for (std::size_t j = 0; j < pieces.count(); ++j) {
    result.times[j] = first + pieces.centre(j) * interval;
    pieces.amplitudes(
        j, {result.amplitude.col(static_cast<Eigen::Index>(j)).data(), pieces.num_lines()});
  }
  return result;
}

Spectrum make_spectrum(std::span<const double> samples, double interval,
                       const SpectrogramParameters& parameters) {
  Pieces pieces("make_spectrum", samples, interval, parameters);
  Spectrum result;
  result.frequencies = pieces.frequencies(interval);
  result.noise_bandwidth = pieces.noise_bandwidth();
  result.ends_at_nyquist = pieces.ends_at_nyquist();
  result.num_pieces = pieces.count();
  result.amplitude.assign(pieces.num_lines(), 0.0);
  std::vector<double> piece(pieces.num_lines());
  for (std::size_t j = 0; j < pieces.count(); ++j) {
    pieces.amplitudes(j, piece);
    for (std::size_t k = 0; k < piece.size(); ++k) result.amplitude[k] += piece[k] * piece[k];
  }
  for (double& a : result.amplitude) a = std::sqrt(a / static_cast<double>(pieces.count()));
  return result;
}

Eigen::MatrixXd power_spectral_density(const Spectrogram& spectrogram) {
  Eigen::MatrixXd density = spectrogram.amplitude.array().square() / spectrogram.noise_bandwidth;
  const Eigen::Index num_lines = density.rows();
  for (Eigen::Index k = 0; k < num_lines; ++k) {
    density.row(k) *=
        density_weight(static_cast<std::size_t>(k), static_cast<std::size_t>(num_lines),
                       spectrogram.ends_at_nyquist);
  }
  return density;
}

std::vector<double> power_spectral_density(const Spectrum& spectrum) {
  const std::size_t num_lines = spectrum.amplitude.size();
  std::vector<double> density(num_lines);
  for (std::size_t k = 0; k < num_lines; ++k) {
    density[k] = density_weight(k, num_lines, spectrum.ends_at_nyquist) * spectrum.amplitude[k] *
                 spectrum.amplitude[k] / spectrum.noise_bandwidth;
  }
  return density;
}

double decibels(double value, double reference) {
  if (!(value >= 0.0)) {
    throw std::invalid_argument(fmt::format("decibels: the amplitude {:g} is negative", value));
  }
  if (!(reference > 0.0) || !std::isfinite(reference)) {
    throw std::invalid_argument(
        fmt::format("decibels: the reference {:g} is not positive and finite", reference));
  }
  return 20.0 * std::log10(value / reference);
}

double standard_reference(const std::string& units) {
  if (units == "m/s^2" || units == "N") return 1e-6;
  if (units == "m/s") return 1e-9;
  if (units == "m") return 1e-12;
  return 1.0;
}

}  // namespace stridor
