// What a run is summed up in, from a run file.
#include "io/run_file/run_summary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "io/run_file/run_file.hpp"
#include "tests/io/run_file_fixture.hpp"

namespace stridor {
namespace {

constexpr double interval = 1e-5;

/// A burst at 0.15 s in a hum, of 0.3 s.
std::vector<double> acceleration() {
  std::vector<double> values(30001);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double t = static_cast<double>(i) * interval;
    const double growth = t < 0.15 ? 150.0 * (t - 0.15) : 300.0 * (0.15 - t);
    values[i] = 5.0 + 1e-3 * std::sin(2.0 * std::numbers::pi * 3e3 * t) +
                10.0 * std::exp(growth) * std::sin(2.0 * std::numbers::pi * 6e3 * t);
  }
  return values;
}

class RunSummary : public testing::Test {
 protected:
  std::string file_of(const std::vector<double>& values) {
    const std::string path = (folder_ / "run.h5").string();
    RunFileWriter writer(path, Overwrite::yes, test::header,
                         {{.path = "/channels/beam.free_end.y.acceleration", .units = "m/s^2"}});
    for (std::size_t i = 0; i < values.size(); ++i)
      writer.append(static_cast<double>(i) * interval, std::vector<double>{values[i]});
    writer.close();
    return path;
  }

  test::TemporaryFolder folder_;
};

TEST_F(RunSummary, IsThatOfTheSeriesInMemory) {
  const std::vector<double> values = acceleration();
  MeasureParameters measure;
  measure.from = 0.05;
  measure.to = 0.25;
  const auto of_file = [&] {
    return summarise_acceleration(RunFileReader(file_of(values)), measure);
  };
  const std::span<const double> measured = std::span(values).subspan(5000, 20001);
  const auto whole = of_file();
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->channel, "beam.free_end.y.acceleration");
  EXPECT_EQ(whole->peak, peak(measured));
  EXPECT_EQ(whole->rms, rms(measured));
  EXPECT_FALSE(whole->bursts);

  measure.band = {2.5e3, 15e3};
  const auto in_band = of_file();
  ASSERT_TRUE(in_band && in_band->bursts);
  EXPECT_EQ(in_band->peak, peak(measured));
  BurstParameters parameters{.band = {2.5e3, 15e3}};
  parameters.measured = {0.05, 0.25};
  const double times_interval = 30000 * interval / 30000;
  const Vibration in_memory = find_vibration(SampleSpan(values), times_interval, parameters);
  EXPECT_DOUBLE_EQ(in_band->rms, in_memory.rms);
  ASSERT_EQ(in_band->bursts->size(), 1u);
  ASSERT_EQ(in_memory.bursts.size(), 1u);
  EXPECT_NEAR((*in_band->bursts)[0].gain, in_memory.bursts[0].gain, 1e-9);
}

TEST_F(RunSummary, OfNothingMeasuredIsNone) {
  MeasureParameters measure;
  measure.from = 1.0;
  EXPECT_FALSE(summarise_acceleration(RunFileReader(file_of(acceleration())), measure));
  EXPECT_FALSE(summarise_acceleration(RunFileReader(file_of({1.0})), MeasureParameters{}));
  EXPECT_FALSE(summarise_acceleration(RunFileReader(file_of({})), MeasureParameters{}));
}

TEST_F(RunSummary, APeakThatIsNoNumberIsSaid) {
  std::vector<double> values(70000, 1.0);
  values[200] = std::nan("");
  const auto summary = summarise_acceleration(RunFileReader(file_of(values)), {});
  ASSERT_TRUE(summary);
  EXPECT_TRUE(std::isnan(summary->peak)) << "whatever follows in later blocks";
}

TEST_F(RunSummary, RowsAreReadFromAnyOnOrRefused) {
  const std::vector<double> values = acceleration();
  const RunFileReader file(file_of(values));
  const std::string series = "/channels/beam.free_end.y.acceleration";
  ASSERT_EQ(file.num_rows(), values.size());
  for (const std::size_t begin : {0, 1, 16383, 16384, 30000}) {
    std::vector<double> rows(std::min<std::size_t>(100, values.size() - begin));
    file.read(series, begin, rows);
    for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(rows[i], values[begin + i]);
  }
  std::vector<double> rows(2);
  EXPECT_THROW(file.read(series, 30000, rows), std::invalid_argument);
  EXPECT_THROW(file.read(series, 40000, {}), std::invalid_argument);
  EXPECT_THROW(file.read("/channels/other", 0, rows), FileError);
}

}  // namespace
}  // namespace stridor
