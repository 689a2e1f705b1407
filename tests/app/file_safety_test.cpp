// Behaviour of the program with files and streams that are not as it expects: closed, full, changed
// since, left over, no files at all; and with too little memory.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <tuple>
#include <vector>

#include "io/hdf5/part_file.hpp"
#include "io/imports/law_table_file.hpp"
#include "io/scene/scene.hpp"
#include "tests/app/resume_fixture.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor {
namespace {

namespace fs = std::filesystem;
using namespace test;
using ::testing::AnyOf;
using ::testing::HasSubstr;

class FileSafety : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  /// Runs a line of a shell in which $S is the program; what it says on stderr goes to `said`.
  int shell(const std::string& line) {
    const std::string whole =
        fmt::format("cd '{}' && export S='{}' && ( {} ) 2> '{}'", folder_.path().string(),
                    STRIDOR_PROGRAM, line, path("said"));
    const int status = std::system(whole.c_str());
    said_ = contents_of(path("said"));
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
  }
  /// Changes the first bytes that read `from` into `to`, of the same length.
  void change_bytes(const std::string& name, const std::string& from, const std::string& to) const {
    ASSERT_EQ(from.size(), to.size());
    std::string bytes = contents_of(path(name));
    const std::size_t at = bytes.find(from);
    ASSERT_NE(at, std::string::npos);
    write(name, bytes.replace(at, from.size(), to));
  }

  TemporaryFolder folder_;
  std::string said_;
  const std::string short_run_ = "$S run " + scene_path("examples/stick_slip.yaml") +
                                 " --set time.end=1e-4 --set measure.from=0";
};

// ---------------------------------------------------------------- standard streams

TEST_F(FileSafety, ClosedStreamsDoNotGetTheRunFile) {
  for (const char* closed : {">&-", "<&-", "<&- >&-"}) {
    EXPECT_EQ(shell(short_run_ + " --force -o c.h5 " + closed), 0) << closed << said_;
    EXPECT_FALSE(RunFileReader(path("c.h5")).times().empty()) << closed;
  }
  // Without stderr as well, on which the shell here listens.
  EXPECT_EQ(shell("exec 2>&-; " + short_run_ + " --force -o c.h5 <&- >&-"), 0);
  EXPECT_FALSE(RunFileReader(path("c.h5")).times().empty());
  EXPECT_EQ(shell("exec 2>&-; $S check none.yaml >&-"), 4);
}

TEST_F(FileSafety, OutputThatCannotBeWrittenEndsWithFour) {
  ASSERT_EQ(shell(short_run_ + " -o a.h5 > out"), 0) << said_;
  const std::string flutter = scene_path("examples/flutter.yaml");
  for (const std::string& command :
       {std::string("$S --help"), std::string("$S run --help"), std::string("$S --version"),
        std::string("$S schema"), "$S check " + flutter, "$S check " + flutter + " --json",
        "$S eig " + flutter, "$S eig " + flutter + " --json", std::string("$S info a.h5"),
        std::string("$S info a.h5 --json"), std::string("$S run --resume a.h5"),
        short_run_ + " -o b.h5", short_run_ + " -o d.h5 --json"}) {
    EXPECT_EQ(shell(command + " > /dev/full"), 4) << command;
    EXPECT_THAT(said_, HasSubstr("stridor: I/O error\nthe standard output cannot be written"))
        << command;
  }
  EXPECT_FALSE(RunFileReader(path("d.h5")).times().empty()) << "the run itself is whole";
  // Other errors are reported first.
  EXPECT_EQ(shell("$S check none.yaml > /dev/full"), 4);
  EXPECT_THAT(said_, HasSubstr("none.yaml: does not exist"));
  EXPECT_EQ(shell("$S eig " + flutter + " --set nothing=1 > /dev/full"), 2);
}

TEST_F(FileSafety, WhereNobodyListensToRemarksTheWorkGoesOn) {
  EXPECT_EQ(shell(short_run_ + " --verify -o c.h5 > out 2> /dev/full"), 3) << "as expected of it";
  EXPECT_EQ(shell("$S check none.yaml > out 2> /dev/full"), 4);
  EXPECT_EQ(shell("$S none > out 2> /dev/full"), 2);
}

