#include "analysis/band_pass.hpp"
#include "tests/support/constants.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace stridor {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

using test::two_pi;
constexpr double filter_dt = 1.0e-5;
constexpr Band band{2.5e3, 15.0e3};

std::vector<double> filtered_sine(double frequency, std::size_t count, double phase = 0.4) {
  std::vector<double> samples(count);
  for (std::size_t i = 0; i < count; ++i) {
    samples[i] = std::sin(two_pi * frequency * static_cast<double>(i) * filter_dt + phase);
  }
  return samples;
}

// Largest |output − gain·input| away from the ends.
double deviation(const std::vector<double>& output, const std::vector<double>& input, double gain) {
  double largest = 0.0;
  for (std::size_t i = input.size() / 4; i < 3 * input.size() / 4; ++i) {
    largest = std::max(largest, std::abs(output[i] - gain * input[i]));
  }
  return largest;
}

TEST(BandPass, GainIsOneHalfAtTheEdgesAndOneAtTheCentre) {
  EXPECT_NEAR(band_pass_gain(band.lower, filter_dt, band), 0.5, 1e-13);
  EXPECT_NEAR(band_pass_gain(band.upper, filter_dt, band), 0.5, 1e-13);
  const double centre = std::atan(std::sqrt(std::tan(std::numbers::pi * band.lower * filter_dt) *
                                            std::tan(std::numbers::pi * band.upper * filter_dt))) /
                        (std::numbers::pi * filter_dt);
  EXPECT_NEAR(band_pass_gain(centre, filter_dt, band), 1.0, 1e-15);
  EXPECT_EQ(band_pass_gain(0.0, filter_dt, band), 0.0);
  EXPECT_EQ(band_pass_gain(0.5 / filter_dt, filter_dt, band), 0.0);
}

TEST(BandPass, GainFallsWithTheEighthPowerPerSide) {
  // Far below a low band tan is linear: |H|² → (f (f₂ − f₁)/(f₁f₂))⁸.
  const Band low{10.0, 20.0};
  EXPECT_NEAR(band_pass_gain(0.1, filter_dt, low) / std::pow(0.1 * 10.0 / 200.0, 8), 1.0, 1e-3);
}

TEST(BandPass, SinesComeOutWithTheGainAndInPhase) {
  // Away from the ends the response to a sine is exact up to what the ends send in, 10⁻¹² after the
  // padding and e^(−100) inside: 10000 samples = 0.1 s against decay times of 0.4 ms.
  for (const double frequency :
       {500.0, 1.5e3, 2.5e3, 4.0e3, 6.0e3, 12.0e3, 15.0e3, 20.0e3, 40.0e3}) {
    const auto input = filtered_sine(frequency, 10000);
    const auto output = band_pass(input, filter_dt, band);
    ASSERT_EQ(output.size(), input.size());
    EXPECT_LT(deviation(output, input, band_pass_gain(frequency, filter_dt, band)), 1e-11)
        << frequency;
  }
}

TEST(BandPass, PassBandIsKeptAndStopBandRemoved) {
  const auto inside = filtered_sine(6.0e3, 10000);
  EXPECT_LT(deviation(band_pass(inside, filter_dt, band), inside, 1.0), 1e-3);
  // Gain 1.2·10⁻⁹ at 200 Hz: (200·12500/(2500·15000))⁸ = 4·10⁻¹⁰ and more by the warping of 15 kHz.
  const auto outside = filtered_sine(200.0, 10000);
  EXPECT_LT(deviation(band_pass(outside, filter_dt, band), outside, 0.0), 2e-9);
}

TEST(BandPass, ConstantAndLineVanish) {
  std::vector<double> samples(3000);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = 7.0 + 0.01 * static_cast<double>(i);
  const auto output = band_pass(samples, filter_dt, band);
  // Odd reflection continues a line as a line up to the ends too; rounding of 37·10⁻¹⁶ times √n.
  for (const double y : output) EXPECT_NEAR(y, 0.0, 1e-9);
}

TEST(BandPass, ResponseToAnImpulseIsSymmetricAndHasTheGainAsSpectrum) {
  const std::size_t middle = 4000;
  std::vector<double> impulse(2 * middle + 1, 0.0);
  impulse[middle] = 1.0;
  const auto response = band_pass(impulse, filter_dt, band);
  for (std::size_t i = 1; i <= middle; ++i) {
    EXPECT_NEAR(response[middle + i], response[middle - i], 1e-15);
  }
  for (const double frequency : {1.0e3, 2.0e3, 6.0e3, 16.0e3, 30.0e3}) {
    double sum = response[middle];
    for (std::size_t i = 1; i <= middle; ++i) {
      sum += 2.0 * response[middle + i] *
             std::cos(two_pi * frequency * static_cast<double>(i) * filter_dt);
    }
    // The response has decayed to rounding (10⁻¹⁶ each, 4000 of them) long before the ends.
    EXPECT_NEAR(sum, band_pass_gain(frequency, filter_dt, band), 1e-12) << frequency;
  }
}

