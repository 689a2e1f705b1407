// Spectra and phase plots.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "io/figures/phase_plot.hpp"
#include "io/figures/spectrum_plot.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;
using ::testing::Not;

// ---------------------------------------------------------------- spectra

TEST(GroupedMarks, CloseOnesShareALabel) {
  const std::vector<MarkGroup> groups =
      grouped({{3534.0, "1"}, {10570.0, "2"}, {3520.0, "3"}, {3534.4, "4"}}, 100.0);
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_EQ(groups[0].label, "1, 3, 4: 3.52–3.53 kHz");
  EXPECT_EQ(groups[0].lower, 3520.0);
  EXPECT_EQ(groups[0].upper, 3534.4);
  EXPECT_EQ(groups[1].label, "2: 10.6 kHz");
}

TEST(GroupedMarks, EqualTextIsWrittenOnceAndPrefixesMayDiffer) {
  EXPECT_EQ(grouped({{3534.0, "1"}, {3534.4, "2"}}, 100.0)[0].label, "1, 2: 3.53 kHz");
  EXPECT_EQ(grouped({{990.0, "1"}, {1010.0, "2"}}, 100.0)[0].label, "1, 2: 990 Hz–1.01 kHz");
  EXPECT_TRUE(grouped({}, 1.0).empty());
  EXPECT_EQ(grouped({{1.0, "1"}, {2.0, "2"}}, 1.0).size(), 2u);
}

Spectrum peak_at(double frequency, double amplitude) {
  Spectrum spectrum;
  for (int k = 0; k <= 1000; ++k) {
    spectrum.frequencies.push_back(10.0 * k);
    spectrum.amplitude.push_back(amplitude / (1.0 + std::pow((10.0 * k - frequency) / 50.0, 2)));
  }
  return spectrum;
}

SpectrumPicture picture_to_8_khz() {
  SpectrumPicture picture;
  picture.max_frequency = 8000.0;
  picture.caption = "Hann window of 100 ms";
  return picture;
}