// ---------------------------------------------------------------- no regular files

TEST_F(FileSafety, WhatIsNoRegularFileIsRefusedWithoutWaiting) {
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  ASSERT_EQ(mkfifo(path("pipe.h5").c_str(), 0600), 0);
  const std::string support = scene_path("examples/rotating_support.yaml");
  const std::string sphere = scene_path("viscoelastic_sphere.yaml");
  const std::string continued = scene_path("examples/continued.yaml");
  for (const std::string& command :
       {std::string("check pipe"), std::string("run pipe -o a.h5"), std::string("eig pipe"),
        std::string("info pipe"), std::string("run --resume pipe"),
        std::string("plot pipe --kind history -o a.png"),
        "run " + support + " --set substructures.support.mass=pipe -o a.h5",
        "eig " + sphere + " --set contact.normal.form=pipe.h5",
        "run " + continued + " --set initial.state=pipe.h5 -o a.h5"}) {
    EXPECT_EQ(shell("timeout 60 $S " + command + " > out"), 4) << command << said_;
    EXPECT_THAT(said_, AnyOf(HasSubstr("pipe: is a FIFO (named pipe)"),
                             HasSubstr("pipe.h5: is a FIFO (named pipe)")))
        << command;
  }
  EXPECT_EQ(shell("timeout 60 $S check /dev/zero > out"), 4) << said_;
  EXPECT_THAT(said_, HasSubstr("/dev/zero: is a device; give the path of a scene file"));
  EXPECT_EQ(shell(short_run_ + " --force -o pipe"), 4);
  EXPECT_THAT(said_, HasSubstr("pipe: is not a regular file and is not replaced"));
}

// ---------------------------------------------------------------- codes

TEST_F(FileSafety, CodesTellWhatCannotBeReadFromWhatCannotBeWritten) {
  ASSERT_EQ(mkfifo(path("pipe.h5").c_str(), 0600), 0);
  EXPECT_EQ(shell("$S info pipe.h5"), 4);
  EXPECT_THAT(said_, HasSubstr("[other-kind-of-file]"));
  EXPECT_EQ(shell("$S info none.h5"), 4);
  EXPECT_THAT(said_, HasSubstr("[cannot-read]"));
  const std::string locus = "$S locus " + scene_path("beam_on_beam.yaml") +
                            " --from 70mm --to 80mm --points 30 -o locus.h5";
  EXPECT_EQ(shell("ulimit -f 4; " + locus + " > out"), 4);
  EXPECT_THAT(said_, HasSubstr("[cannot-write]"));
}

TEST_F(FileSafety, SweepInWhichEveryRunFailsHasTheCodeOfTheFirst) {
  EXPECT_EQ(shell("$S sweep " + scene_path("extreme/friction_two.yaml") +
                  " --parameter contact.friction.coefficient --from 2 --to 2.1 --points 2 > out"),
            3);
  EXPECT_THAT(said_, HasSubstr("[contact-pulls]"));
}

// ---------------------------------------------------------------- memory

TEST_F(FileSafety, TooLittleMemoryForBlasIsSaid) {
  const std::string flutter = scene_path("examples/flutter.yaml");
  for (const char* command : {"eig ", "check "}) {
    EXPECT_EQ(shell(fmt::format("ulimit -v 200000; timeout 60 $S {}{} > out", command, flutter)), 1)
        << said_;
    EXPECT_THAT(said_, HasSubstr("out of memory\nthe library of linear algebra (BLAS) needs 128 "
                                 "MiB of address space"));
    EXPECT_THAT(said_, HasSubstr("raise the limit (ulimit -v)"));
  }
  // Where it is enough for BLAS only, it ends all the same.
  for (int limit = 230; limit <= 310; limit += 20) {
    const int code = shell(
        fmt::format("ulimit -v {}000; timeout 60 {} --force -o a.h5 > out", limit, short_run_));
    EXPECT_TRUE(code == 0 || code == 1 || code == 3 || code == 4) << limit << " MB: " << code;
    EXPECT_TRUE(code == 0 || !said_.empty());
  }
}