TEST(BandPass, BandsNearTheEndsOfTheSpectrumHaveTheirGain) {
  // Within 1 s, 10⁵ samples, the responses decay to rounding.
  for (const Band& extreme : {Band{60.0, 120.0}, Band{49.90e3, 49.98e3}}) {
    const std::size_t middle = 100000;
    std::vector<double> impulse(2 * middle + 1, 0.0);
    impulse[middle] = 1.0;
    const auto response = band_pass(impulse, filter_dt, extreme);
    const double width = extreme.upper - extreme.lower;
    for (const double place : {-0.2, 0.0, 0.4, 1.0, 1.2}) {
      const double frequency = extreme.lower + place * width;
      double sum = response[middle];
      for (std::size_t i = 1; i <= middle; ++i) {
        sum += 2.0 * response[middle + i] *
               std::cos(two_pi * frequency * static_cast<double>(i) * filter_dt);
      }
      EXPECT_NEAR(sum, band_pass_gain(frequency, filter_dt, extreme), 1e-10) << frequency;
    }
  }
}

TEST(BandSpectrum, GivesWhatTheBandPassGivesWhateverIsAskedBefore) {
  const auto input = filtered_sine(6.0e3, 3000);
  const SampleSpan source(input);
  BandSpectrum spectrum(source, {0, input.size()}, filter_dt, band);
  const Band narrow{5.9e3, 6.1e3};  // takes longer to decay
  for (const Band& one : {band, narrow, band}) {
    const auto output = spectrum.in(one);
    const auto expected = band_pass(input, filter_dt, one);
    ASSERT_EQ(output.size(), expected.size());
    for (std::size_t i = 0; i < output.size(); ++i) EXPECT_NEAR(output[i], expected[i], 1e-11);
  }
}

TEST(BandSpectrum, TellsTheAmplitudeOfASineAfterAllBands) {
  constexpr double frequency = 6.0e3;
  const Band narrow{5.8e3, 6.0e3};  // the gain at its edge is 1/2
  // The ends are felt for 1/(2π·100·sin π/8) = 4 ms, here 40 times that ago.
  const auto input = filtered_sine(frequency, 40000);
  const SampleSpan source(input);
  BandSpectrum spectrum(source, {0, input.size()}, filter_dt, band);
  const PassedSignal passed = spectrum.pass({band, narrow});
  const double gain = 0.5 * band_pass_gain(frequency, filter_dt, band);
  for (std::size_t i = 17000; i < 23000; ++i) {
    EXPECT_NEAR(passed.samples[i], gain * input[i], 1e-9);
    EXPECT_NEAR(passed.squared_amplitude[i], 0.5 * gain * gain, 1e-9);
  }
}

TEST(BandSpectrum, NoSamplesAreRejected) {
  const SampleSpan none({});
  EXPECT_THAT(
      [&] {
        BandSpectrum(none, {0, 0}, filter_dt, band);
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("there are no samples")));
}

TEST(BandPass, ShortSignalsWork) {
  EXPECT_TRUE(band_pass({}, filter_dt, band).empty());
  // One or a few samples, continued oddly about both ends; a single sample is a constant.
  const std::vector<double> one{3.0};
  EXPECT_NEAR(band_pass(one, filter_dt, band).at(0), 0.0, 1e-13);
  const std::vector<double> three{0.0, 1.0, 2.0};
  for (const double y : band_pass(three, filter_dt, band)) EXPECT_LT(std::abs(y), 2.0);
}

TEST(BandPass, EndsOfALongSineHaveNoJump) {
  // A sine that starts in a zero is its own odd reflection: exact up to the first sample.
  const auto input = filtered_sine(6.0e3, 5001, 0.0);
  const auto output = band_pass(input, filter_dt, band);
  const double gain = band_pass_gain(6.0e3, filter_dt, band);
  for (std::size_t i = 0; i < 1000; ++i) EXPECT_NEAR(output[i], gain * input[i], 1e-11);
}

TEST(BandPass, BandsOutOfRangeAreRejected) {
  const std::vector<double> samples(100, 0.0);
  const double nan = std::nan("");
  for (const Band wrong : {Band{0.0, 1e3}, Band{-1.0, 1e3}, Band{2e3, 1e3}, Band{1e3, 1e3},
                           Band{1e3, 50e3}, Band{1e3, 70e3}, Band{nan, 1e3}, Band{1e3, nan}}) {
    EXPECT_THAT([&] { band_pass(samples, filter_dt, wrong); },
                ThrowsMessage<std::invalid_argument>(HasSubstr("0 < lower < upper < 50000 Hz")));
  }
  for (const double interval : {0.0, -1.0, nan, HUGE_VAL}) {
    EXPECT_THAT(
        [&] { band_pass(samples, interval, band); },
        ThrowsMessage<std::invalid_argument>(HasSubstr("sampling interval must be positive")));
  }
  for (const double frequency : {-1.0, 50.001e3, nan}) {
    EXPECT_THAT([&] { band_pass_gain(frequency, filter_dt, band); },
                ThrowsMessage<std::invalid_argument>(HasSubstr("0 to half the sampling rate")));
  }
}

TEST(BandPass, SamplesThatAreNotFiniteAreRejected) {
  std::vector<double> samples(100, 0.0);
  samples[50] = std::nan("");
  EXPECT_THAT([&] { band_pass(samples, filter_dt, band); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("samples must be finite")));
}

TEST(BandPass, BandTooNarrowForMemoryIsRejected) {
  const std::vector<double> samples(100, 0.0);
  EXPECT_THAT(
      [&] {
        band_pass(samples, filter_dt, Band{1000.0, 1000.0005});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("too many")));
}

}  // namespace
}  // namespace stridor
