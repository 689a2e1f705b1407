#include "io/run_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <hdf5_hl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "core/errors.hpp"

namespace stridor {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

const RunFileHeader header{
    .version = "0.1.0",
    .commit = "abcdef",
    .command = "stridor run 'scène à bielle.yaml' --set time.end=1",
    .scene_hash = "1234",
    .date = "2024-05-17T08:30:00Z",
    .scene_text = "format: 1 # µ = 0.3\n",
    .scene_resolved = "format: 1\ntime: {step: 2.0e-7}\n",
};

std::vector<SeriesSpec> two_series() {
  return {{.path = "/channels/tip.y.acceleration",
           .units = "m/s2",
           .attributes = {{"filter", "linear phase"}, {"delay", 0.25}}},
          {.path = "/contact/main/state",
           .units = "1",
           .kind = SeriesKind::state,
           .attributes = {{"meaning", "0 open, 1 slip, 2 stick"}}}};
}

double value_at(std::uint64_t row) {
  return std::sin(0.1 * static_cast<double>(row));
}
double state_at(std::uint64_t row) {
  return static_cast<double>(row % 3);
}
double time_at(std::uint64_t row) {
  return 1e-5 * static_cast<double>(row);
}

void append_rows(RunFileWriter& writer, std::uint64_t begin, std::uint64_t count) {
  std::vector<double> time;
  std::vector<double> value;
  std::vector<double> state;
  for (std::uint64_t row = begin; row < begin + count; ++row) {
    time.push_back(time_at(row));
    value.push_back(value_at(row));
    state.push_back(state_at(row));
  }
  writer.append(time, {value, state});
}

// Opens the file and compares every row of it. @return number of rows
std::uint64_t check_rows(const std::string& path) {
  const RunFileReader reader(path);
  const auto& times = reader.times();
  const auto values = reader.series("/channels/tip.y.acceleration");
  const auto states = reader.series("/contact/main/state");
  EXPECT_EQ(values.size(), times.size());
  EXPECT_EQ(states.size(), times.size());
  std::uint64_t wrong = 0;
  for (std::uint64_t row = 0; row < times.size(); ++row) {
    if (times[row] != time_at(row) || values[row] != value_at(row) || states[row] != state_at(row))
      ++wrong;
  }
  EXPECT_EQ(wrong, 0U) << path;
  return times.size();
}

std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class RunFile : public ::testing::Test {
 protected:
  RunFile() {
    std::string pattern = (fs::temp_directory_path() / "stridor-run-file-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~RunFile() override {
    std::error_code ignored;
    fs::permissions(folder_, fs::perms::owner_all, ignored);
    fs::remove_all(folder_, ignored);
  }
  std::string path(const std::string& name = "run.h5") const { return (folder_ / name).string(); }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_))
      names.push_back(entry.path().filename().string());
    return names;
  }
  // A file with `rows` rows, closed.
  std::string make_file(std::uint64_t rows) const {
    RunFileWriter writer(path(), Overwrite::yes, header, two_series());
    append_rows(writer, 0, rows);
    writer.close();
    return path();
  }
  // Changes a finished file behind the back of the writer.
  static void edit(const std::string& file, const std::function<void(hid_t)>& action) {
    const hid_t id = H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    ASSERT_GE(id, 0);
    action(id);
    ASSERT_GE(H5Fclose(id), 0);
  }

  fs::path folder_;
};

template <typename Action>
void expect_file_error(const Action& action,
                       const ::testing::Matcher<const std::string&>& message) {
  EXPECT_THAT(action, ThrowsMessage<FileError>(message));
}

// ---------------------------------------------------------------- what is written is read

