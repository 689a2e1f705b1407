#include "core/fft_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <numbers>
#include <thread>
#include <vector>

#include "tests/support/constants.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/rejection.hpp"

namespace stridor {
namespace {

using test::expect_rejection;
using test::noise;

using test::two_pi;

TEST(Fft, TransformsAsDefinedAndBackForEvenAndOddLengths) {
  for (const std::size_t n : {1U, 2U, 7U, 12U}) {
    const std::vector<double> samples = noise(n);
    RealFft forward(n);
    std::copy(samples.begin(), samples.end(), forward.input().begin());
    forward.execute();
    InverseRealFft backward(n);
    ASSERT_EQ(forward.output().size(), n / 2 + 1);
    for (std::size_t k = 0; k < forward.output().size(); ++k) {
      std::complex<double> sum = 0.0;
      for (std::size_t i = 0; i < n; ++i) {
        sum +=
            std::polar(samples[i], -two_pi * static_cast<double>(i * k) / static_cast<double>(n));
      }
      EXPECT_NEAR(std::abs(forward.output()[k] - sum), 0.0, 1e-14 * static_cast<double>(n * n));
      backward.input()[k] = forward.output()[k];
    }
    backward.execute();
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_EQ(forward.input()[i], samples[i]);
      EXPECT_NEAR(backward.output()[i], static_cast<double>(n) * samples[i],
                  1e-14 * static_cast<double>(n * n));
    }
  }
}

TEST(Fft, MovedPlanStillTransforms) {
  RealFft first(4);
  RealFft second = std::move(first);
  for (double& x : second.input()) x = 1.0;
  second.execute();
  EXPECT_EQ(second.output()[0], 4.0);
}

TEST(Fft, PlansAreMadeInSeveralThreadsAtOnce) {
  std::vector<std::thread> threads;
  std::vector<double> sums(4);
  for (std::size_t t = 0; t < sums.size(); ++t) {
    threads.emplace_back([&sums, t] {
      for (std::size_t n = 2; n < 60; ++n) {
        RealFft fft(n);
        for (double& x : fft.input()) x = 1.0;
        fft.execute();
        sums[t] += fft.output()[0].real();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const double sum : sums) EXPECT_EQ(sum, 59.0 * 60.0 / 2.0 - 1.0);
}

TEST(Fft, TransformsOfOneLengthDoNotDisturbEachOther) {
  // They share a plan; each has buffers of its own, and several run at once.
  constexpr std::size_t n = 1000;
  std::vector<std::thread> threads;
  std::vector<double> errors(4, 1.0);
  for (std::size_t t = 0; t < errors.size(); ++t) {
    threads.emplace_back([&errors, t] {
      double largest = 0.0;
      for (int round = 0; round < 50; ++round) {
        RealFft forward(n);
        InverseRealFft backward(n);
        const double level = static_cast<double>(t + 1);
        for (double& x : forward.input()) x = level;
        forward.execute();
        std::copy(forward.output().begin(), forward.output().end(), backward.input().begin());
        backward.execute();
        for (const double x : backward.output())
          largest = std::max(largest, std::abs(x - level * static_cast<double>(n)));
      }
      errors[t] = largest;
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const double error : errors) EXPECT_LT(error, 1e-9);
}

TEST(Fft, RejectsLengthsOutOfRange) {
  expect_rejection([] { RealFft fft(0); }, "the length 0 is not 1 to 2147483647");
  expect_rejection([] { RealFft fft(std::size_t{1} << 31); }, "the length 2147483648 is not");
  expect_rejection([] { InverseRealFft fft(0); }, "the length 0 is not");
  expect_rejection([] { fast_fft_length(std::size_t{1} << 31); }, "are more than");
  expect_rejection([] { fast_fft_length((std::size_t{1} << 31) - 1); }, "are more than");
}

TEST(Fft, FastLengthIsTheNextEvenProductOfSmallPrimes) {
  EXPECT_EQ(fast_fft_length(0), 2U);
  EXPECT_EQ(fast_fft_length(2), 2U);
  EXPECT_EQ(fast_fft_length(11), 12U);
  EXPECT_EQ(fast_fft_length(13), 14U);
  EXPECT_EQ(fast_fft_length(121), 126U);
  EXPECT_EQ(fast_fft_length(1025), 1050U);
}

}  // namespace
}  // namespace stridor
