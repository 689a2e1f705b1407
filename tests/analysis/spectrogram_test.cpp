#include "analysis/spectrogram.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "tests/support/constants.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/rejection.hpp"

namespace stridor {
namespace {

using test::expect_rejection;
using test::noise;

using test::two_pi;
constexpr double signal_dt = 1.0e-4;
constexpr auto all_windows = {WindowKind::hann, WindowKind::blackman_harris,
                              WindowKind::rectangular};

std::vector<double> sine(double amplitude, double frequency, std::size_t count) {
  std::vector<double> samples(count);
  for (std::size_t i = 0; i < count; ++i) {
    samples[i] =
        amplitude * std::sin(two_pi * frequency * static_cast<double>(i) * signal_dt + 0.7);
  }
  return samples;
}

TEST(Spectrogram, SineOnALineHasItsAmplitudeThere) {
  // Line 50 of 500 samples: 1 kHz. Even and odd lengths; the lines of a window's main lobe aside,
  // all others are rounding for a cosine-sum window.
  for (const WindowKind kind : all_windows) {
    for (const std::size_t n : {500U, 501U}) {
      const double frequency = 50.0 / (static_cast<double>(n) * signal_dt);
      const Spectrogram s = make_spectrogram(sine(2.5, frequency, 1600), signal_dt, {kind, n, 0.5});
      ASSERT_EQ(s.frequencies.size(), n / 2 + 1);
      ASSERT_EQ(s.amplitude.rows(), static_cast<Eigen::Index>(n / 2 + 1));
      ASSERT_EQ(s.amplitude.cols(), static_cast<Eigen::Index>(s.times.size()));
      EXPECT_NEAR(s.frequencies[50], frequency, 1e-9);
      for (Eigen::Index j = 0; j < s.amplitude.cols(); ++j) {
        EXPECT_NEAR(s.amplitude(50, j), 2.5, 1e-12);
        EXPECT_NEAR(s.amplitude(100, j), 0.0, 1e-12);
        EXPECT_NEAR(s.amplitude(0, j), 0.0, 1e-12);
      }
    }
  }
}

TEST(Spectrogram, SineBetweenLinesLosesAtMostTheScallopingOfTheWindow) {
  // Half-way the loss is the ratio |W(½)|/|W(0)| of the window's own transform, in closed form
  // Σ a_j-weighted Dirichlet kernels; for many samples 8/(3π), 0.9089 and 2/π. The image at the
  // negative frequency, 100 lines away, adds less than its side lobes: 1/(π·100) for rectangular.
  const struct {
    WindowKind kind;
    double loss;
    double image;
  } cases[] = {{WindowKind::hann, 8.0 / (3.0 * std::numbers::pi), 1e-5},
               {WindowKind::blackman_harris, std::pow(10.0, -0.8256 / 20.0), 3e-5},
               {WindowKind::rectangular, 2.0 / std::numbers::pi, 4e-3}};
  for (const auto& c : cases) {
    const Spectrum s =
        make_spectrum(sine(1.0, 50.5 / (1000.0 * signal_dt), 1000), signal_dt, {c.kind, 1000, 0.0});
    EXPECT_NEAR(s.amplitude[50], c.loss, c.image + 1e-5);
    EXPECT_NEAR(s.amplitude[51], c.loss, c.image + 1e-5);
    for (const double part : {0.1, 0.25, 0.4}) {
      const Spectrum t = make_spectrum(sine(1.0, (50.0 + part) / (1000.0 * signal_dt), 1000),
                                       signal_dt, {c.kind, 1000, 0.0});
      EXPECT_GE(t.amplitude[50], c.loss - c.image);
      EXPECT_LE(t.amplitude[50], 1.0 + c.image);
    }
  }
}

TEST(Spectrogram, ConstantAndNyquistReadTheirAmplitudeOnce) {
  std::vector<double> samples(64);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = -1.5 + (i % 2 == 0 ? 0.5 : -0.5);
  for (const WindowKind kind : all_windows) {
    const Spectrum s = make_spectrum(samples, signal_dt, {kind, 32, 0.5});
    EXPECT_TRUE(s.ends_at_nyquist);
    EXPECT_EQ(s.num_pieces, 3U);
    EXPECT_NEAR(s.amplitude.front(), 1.5, 1e-14);
    EXPECT_NEAR(s.amplitude.back(), 0.5, 1e-14);
    EXPECT_NEAR(s.frequencies.back(), 0.5 / signal_dt, 1e-9);
  }
  EXPECT_FALSE(make_spectrum(samples, signal_dt, {WindowKind::hann, 33, 0.0}).ends_at_nyquist);
}

TEST(Spectrogram, TimesAreTheCentresOfTheWindows) {
  const Spectrogram hann =
      make_spectrogram(noise(1000), signal_dt, {WindowKind::hann, 100, 0.75}, 2.0);
  ASSERT_EQ(hann.times.size(), 37U);  // 1 + 900/25
  EXPECT_NEAR(hann.times.front(), 2.0 + 50.0 * signal_dt, 1e-14);
  EXPECT_NEAR(hann.times.back(), 2.0 + 950.0 * signal_dt, 1e-14);
  const Spectrogram flat =
      make_spectrogram(noise(1024), signal_dt, {WindowKind::rectangular, 100, 0.0});
  ASSERT_EQ(flat.times.size(), 10U);
  EXPECT_NEAR(flat.times.front(), 49.5 * signal_dt, 1e-14);
  EXPECT_EQ(make_spectrogram(noise(100), signal_dt, {WindowKind::hann, 100, 0.5}).times.size(), 1U);
}

TEST(Spectrogram, AClickStandsInTheColumnOfItsTime) {
  std::vector<double> samples(1000);
  samples[500] = 1.0;
  const Spectrogram s = make_spectrogram(samples, signal_dt, {WindowKind::hann, 100, 0.99});
  Eigen::Index column = 0;
  s.amplitude.row(20).maxCoeff(&column);
  EXPECT_NEAR(s.times[static_cast<std::size_t>(column)], 500.0 * signal_dt, 1e-12);
}

TEST(Spectrogram, RidgeOfAChirpFollowsItsFrequency) {
  // 500 Hz + 2000 Hz/s: over a window of 20 ms the frequency moves 40 Hz, less than a line (50 Hz);
  // the column is symmetric about the frequency at its centre, so the highest line is the nearest,
  // at most 25 Hz off, and a Hann column's parabola is a few hertz off.
  std::vector<double> samples(10000);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double t = static_cast<double>(i) * signal_dt;
    samples[i] = std::cos(two_pi * (500.0 * t + 1000.0 * t * t));
  }
  const Spectrogram s = make_spectrogram(samples, signal_dt, {WindowKind::hann, 200, 0.5});
  for (std::size_t j = 0; j < s.times.size(); ++j) {
    Eigen::Index line = 0;
    s.amplitude.col(static_cast<Eigen::Index>(j)).maxCoeff(&line);
    EXPECT_NEAR(s.frequencies[static_cast<std::size_t>(line)], 500.0 + 2000.0 * s.times[j], 26.0);
  }
}

TEST(Spectrogram, DensityIntegratesToTheMeanSquareUnderTheWindow) {
  for (const WindowKind kind : all_windows) {
    for (const std::size_t n : {128U, 129U}) {
      const std::vector<double> samples = noise(3 * n);
      const std::vector<double> window = make_window(kind, n);
      const SpectrogramParameters parameters{kind, n, 0.0};
      const Spectrogram s = make_spectrogram(samples, signal_dt, parameters);
      const double resolution = 1.0 / (static_cast<double>(n) * signal_dt);
      const Eigen::MatrixXd density = power_spectral_density(s);
      ASSERT_EQ(density.cols(), 3);
      double mean = 0.0;
      for (std::size_t j = 0; j < 3; ++j) {
        double squares = 0.0;
        double weights = 0.0;
        for (std::size_t i = 0; i < n; ++i) {
          squares += std::pow(window[i] * samples[j * n + i], 2);
          weights += window[i] * window[i];
        }
        mean += squares / weights / 3.0;
        EXPECT_NEAR(density.col(static_cast<Eigen::Index>(j)).sum() * resolution, squares / weights,
                    1e-12);
      }
      // The average over the pieces, which for the rectangular window is the signal's mean square.
      double integral = 0.0;
      for (const double d : power_spectral_density(make_spectrum(samples, signal_dt, parameters))) {
        integral += d * resolution;
      }
      EXPECT_NEAR(integral, mean, 1e-12);
    }
  }
}

TEST(Spectrogram, WelchDensityOfWhiteNoiseIsItsVarianceOverTheBand) {
  // Variance 1 over 0 to 5 kHz: 2·10⁻⁴/Hz at every line. With about 400 independent pieces a line
  // scatters by 5 %; six of that over 100 lines.
  const Spectrum s = make_spectrum(noise(80000), signal_dt, {WindowKind::hann, 200, 0.5});
  const std::vector<double> density = power_spectral_density(s);
  for (std::size_t k = 3; k + 1 < density.size(); ++k) EXPECT_NEAR(density[k], 2e-4, 0.6e-4);
}

TEST(Spectrogram, RejectsWhatItCannotUse) {
  const std::vector<double> samples = noise(1000);
  const auto call = [&](double interval, const SpectrogramParameters& parameters) {
    return [&samples, interval, parameters] { make_spectrogram(samples, interval, parameters); };
  };
  const SpectrogramParameters good{WindowKind::hann, 100, 0.5};
  const double infinity = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double interval : {0.0, -1.0, infinity, nan}) {
    expect_rejection(call(interval, good), "the sampling interval must be positive and finite");
  }
  for (const std::size_t length : {0U, 1U}) {
    expect_rejection(call(signal_dt, {WindowKind::hann, length, 0.5}),
                     "must have at least 2 samples");
    expect_rejection([&] { make_window(WindowKind::hann, length); }, "at least 2 samples");
  }
  for (const double overlap : {-0.1, 0.996, 1.0, 2.0, infinity, nan}) {
    expect_rejection(call(signal_dt, {WindowKind::hann, 100, overlap}),
                     "is not 0 to 0.99 (a window of 100");
  }
  expect_rejection(call(signal_dt, {WindowKind::hann, 1001, 0.5}),
                   "the signal of 1000 samples (0.1 s) is shorter than one window of 1001 samples "
                   "(0.1001 s)");
  expect_rejection(
      [] {
        make_spectrum({}, signal_dt, {WindowKind::hann, 10, 0.5});
      },
      "make_spectrum: the signal of 0 samples");
  expect_rejection([&] { make_spectrogram(samples, signal_dt, good, nan); },
                   "time of the first sample");
  std::vector<double> broken = samples;
  broken[999] = nan;
  expect_rejection([&] { make_spectrogram(broken, signal_dt, good); },
                   "the samples must be finite");
  expect_rejection([&] { make_spectrum(broken, signal_dt, good); }, "the samples must be finite");
}

