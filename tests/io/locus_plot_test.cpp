#include "io/figures/locus_plot.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/errors.hpp"
#include "io/figures/stability_map_plot.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;
using ::testing::Not;

LocusPicture small_picture() {
  LocusPicture picture;
  picture.parameter = "contact.start";
  picture.units = "m";
  picture.curves = {{{0.03, 0.04, 0.05}, {-10.0, 5.0, -10.0}, {3500.0, 3520.0, 3530.0}},
                    {{0.03, 0.04, 0.05},
                     {-30.0, std::numeric_limits<double>::quiet_NaN(), -31.0},
                     {9000.0, 9000.0, 9100.0}}};
  picture.windows = {{0.037, 0.043, 3520.0, 5.0}};
  picture.caption = "A caption.";
  return picture;
}

TEST(WindowLabels, StandOverTheMiddlesOfTheirWindows) {
  const auto labels =
      place_window_labels({{0.2, 0.4, 3521.0, 1.0}, {0.7, 0.7, 10570.0, 2.0}}, 0.0, 1.0, 10.0, 0.5);
  ASSERT_EQ(labels.size(), 2u);
  EXPECT_EQ(labels[0].text, "3.52 kHz");
  EXPECT_NEAR(labels[0].x, 3.0, 1e-12);
  EXPECT_EQ(labels[1].text, "10.6 kHz");
  EXPECT_NEAR(labels[1].x, 7.0, 1e-12);
}

TEST(WindowLabels, KeepTheirDistanceAndStayWithinTheDiagram) {
  std::vector<LocusWindow> windows;
  for (int i = 0; i < 8; ++i) windows.push_back({0.9 + 0.01 * i, 0.9 + 0.01 * i, 1000.0, 1.0});
  const auto labels = place_window_labels(windows, 0.0, 1.0, 10.0, 0.5);
  ASSERT_EQ(labels.size(), 8u);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    EXPECT_GE(labels[i].x, 0.0);
    EXPECT_LE(labels[i].x, 10.0);
    if (i > 0) {
      EXPECT_GE(labels[i].x - labels[i - 1].x, 0.5 - 1e-12);
    }
  }
}

TEST(WindowLabels, WeakestAreLeftOutWhereThereIsNoRoom) {
  const auto labels = place_window_labels(
      {{0.1, 0.1, 100.0, 3.0}, {0.5, 0.5, 200.0, 1.0}, {0.9, 0.9, 300.0, 2.0}}, 0.0, 1.0, 1.0, 0.8);
  ASSERT_EQ(labels.size(), 2u);
  EXPECT_EQ(labels[0].window, 0u);
  EXPECT_EQ(labels[1].window, 2u);
  EXPECT_TRUE(place_window_labels({}, 0.0, 1.0, 1.0, 0.8).empty());
}

TEST(LocusPlot, BothPicturesAreDrawn) {
  const TemporaryFolder folder;
  plot_locus(small_picture(), folder / "locus.svg");
  plot_locus_histories(small_picture(), folder / "history.svg");
  for (const char* name : {"locus.svg", "history.svg"}) {
    const std::string svg = contents_of(folder / name);
    for (const char* text : {"3.52 kHz", "growth rate", "frequency", "contact.start", "A caption."})
      EXPECT_THAT(svg, HasSubstr(text)) << name;
  }
}

TEST(LocusPlot, OneValueIsEnough) {
  const TemporaryFolder folder;
  LocusPicture picture;
  picture.parameter = "x";
  picture.units = "1";
  picture.curves = {{{0.3}, {-1.0}, {100.0}}};
  plot_locus(picture, folder / "locus.svg");
  plot_locus_histories(picture, folder / "history.svg");
}

