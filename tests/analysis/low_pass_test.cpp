#include "analysis/low_pass.hpp"
#include "tests/support/constants.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

namespace stridor {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

using test::two_pi;
constexpr double dt_in = 2.0e-7;
constexpr int ratio = 50;
constexpr double dt_out = dt_in * ratio;

std::shared_ptr<const DecimationFilter> make_filter(double interval = dt_in, int thinning = ratio) {
  return std::make_shared<const DecimationFilter>(interval, thinning);
}

struct Output {
  std::vector<double> value;
  std::vector<double> velocity;
  std::vector<double> acceleration;
};

Output decimate(const std::shared_ptr<const DecimationFilter>& filter, int num_inputs,
                const std::function<double(double)>& signal) {
  Decimator decimator(filter);
  Output output;
  for (int i = 0; i < num_inputs; ++i) {
    if (!decimator.push(signal(i * filter->input_interval()))) continue;
    output.value.push_back(decimator.value(Derivative::none));
    output.velocity.push_back(decimator.value(Derivative::first));
    output.acceleration.push_back(decimator.value(Derivative::second));
  }
  return output;
}

// Outputs whose window does not reach back before the first input.
std::size_t first_settled(const DecimationFilter& filter) {
  return static_cast<std::size_t>(filter.half_length() / filter.ratio() + 1);
}

double largest_difference(const std::vector<double>& values, double interval, std::size_t first,
                          const std::function<double(double)>& expected) {
  double largest = 0.0;
  for (std::size_t k = first; k < values.size(); ++k) {
    largest = std::max(largest, std::abs(values[k] - expected(static_cast<double>(k) * interval)));
  }
  return largest;
}

TEST(DecimationFilter, LowPassTapsHaveUnitSumAndAreSymmetric) {
  const auto filter = make_filter();
  const auto taps = filter->taps(Derivative::none);
  ASSERT_EQ(taps.size() % 2, 1U);
  double sum = 0.0;
  for (std::size_t i = 0; i < taps.size(); ++i) {
    sum += taps[i];
    EXPECT_EQ(taps[i], taps[taps.size() - 1 - i]);
  }
  // About 1250 additions of rounding 10⁻¹⁶ each, at random.
  EXPECT_NEAR(sum, 1.0, 1e-14);
}

TEST(DecimationFilter, DerivativeTapsAreOddAndEven) {
  const auto filter = make_filter();
  const auto first = filter->taps(Derivative::first);
  const auto second = filter->taps(Derivative::second);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i], -first[first.size() - 1 - i]);
    EXPECT_EQ(second[i], second[second.size() - 1 - i]);
  }
}

TEST(DecimationFilter, AmplitudeResponseKeepsToItsBands) {
  // 80 dB are 10⁻⁴ in both bands; Kaiser's formula for the length is an empirical fit, so 75 dB.
  const double allowed = std::pow(10.0, -75.0 / 20.0);
  for (const int thinning : {2, 5, 10, 50}) {
    const auto filter = make_filter(1.0, thinning);
    const auto taps = filter->taps(Derivative::none);
    for (double f = 0.0; f <= 0.5; f += 0.002 / thinning) {
      double response = 0.0;
      for (std::size_t i = 0; i < taps.size(); ++i) {
        response +=
            taps[i] * std::cos(two_pi * f * (static_cast<double>(i) - filter->half_length()));
      }
      if (f <= 0.4 / thinning) {
        EXPECT_NEAR(response, 1.0, allowed) << f * thinning;
      } else if (f >= 0.6 / thinning) {
        EXPECT_NEAR(response, 0.0, allowed) << f * thinning;
      }
    }
  }
}

TEST(DecimationFilter, ConstantComesOutExactly) {
  const auto filter = make_filter();
  for (const double constant : {1.0, 0.1, -1e9, 1.0 / 3.0}) {
    const Output output = decimate(filter, 5000, [constant](double) { return constant; });
    ASSERT_GT(output.value.size(), 80U);
    for (std::size_t k = 0; k < output.value.size(); ++k) {
      EXPECT_EQ(output.value[k], constant);
      EXPECT_EQ(output.velocity[k], 0.0);
      EXPECT_EQ(output.acceleration[k], 0.0);
    }
  }
}

