#include "io/figures/assurance_plot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(AssurancePlot, WritesFrequenciesAndTheValuesThatCount) {
  const TemporaryFolder folder;
  const std::filesystem::path figure = folder / "mac.svg";
  AssurancePicture picture{Eigen::MatrixXd(2, 3), {100.0, 250.5}, {101.0, 249.0, 400.25}};
  picture.assurance << 0.98, 0.02, 0.13, 0.04, 0.87, 0.09;
  plot_assurance(picture, "It's a caption.", figure);
  const std::string text = contents_of(figure);
  EXPECT_THAT(text, AllOf(HasSubstr("250.5"), HasSubstr("400.25"), HasSubstr(">0.98<"), HasSubstr(">0.87<"),
                          HasSubstr(">0.13<")));
  EXPECT_THAT(text, AllOf(Not(HasSubstr(">0.09<")), Not(HasSubstr(">0.02<"))));
  // Of many modes some are labelled, and cells have no room for values.
  picture = {Eigen::MatrixXd::Identity(100, 80), std::vector<double>(100, 7.0), std::vector<double>(80, 9.0)};
  plot_assurance(picture, "Many.", folder / "many.svg");
  EXPECT_THAT(contents_of(folder / "many.svg"), Not(HasSubstr(">1.00<")));
}

TEST(AssurancePlot, RefusesWhatItCannotDraw) {
  const auto says = [](const AssurancePicture& picture) {
    return message_of<std::invalid_argument>([&] { plot_assurance(picture, "", "a.png"); });
  };
  EXPECT_THAT(says({}), HasSubstr("no mode"));
  EXPECT_THAT(says({Eigen::MatrixXd::Zero(1, 1), {1.0}, {}}), HasSubstr("not as many frequencies"));
  EXPECT_THAT(message_of<ConfigError>([] {
                plot_assurance({Eigen::MatrixXd::Zero(1, 1), {1.0}, {1.0}}, "", "a.gif");
              }),
              HasSubstr(".png"));
}

}  // namespace
}  // namespace stridor
