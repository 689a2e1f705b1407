// A signal in blocks and as a whole.
#include "analysis/vibration_blocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "analysis/bursts.hpp"
#include "tests/support/constants.hpp"
#include "tests/support/rejection.hpp"

namespace stridor {
namespace {

using test::two_pi;
constexpr double block_dt = 1.0e-5;
constexpr BurstParameters wide{.band = {2.5e3, 15.0e3}};
constexpr std::size_t count = 60000;
// Shorter than the smoothing of 500 samples, and than the filter's response; primes; one that ends
// with the signal, one that leaves a single sample, and half of it.
constexpr std::size_t lengths[] = {211, 1009, 4999, 20000, 30000, 59999};

/// Three bursts in noise of 10⁻³: one that straddles the middle, one at the end.
std::vector<double> with_bursts() {
  std::mt19937_64 generator(11);
  std::normal_distribution<double> normal(0.0, 1e-3);
  std::vector<double> samples(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) * block_dt;
    double sum = 20.0 + normal(generator);  // and an offset far above the band's noise
    for (const auto& [peak, frequency, amplitude] :
         {std::tuple{0.12, 6.0e3, 1.0}, std::tuple{0.3, 4.1e3, 30.0}, std::tuple{0.62, 9e3, 5.0}}) {
      const double growth = t < peak ? 150.0 * (t - peak) : 400.0 * (peak - t);
      sum += amplitude * std::exp(growth) * std::sin(two_pi * frequency * t);
    }
    samples[i] = sum;
  }
  return samples;
}

/// Remembers how much was asked for at a time.
class Counting final : public SampleSource {
 public:
  explicit Counting(std::span<const double> samples) : span_(samples) {}
  std::size_t size() const override { return span_.size(); }
  void read(std::size_t begin, std::span<double> target) const override {
    most = std::max(most, target.size());
    span_.read(begin, target);
  }
  mutable std::size_t most = 0;

