#include "analysis/cycle_meter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace stridor {
namespace {

constexpr double period = 2.0, mean = 0.3, amplitude = 0.1;

/// Notes the turns of mean + amplitude cos(2πt/period), of which `stick` of every period sticks.
void note(CycleMeter& meter, int first, int last, double stick = 0.5) {
  for (int k = first; k <= last; ++k) {
    const double time = k * period;
    meter.note_position(time - 0.5 * period, mean - amplitude, 0.02);
    meter.note_position(time, mean + amplitude, 0.01);
    meter.note_turn({time, mean + amplitude, mean * time,
                     (mean * mean + 0.5 * amplitude * amplitude) * time, stick * k, 0.0});
  }
}

TEST(CycleMeter, ReadsWholeCyclesInItsWindow) {
  CycleMeter meter(10.0, 50.0);
  note(meter, 1, 40);
  const CycleMeter::Reading seen = meter.reading();
  EXPECT_NEAR(seen.period.value(), period, 1e-14);
  EXPECT_NEAR(seen.mean.value(), mean, 1e-13);
  EXPECT_NEAR(seen.rms.value(), amplitude / std::numbers::sqrt2, 1e-13);
  EXPECT_NEAR(seen.stick_fraction.value(), 0.25, 1e-14);
  EXPECT_EQ(seen.free_fraction.value(), 0.0);
  EXPECT_EQ(seen.smallest, mean - amplitude);
  EXPECT_EQ(seen.largest, mean + amplitude);
  EXPECT_EQ(seen.deepest, 0.02);
}

TEST(CycleMeter, SaysNothingOfLessThanTwoCycles) {
  CycleMeter meter(0.0, 5.0);
  note(meter, 1, 40);
  const CycleMeter::Reading seen = meter.reading();
  EXPECT_FALSE(seen.period.has_value());
  EXPECT_FALSE(seen.rms.has_value());
  EXPECT_EQ(seen.largest, mean + amplitude);
}

TEST(CycleMeter, GoesOnFromAStateAsIfItHadNotStopped) {
  CycleMeter whole(0.0, 100.0);
  note(whole, 1, 40);
  CycleMeter broken(0.0, 100.0);
  note(broken, 1, 17);
  State state;
  broken.save(state, "meter/");
  CycleMeter resumed(0.0, 100.0);
  resumed.load(state, "meter/");
  note(resumed, 18, 40);
  EXPECT_EQ(resumed.reading().rms, whole.reading().rms);
  EXPECT_EQ(resumed.reading().period, whole.reading().period);
}

}  // namespace
}  // namespace stridor
