#include "io/figures/run_panels.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "io/figures/phase_plot.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor {
namespace {

using ::testing::ElementsAre;

RunFileReader run_of(const test::TemporaryFolder& folder, const std::vector<std::string>& paths) {
  const std::string path = (folder / "run.h5").string();
  std::vector<SeriesSpec> series;
  for (const std::string& one : paths) {
    SeriesSpec spec{one, "N", SeriesKind::real, {{"filter", "none"}}};
    if (one.ends_with("gap")) {
      spec.attributes = {
          {"filter", "linear phase, pass band to 40000 Hz, stop band from 60000 Hz"}};
    }
    if (one.ends_with("state")) {
      spec.kind = SeriesKind::state;
      spec.attributes.emplace_back("meaning", "0 open, 1 stick, 2 slip");
    }
    series.push_back(spec);
  }
  RunFileWriter writer(path, Overwrite::yes, {}, series);
  for (int k = 0; k < 3; ++k) writer.append(0.1 * k, std::vector<double>(paths.size(), 1.0));
  writer.close();
  return RunFileReader(path);
}

TEST(RunPanels, ChannelsAreChosenByUseAndNumbersAreSortedAsNumbers) {
  const test::TemporaryFolder folder;
  const RunFileReader file =
      run_of(folder, {"/channels/a.tip.y.displacement", "/channels/a.tip.y.acceleration",
                      "/contact/pad[10]/force", "/contact/pad[10]/force_min",
                      "/contact/pad[10]/force_max", "/contact/pad[2]/force",
                      "/contact/pad[2]/state", "/contact/pad[2]/gap", "/energy/strain"});
  EXPECT_THAT(series_by_use(file, SeriesUse::history),
              ElementsAre("/channels/a.tip.y.acceleration", "/contact/pad[2]/force",
                          "/contact/pad[10]/force", "/contact/pad[2]/state", "/contact/pad[2]/gap",
                          "/channels/a.tip.y.displacement", "/energy/strain"));
  // One of every quantity before the second of any.
  EXPECT_THAT(chosen_series(file, SeriesUse::history, 3),
              ElementsAre("/channels/a.tip.y.acceleration", "/contact/pad[2]/force",
                          "/contact/pad[2]/state"));
  EXPECT_THAT(chosen_series(file, SeriesUse::spectrum, 8),
              ElementsAre("/channels/a.tip.y.acceleration", "/contact/pad[2]/force",
                          "/contact/pad[10]/force", "/contact/pad[2]/gap",
                          "/channels/a.tip.y.displacement"));
}

TEST(RunPanels, SayWhatIsFilteredAndWhatValuesMean) {
  const test::TemporaryFolder folder;
  const RunFileReader file =
      run_of(folder, {"/contact/pad/force", "/contact/pad/force_min", "/contact/pad/force_max",
                      "/contact/pad/friction_force", "/contact/pad/friction_force_min",
                      "/contact/pad/friction_force_max", "/contact/pad/gap", "/contact/pad/state"});
  EXPECT_EQ(panel_of(file, "/contact/pad/gap", {0, 3}).title, "pad (low-passed to 40 kHz)");
  const Panel force = panel_of(file, "/contact/pad/force", {1, 3});
  EXPECT_EQ(force.band.times.size(), 2u);
  EXPECT_EQ(force.title, "pad (band: extremes of all steps)");
  EXPECT_EQ(panel_of(file, "/contact/pad/friction_force", {1, 3}).band.times.size(), 2u);
  EXPECT_THAT(series_by_use(file, SeriesUse::history),
              ElementsAre("/contact/pad/force", "/contact/pad/state", "/contact/pad/friction_force",
                          "/contact/pad/gap"));
  const Panel state = panel_of(file, "/contact/pad/state", {0, 3});
  ASSERT_EQ(state.named_values.size(), 3u);
  EXPECT_EQ(state.named_values[2].value, 2.0);
  EXPECT_EQ(state.named_values[2].name, "slip");
}

TEST(PhasePlot, CountsTheSamplesOfAPeriod) {
  std::vector<double> values;
  for (int k = 0; k < 1000; ++k)
    values.push_back(5.0 + std::sin(2.0 * std::numbers::pi * k / 7.3 + 0.1));
  ASSERT_TRUE(samples_per_period(values));
  EXPECT_NEAR(*samples_per_period(values), 7.3, 0.05);
  EXPECT_FALSE(samples_per_period(std::vector<double>{1.0, 2.0, 3.0}));
}

}  // namespace
}  // namespace stridor
