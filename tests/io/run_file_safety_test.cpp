// Run files while they are written: killed runs, full disks, files in the way, rows that are wrong.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "core/errors.hpp"
#include "io/run_file/run_file.hpp"
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
  for (int trial = 0; trial < 10; ++trial)
    write_until_killed(path(), std::chrono::milliseconds(3 + 5 * trial));
}

TEST_F(RunFile, IsReadableAfterEveryWrite) {
  check_after_every_write(path(), 200);
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
  const std::string before = contents_of(path());
  expect_file_error([&] { RunFileWriter(path(), Overwrite::no, header, two_series()); },
                    AllOf(HasSubstr("run.h5"), HasSubstr("exists; use --force to overwrite it")));
  EXPECT_EQ(contents_of(path()), before);
  make_file(3);
  EXPECT_EQ(check_rows(path()), 3U);
}

TEST_F(RunFile, AFileThatIsBeingWrittenIsNotOverwritten) {
  RunFileWriter writer(path(), Overwrite::no, header, two_series());
  append_rows(writer, 0, 10);
  writer.flush();
  const std::string before = contents_of(path());
  const auto is_refused = HasSubstr("run.h5: another process is writing it, a run that goes on");
  expect_file_error([&] { check_output(path(), Overwrite::yes); }, is_refused);
  expect_file_error([&] { check_replaceable(path(), Overwrite::yes); }, is_refused);
  expect_file_error([&] { RunFileWriter(path(), Overwrite::yes, header, two_series()); },
                    is_refused);
  EXPECT_EQ(contents_of(path()), before);
  EXPECT_THAT(files(), ElementsAre("run.h5"));
  append_rows(writer, 10, 10);
  writer.close();
  EXPECT_EQ(check_rows(path()), 20U) << "the run goes on as if nothing had been";
}

TEST_F(RunFile, ExistingFileIsKeptWhenSetUpFails) {
  make_file(10);
  const std::string before = contents_of(path());
  // An attribute may have 64 KiB at most in the default format.
  auto series = two_series();
  series[0].attributes.emplace_back("essay", std::string(70000, 'x'));
  expect_file_error(
      [&] { RunFileWriter(path(), Overwrite::yes, header, series); },
      AllOf(HasSubstr("dataset /channels/tip.y.acceleration"), HasSubstr("attribute 'essay'")));
  EXPECT_EQ(contents_of(path()), before);
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
  write_file(path("plain"), "text");
  expect_file_error([&] { RunFileWriter(path("plain/run.h5"), Overwrite::no, header, {}); },
                    HasSubstr("plain' is not a folder"));
  expect_file_error([&] { RunFileWriter(folder_.path().string(), Overwrite::yes, header, {}); },
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
  fs::permissions(folder_.path(), fs::perms::owner_read | fs::perms::owner_exec);
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
  writer.write_static({"/modal/beam/frequency", one, "Hz"});
  rejected(
      [&] {
        writer.write_static({"/modal/beam/frequency", one, "Hz"});
      },
      "there is a dataset");
  rejected([&] { writer.write_static({"modal", one, "Hz"}); }, "is not a path of the form");
  rejected(
      [&] {
        writer.write_static({"/modal/beam/damping_ratio", {1.0, 2.0}, "1"});
      },
      "'/modal/beam/damping_ratio' has 2 entries, its scale '/modal/beam/number' 1");
  writer.close();
  rejected([&] { writer.append(0.0, two); }, "written to after close()");
  rejected([&] { writer.write_result("x", 1.0); }, "written to after close()");
  rejected([&] { writer.write_static({"/a/b", one, "1"}); }, "written to after close()");
  rejected([&] { writer.flush(); }, "written to after close()");
  EXPECT_EQ(check_rows(path()), 0U);
}

}  // namespace
}  // namespace stridor