TEST(DecimationFilter, ParabolaHasExactDerivatives) {
  // A symmetric filter of unit sum keeps lines, and its effect on a parabola is a constant.
  const double a = 3.0e4;
  const auto filter = make_filter();
  const Output output = decimate(filter, 20000, [a](double t) { return 0.5 * a * t * t; });
  const std::size_t first = first_settled(*filter);
  // x up to 0.24, rounded to 2·10⁻¹⁷, times √Σt² of about 10¹¹/s² (taps ~ω²/ratio): 10⁻⁵; allow
  // 10⁻³.
  EXPECT_LT(largest_difference(output.acceleration, dt_out, first, [a](double) { return a; }),
            1e-3);
  // The same with taps of ω/ratio: 10⁵/s · 10⁻¹⁶.
  EXPECT_LT(largest_difference(output.velocity, dt_out, first, [a](double t) { return a * t; }),
            1e-8);
}

TEST(Decimator, SineInThePassBandKeepsAmplitudePhaseAndDerivatives) {
  const auto filter = make_filter();
  for (const double frequency : {100.0, 5.0e3, 17.0e3, 39.0e3}) {  // pass band to 40 kHz
    const double w = two_pi * frequency;
    const auto x = [w](double t) { return std::sin(w * t + 0.7); };
    const auto v = [w](double t) { return w * std::cos(w * t + 0.7); };
    // The second difference over the output interval is low by the square of sin(x)/x.
    const double lobe = std::sin(0.5 * w * dt_out) / (0.5 * w * dt_out);
    const auto a = [w, lobe](double t) { return -w * w * lobe * lobe * std::sin(w * t + 0.7); };
    const Output output = decimate(filter, 30000, x);
    const std::size_t first = first_settled(*filter);
    // Ripple 10⁻⁴ (80 dB), stencil below 2·10⁻⁷; an offset of one input sample would show as w·dt
    // = 0.05 at 39 kHz. At 100 Hz the second derivative adds rounding, 10⁻¹⁶·10¹¹/w² = 10⁻¹⁰.
    const double tolerance = 2e-4;
    EXPECT_LT(largest_difference(output.value, dt_out, first, x), tolerance) << frequency;
    EXPECT_LT(largest_difference(output.velocity, dt_out, first, v), tolerance * w) << frequency;
    EXPECT_LT(largest_difference(output.acceleration, dt_out, first, a), tolerance * w * w)
        << frequency;
  }
}

TEST(Decimator, StopBandIsDown) {
  const auto filter = make_filter();
  const double allowed = std::pow(10.0, -75.0 / 20.0);
  for (const double frequency : {60.0e3, 99.0e3, 100.0e3, 1.0e6, 2.4e6}) {
    const double w = two_pi * frequency;
    const Output output = decimate(filter, 20000, [w](double t) { return std::sin(w * t + 0.3); });
    const std::size_t first = first_settled(*filter);
    const auto nothing = [](double) { return 0.0; };
    EXPECT_LT(largest_difference(output.value, dt_out, first, nothing), allowed) << frequency;
    // The stencils' gain never exceeds that of the exact derivative.
    EXPECT_LT(largest_difference(output.velocity, dt_out, first, nothing), allowed * w)
        << frequency;
    EXPECT_LT(largest_difference(output.acceleration, dt_out, first, nothing), allowed * w * w)
        << frequency;
  }
}

TEST(Decimator, ChirpComesOutInStepWithTheInput) {
  const auto filter = make_filter();
  // From 1 kHz to 35 kHz in 20 ms, rising at 1.7 MHz/s.
  const double rate = 1.7e6;
  const auto phase = [rate](double t) { return two_pi * (1.0e3 * t + 0.5 * rate * t * t); };
  const auto x = [phase](double t) { return std::sin(phase(t)); };
  const Output output = decimate(filter, 100000, x);
  ASSERT_GT(output.value.size(), 1900U);
  // As for sines; the spectrum of the chirp is quasi-stationary (rate·(window 0.25 ms)² = 0.1).
  EXPECT_LT(largest_difference(output.value, dt_out, first_settled(*filter), x), 1e-3);
}