TEST(LocusPlot, WhatCannotBeDrawnIsRefused) {
  const TemporaryFolder folder;
  EXPECT_THAT(message_of<std::invalid_argument>([&] { plot_locus({}, folder / "a.svg"); }),
              HasSubstr("there is no point"));
  LocusPicture picture = small_picture();
  picture.curves[0].growth.pop_back();
  EXPECT_THAT(
      message_of<std::invalid_argument>([&] { plot_locus_histories(picture, folder / "a.svg"); }),
      HasSubstr("a curve of 3 values has 2 growth rates and 3 frequencies"));
  EXPECT_THAT(message_of<ConfigError>([&] { plot_locus(small_picture(), folder / "a.bmp"); }),
              HasSubstr(".bmp"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(StabilityMapPlot, IsDrawnOnLinearAndLogarithmicAxes) {
  const TemporaryFolder folder;
  StabilityMapPicture picture;
  picture.x = {"contact.start", "m", {0.03, 0.04, 0.05}, false};
  picture.y = {"contact.friction.coefficient", "1", {0.01, 0.1}, true};
  picture.growth = {{-1.0, -2.0, -1.0}, {-1.0, 3.0, std::numeric_limits<double>::quiet_NaN()}};
  picture.boundary = {{{0.035, 0.1}, {0.04, 0.05}, {0.045, 0.1}}};
  plot_stability_map(picture, folder / "map.svg");
  const std::string svg = contents_of(folder / "map.svg");
  for (const char* text : {"contact.friction.coefficient", "largest growth rate", "0.02"})
    EXPECT_THAT(svg, HasSubstr(text));
}

TEST(StabilityMapPlot, WithoutABoundaryItIsAllOneColour) {
  const TemporaryFolder folder;
  StabilityMapPicture picture;
  picture.x = {"x", "1", {0.0, 1.0}, false};
  picture.y = {"y", "1", {0.0, 1.0}, false};
  picture.growth = {{-1.0, -2.0}, {-1.0, -3.0}};
  plot_stability_map(picture, folder / "map.svg");
  EXPECT_THAT(contents_of(folder / "map.svg"), HasSubstr("largest growth rate"));
}

TEST(StabilityMapPlot, DecayHasHalfOfTheColoursHoweverFastTheGrowthIs) {
  const TemporaryFolder folder;
  StabilityMapPicture picture;
  picture.x = {"x", "1", {0.0, 1.0}, false};
  picture.y = {"y", "1", {0.0, 1.0}, false};
  picture.growth = {{-1.0, -2.0}, {-1.0, 4000.0}};
  picture.boundary = {{{0.5, 1.0}, {1.0, 0.5}}};
  plot_stability_map(picture, folder / "map.svg");
  const std::string svg = contents_of(folder / "map.svg");
  for (const char* tick : {"-2", "-1", "2000", "4000"}) EXPECT_THAT(svg, HasSubstr(tick)) << tick;
  // A corner that decays fast does not bleach the rest, and is told.
  picture.growth = {{-1.0, -2.0}, {-1e6, 4000.0}};
  plot_stability_map(picture, folder / "corner.svg");
  EXPECT_THAT(contents_of(folder / "corner.svg"), HasSubstr("up to 1e+06 1/s"));
}

TEST(LocusPlot, GrowthAxisIsCutAtStronglyDampedRealRootsAndSaysSo) {
  const TemporaryFolder folder;
  LocusPicture picture;
  picture.parameter = "mu";
  picture.units = "1";
  picture.curves = {{{0.0, 1.0}, {-5.0, 3.0}, {100.0, 101.0}},
                    {{0.0, 1.0}, {-1.9e6, -1.8e6}, {0.0, 0.0}}};
  picture.windows = {{0.6, 1.0, 101.0, 3.0}};
  for (const auto& [draw, name] :
       {std::pair{&plot_locus, "a.svg"}, std::pair{&plot_locus_histories, "b.svg"}}) {
    draw(picture, folder / name);
    const std::string svg = contents_of(folder / name);
    EXPECT_THAT(svg, HasSubstr("2 values of strongly damped motions"));
    EXPECT_THAT(svg, Not(HasSubstr("10⁶")));  // the axis is that of the others
  }
}

TEST(LocusPlot, EveryWindowHasALabelBesideThePlaneOrInTheCaption) {
  const TemporaryFolder folder;
  LocusPicture picture;
  picture.parameter = "mu";
  picture.units = "1";
  picture.curves = {{{0.0, 1.0}, {-5.0, 40.0}, {100.0, 10000.0}}};
  for (int i = 1; i <= 40; ++i)
    picture.windows.push_back({0.1, 0.2, 1000.0 + 10.0 * i, static_cast<double>(i)});
  plot_locus(picture, folder / "a.svg");
  const std::string svg = contents_of(folder / "a.svg");
  // The strongest beside the plane, the others by name.
  EXPECT_THAT(svg, HasSubstr("Without room for a label"));
  for (int i = 1; i <= 40; ++i) {
    const std::string text = fmt::format("{:.3g}", 1.0 + 0.01 * i);
    EXPECT_THAT(svg, HasSubstr(text)) << i;
  }
}

TEST(StabilityMapPlot, RowsMustFitTheAxes) {
  const TemporaryFolder folder;
  StabilityMapPicture picture;
  picture.x = {"x", "1", {0.0, 1.0}, false};
  picture.y = {"y", "1", {0.0, 1.0}, false};
  picture.growth = {{1.0, 2.0}};
  EXPECT_THAT(
      message_of<std::invalid_argument>([&] { plot_stability_map(picture, folder / "map.svg"); }),
      HasSubstr("the growth rates are not 2 rows of 2"));
  picture.x.values = {0.0};
  EXPECT_THAT(
      message_of<std::invalid_argument>([&] { plot_stability_map(picture, folder / "map.svg"); }),
      HasSubstr("at least two values along each axis"));
}

}  // namespace
}  // namespace stridor
