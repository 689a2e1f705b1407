#include "io/figures/axes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace stridor {
namespace {

using ::testing::ElementsAre;

TEST(ValueRange, TakesInWhatIsFinite) {
  ValueRange range;
  EXPECT_TRUE(range.is_empty());
  range.include(std::vector<double>{3.0, std::nan(""), -1.0, HUGE_VAL});
  EXPECT_EQ(range.lower, -1.0);
  EXPECT_EQ(range.upper, 3.0);
  EXPECT_EQ(range.widened(0.25).lower, -2.0);
  EXPECT_EQ(range.widened(0.25).upper, 4.0);
}

TEST(ValueRange, WidenedIsNeverAPoint) {
  EXPECT_EQ(ValueRange().widened(0.1).upper, 1.0);
  EXPECT_LT((ValueRange{5.0, 5.0}.widened(0.1).lower), 5.0);
  EXPECT_EQ((ValueRange{0.0, 0.0}.widened(0.1).upper), 1.0);
}

TEST(AxisLabel, NamesTheUnitOfTheNumbers) {
  AxisScale scale;
  EXPECT_EQ(axis_label("force", "N", scale), "force (N)");
  EXPECT_EQ(axis_label("ratio", "", scale), "ratio");
  scale.exponent = -6;
  EXPECT_EQ(axis_label("force", "N", scale), "force (µN)");
  EXPECT_EQ(axis_label("time", "s", scale), "time (µs)");
  scale.offset = 0.2;
  EXPECT_EQ(offset_text("N", scale), "minus 0.2 N");
  EXPECT_NEAR(as_number(0.2 + 3e-6, scale), 3.0, 1e-9);  // 0.2 is known to 3e-17
}

TEST(FrequencyScale, IsInKilohertzFrom2000HertzOn) {
  EXPECT_EQ(axis_label("frequency", "Hz", frequency_scale(1900.0, 6)), "frequency (Hz)");
  const AxisScale scale = frequency_scale(15000.0, 8);
  EXPECT_EQ(axis_label("frequency", "Hz", scale), "frequency (kHz)");
  EXPECT_EQ(scale.step, 2.0);
  EXPECT_EQ(scale.decimals, 0);
  EXPECT_EQ(as_number(15000.0, scale), 15.0);
  EXPECT_EQ(tick_characters({0.0, 15000.0}, scale), 2u);
}

std::vector<std::string> written(const std::vector<LogTick>& ticks) {
  std::vector<std::string> texts;
  for (const LogTick& tick : ticks)
    if (!tick.text.empty()) texts.push_back(tick.text);
  return texts;
}

TEST(LogTicks, AreWrittenAlikeAlongAnAxis) {
  EXPECT_THAT(written(log_ticks(1e-3, 10.0)), ElementsAre("0.001", "0.01", "0.1", "1", "10"));
  EXPECT_THAT(written(log_ticks(1e-4, 0.1)), ElementsAre("1e-4", "1e-3", "1e-2", "1e-1"));
  EXPECT_THAT(written(log_ticks(0.2, 3.0)), ElementsAre("0.2", "0.5", "1", "2"));
}

TEST(LogTicks, LeaveOutPowersWhereThereIsNoRoom) {
  EXPECT_THAT(written(log_ticks(1e-8, 1e3)),
              ElementsAre("1e-8", "1e-6", "1e-4", "1e-2", "1e0", "1e2"));
}

TEST(QuantityText, HasThreeDigitsAndAPrefix) {
  EXPECT_EQ(quantity_text(1e-6, "m/s^2"), "1 µm/s²");
  EXPECT_EQ(quantity_text(1e-9, "m/s"), "1 nm/s");
  EXPECT_EQ(quantity_text(1e-12, "m"), "1 pm");
  EXPECT_EQ(quantity_text(2e-5, "N"), "20 µN");
  EXPECT_EQ(quantity_text(3534.4, "Hz"), "3.53 kHz");
  EXPECT_EQ(quantity_text(0.0125, "s"), "12.5 ms");
  EXPECT_EQ(quantity_text(80.0, "Hz"), "80 Hz");
  EXPECT_EQ(quantity_text(0.0, "Hz"), "0 Hz");
  EXPECT_EQ(quantity_text(0.02, "1"), "0.02");
}

TEST(QuantityText, RoundsUpIntoTheNextPrefix) {
  EXPECT_EQ(quantity_text(999.4, "Hz"), "999 Hz");
  EXPECT_EQ(quantity_text(999.6, "Hz"), "1 kHz");
  EXPECT_EQ(quantity_text(-1500.0, "Hz"), "-1.5 kHz");
}

TEST(QuantityText, GivesNoPrefixToOtherUnits) {
  EXPECT_EQ(quantity_text(1e-6, "m^2"), "1e-06 m²");
  EXPECT_EQ(quantity_text(1e-21, "m"), "1e-21 m");
  EXPECT_EQ(typeset_units("kg/m^3"), "kg/m³");
  EXPECT_EQ(typeset_units("1"), "");
}

TEST(Wrapped, BreaksAtBlanksOnly) {
  const double five = text_width("aaaaa", 10.0);
  EXPECT_THAT(wrapped("aa bb cc", 10.0, 1.01 * five), ElementsAre("aa bb", "cc"));
  EXPECT_THAT(wrapped("aaaaaaaa b", 10.0, 1.01 * five), ElementsAre("aaaaaaaa", "b"));
  EXPECT_THAT(wrapped("", 10.0, 1.0), ElementsAre());
}

TEST(Wrapped, KeepsWhatIsUnbrokenTogether) {
  const double five = text_width("aaaaa", 10.0);
  EXPECT_THAT(wrapped("aa " + unbroken("bb cc"), 10.0, 1.01 * five), ElementsAre("aa", "bb cc"));
}

TEST(Wrapped, LabelKeepsItsUnitInOneLine) {
  const double ten = text_width("aaaaaaaaaa", 10.0);
  EXPECT_THAT(wrapped_label("amplitude (dB re 1 µN)", 10.0, ten),
              ElementsAre("amplitude", "(dB re 1 µN)"));
  EXPECT_THAT(wrapped_label("ratio", 10.0, ten), ElementsAre("ratio"));
}

TEST(TextWidth, CountsCharactersNotBytes) {
  EXPECT_EQ(text_width("µ²", 10.0), text_width("ab", 10.0));
}

TEST(RowsWithoutOverlap, FillTheLowestFreeRow) {
  const std::vector<std::pair<double, double>> intervals{
      {0.0, 2.0}, {1.0, 3.0}, {2.0, 4.0}, {2.5, 5.0}};
  EXPECT_THAT(rows_without_overlap(intervals, 2), ElementsAre(0, 1, 0, -1));
  EXPECT_THAT(rows_without_overlap(intervals, 3), ElementsAre(0, 1, 0, 2));
  EXPECT_THAT(rows_without_overlap({{5.0, 6.0}, {0.0, 6.0}}, 1), ElementsAre(-1, 0));
  EXPECT_THAT(rows_without_overlap(intervals, 0), ElementsAre(-1, -1, -1, -1));
}

TEST(FigureScript, PlacesThingsInCentimetres) {
  FigureScript script({.width = 10.0, .height = 20.0, .font_size = 12.0});
  script.add_text("it's", 5.0, 5.0, "center");
  script.add_text("small", 5.0, 5.0, "left", 8.0);
  script.set_margins(1.0, 9.0, 2.0, 18.0);
  EXPECT_EQ(script.text(),
            "set label 1 'it''s' at screen 0.500000, screen 0.250000 center font ',12'\n"
            "set label 2 'small' at screen 0.500000, screen 0.250000 left font ',8'\n"
            "set lmargin at screen 0.100000\nset rmargin at screen 0.900000\n"
            "set bmargin at screen 0.100000\nset tmargin at screen 0.900000\n");
}

}  // namespace
}  // namespace stridor