TEST(Decimator, SampleIsTheInputOfTheSameInstantUntouched) {
  for (const int thinning : {1, 3, 50}) {
    const auto filter = make_filter(dt_in, thinning);
    Decimator decimator(filter);
    // A stream of numbers that no filter would leave alone.
    const auto signal = [](int i) { return static_cast<double>((i * 7919) % 104729); };
    int next = 0;
    for (int i = 0; i < 5000; ++i) {
      if (!decimator.push(signal(i))) continue;
      ASSERT_EQ(decimator.sample(), signal(next)) << thinning;
      next += thinning;
    }
    EXPECT_GT(next, 3000);
  }
}

TEST(Decimator, StreamIsAtRestBeforeTheFirstSample) {
  const auto filter = make_filter();
  // A smooth start from rest at 0.4: what comes out equals the same stream with explicit rest
  // before.
  const auto signal = [](double t) { return 0.4 + 1e6 * t * t * t; };
  const int lead = 40 * ratio;  // more than the half length
  ASSERT_GT(lead, filter->half_length());
  const Output direct = decimate(filter, 10000, signal);
  const Output led = decimate(filter, 10000 + lead, [&](double t) {
    const auto i = std::lround(t / dt_in) - lead;
    return signal(i < 0 ? 0.0 : static_cast<double>(i) * dt_in);
  });
  ASSERT_EQ(led.value.size(), direct.value.size() + 40);
  for (std::size_t k = 0; k < direct.value.size(); ++k) {
    EXPECT_EQ(direct.value[k], led.value[k + 40]);
    EXPECT_EQ(direct.velocity[k], led.velocity[k + 40]);
    EXPECT_EQ(direct.acceleration[k], led.acceleration[k + 40]);
  }
}

TEST(Decimator, OutputsComeAtTheStatedLatency) {
  for (const int thinning : {1, 3, 50}) {
    const auto filter = make_filter(dt_in, thinning);
    Decimator decimator(filter);
    EXPECT_EQ(decimator.latency(), filter->half_length());
    for (int i = 0; i < 5000; ++i) {
      const int belongs_to = i - decimator.latency();
      const bool expected = belongs_to >= 0 && belongs_to % thinning == 0;
      ASSERT_EQ(decimator.push(1.0), expected) << i;
      if (expected) {
        ASSERT_EQ(decimator.num_outputs(), belongs_to / thinning + 1);
      }
    }
  }
}

TEST(Decimator, RatioOnePassesThroughAndDifferentiates) {
  const double h = 1.0e-3;
  const auto filter = make_filter(h, 1);
  EXPECT_EQ(filter->half_length(), 2);
  EXPECT_EQ(filter->description(), "none");
  const double w = two_pi * 5.0;  // ωh = 0.031
  const auto x = [w](double t) { return std::sin(w * t); };
  const Output output = decimate(filter, 1000, x);
  ASSERT_EQ(output.value.size(), 998U);
  EXPECT_EQ(largest_difference(output.value, h, 0, x), 0.0);
  // (ωh)⁴/30 = 3.2·10⁻⁸ and (ωh)²/12 = 8·10⁻⁵, and no smaller: it is the stencil alone.
  const double velocity =
      largest_difference(output.velocity, h, 2, [w](double t) { return w * std::cos(w * t); }) / w;
  const double acceleration =
      largest_difference(output.acceleration, h, 2,
                         [w](double t) { return -w * w * std::sin(w * t); }) /
      (w * w);
  EXPECT_NEAR(velocity, std::pow(w * h, 4) / 30.0, 0.02 * velocity);
  EXPECT_NEAR(acceleration, std::pow(w * h, 2) / 12.0, 0.02 * acceleration);
}

