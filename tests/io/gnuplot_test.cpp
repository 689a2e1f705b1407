#include "io/figures/gnuplot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "io/figures/history_plot.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor {
namespace {

namespace fs = std::filesystem;
using namespace test;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

// Sets an environment variable for one test.
class ScopedVariable {
 public:
  ScopedVariable(const char* name, const std::string& value) : name_(name) {
    const char* old = std::getenv(name);
    was_set_ = old != nullptr;
    if (was_set_) old_ = old;
    setenv(name, value.c_str(), 1);
  }
  ScopedVariable(const ScopedVariable&) = delete;
  ScopedVariable& operator=(const ScopedVariable&) = delete;
  ~ScopedVariable() {
    if (was_set_) {
      setenv(name_, old_.c_str(), 1);
    } else {
      unsetenv(name_);
    }
  }

 private:
  const char* name_;
  bool was_set_ = false;
  std::string old_;
};

class WithFolder : public ::testing::Test {
 protected:
  std::vector<std::string> files() const { return folder_.files(); }

  TemporaryFolder folder_;
};

using Gnuplot = WithFolder;
using HistoryPlot = WithFolder;

template <typename Action>
void expect_file_error(const Action& action,
                       const ::testing::Matcher<const std::string&>& message) {
  EXPECT_THAT(action, ThrowsMessage<FileError>(message));
}

TEST_F(Gnuplot, EndingOfTheNameChoosesTheFormat) {
  draw_figure(folder_ / "a.png", "plot sin(x)");
  draw_figure(folder_ / "a.svg", "plot sin(x)");
  draw_figure(folder_ / "a.pdf", "plot sin(x)");
  EXPECT_THAT(contents_of(folder_ / "a.png"), StartsWith("\x89PNG"));
  EXPECT_THAT(contents_of(folder_ / "a.svg"),
              AllOf(HasSubstr("<svg"), HasSubstr("</svg>"), HasSubstr("DejaVu Sans")));
  EXPECT_THAT(contents_of(folder_ / "a.pdf"), StartsWith("%PDF"));
  EXPECT_EQ(files().size(), 3U);
}

TEST_F(Gnuplot, DrawsEveryCharacterWhateverTheLocaleIs) {
  const ScopedVariable locale("LC_ALL", "C");
  draw_figure(folder_ / "a.svg", "set title '30° at 5 µm'; plot sin(x)");
  EXPECT_THAT(contents_of(folder_ / "a.svg"), HasSubstr("30° at 5 µm"));
}

TEST_F(Gnuplot, PngHasTheSizeAskedFor) {
  draw_figure(folder_ / "a.png", "plot sin(x)", {.width = 8.0, .height = 5.0, .font_size = 10.0});
  // Bytes 16 to 23 of a PNG are width and height, most significant byte first; 100 dots per cm.
  const std::string bytes = contents_of(folder_ / "a.png");
  const auto number = [&](std::size_t at) {
    unsigned value = 0;
    for (std::size_t i = 0; i < 4; ++i)
      value = value * 256U + static_cast<unsigned char>(bytes.at(at + i));
    return value;
  };
  EXPECT_EQ(number(16), 800U);
  EXPECT_EQ(number(20), 500U);
}

TEST_F(Gnuplot, OddNamesAndQuotesDoNoHarm) {
  const fs::path odd = folder_ / "it's `touch x` $(touch y) µ;.svg";
  draw_figure(odd,
              "set title " + gnuplot_string("it's `touch z` \"q\"\n!touch w") + "\nplot sin(x)");
  EXPECT_THAT(files(), ElementsAre(odd.filename().string()));
  EXPECT_THAT(contents_of(odd), HasSubstr("`touch z`"));
  EXPECT_EQ(gnuplot_string("a'b\nc"), "'a''b c'");
}

TEST_F(Gnuplot, OtherEndingsAreRejected) {
  for (const char* name : {"a.gif", "a", "a.png.txt", ".png", "a.PNG"}) {
    EXPECT_THAT([&] { draw_figure(folder_ / name, "plot sin(x)"); },
                ThrowsMessage<ConfigError>(HasSubstr("must end with .png, .svg or .pdf")))
        << name;
  }
  EXPECT_THAT(files(), IsEmpty());
}

TEST_F(Gnuplot, ErrorInTheScriptKeepsTheOldFigure) {
  write_file(folder_ / "a.png", "old");
  expect_file_error(
      [&] { draw_figure(folder_ / "a.png", "plot nonsense(x)"); },
      AllOf(HasSubstr("a.png"), HasSubstr("gnuplot failed"), HasSubstr("undefined function")));
  EXPECT_EQ(contents_of(folder_ / "a.png"), "old");
  EXPECT_THAT(files(), ElementsAre("a.png"));
}

TEST_F(Gnuplot, ComplaintWithoutFailureIsAnErrorToo) {
  expect_file_error(
      [&] { draw_figure(folder_ / "a.svg", "print 'something is odd'\nplot sin(x)"); },
      HasSubstr("something is odd"));
  EXPECT_THAT(files(), IsEmpty());
}

TEST_F(Gnuplot, NoPictureIsAnError) {
  expect_file_error(
      [&] {
        draw_figure(folder_ / "a.png", "set output " + gnuplot_string((folder_ / "b").string()));
      },
      HasSubstr("gnuplot wrote no picture"));
}

TEST_F(Gnuplot, GnuplotThatIsKilledIsReported) {
  write_file(folder_ / "gnuplot", "#!/bin/sh\nkill -9 $$\n");
  fs::permissions(folder_ / "gnuplot", fs::perms::owner_all);
  const ScopedVariable path("PATH", folder_.path().string());
  expect_file_error([&] { draw_figure(folder_ / "a.png", "plot sin(x)"); },
                    HasSubstr("was ended by signal 9"));
}

TEST_F(Gnuplot, MissingGnuplotSaysWhatToInstall) {
  const ScopedVariable path("PATH", folder_.path().string());
  expect_file_error([&] { draw_figure(folder_ / "a.png", "plot sin(x)"); },
                    AllOf(HasSubstr("gnuplot is not installed"), HasSubstr("gnuplot-nox"),
                          HasSubstr("fonts-dejavu-core")));
  EXPECT_THAT(files(), IsEmpty());
}

TEST_F(Gnuplot, UnusableTargetsAreRejected) {
  expect_file_error([&] { draw_figure(folder_ / "none/a.png", "plot sin(x)"); },
                    HasSubstr("there is no folder"));
  fs::create_directory(folder_ / "dir.png");
  expect_file_error([&] { draw_figure(folder_ / "dir.png", "plot sin(x)"); },
                    HasSubstr("is not a regular file"));
  EXPECT_THAT([&] { draw_figure(folder_ / "a.png", "plot sin(x)", {.width = 0.0}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("size must be positive")));
}

TEST_F(Gnuplot, FolderWithoutWritePermissionIsRejected) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  fs::permissions(folder_.path(), fs::perms::owner_read | fs::perms::owner_exec);
  expect_file_error([&] { draw_figure(folder_ / "a.png", "plot sin(x)"); },
                    HasSubstr("cannot write in the folder"));
}

TEST_F(Gnuplot, TemporaryFolderThatCannotBeMadeIsReported) {
  const ScopedVariable temporary("TMPDIR", (folder_ / "none").string());
  expect_file_error([&] { draw_figure(folder_ / "a.png", "plot sin(x)"); },
                    HasSubstr("cannot make a temporary folder"));
}

TEST_F(Gnuplot, FontsAreLookedForInSubfolders) {
  EXPECT_FALSE(has_fonts({folder_.path(), folder_ / "none"}));
  fs::create_directories(folder_ / "truetype/dejavu");
  write_file(folder_ / "truetype/dejavu/readme.txt", "x");
  EXPECT_FALSE(has_fonts({folder_.path()}));
  write_file(folder_ / "truetype/dejavu/DejaVuSans.ttf", "x");
  EXPECT_TRUE(has_fonts({folder_ / "none", folder_.path()}));
}

// ---------------------------------------------------------------- envelope and axes

TEST(Envelope, ShortSeriesIsKept) {
  const Curve curve{{0.0, 1.0, 2.0}, {5.0, -1.0, 3.0}, "name"};
  const Curve same = envelope(curve, 2);
  EXPECT_EQ(same.times, curve.times);
  EXPECT_EQ(same.values, curve.values);
  EXPECT_EQ(same.name, "name");
}

TEST(Envelope, KeepsTheExtremesOfEveryColumnInOrder) {
  Curve curve;
  for (int i = 0; i < 100000; ++i) {
    curve.times.push_back(i * 1e-5);
    curve.values.push_back(std::sin(0.37 * i) * i);
  }
  curve.values[777] = 1e6;  // a single spike must not be lost
  const Curve reduced = envelope(curve, 500);
  EXPECT_LE(reduced.times.size(), 1000U);
  EXPECT_TRUE(std::is_sorted(reduced.times.begin(), reduced.times.end()));
  EXPECT_EQ(*std::max_element(reduced.values.begin(), reduced.values.end()), 1e6);
  EXPECT_EQ(*std::min_element(reduced.values.begin(), reduced.values.end()),
            *std::min_element(curve.values.begin(), curve.values.end()));
}

TEST(Envelope, GapsStayGaps) {
  Curve curve;
  for (int i = 0; i < 10000; ++i) {
    curve.times.push_back(i);
    curve.values.push_back(i >= 4000 && i < 6000 ? std::nan("") : 1.0);
  }
  const Curve reduced = envelope(curve, 100);
  EXPECT_TRUE(std::any_of(reduced.values.begin(), reduced.values.end(),
                          [](double x) { return std::isnan(x); }));
}

TEST(Envelope, WrongSeriesAreRejected) {
  EXPECT_THAT(
      [] {
        envelope({{0.0, 1.0}, {0.0}, ""}, 10);
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("2 times for 1 values")));
  EXPECT_THAT(
      [] {
        envelope({{1.0, 0.0}, {0.0, 0.0}, ""}, 10);
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("the times do not ascend")));
  EXPECT_THAT(
      [] {
        envelope({{0.0}, {0.0}, ""}, 0);
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("at least one column")));
}

TEST(AxisScale, ForceThatHardlyVariesGetsTheDecimalsItNeeds) {
  const AxisScale scale = axis_scale(0.19751, 0.19976, 5);
  EXPECT_EQ(scale.offset, 0.0);
  EXPECT_EQ(scale.exponent, 0);
  EXPECT_NEAR(scale.step, 5e-4, 1e-12);
  EXPECT_EQ(scale.decimals, 4);
}

TEST(AxisScale, TinyVariationIsShownAboutAnOffset) {
  const AxisScale scale = axis_scale(0.2 - 1e-8, 0.2 + 1e-8, 5);
  EXPECT_NEAR(scale.offset, 0.2, 1e-15);
  EXPECT_EQ(scale.exponent, -9);
  EXPECT_NEAR(scale.step, 5.0, 1e-9);
  EXPECT_EQ(scale.decimals, 0);
}

TEST(AxisScale, SmallAndLargeValuesAreScaledByThousands) {
  EXPECT_EQ(axis_scale(-3e-6, 8e-6, 5).exponent, -6);
  EXPECT_EQ(axis_scale(0.0, 3.2e6, 5).exponent, 6);
  EXPECT_EQ(axis_scale(-180.0, 180.0, 5).exponent, 0);
  EXPECT_NEAR(axis_scale(0.0, 3.2e6, 5).step, 1.0, 1e-12);
}

TEST_F(HistoryPlot, LongSeriesMakeSmallFiles) {
  Curve acceleration;
  for (int i = 0; i < 225000; ++i) {
    const double t = i * 1e-5;
    acceleration.times.push_back(t);
    acceleration.values.push_back(180.0 * std::exp(-std::pow((t - 0.9) / 0.1, 2)) *
                                  std::sin(2.0 * std::numbers::pi * 6400.0 * t));
  }
  Curve force = acceleration;
  force.name = "Subs-b";
  for (double& x : force.values) x = 0.1985 + 5e-6 * x;
  const std::vector<Panel> panels{{"Free end", "acceleration", "m/s²", {acceleration}},
                                  {"Contact", "contact force", "N", {force}}};
  for (const char* name : {"a.svg", "a.pdf", "a.png"}) {
    plot_histories(panels, folder_ / name, "A 'burst' of {1} beam_on_beam");
    // 2 panels · 4000 points · about 13 bytes in SVG.
    EXPECT_LT(fs::file_size(folder_ / name), 300000U) << name;
    EXPECT_GT(fs::file_size(folder_ / name), 5000U) << name;
  }
  const std::string svg = contents_of(folder_ / "a.svg");
  for (const char* text : {"acceleration (m/s²)", "contact force (N)", "time (s)", "beam_on_beam",
                           "Subs-b", "0.1985"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
}

TEST_F(HistoryPlot, BandsNamesOfValuesAndCaptionsAreDrawn) {
  Panel force{"contact", "force", "N", {{{0.0, 1.0, 2.0}, {0.0, 1.0, 0.5}, ""}}};
  force.band = {{0.0, 1.0, 2.0}, {0.0, 0.0, 0.0}, {0.0, 16.8, 2.0}};
  Panel state{"contact", "state", "1", {{{0.0, 1.0, 2.0}, {0.0, 2.0, 1.0}, ""}}};
  state.named_values = {{0.0, "open"}, {1.0, "stick"}, {2.0, "slip"}};
  plot_histories({force, state}, folder_ / "a.svg", "", "Low-passed to 40 kHz before thinning.");
  const std::string svg = contents_of(folder_ / "a.svg");
  for (const char* text : {"open", "stick", "slip", "Low-passed to 40 kHz", ">15<"})
    EXPECT_THAT(svg, HasSubstr(text));  // the axis reaches to the peak of the band
}

TEST(TimeLabels, NeitherOverlapNorVanish) {
  std::vector<TimeMark> marks;
  for (int i = 1; i <= 9; ++i) marks.push_back({0.1 * i, 0.1 * i, std::to_string(i)});
  const auto apart = place_time_labels(marks, 0.0, 1.0, 10.0, 13.0);
  ASSERT_EQ(apart.size(), 9u);
  EXPECT_NEAR(apart[0].middle, 1.0, 1e-12);
  EXPECT_EQ(apart[8].text, "9");
  marks.push_back({0.405, 0.405, "10"});
  const auto joined = place_time_labels(marks, 0.0, 1.0, 10.0, 13.0);
  ASSERT_EQ(joined.size(), 9u);
  EXPECT_EQ(joined[3].text, "4–10");
  const auto crowded = place_time_labels(marks, 0.0, 1.0, 1.0, 13.0);
  ASSERT_EQ(crowded.size(), 1u);
  EXPECT_EQ(crowded[0].text, "1–9");
}

TEST_F(HistoryPlot, DegenerateDataAreDrawn) {
  const double nan = std::nan("");
  const std::vector<Panel> panels{
      {"constant", "x", "", {{{0.0, 1.0}, {3.0, 3.0}, ""}}},
      {"zero", "x", "m", {{{0.0, 1.0}, {0.0, 0.0}, ""}}},
      {"no data", "x", "m", {{{}, {}, "nothing"}}},
      {"not finite", "x", "m", {{{0.0, 1.0, 2.0}, {nan, HUGE_VAL, nan}, ""}}},
      {"one point and a gap", "x", "m", {{{0.0, 1.0, 2.0}, {nan, 1.0, nan}, ""}}},
      {"about an offset", "force", "N", {{{0.0, 1.0, 2.0}, {0.2, 0.2 + 1e-8, 0.2}, ""}}},
  };
  for (const char* name : {"a.svg", "a.png", "a.pdf"}) plot_histories(panels, folder_ / name, "");
  EXPECT_THAT(contents_of(folder_ / "a.svg"),
              AllOf(HasSubstr("force (nN)"), HasSubstr("minus 0.2 N")));
  plot_histories({{"", "x", "", {{{}, {}, ""}}}}, folder_ / "empty.svg", "");
  plot_histories({{"", "x", "", {{{0.0, 2e-6}, {1.0, 2.0}, ""}}}}, folder_ / "short.svg", "");
  EXPECT_THAT(contents_of(folder_ / "short.svg"), HasSubstr("time (µs)"));
}

TEST_F(HistoryPlot, WrongPanelsAreRejected) {
  EXPECT_THAT([&] { plot_histories({}, folder_ / "a.svg", ""); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("no panels")));
  EXPECT_THAT(
      [&] {
        plot_histories({{"", "x", "", {}}}, folder_ / "a.svg", "");
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("a panel without a curve")));
  EXPECT_THAT(
      [&] {
        plot_histories({{"", "x", "", {{{0.0}, {}, ""}}}}, folder_ / "a.svg", "");
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("1 times for 0 values")));
  EXPECT_THAT(
      [&] {
        plot_histories({{"", "x", "", {{{0.0}, {1.0}, ""}}}}, folder_ / "a.bmp", "");
      },
      ThrowsMessage<ConfigError>(HasSubstr("must end with .png, .svg or .pdf")));
  EXPECT_THAT(files(), IsEmpty());
}

}  // namespace
}  // namespace stridor
