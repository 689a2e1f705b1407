#include "io/results/locus_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <hdf5_hl.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "core/errors.hpp"
#include "io/results/result_file.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

Locus small_locus() {
  Locus locus;
  locus.values = {0.03, 0.04};
  locus.eigenvalues = {{{-1.0, 10.0}, {2.0, 20.0}}, {{-1.0, 11.0}}};
  locus.branches = {{{0.03, 0.035, 0.04}, {{-1.0, 10.0}, {-1.0, 10.5}, {-1.0, 11.0}}}};
  return locus;
}

TimedWindow window_at(double from) {
  constexpr double never = std::numeric_limits<double>::quiet_NaN();
  return {{from, from + 0.001, 3520.0, 87.0, 0.05, from + 0.0005, 0}, 1.5, never, 2.5};
}

TEST(LocusFile, WindowsAreReadAsTheyWereWritten) {
  const TemporaryFolder folder;
  const std::string path = (folder / "locus.h5").string();
  write_locus_file(path, Overwrite::no, small_locus(), {window_at(0.03), window_at(0.035)}, "m",
                   {{"parameter", std::string("contact.start")}});
  const auto windows = read_locus_windows(path);
  ASSERT_EQ(windows.size(), 2u);
  EXPECT_EQ(windows[1].window.from, 0.035);
  EXPECT_EQ(windows[1].window.to, window_at(0.035).window.to);
  EXPECT_EQ(windows[1].window.frequency, 3520.0);
  EXPECT_EQ(windows[1].window.growth_max, 87.0);
  EXPECT_EQ(windows[1].window.growth_integral, 0.05);
  EXPECT_EQ(windows[1].window.value_max, window_at(0.035).window.value_max);
  EXPECT_EQ(windows[1].from_time, 1.5);
  EXPECT_TRUE(std::isnan(windows[1].to_time));
  EXPECT_EQ(windows[1].gain, 2.5);
}

TEST(LocusFile, WithoutWindowsTheListIsEmpty) {
  const TemporaryFolder folder;
  const std::string path = (folder / "locus.h5").string();
  write_locus_file(path, Overwrite::no, small_locus(), {}, "m", {});
  EXPECT_TRUE(read_locus_windows(path).empty());
}

TEST(LocusFile, ExistingFileIsKeptUnlessItMayBeReplaced) {
  const TemporaryFolder folder;
  const std::string path = (folder / "locus.h5").string();
  write_locus_file(path, Overwrite::no, small_locus(), {}, "m", {});
  EXPECT_THAT(message_of<FileError>(
                  [&] { write_locus_file(path, Overwrite::no, small_locus(), {}, "m", {}); }),
              HasSubstr("exists; use --force to overwrite it"));
  write_locus_file(path, Overwrite::yes, small_locus(), {window_at(0.03)}, "m", {});
  EXPECT_EQ(read_locus_windows(path).size(), 1u);
}

TEST(LocusFile, OtherFilesAreRefused) {
  const TemporaryFolder folder;
  const std::string path = (folder / "map.h5").string();
  write_map_file(path, Overwrite::no, {{0, 1}, {0, 1}, {{1, 2}, {3, 4}}, {{{0, 0}, {1, 1}}}}, "m",
                 "1", {});
  EXPECT_THAT(message_of<FileError>([&] { read_locus_windows(path); }),
              HasSubstr("a file of `stridor locus -o` is needed"));
  write_file(folder / "text.h5", "no HDF5");
  EXPECT_THAT(message_of<FileError>([&] { read_locus_windows((folder / "text.h5").string()); }),
              HasSubstr("is not an HDF5 file"));
}

TEST(LocusFile, BranchesAreARectangleWithNothingBehindTheirEnds) {
  const TemporaryFolder folder;
  const std::string path = (folder / "locus.h5").string();
  Locus locus = small_locus();
  locus.branches.push_back({{0.03, 0.04}, {{2.0, 20.0}, {2.5, 21.0}}});
  write_locus_file(path, Overwrite::no, locus, {}, "m", {});
  const ResultFile file(path);
  EXPECT_EQ(file.array("/branches/value").shape, (std::vector<std::size_t>{2, 3}));
  const std::vector<double> growth = file.read("/branches/growth", 2);
  EXPECT_EQ(growth[2], -1.0);
  EXPECT_EQ(growth[4], 2.5);
  EXPECT_TRUE(std::isnan(growth[5]));
  EXPECT_EQ(file.read("/branches/number"), (std::vector<double>{1.0, 2.0}));
}

TEST(LocusFile, MapsSayWhyTheirPointsFailed) {
  const TemporaryFolder folder;
  const std::string path = (folder / "map.h5").string();
  StabilityMap map{{0, 1}, {0, 2}, {{1, std::nan("")}, {3, 4}}, {{{0, 0.5}, {1, 2}}, {{0, 2}}}};
  map.failure = {{0, 1}, {0, 0}};
  map.reasons = {"every contact is open"};
  write_map_file(path, Overwrite::no, map, "m", "1", {});
  const ResultFile file(path);
  EXPECT_EQ(file.read("/failure", 2), (std::vector<double>{0.0, 1.0, 0.0, 0.0}));
  EXPECT_EQ(file.texts("/failures/reason"), map.reasons);
  EXPECT_EQ(file.array("/boundary/x").units, "m");
  EXPECT_EQ(file.array("/boundary/y").units, "1");
  EXPECT_EQ(file.read("/boundary/y", 2)[1], 2.0);
  map.failure.clear();
  map.reasons.clear();
  write_map_file(path, Overwrite::yes, map, "m", "1", {});
  EXPECT_FALSE(ResultFile(path).has("/failure"));
}

TEST(LocusFile, ColumnsOfDifferentLengthsAreRefused) {
  const TemporaryFolder folder;
  const std::string path = (folder / "locus.h5").string();
  write_locus_file(path, Overwrite::no, small_locus(), {window_at(0.03), window_at(0.035)}, "m",
                   {});
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  ASSERT_GE(H5Ldelete(file, "/unstable/gain", H5P_DEFAULT), 0);
  const hsize_t shape[] = {3};
  const double gains[] = {1.0, 2.0, 3.0};
  ASSERT_GE(H5LTmake_dataset_double(file, "/unstable/gain", 1, shape, gains), 0);
  H5Fclose(file);
  EXPECT_THAT(message_of<FileError>([&] { read_locus_windows(path); }),
              HasSubstr("/unstable/gain: has 3 entries, /unstable/from 2"));
}

}  // namespace
}  // namespace stridor