// ---------------------------------------------------------------- leftovers

/// The number of a process that is no more.
pid_t dead_process() {
  const pid_t child = fork();
  if (child == 0) _exit(0);
  waitpid(child, nullptr, 0);
  return child;
}

TEST_F(FileSafety, PartFilesOfDeadProcessesAreRemoved) {
  const std::string hdf5 = "\x89HDF\r\n\x1a\n and more";
  const pid_t dead = dead_process();
  write(fmt::format("x.json.part-{}", dead), hdf5);
  write(fmt::format("x.json.part-{}", dead_process()), "");
  write(fmt::format("x.json.part-{}", getppid()), hdf5);          // alive
  write(fmt::format("y.json.part-{}", dead), hdf5);               // of another file
  write(fmt::format("x.json.part-0{}", dead), hdf5);              // not a name of ours
  write(fmt::format("x.json.part-{}", dead_process()), "piece");  // not ours inside
  const std::size_t before = folder_.files().size();
  write_text_file(path("x.json"), "{}\n");
  EXPECT_EQ(contents_of(path("x.json")), "{}\n");
  EXPECT_EQ(folder_.files().size(), before - 2 + 1);
  EXPECT_FALSE(fs::exists(path(fmt::format("x.json.part-{}", dead))));
  EXPECT_TRUE(fs::exists(path(fmt::format("x.json.part-{}", getppid()))));
  EXPECT_TRUE(fs::exists(path(fmt::format("y.json.part-{}", dead))));
}

TEST_F(FileSafety, ResumingRemovesWhatAKilledCommandLeft) {
  ASSERT_EQ(shell(short_run_ + " --set time.end=2e4 --set drive.velocity=1e-9 "
                               "--set record.interval=0.01 --max-wall 0.05 -o run.h5 > out"),
            5)
      << said_;
  const std::string left = fmt::format("run.h5.part-{}", dead_process());
  write(left, "\x89HDF\r\n\x1a\n and more");
  EXPECT_EQ(shell("$S run --resume run.h5 --max-wall 0.05 > out"), 5) << said_;
  EXPECT_FALSE(fs::exists(path(left)));
}

// ---------------------------------------------------------------- one physics from begin to end

class ResumedScene : public FileSafety {
 protected:
  void write_mass(double mass) const {
    std::string text = "%%MatrixMarket matrix coordinate real symmetric\n6 6 6\n";
    for (int i = 1; i <= 6; ++i) text += fmt::format("{} {} {}\n", i, i, mass);
    write("mass.mtx", text);
  }
  void begin_with_matrix() {
    write_mass(0.02);
    ASSERT_EQ(shell("$S run " + scene_path("examples/rotating_support.yaml") +
                    " --set substructures.support.mass=mass.mtx --set time.step=2e-7 --max-wall "
                    "0.05 -o run.h5 > out"),
              5)
        << said_;
  }
  int resume() { return shell("$S run --resume run.h5 --max-wall 0.05 > out"); }
};

TEST_F(ResumedScene, IsRefusedWhereAMatrixFileHasChanged) {
  begin_with_matrix();
  EXPECT_EQ(resume(), 5) << said_;
  write_mass(0.03);
  EXPECT_EQ(resume(), 4);
  EXPECT_THAT(said_, HasSubstr("run.h5: files that its scene names have changed since the run "
                               "began: " +
                               fs::canonical(folder_.path()).string() +
                               "/mass.mtx (substructures.support.mass); put the former ones back"));
  write_mass(0.02);
  EXPECT_EQ(resume(), 5) << said_;
}