TEST(PlotSpectra, SaysWhatItShows) {
  const TemporaryFolder folder;
  SpectrumPicture picture = picture_to_8_khz();
  picture.marks = {{3500.0, "1"}, {9000.0, "beyond"}};
  const std::vector<SpectrumPanel> panels{
      {"m/s^2", 1e-6, {{"beam.a", peak_at(3500.0, 2.0)}, {"beam.b", peak_at(1500.0, 1.0)}}},
      {"N", 1e-6, {{"contact.force", peak_at(3500.0, 1e-3)}}}};
  plot_spectra(panels, picture, folder / "a.svg");
  const std::string svg = contents_of(folder / "a.svg");
  for (const char* text : {"(dB re 1 µm/s²)", "(dB re 1 µN)", "frequency (kHz)", "beam.a", "beam.b",
                           "contact.force", "1: 3.5 kHz", "Hann window of 100 ms"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
  EXPECT_THAT(svg, Not(HasSubstr("beyond")));
  picture.scale = AmplitudeScale::linear;
  plot_spectra(panels, picture, folder / "b.svg");
  EXPECT_THAT(contents_of(folder / "b.svg"), HasSubstr("amplitude (m/s²)"));
}

TEST(PlotSpectra, EveryBurstOfARunIsNamed) {
  const TemporaryFolder folder;
  SpectrumPicture picture = picture_to_8_khz();
  picture.max_frequency = 12000.0;
  picture.marks = {{6450.0, "1"}, {5310.0, "2"}, {6540.0, "3"}, {8250.0, "4"}, {5450.0, "5"},
                   {7450.0, "6"}, {6600.0, "7"}, {7500.0, "8"}, {6630.0, "9"}};
  plot_spectra({{"m/s^2", 1e-6, {{"beam.a", peak_at(3500.0, 2.0)}}}}, picture, folder / "a.svg");
  const std::string svg = contents_of(folder / "a.svg");
  for (const char* text :
       {"1, 3, 7, 9: 6.45–6.63 kHz", "2, 5: 5.31–5.45 kHz", "4: 8.25 kHz", "6, 8: 7.45–7.5 kHz"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
}

TEST(PlotSpectra, SilenceIsDrawn) {
  const TemporaryFolder folder;
  SpectrumPicture picture = picture_to_8_khz();
  for (const AmplitudeScale scale : {AmplitudeScale::level, AmplitudeScale::linear}) {
    picture.scale = scale;
    plot_spectra({{"m", 1e-12, {{"beam.x", peak_at(100.0, 0.0)}}}}, picture, folder / "a.svg");
    EXPECT_GT(std::filesystem::file_size(folder / "a.svg"), 1000u);
  }
}

TEST(PlotSpectra, RejectsWhatItCannotDraw) {
  const TemporaryFolder folder;
  const std::vector<SpectrumPanel> good{{"m", 1e-12, {{"x", peak_at(100.0, 1.0)}}}};
  const auto message = [&](const std::vector<SpectrumPanel>& panels, const auto& change) {
    SpectrumPicture picture = picture_to_8_khz();
    change(picture);
    return message_of<std::invalid_argument>(
        [&] { plot_spectra(panels, picture, folder / "a.svg"); });
  };
  const auto nothing = [](SpectrumPicture&) {};
  EXPECT_THAT(message({}, nothing), HasSubstr("no panels"));
  EXPECT_THAT(message({{"m", 1e-12, {}}}, nothing), HasSubstr("a panel without a curve"));
  EXPECT_THAT(message({{"m", 0.0, good[0].curves}}, nothing),
              HasSubstr("the reference must be positive"));
  EXPECT_THAT(message(good, [](SpectrumPicture& p) { p.max_frequency = 0.0; }),
              HasSubstr("the highest frequency must be positive"));
  EXPECT_THAT(message(good, [](SpectrumPicture& p) { p.range = 0.0; }),
              HasSubstr("the range must be positive"));
  EXPECT_THAT(
      message_of<ConfigError>([&] { plot_spectra(good, picture_to_8_khz(), folder / "a.bmp"); }),
      HasSubstr("must end with"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

// ---------------------------------------------------------------- phase plots

// A circle run through `turns` times in steps of a hundredth of a turn.
PlanePath circle(int turns) {
  PlanePath path;
  for (int i = 0; i <= 100 * turns; ++i) {
    const double angle = 2.0 * std::numbers::pi * 0.01 * (i % 100);
    path.x.push_back(std::cos(angle));
    path.y.push_back(std::sin(angle));
  }
  return path;
}

TEST(VisiblePath, AnOrbitIsKeptOnce) {
  const PlanePath orbit = circle(1000);
  const PlanePath path = visible_path(orbit.x, orbit.y, 80, 80);
  EXPECT_EQ(path.x.size(), 101u);
  EXPECT_EQ(path.y.size(), 101u);
}

TEST(VisiblePath, TouchesEveryCellThatTheWholeTouches) {
  // Spirals inwards and crosses itself nowhere, so that next to nothing may be left out on a fine
  // grid, and much on a coarse one.
  PlanePath spiral;
  for (int i = 0; i < 20000; ++i) {
    const double angle = 0.02 * i;
    const double radius = 1.0 - 4e-5 * i;
    spiral.x.push_back(radius * std::cos(angle));
    spiral.y.push_back(radius * std::sin(angle));
  }
  const PlanePath path = visible_path(spiral.x, spiral.y, 40, 30);
  EXPECT_LT(path.x.size(), 40u * 30u * 3u);
  const auto cells = [](const PlanePath& points) {
    std::set<std::pair<int, int>> touched;
    for (std::size_t i = 0; i < points.x.size(); ++i) {
      if (!std::isfinite(points.x[i])) continue;
      touched.insert({static_cast<int>(20.0 * (points.x[i] + 1.0)),
                      static_cast<int>(15.0 * (points.y[i] + 1.0))});
    }
    return touched;
  };
  // Cells of another grid, whose edges lie elsewhere by less than a cell: as many but for the rim.
  const auto whole = static_cast<double>(cells(spiral).size());
  EXPECT_GT(static_cast<double>(cells(path).size()), 0.95 * whole);
}

TEST(VisiblePath, SlowMotionLeavesNoGaps) {
  // A thousand points to a cell: segments from cell to cell, all of one piece.
  std::vector<double> line;
  for (int i = 0; i <= 20000; ++i) line.push_back(5e-5 * i);
  const PlanePath path = visible_path(line, line, 20, 20);
  EXPECT_EQ(path.x.size(), 21u);
  EXPECT_EQ(path.x.front(), 0.0);
  EXPECT_NEAR(path.x.back(), 1.0, 1e-12);
  for (const double x : path.x) EXPECT_TRUE(std::isfinite(x));
}

TEST(VisiblePath, ShortOnesAreKeptAndGapsStayGaps) {
  const double nan = std::nan("");
  const std::vector<double> x{0.0, 1.0, nan, 2.0, 3.0};
  const std::vector<double> y{0.0, 1.0, 0.0, nan, 3.0};
  EXPECT_EQ(visible_path(x, y, 10, 10).x.size(), 5u);
  PlanePath orbit = circle(3);
  orbit.x[50] = nan;
  const PlanePath path = visible_path(orbit.x, orbit.y, 80, 80);
  // The first turn but for two segments, which the second turn adds: a gap before and after them.
  EXPECT_EQ(std::count_if(path.x.begin(), path.x.end(), [](double v) { return std::isnan(v); }), 2);
}

TEST(VisiblePath, ConstantsAndEmptinessAreNoTrouble) {
  const std::vector<double> constant(1000, 2.5);
  EXPECT_LE(visible_path(constant, constant, 10, 10).x.size(), 3u);
  EXPECT_TRUE(visible_path({}, {}, 10, 10).x.empty());
  const std::vector<double> nothing(100, std::nan(""));
  EXPECT_TRUE(visible_path(nothing, nothing, 10, 10).x.empty());
}

TEST(VisiblePath, RejectsWhatItCannotUse) {
  const std::vector<double> one{1.0};
  const auto message = [&](std::span<const double> y, std::size_t columns) {
    return message_of<std::invalid_argument>([&] { visible_path(one, y, columns, 5); });
  };
  EXPECT_THAT(message({}, 5), HasSubstr("0 values against 1"));
  EXPECT_THAT(message(one, 0), HasSubstr("no cells"));
}

TEST(PlotPhase, SaysWhatItShows) {
  const TemporaryFolder folder;
  PlanePath orbit = circle(30);
  for (double& x : orbit.x) x = 0.2 + 1e-8 * x;
  plot_phase({"beam.x.displacement", "m", orbit.x}, {"beam.x.velocity", "m/s", orbit.y},
             "From 0 to 1 s", folder / "a.svg");
  const std::string svg = contents_of(folder / "a.svg");
  for (const char* text :
       {"beam.x.displacement (nm), minus 0.2 m", "beam.x.velocity (m/s)", "From 0 to 1 s"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
}

TEST(PlotPhase, DegenerateDataAreDrawn) {
  const TemporaryFolder folder;
  const std::vector<double> nothing(3, std::nan(""));
  const std::vector<double> point{1.0};
  for (const std::vector<double>& values : {nothing, point, std::vector<double>{}}) {
    plot_phase({"x", "1", values}, {"y", "m", values}, "", folder / "a.png");
    EXPECT_GT(std::filesystem::file_size(folder / "a.png"), 1000u);
  }
}

TEST(PlotPhase, RejectsWhatItCannotDraw) {
  const TemporaryFolder folder;
  EXPECT_THAT(message_of<std::invalid_argument>([&] {
                plot_phase({"x", "m", {1.0}}, {"y", "m", {}}, "", folder / "a.svg");
              }),
              HasSubstr("0 values against 1"));
  EXPECT_THAT(message_of<ConfigError>([&] {
                plot_phase({"x", "m", {1.0}}, {"y", "m", {1.0}}, "", folder / "a.txt");
              }),
              HasSubstr("must end with"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace stridor