TEST_F(RunFile, EverythingWrittenIsReadBack) {
  const std::vector<double> frequencies{101.5, 640.25};
  {
    RunFileWriter writer(path(), Overwrite::no, header, two_series());
    append_rows(writer, 0, 40000);  // over several chunks and blocks
    writer.write_static("/modal/beam/frequency", frequencies, "Hz");
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
  EXPECT_THAT(reader.static_names(), ElementsAre("/modal/beam/frequency"));
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
  writer.write_static("/modal/none", {}, "Hz");
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

// ---------------------------------------------------------------- during the run, and when it dies

TEST_F(RunFile, IsReadableDuringTheRunByAnotherProcess) {
  RunFileWriter writer(path(), Overwrite::no, header, two_series());
  append_rows(writer, 0, 100);
  writer.flush();
  append_rows(writer, 100, 50);  // in memory only
  EXPECT_EQ(writer.num_written(), 100U);
  // A copy sees what another process would see: the bytes in the file, none of the writer's memory.
  fs::copy_file(path(), path("copy.h5"));
  EXPECT_EQ(check_rows(path("copy.h5")), 100U);
}

TEST_F(RunFile, KilledRunLeavesAReadableFile) {
  for (int trial = 0; trial < 10; ++trial) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      RunFileWriter writer(path(), Overwrite::yes, header, two_series(), {.block_rows = 500});
      for (std::uint64_t row = 0;; row += 500) append_rows(writer, row, 500);
    }
    while (!fs::exists(path())) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    std::this_thread::sleep_for(std::chrono::milliseconds(3 + 5 * trial));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status));
    check_rows(path());
    fs::remove(path());
  }
}