 private:
  SampleSpan span_;
};

double largest(const std::vector<double>& values) {
  double found = 0.0;
  for (const double x : values) found = std::max(found, std::abs(x));
  return found;
}

TEST(BandSpectrum, PartsOfASignalFitTogether) {
  const std::vector<double> samples = with_bursts();
  const SampleSpan source(samples);
  const Band own{5.6e3, 6.4e3};
  const std::vector<Band> bands{wide.band, own};
  const PassedSignal whole = BandSpectrum(source, {0, count}, block_dt, wide.band).pass(bands);
  // Where the signal ends the whole differs from the parts by what the filter's response keeps
  // after the continuation of the whole, 10⁻¹² of the samples.
  const double tolerance = 1e-12 * largest(samples);
  for (const std::size_t length : lengths) {
    BandSpectrum parts(source, {0, std::min(length, count)}, block_dt, wide.band);
    double apart = 0.0;
    for (std::size_t begin = 0; begin < count; begin += length) {
      const IndexRange part{begin, std::min(begin + length, count)};
      parts.move_to(part);
      const PassedSignal passed = parts.pass(bands);
      ASSERT_EQ(passed.samples.size(), part.size());
      for (std::size_t i = part.begin; i < part.end; ++i) {
        apart = std::max(apart, std::abs(passed.samples[i - begin] - whole.samples[i]));
        apart = std::max(apart, std::abs(std::sqrt(passed.squared_amplitude[i - begin]) -
                                         std::sqrt(whole.squared_amplitude[i])));
      }
    }
    EXPECT_LT(apart, tolerance) << length;
  }
}

TEST(VibrationBlocks, EnvelopesAreThoseOfTheWhole) {
  const std::vector<double> samples = with_bursts();
  const SampleSpan source(samples);
  const std::vector<double> whole = burst_envelope(samples, block_dt, wide.band, wide.smoothing);
  for (const std::size_t length : lengths) {
    SignalBlocks blocks(source, block_dt, wide.band, wide.smoothing, length);
    VibrationBlocks vibration(blocks, {wide.band}, wide.smoothing);
    std::size_t next = 0;
    double apart = 0.0;
    vibration.for_each({0, count}, [&](const VibrationPiece& piece, IndexRange part) {
      EXPECT_EQ(part.begin, next);
      next = part.end;
      for (std::size_t i = part.begin; i < part.end; ++i)
        apart = std::max(apart, std::abs(piece.envelope(i) - whole[i]));
      // What lies around a block is as good.
      const std::size_t after = std::min(part.end - 1 + blocks.margin(), count - 1);
      const std::size_t before = part.begin - std::min(blocks.margin(), part.begin);
      for (const std::size_t i : {before, after})
        apart = std::max(apart, std::abs(piece.envelope(i) - whole[i]));
    });
    EXPECT_EQ(next, count);
    EXPECT_LT(apart, 1e-12 * largest(samples)) << length;
  }
}

TEST(VibrationBlocks, AQuietStretchIsNotDrownedByAStrongBlockBeforeIt) {
  // As BurstEnvelope.AStrongEndDoesNotLeakIntoAQuietStart, at the border of two blocks.
  std::vector<double> samples(20000);
  for (std::size_t i = 10000; i < samples.size(); ++i)
    samples[i] = 1e6 * std::sin(two_pi * 3.5e3 * static_cast<double>(i) * block_dt);
  const SampleSpan source(samples);
  SignalBlocks blocks(source, block_dt, wide.band, wide.smoothing, 10000);
  VibrationBlocks vibration(blocks, {wide.band}, wide.smoothing);
  vibration.for_each({0, 5000}, [](const VibrationPiece& piece, IndexRange part) {
    for (const double e : piece.envelope(part)) EXPECT_LT(e, 1e-3);
  });
}

void expect_same(const Vibration& found, const Vibration& whole, std::size_t length) {
  EXPECT_NEAR(found.rms, whole.rms, 1e-12 * whole.rms) << length;
  ASSERT_EQ(found.bursts.size(), whole.bursts.size()) << length;
  for (std::size_t j = 0; j < whole.bursts.size(); ++j) {
    const Burst& a = found.bursts[j];
    const Burst& b = whole.bursts[j];
    EXPECT_EQ(a.start, b.start) << length;
    EXPECT_EQ(a.end, b.end) << length;
    EXPECT_EQ(a.peak_time, b.peak_time) << length;
    EXPECT_NEAR(a.peak, b.peak, 1e-12 * 30.0) << length;
    // The envelope at the onset is 10⁻³ of the largest sample: ln of it is good to 10⁻⁹.
    EXPECT_NEAR(a.frequency, b.frequency, 1e-9 * b.frequency) << length;
    EXPECT_NEAR(a.growth, b.growth, 1e-9 * b.growth) << length;
    EXPECT_NEAR(a.gain, b.gain, 1e-9) << length;
  }
}

TEST(Bursts, OfASignalInBlocksAreThoseOfTheWhole) {
  const std::vector<double> samples = with_bursts();
  const SampleSpan source(samples);
  BurstParameters late = wide;
  late.measured = {10.05, 10.55};
  BurstParameters given = wide;
  given.quiet = Window{10.4, 10.52};
  for (const BurstParameters& parameters : {wide, late, given}) {
    const Vibration whole = find_vibration(source, block_dt, parameters, 10.0);
    ASSERT_EQ(whole.bursts.size(), parameters.measured.to < 10.6 ? 2u : 3u);
    for (const std::size_t length : lengths) {
      expect_same(find_vibration(source, block_dt, parameters, 10.0, length), whole, length);
    }
  }
}

TEST(Bursts, ABorderMayLieAnywhereInABurst) {
  // The burst of 0.3 s grows from about 0.23 s on and is over at 0.33 s.
  const std::vector<double> samples = with_bursts();
  const SampleSpan source(samples);
  const Vibration whole = find_vibration(source, block_dt, wide);
  for (std::size_t border = 22000; border < 34000; border += 731)
    expect_same(find_vibration(source, block_dt, wide, 0.0, border), whole, border);
}

TEST(Bursts, ASignalIsNeverReadAsAWhole) {
  std::vector<double> samples;
  for (int i = 0; i < 6; ++i) {
    const std::vector<double> once = with_bursts();
    samples.insert(samples.end(), once.begin(), once.end());
  }
  const Counting source(samples);
  constexpr std::size_t length = 20000;
  const Vibration found = find_vibration(source, block_dt, wide, 0.0, length);
  EXPECT_GE(found.bursts.size(), 12u);
  // Blocks with twice the margin and 1.5 times the response, rounded up to a fast length, at both
  // ends; or 2^16 at a time where nothing is filtered.
  const double decay = band_pass_decay(block_dt, {5.6e3, 6.4e3});
  const std::size_t at_most = length + 2 * static_cast<std::size_t>(2.0 * 501.0 + 1.5 * decay);
  EXPECT_LT(source.most, std::max<std::size_t>(65537, at_most * 6 / 5));
  EXPECT_LT(source.most, samples.size() / 4);
}

TEST(Bursts, OfASignalThatFillsOneBlockAreThoseOfItsWhole) {
  // The usual length is not reached: one block, of which the spectrum is that of band_pass().
  const std::vector<double> samples = with_bursts();
  const SampleSpan source(samples);
  const std::vector<double> filtered = band_pass(samples, block_dt, wide.band);
  EXPECT_EQ(find_vibration(source, block_dt, wide).rms, rms(filtered));
}

TEST(SignalBlocks, AnEmptyBlockIsRejected) {
  const std::vector<double> samples(100, 1.0);
  const SampleSpan source(samples);
  test::expect_rejection([&] { SignalBlocks(source, block_dt, wide.band, wide.smoothing, 0); },
                         "must hold a sample");
}

}  // namespace
}  // namespace stridor