TEST(Spectrogram, WindowsHaveNamesAndMainLobes) {
  EXPECT_EQ(window_names().size(), 3U);
  for (const auto& [name, kind] : window_names()) EXPECT_EQ(window_name(kind), name);
  // A constant stands in the main lobe about 0 Hz and nowhere else, down to the side lobes.
  for (const WindowKind kind : all_windows) {
    const Spectrum s = make_spectrum(std::vector<double>(600, 1.0), signal_dt, {kind, 600, 0.0});
    const std::size_t lobe = main_lobe_lines(kind);
    EXPECT_GT(s.amplitude[lobe - 1], 1e-3);
    for (std::size_t k = lobe; k < s.amplitude.size(); ++k) EXPECT_NEAR(s.amplitude[k], 0.0, 1e-13);
  }
}

TEST(Decibels, ReferencesAreThoseOfTheStandard) {
  EXPECT_EQ(standard_reference("m/s^2"), 1e-6);
  EXPECT_EQ(standard_reference("m/s"), 1e-9);
  EXPECT_EQ(standard_reference("m"), 1e-12);
  EXPECT_EQ(standard_reference("N"), 1e-6);
  EXPECT_EQ(standard_reference("1"), 1.0);
}

TEST(Decibels, AreTwentyTimesTheLogarithmOfAnAmplitudeRatio) {
  EXPECT_NEAR(decibels(20.0, 2.0), 20.0, 1e-13);
  EXPECT_NEAR(decibels(1e-3, 1.0), -60.0, 1e-13);
  EXPECT_EQ(decibels(0.0, 1.0), -std::numeric_limits<double>::infinity());
  expect_rejection([] { decibels(-1.0, 1.0); }, "the amplitude -1 is negative");
  expect_rejection([] { decibels(std::nan(""), 1.0); }, "is negative");
  expect_rejection([] { decibels(1.0, 0.0); }, "the reference 0 is not positive");
  expect_rejection([] { decibels(1.0, -1.0); }, "is not positive");
}

}  // namespace
}  // namespace stridor