TEST_F(ResumedScene, IsRefusedWhereTheTableOfItsLawHasChanged) {
  const auto write_law = [&](double factor) {
    ContactTable table;
    table.speeds = {1e-6, 1e-3, 1e-1, 1e3};
    table.indentations = {1e-6, 1e-3, 0.9};
    for (const double y : table.indentations) {
      for (const double v : table.speeds) {
        table.force.push_back(factor * std::pow(y, 1.5));
        table.area.push_back(3.0 * y);
        table.friction.push_back(1e-3 * std::pow(v, 0.1));
      }
    }
    write_law_table(path("law.h5"), Overwrite::yes, table,
                    std::vector<double>(table.force.size(), 50.0), {});
  };
  write_law(1.5);
  ASSERT_EQ(
      shell("$S run " + scene_path("viscoelastic_sphere.yaml") +
            " --set contact.normal.form=law.h5 --set time.end=2e5 --max-wall 0.05 -o run.h5 > out"),
      5)
      << said_;
  EXPECT_EQ(resume(), 5) << said_;
  write_law(1.6);
  EXPECT_EQ(resume(), 4);
  EXPECT_THAT(said_, HasSubstr("/law.h5 (contact.normal.form); put the former ones back"));
}

TEST_F(ResumedScene, IsRefusedWhereItsInitialStateHasChangedButDoesNotNeedIt) {
  const std::string first = "$S run " + scene_path("examples/clamped_bridge.yaml") +
                            " --set measure.from=0 --force -o first.h5 --set time.end=";
  ASSERT_EQ(shell(first + "2e-4 > out"), 0) << said_;
  ASSERT_EQ(shell("$S run " + scene_path("examples/continued.yaml") +
                  " --set contact.assumption=film --set initial.state=first.h5 --set "
                  "time.step=5e-8 --set time.end=0.4 "
                  "--max-wall 0.05 -o run.h5 > out"),
            5)
      << said_;
  EXPECT_EQ(resume(), 5) << said_;
  ASSERT_EQ(shell(first + "3e-4 > out"), 0) << said_;
  EXPECT_EQ(resume(), 4);
  EXPECT_THAT(said_, HasSubstr("/first.h5 (initial.state); put the former ones back"));
  // The state is in the checkpoint: nothing else can come in its place.
  fs::remove(path("first.h5"));
  EXPECT_EQ(resume(), 5) << said_;
}

TEST_F(ResumedScene, IsRefusedWhereItsBytesInTheRunFileHaveChanged) {
  begin_with_matrix();
  fs::copy_file(path("run.h5"), path("kept.h5"));
  for (const auto& [from, to, where] :
       {std::tuple{"coefficient: 0.6\n", "coefficient: 0.7\n", "/scene/resolved"},
        std::tuple{"{coefficient: 0.60}", "{coefficient: 0.70}", "/scene/text"},
        std::tuple{" substructures.support.mass /", " substructures.support.masx /",
                   "/scene/resolved"}}) {
    change_bytes("run.h5", from, to);
    EXPECT_EQ(resume(), 4) << where;
    EXPECT_THAT(said_, HasSubstr(fmt::format(
                           "dataset {}: is not the scene with which the run began", where)));
    fs::copy_file(path("kept.h5"), path("run.h5"), fs::copy_options::overwrite_existing);
  }
  EXPECT_EQ(resume(), 5) << said_;
}

TEST_F(ResumedScene, ItsHashChangesWithTheFilesThatItNames) {
  write_mass(0.02);
  const auto hash = [&] {
    return load_scene(scene_path("examples/rotating_support.yaml"),
                      {"substructures.support.mass=" + path("mass.mtx")})
        .hash();
  };
  const std::string before = hash();
  write_mass(0.03);
  EXPECT_NE(hash(), before);
  write_mass(0.02);
  EXPECT_EQ(hash(), before);
}

TEST_F(ResumedScene, ItsHashDoesNotDependOnTheFolder) {
  write_mass(0.02);
  fs::create_directory(path("elsewhere"));
  fs::copy_file(path("mass.mtx"), path("elsewhere/mass.mtx"));
  const auto hash = [&](const std::string& file) {
    return load_scene(scene_path("examples/rotating_support.yaml"),
                      {"substructures.support.mass=" + path(file)})
        .hash();
  };
  EXPECT_EQ(hash("elsewhere/mass.mtx"), hash("mass.mtx"));
}

}  // namespace
}  // namespace stridor