TEST(Decimator, ResumedStreamIsBitwiseTheSame) {
  const auto filter = make_filter(dt_in, 7);
  const auto signal = [](int i) { return std::sin(0.01 * i) + 1e-3 * std::cos(1.1 * i); };
  // Before the first sample, in the start-up, at an output, between two, after the buffer has
  // moved.
  for (const int stop : {0, 1, 20, 107, 500, 1234}) {
    Decimator straight(filter);
    for (int i = 0; i < stop; ++i) straight.push(signal(i));
    State state;
    straight.save(state, "channel/tip");
    Decimator resumed(filter);
    for (int i = 0; i < 333; ++i) resumed.push(-5.0);  // what was there before does not matter
    resumed.load(state, "channel/tip");
    State again;
    resumed.save(again, "channel/tip");
    EXPECT_EQ(state, again);
    for (int i = stop; i < stop + 1000; ++i) {
      const bool due = straight.push(signal(i));
      ASSERT_EQ(resumed.push(signal(i)), due);
      if (!due) continue;
      ASSERT_EQ(straight.num_outputs(), resumed.num_outputs());
      for (const Derivative d : {Derivative::none, Derivative::first, Derivative::second}) {
        ASSERT_EQ(straight.value(d), resumed.value(d)) << "stopped at " << stop << ", sample " << i;
      }
      ASSERT_EQ(straight.sample(), resumed.sample());
    }
  }
}

TEST(Decimator, StateOfAnotherFilterIsRejected) {
  State state;
  Decimator(make_filter(dt_in, 7)).save(state, "tip");
  Decimator other(make_filter(dt_in, 8));
  EXPECT_THAT([&] { other.load(state, "tip"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("comes from another filter")));
  EXPECT_THAT([&] { other.load(State{}, "tip"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("no array 'tip/window'")));
}

TEST(Decimator, DamagedStateIsRejected) {
  const auto filter = make_filter(dt_in, 7);
  Decimator decimator(filter);
  for (int i = 0; i < 300; ++i) decimator.push(1.0);
  State good;
  decimator.save(good, "tip");
  const auto damaged = [&](const std::string& name, std::vector<double> values) {
    State state = good;
    state.put("tip/" + name, values);
    EXPECT_THAT([&] { decimator.load(state, "tip"); },
                ThrowsMessage<std::invalid_argument>(HasSubstr("state 'tip' is damaged")))
        << name;
  };
  damaged("window", {});
  damaged("window", {1.0, 2.0});
  damaged("window", std::vector<double>(1000, 0.0));
  damaged("until_due", {0.0});
  damaged("until_due", {std::nan("")});
  damaged("num_outputs", {-1.0});
}

TEST(Decimator, MissingFilterAndEarlyValueAreRejected) {
  EXPECT_THAT([] { Decimator(nullptr); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("no filter")));
  Decimator decimator(make_filter());
  decimator.push(1.0);
  EXPECT_THAT([&] { decimator.value(Derivative::none); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("no output is due yet")));
  EXPECT_THAT([&] { decimator.sample(); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("no output is due yet")));
}

TEST(DecimationFilter, ArgumentsOutOfRangeAreRejected) {
  for (const double interval : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    EXPECT_THAT(
        [&] { DecimationFilter(interval, 2); },
        ThrowsMessage<std::invalid_argument>(HasSubstr("interval must be positive and finite")));
  }
  for (const int thinning : {0, -3, 100001}) {
    EXPECT_THAT([&] { DecimationFilter(dt_in, thinning); },
                ThrowsMessage<std::invalid_argument>(HasSubstr("ratio must be 1 to 100000")));
  }
  const std::vector<double> short_window(3, 0.0);
  EXPECT_THAT(
      [&] { make_filter()->apply(short_window, Derivative::none); },
      ThrowsMessage<std::invalid_argument>(HasSubstr("the window has 3 samples, expected")));
}

TEST(DecimationFilter, DescriptionNamesTheBands) {
  const std::string text = make_filter()->description();
  EXPECT_THAT(text, HasSubstr("linear phase"));
  EXPECT_THAT(text, HasSubstr("pass band to 40000 Hz"));
  EXPECT_THAT(text, HasSubstr("stop band from 60000 Hz"));
  EXPECT_THAT(text, HasSubstr("80 dB"));
}

}  // namespace
}  // namespace stridor