// Runs `action` in a process of its own in which no file may grow beyond `limit` bytes, as on a
// full disk. @return the exit code that the action gives
int with_file_size_limit(rlim_t limit, const std::function<int()>& action) {
  const pid_t child = fork();
  if (child == 0) {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit size{limit, limit};
    setrlimit(RLIMIT_FSIZE, &size);
    int code = 99;
    try {
      code = action();
    } catch (const std::exception& error) {
      fmt::print(stderr, "unexpected: {}\n", error.what());
    }
    _exit(code);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

// Fills the disk and closes; 0 if both appending and closing report it as they should.
int fill_disk(const std::string& path, RunFileOptions options) {
  RunFileWriter writer(path, Overwrite::no, header, two_series(), options);
  std::string message;
  try {
    for (std::uint64_t row = 0; row < 1000000; row += 1000) append_rows(writer, row, 1000);
  } catch (const FileError& error) {
    message = error.what();
  }
  if (message.find(path + ": dataset /") != 0 ||
      message.find("File too large") == std::string::npos) {
    fmt::print(stderr, "unexpected message: {}\n", message);
    return 1;
  }
  const std::uint64_t kept = writer.num_written();
  try {
    writer.close();
    return 2;
  } catch (const FileError&) {
  }
  // In the same process, where HDF5 may still know the file.
  return kept > 0 && RunFileReader(path).times().size() == kept ? 0 : 3;
}

TEST_F(RunFile, FullDiskIsReportedAndLeavesTheRowsWrittenSoFar) {
  for (const rlim_t limit : {900000, 1400001, 2000000}) {
    EXPECT_EQ(with_file_size_limit(limit, [&] { return fill_disk(path(), {.block_rows = 3000}); }),
              0);
    EXPECT_GE(check_rows(path()), 16000U);
    fs::remove(path());
  }
}

TEST_F(RunFile, WriteThatFailsHalfWayLeavesTheRowsWrittenSoFar) {
  // Without the reservation HDF5 itself runs into the limit, at various places.
  for (rlim_t limit = 600000; limit < 3000000; limit += 100003) {
    const RunFileOptions options{.block_rows = 3000,
                                 .reservation = RunFileOptions::Reservation::off};
    EXPECT_EQ(with_file_size_limit(limit, [&] { return fill_disk(path(), options); }), 0) << limit;
    EXPECT_GE(check_rows(path()), 12000U);
    fs::remove(path());
  }
}

TEST_F(RunFile, RowsRefusedByAFullDiskAreWrittenWhenThereIsRoomAgain) {
  const auto action = [&] {
    RunFileWriter writer(path(), Overwrite::no, header, two_series(), {.block_rows = 16384});
    append_rows(writer, 0, 16384);
    rlimit size{};
    getrlimit(RLIMIT_FSIZE, &size);
    const rlimit small{fs::file_size(path()) + 1000, size.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
    try {
      append_rows(writer, 16384, 16384);
      return 1;
    } catch (const FileError&) {
    }
    setrlimit(RLIMIT_FSIZE, &size);
    append_rows(writer, 32768, 1);
    writer.close();
    return 0;
  };
  EXPECT_EQ(with_file_size_limit(1 << 30, action), 0);
  EXPECT_EQ(check_rows(path()), 32769U);
}

TEST_F(RunFile, NothingIsAcceptedAfterAFailedWrite) {
  const auto action = [&] {
    RunFileWriter writer(path(), Overwrite::no, header, two_series(),
                         {.block_rows = 3000, .reservation = RunFileOptions::Reservation::off});
    int failures = 0;
    std::string last;
    for (std::uint64_t row = 0; row < 60000; row += 3000) {
      try {
        append_rows(writer, row, 3000);
      } catch (const FileError& error) {
        ++failures;
        last = error.what();
      }
    }
    return failures > 1 && last.find("an earlier write failed") != std::string::npos ? 0 : 1;
  };
  EXPECT_EQ(with_file_size_limit(700000, action), 0);
}

TEST_F(RunFile, FullDiskAtSetUpLeavesNothingBehind) {
  const auto action = [&] {
    try {
      RunFileWriter(path(), Overwrite::no, header, two_series());
      return 1;
    } catch (const FileError& error) {
      return std::string(error.what()).find("File too large") != std::string::npos ? 0 : 2;
    }
  };
  EXPECT_EQ(with_file_size_limit(1000, action), 0);
  EXPECT_THAT(files(), IsEmpty());
}

// ---------------------------------------------------------------- set-up

TEST_F(RunFile, ExistingFileIsNotOverwrittenUnlessAsked) {
  make_file(10);
  const std::string before = content(path());
  expect_file_error([&] { RunFileWriter(path(), Overwrite::no, header, two_series()); },
                    AllOf(HasSubstr("run.h5"), HasSubstr("exists; use --force to overwrite it")));
  EXPECT_EQ(content(path()), before);
  make_file(3);
  EXPECT_EQ(check_rows(path()), 3U);
}

TEST_F(RunFile, ExistingFileIsKeptWhenSetUpFails) {
  make_file(10);
  const std::string before = content(path());
  // An attribute may have 64 KiB at most in the default format.
  auto series = two_series();
  series[0].attributes.emplace_back("essay", std::string(70000, 'x'));
  expect_file_error(
      [&] { RunFileWriter(path(), Overwrite::yes, header, series); },
      AllOf(HasSubstr("dataset /channels/tip.y.acceleration"), HasSubstr("attribute 'essay'")));
  EXPECT_EQ(content(path()), before);
  EXPECT_THAT(files(), ElementsAre("run.h5"));
}

TEST_F(RunFile, FailedSetUpLeavesNothingBehind) {
  RunFileHeader large = header;
  large.command = std::string(70000, 'x');
  expect_file_error([&] { RunFileWriter(path(), Overwrite::no, large, two_series()); },
                    HasSubstr("cannot write attribute 'command'"));
  EXPECT_THAT(files(), IsEmpty());
}

TEST_F(RunFile, UnusableFoldersAreRejected) {
  expect_file_error([&] { RunFileWriter(path("none/run.h5"), Overwrite::no, header, {}); },
                    AllOf(HasSubstr("the folder '"),
                          HasSubstr("none' cannot be used: No such file or directory")));
  std::ofstream(path("plain")) << "text";
  expect_file_error([&] { RunFileWriter(path("plain/run.h5"), Overwrite::no, header, {}); },
                    HasSubstr("plain' is not a folder"));
  expect_file_error([&] { RunFileWriter(folder_.string(), Overwrite::yes, header, {}); },
                    HasSubstr("is a folder"));
  expect_file_error([&] { RunFileWriter(path("x/"), Overwrite::yes, header, {}); },
                    HasSubstr("is not the name of a file"));
  expect_file_error([&] { RunFileWriter("", Overwrite::yes, header, {}); },
                    HasSubstr("is not the name of a file"));
  expect_file_error([&] { RunFileWriter("/dev/null", Overwrite::yes, header, {}); },
                    HasSubstr("is not a regular file and is not replaced"));
}

TEST_F(RunFile, FolderWithoutWritePermissionIsRejected) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
  expect_file_error([&] { RunFileWriter(path(), Overwrite::no, header, {}); },
                    AllOf(HasSubstr("cannot write in the folder"), HasSubstr("Permission denied")));
}

TEST_F(RunFile, WrongSeriesAreRejected) {
  const auto rejected = [&](std::vector<SeriesSpec> series, const std::string& message) {
    EXPECT_THAT([&] { RunFileWriter(path(), Overwrite::no, header, series); },
                ThrowsMessage<std::invalid_argument>(HasSubstr(message)));
    EXPECT_THAT(files(), IsEmpty());
  };
  for (const char* wrong :
       {"", "/", "channels/x", "/channels//x", "/channels/", "/a/./b", "/a/."}) {
    rejected({{.path = wrong, .units = "m"}}, fmt::format("'{}' is not a path of the form", wrong));
  }
  for (const char* reserved : {"/time", "/results", "/results/x", "/scene/text"}) {
    rejected({{.path = reserved, .units = "s"}}, "is reserved");
  }
  rejected({{.path = "/a/b", .units = "m"}, {.path = "/a/b", .units = "m"}},
           "'/a/b' appears twice");
  rejected({{.path = "/a/b", .units = "1", .kind = SeriesKind::state}},
           "needs the attribute 'meaning'");
  EXPECT_THAT([&] { RunFileWriter(path(), Overwrite::no, header, {}, {.block_rows = 0}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("block_rows must be at least 1")));
}

TEST_F(RunFile, WrongRowsAreRejectedAndNotAdded) {
  RunFileWriter writer(path(), Overwrite::no, header, two_series());
  const std::vector<double> one{1.0};
  const std::vector<double> two{1.0, 2.0};
  const auto rejected = [](const auto& action, const std::string& message) {
    EXPECT_THAT(action, ThrowsMessage<std::invalid_argument>(HasSubstr(message)));
  };
  rejected([&] { writer.append(one, {one}); }, "1 columns for 2 series");
  rejected(
      [&] {
        writer.append(one, {one, two});
      },
      "series '/contact/main/state' has 2 rows, time has 1");
  rejected([&] { writer.append(0.0, one); }, "1 columns for 2 series");
  for (const double state : {-1.0, 0.5, 256.0, std::nan("")}) {
    const std::vector<double> row{0.0, state};
    rejected([&] { writer.append(0.0, row); },
             "states of '/contact/main/state' must be integers 0 to 255");
  }
  writer.write_static("/modal/beam/frequency", one, "Hz");
  rejected([&] { writer.write_static("/modal/beam/frequency", one, "Hz"); }, "there is a dataset");
  rejected([&] { writer.write_static("modal", one, "Hz"); }, "is not a path of the form");
  writer.close();
  rejected([&] { writer.append(0.0, two); }, "written to after close()");
  rejected([&] { writer.write_result("x", 1.0); }, "written to after close()");
  rejected([&] { writer.write_static("/a/b", one, "1"); }, "written to after close()");
  rejected([&] { writer.flush(); }, "written to after close()");
  EXPECT_EQ(check_rows(path()), 0U);
}

// ---------------------------------------------------------------- files that are no good

TEST_F(RunFile, MissingAndUnreadableFilesAreRejected) {
  expect_file_error([&] { RunFileReader{path()}; }, AllOf(HasSubstr("run.h5: cannot be opened"),
                                                          HasSubstr("No such file or directory")));
  expect_file_error([&] { RunFileReader{folder_.string()}; }, HasSubstr("is a folder"));
}

TEST_F(RunFile, OtherFilesAreRejected) {
  std::ofstream(path()) << "time,force\n0,1\n";
  expect_file_error([&] { RunFileReader{path()}; }, HasSubstr("run.h5: is not an HDF5 file"));
  std::ofstream(path(), std::ios::trunc).flush();
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
  std::string bytes = content(path());
  for (std::size_t i = 96; i < 2000; ++i) bytes[i] = '\x5a';
  std::ofstream(path(), std::ios::binary | std::ios::trunc) << bytes;
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
