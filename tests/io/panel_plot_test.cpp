#include "io/figures/panel_plot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/errors.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;
using ::testing::Not;

DiagramPanel small_panel() {
  constexpr double gap = std::numeric_limits<double>::quiet_NaN();
  DiagramPanel panel{"speed", "force", AxisKind::logarithmic, AxisKind::linear, false, {}};
  panel.curves.push_back({"a label's", {0.1, 1.0, 10.0}, {1.0, gap, 3.0}, Mark::line, 0});
  panel.curves.push_back({"", {0.1, -1.0, 10.0}, {1.0, 2.0, 3.0}, Mark::points, 1});
  return panel;
}

TEST(PanelPlot, DrawsOneToSixDiagrams) {
  const TemporaryFolder folder;
  for (const std::size_t count : {1, 2, 4}) {
    const std::filesystem::path figure = folder / "panels.svg";
    plot_panels(std::vector<DiagramPanel>(count, small_panel()), "A caption.", figure);
    const std::string text = contents_of(figure);
    EXPECT_THAT(text, HasSubstr("A caption."));
    EXPECT_THAT(text, HasSubstr("label’s"));
  }
}

// A trough may be as deep as it likes: the axis ends where it is told to.
TEST(PanelPlot, CutsOffWhatLiesBelowTheLeastOfALogarithmicAxis) {
  const TemporaryFolder folder;
  DiagramPanel panel{"frequency", "size", AxisKind::linear, AxisKind::logarithmic, false, {}};
  panel.curves.push_back({"", {0.0, 1.0, 2.0}, {1.0, 1e-12, 1.0}, Mark::line, 0});
  plot_panels({panel}, "", folder / "whole.svg");
  EXPECT_THAT(contents_of(folder / "whole.svg"), HasSubstr("10⁻¹²"));
  panel.y_least = 1e-3;
  plot_panels({panel}, "", folder / "cut.svg");
  EXPECT_THAT(contents_of(folder / "cut.svg"), HasSubstr("10⁻³"));
  EXPECT_THAT(contents_of(folder / "cut.svg"), Not(HasSubstr("10⁻¹²")));
}

// Equal lengths are equal numbers only in one unit.
TEST(PanelPlot, BothAxesToScaleHaveOnePowerOfTen) {
  const TemporaryFolder folder;
  DiagramPanel panel{"real (m)", "imaginary (m)", AxisKind::linear, AxisKind::linear, true, {}};
  panel.curves.push_back({"", {-2e-7, 2e-7}, {0.0, 3e-5}, Mark::line, 0});
  plot_panels({panel}, "", folder / "scale.svg");
  const std::string text = contents_of(folder / "scale.svg");
  const auto unit_behind = [&](const std::string& label) {
    const std::size_t begin = text.find(label + " (") + label.size();
    return text.substr(begin, text.find(')', begin) - begin);
  };
  EXPECT_EQ(unit_behind("real"), unit_behind("imaginary"));
}

TEST(PanelPlot, DrawsAFieldWithACurve) {
  const TemporaryFolder folder;
  FieldPicture picture;
  picture.num_columns = 4;
  picture.cell_side = 0.1;
  picture.values = {0.0, 1.0, 2.0, std::nan(""), 3.0, 1.0, 0.5, 0.1};
  picture.x_label = "x/R";
  picture.y_label = "y/R";
  picture.value_label = "pressure";
  picture.curve_x = {0.1, 0.0, -0.1};
  picture.curve_y = {0.0, 0.1, 0.0};
  const std::filesystem::path figure = folder / "field.svg";
  plot_field(picture, "Under it.", figure);
  EXPECT_THAT(contents_of(figure), HasSubstr("Under it."));
}

TEST(PanelPlot, RefusesWhatItCannotDraw) {
  const auto says = [](auto&& call) { return message_of<std::invalid_argument>(call); };
  EXPECT_THAT(says([] { plot_panels({}, "", "a.png"); }), HasSubstr("no diagram"));
  DiagramPanel panel = small_panel();
  panel.curves[0].y.pop_back();
  EXPECT_THAT(says([&] { plot_panels({panel}, "", "a.png"); }),
              HasSubstr("2 values against 3 in 'a label's'"));
  EXPECT_THAT(message_of<ConfigError>([] { plot_panels({small_panel()}, "", "a.gif"); }),
              HasSubstr(".png"));
  FieldPicture picture;
  picture.num_columns = 3;
  picture.values = {1.0, 2.0};
  EXPECT_THAT(says([&] { plot_field(picture, "", "a.png"); }), HasSubstr("2 values in rows of 3"));
  picture.values = {1.0, 2.0, 3.0};
  picture.curve_x = {1.0};
  EXPECT_THAT(says([&] { plot_field(picture, "", "a.png"); }), HasSubstr("as many x as y"));
}

}  // namespace
}  // namespace stridor
