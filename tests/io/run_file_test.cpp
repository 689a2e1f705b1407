#include "io/run_file/run_file.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <hdf5_hl.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "tests/io/run_file_fixture.hpp"

namespace stridor {
namespace {

namespace fs = std::filesystem;
using namespace test;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

// ---------------------------------------------------------------- data written are read back

TEST_F(RunFile, EverythingWrittenIsReadBack) {
  const std::vector<double> frequencies{101.5, 640.25};
  {
    RunFileWriter writer(path(), Overwrite::no, header, two_series());
    append_rows(writer, 0, 40000);  // over several chunks and blocks
    writer.write_static({"/modal/beam/frequency", frequencies, "Hz"});
    writer.write_result("contact_force.min", 0.5);
    writer.write_result("contact_force.min", 0.19751);
    writer.write_result("status", "completed");
    writer.close();
    EXPECT_EQ(writer.num_written(), 40000U);
    writer.close();  // again, does nothing
  }
  EXPECT_EQ(check_rows(path()), 40000U);
  EXPECT_THAT(files(), ElementsAre("run.h5"));

  const RunFileReader reader(path());
  EXPECT_EQ(reader.header().version, header.version);
  EXPECT_EQ(reader.header().commit, header.commit);
  EXPECT_EQ(reader.header().command, header.command);
  EXPECT_EQ(reader.header().scene_hash, header.scene_hash);
  EXPECT_EQ(reader.header().date, header.date);
  EXPECT_EQ(reader.header().scene_text, header.scene_text);
  EXPECT_EQ(reader.header().scene_resolved, header.scene_resolved);
  EXPECT_THAT(reader.series_names(),
              ElementsAre("/channels/tip.y.acceleration", "/contact/main/state"));
  EXPECT_THAT(reader.static_names(), ElementsAre("/modal/beam/frequency", "/modal/beam/number"));
  EXPECT_EQ(reader.static_array("/modal/beam/frequency"), frequencies);
  EXPECT_EQ(reader.units("/modal/beam/frequency"), "Hz");
  EXPECT_EQ(reader.units("/channels/tip.y.acceleration"), "m/s2");
  EXPECT_EQ(reader.units("/time"), "s");
  const auto attributes = reader.attributes("/channels/tip.y.acceleration");
  EXPECT_EQ(std::get<std::string>(attributes.at("filter")), "linear phase");
  EXPECT_EQ(std::get<double>(attributes.at("delay")), 0.25);
  EXPECT_EQ(std::get<std::string>(reader.attributes("/contact/main/state").at("meaning")),
            "0 open, 1 slip, 2 stick");
  const auto results = reader.results();
  EXPECT_EQ(std::get<double>(results.at("contact_force.min")), 0.19751);
  EXPECT_EQ(std::get<std::string>(results.at("status")), "completed");
  EXPECT_TRUE(reader.has("/contact/main"));
  EXPECT_FALSE(reader.has("/contact/other/state"));
}

TEST_F(RunFile, RowsOneByOneAndInPiecesGiveTheSameFile) {
  RunFileWriter rows(path("rows.h5"), Overwrite::no, header, two_series(), {.block_rows = 7});
  for (std::uint64_t row = 0; row < 100; ++row) {
    const std::vector<double> values{value_at(row), state_at(row)};
    rows.append(time_at(row), values);
  }
  rows.close();
  RunFileWriter pieces(path("pieces.h5"), Overwrite::no, header, two_series(), {.block_rows = 7});
  append_rows(pieces, 0, 3);
  append_rows(pieces, 3, 30);
  append_rows(pieces, 33, 0);
  append_rows(pieces, 33, 67);
  pieces.close();
  EXPECT_EQ(check_rows(path("rows.h5")), 100U);
  EXPECT_EQ(check_rows(path("pieces.h5")), 100U);
}

TEST_F(RunFile, DatasetsFollowTheFormat) {
  make_file(10);
  const hid_t file = H5Fopen(path().c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t time = H5Dopen2(file, "/time", H5P_DEFAULT);
  const hid_t value = H5Dopen2(file, "/channels/tip.y.acceleration", H5P_DEFAULT);
  const hid_t state = H5Dopen2(file, "/contact/main/state", H5P_DEFAULT);
  EXPECT_GT(H5DSis_scale(time), 0);
  EXPECT_GT(H5DSis_attached(value, time, 0), 0);
  EXPECT_GT(H5DSis_attached(state, time, 0), 0);
  const hid_t value_type = H5Dget_type(value);
  const hid_t state_type = H5Dget_type(state);
  EXPECT_GT(H5Tequal(value_type, H5T_IEEE_F64LE), 0);
  EXPECT_GT(H5Tequal(state_type, H5T_STD_U8LE), 0);
  const hid_t attribute = H5Aopen(file, "command", H5P_DEFAULT);
  const hid_t text_type = H5Aget_type(attribute);
  EXPECT_EQ(H5Tis_variable_str(text_type), 0);
  EXPECT_EQ(H5Tget_cset(text_type), H5T_CSET_UTF8);
  H5Tclose(text_type);
  H5Aclose(attribute);
  for (const hid_t type : {value_type, state_type}) H5Tclose(type);
  for (const hid_t dataset : {time, value, state}) H5Dclose(dataset);
  H5Fclose(file);
}

TEST_F(RunFile, PathsWithSpacesAndUnicodeWork) {
  const std::string odd = path("Lauf 1 — µ=0,3 'ü'.h5");
  RunFileWriter writer(odd, Overwrite::no, header, two_series());
  append_rows(writer, 0, 5);
  writer.close();
  EXPECT_EQ(check_rows(odd), 5U);
}

TEST_F(RunFile, EmptyTextAndNoSeriesAndNoRowsAreAllowed) {
  RunFileWriter writer(path(), Overwrite::no, {}, {});
  writer.write_static({"/modal/none", {}, "Hz"});
  writer.close();
  const RunFileReader reader(path());
  EXPECT_EQ(reader.header().scene_text, "");
  EXPECT_THAT(reader.times(), IsEmpty());
  EXPECT_THAT(reader.series_names(), IsEmpty());
  EXPECT_THAT(reader.static_array("/modal/none"), IsEmpty());
  EXPECT_TRUE(reader.results().empty());
}

TEST_F(RunFile, DestructorWritesWhatIsLeft) {
  {
    RunFileWriter writer(path(), Overwrite::no, header, two_series());
    append_rows(writer, 0, 12);
  }
  EXPECT_EQ(check_rows(path()), 12U);
}

TEST_F(RunFile, WriterCanBeMoved) {
  RunFileWriter first(path("a.h5"), Overwrite::no, header, two_series());
  append_rows(first, 0, 3);
  RunFileWriter second(path("b.h5"), Overwrite::no, header, two_series());
  append_rows(second, 0, 4);
  second = std::move(first);
  append_rows(second, 3, 2);
  second.close();
  EXPECT_EQ(check_rows(path("a.h5")), 5U);
  EXPECT_EQ(check_rows(path("b.h5")), 4U);
}

TEST_F(RunFile, DateIsIso8601Utc) {
  EXPECT_THAT(utc_now(),
              ::testing::MatchesRegex("2[0-9]{3}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}Z"));
}

// ---------------------------------------------------------------- files that are no good

TEST_F(RunFile, MissingAndUnreadableFilesAreRejected) {
  expect_file_error([&] { RunFileReader{path()}; }, AllOf(HasSubstr("run.h5: cannot be opened"),
                                                          HasSubstr("No such file or directory")));
  expect_file_error([&] { RunFileReader{folder_.path().string()}; }, HasSubstr("is a folder"));
}

TEST_F(RunFile, OtherFilesAreRejected) {
  write_file(path(), "time,force\n0,1\n");
  expect_file_error([&] { RunFileReader{path()}; }, HasSubstr("run.h5: is not an HDF5 file"));
  write_file(path(), "");
  expect_file_error([&] { RunFileReader{path()}; }, HasSubstr("is not an HDF5 file"));
  H5Fclose(H5Fcreate(path("other.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
  expect_file_error([&] { RunFileReader{path("other.h5")}; },
                    HasSubstr("is not a run file of stridor"));
}

TEST_F(RunFile, TruncatedFileIsRejected) {
  make_file(40000);
  fs::resize_file(path(), fs::file_size(path()) / 2);
  expect_file_error([&] { RunFileReader{path()}; },
                    AllOf(HasSubstr("is damaged or truncated"), HasSubstr("truncated file")));
}

TEST_F(RunFile, DamagedFileIsRejected) {
  make_file(10);
  std::string bytes = contents_of(path());
  for (std::size_t i = 96; i < 2000; ++i) bytes[i] = '\x5a';
  write_file(path(), bytes);
  EXPECT_THROW(RunFileReader{path()}, FileError);
}

TEST_F(RunFile, NewerFormatIsRejected) {
  make_file(1);
  const auto set_format = [&](int number) {
    edit(path(), [number](hid_t file) { H5LTset_attribute_int(file, "/", "format", &number, 1); });
  };
  set_format(2);
  expect_file_error([&] { RunFileReader{path()}; },
                    HasSubstr("has format 2, this program reads formats up to 1; use a newer one"));
  set_format(0);
  expect_file_error([&] { RunFileReader{path()}; }, HasSubstr("has the unknown format 0"));
}

TEST_F(RunFile, MissingPartsAreNamed) {
  const auto without = [&](const std::function<void(hid_t)>& action, const std::string& message) {
    make_file(1);
    edit(path(), action);
    expect_file_error([&] { RunFileReader{path()}; }, HasSubstr(message));
  };
  without([](hid_t file) { H5Adelete(file, "commit"); }, "no attribute 'commit'");
  without([](hid_t file) { H5Ldelete(file, "/scene/text", H5P_DEFAULT); },
          "dataset /scene/text: is missing");
  without([](hid_t file) { H5Ldelete(file, "/time", H5P_DEFAULT); }, "dataset /time: is missing");
}

TEST_F(RunFile, WrongDatasetsAreNamed) {
  make_file(100);
  edit(path(), [](hid_t file) {
    const double numbers[6] = {};
    const hsize_t short_length[1] = {5};
    const hsize_t square[2] = {2, 3};
    H5LTmake_dataset_double(file, "/channels/short", 1, short_length, numbers);
    H5LTmake_dataset_double(file, "/channels/square", 2, square, numbers);
    H5LTmake_dataset_string(file, "/channels/text", "words");
  });
  const RunFileReader reader(path());
  expect_file_error([&] { reader.series("/channels/short"); },
                    AllOf(HasSubstr(path()),
                          HasSubstr("dataset /channels/short: has 5 rows, but /time has 100")));
  expect_file_error([&] { reader.series("/channels/square"); },
                    HasSubstr("dataset /channels/square: has 2 dimensions, expected 1"));
  expect_file_error([&] { reader.series("/channels/text"); },
                    HasSubstr("dataset /channels/text: does not hold real numbers"));
  expect_file_error([&] { reader.series("/channels/none"); },
                    HasSubstr("dataset /channels/none: is missing"));
  expect_file_error([&] { reader.series("nonsense//x"); }, HasSubstr("is missing"));
  expect_file_error([&] { reader.series("/channels"); },
                    HasSubstr("dataset /channels: is not a dataset"));
  expect_file_error([&] { reader.static_array("/modal/x"); },
                    HasSubstr("dataset /modal/x: is missing"));
  expect_file_error([&] { reader.units("/channels/short"); },
                    HasSubstr("has no attribute 'units'"));
  expect_file_error([&] { reader.attributes("/nothing"); },
                    HasSubstr("dataset /nothing: is missing"));
}

TEST_F(RunFile, SeriesLongerThanTimeIsCut) {
  make_file(100);
  edit(path(), [](hid_t file) {
    const hid_t time = H5Dopen2(file, "/time", H5P_DEFAULT);
    const hsize_t length = 60;
    H5Dset_extent(time, &length);
    H5Dclose(time);
  });
  EXPECT_EQ(check_rows(path()), 60U);
}

}  // namespace
}  // namespace stridor
