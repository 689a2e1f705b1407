// Files that are damaged, foreign, or of another verb than the one asked to read them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <hdf5_hl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "io/hdf5/damage_guard.hpp"
#include "tests/app/pictures_fixture.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;
using Json = nlohmann::json;

/// Every command that reads a run file.
std::vector<std::vector<std::string>> reading_commands(const std::string& run,
                                                       const std::string& figure) {
  std::vector<std::vector<std::string>> commands{{"info", run}, {"spectrogram", run, "-o", figure}};
  for (const char* kind : {"history", "spectrogram", "phase", "spectrum"})
    commands.push_back({"plot", run, "--kind", kind, "-o", figure});
  return commands;
}

TEST_F(Pictures, WhatIsNoRunFileIsFileTroubleForEveryCommand) {
  const std::string whole = contents_of(make_run());
  write_file(path("text.h5"), "not HDF5 at all");
  write_file(path("empty.h5"), "");
  write_file(path("cut.h5"), whole.substr(0, whole.size() / 2));
  H5Fclose(H5Fcreate(path("foreign.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
  std::filesystem::create_directory(folder_ / "folder.h5");
  for (const char* name :
       {"text.h5", "empty.h5", "cut.h5", "foreign.h5", "folder.h5", "missing.h5"}) {
    for (const auto& arguments : reading_commands(path(name), path("a.svg"))) {
      const ProgramResult result = Program(arguments).run();
      EXPECT_EQ(result.exit_code, 4) << name << result.err;
      EXPECT_THAT(result.err, HasSubstr(name));
    }
  }
  EXPECT_FALSE(exists("a.svg"));
}

struct Damage {
  const char* what;
  std::function<void(hid_t)> action;
  std::string message;  ///< names the dataset
  bool is_seen_by_info = true;
  bool is_seen_by_history = true;
};

TEST_F(Pictures, DamagedDatasetsAreNamed) {
  const auto set_value = [](hid_t file, const char* dataset, hsize_t row, double value) {
    const hid_t data = H5Dopen2(file, dataset, H5P_DEFAULT);
    const hid_t space = H5Dget_space(data);
    const hsize_t one = 1;
    H5Sselect_hyperslab(space, H5S_SELECT_SET, &row, nullptr, &one, nullptr);
    const hid_t memory = H5Screate_simple(1, &one, nullptr);
    H5Dwrite(data, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, &value);
    H5Sclose(memory);
    H5Sclose(space);
    H5Dclose(data);
  };
  const auto resize = [](hid_t file, const char* dataset, hsize_t length) {
    const hid_t data = H5Dopen2(file, dataset, H5P_DEFAULT);
    H5Dset_extent(data, &length);
    H5Dclose(data);
  };
  const char* acceleration = "/channels/beam.tip.y.acceleration";
  const std::string named = std::string("dataset ") + acceleration;
  const std::vector<Damage> damages{
      {"no time", [](hid_t f) { H5Ldelete(f, "/time", H5P_DEFAULT); }, "dataset /time: is missing"},
      {"no rows", [&](hid_t f) { resize(f, "/time", 0); }, "dataset /time: is empty", false},
      {"times swapped", [&](hid_t f) { set_value(f, "/time", 7, 0.3); },
       "dataset /time: is not equidistant: row 7", false},
      {"time not a number", [&](hid_t f) { set_value(f, "/time", 3999, std::nan("")); },
       "dataset /time: is not equidistant", false},
      {"no scene", [](hid_t f) { H5Ldelete(f, "/scene/resolved", H5P_DEFAULT); },
       "dataset /scene/resolved: is missing"},
      {"channel too short", [&](hid_t f) { resize(f, acceleration, 100); },
       named + ": has 100 rows, but /time has 4000", false},
      {"no unit",
       [&](hid_t f) {
         const hid_t data = H5Dopen2(f, acceleration, H5P_DEFAULT);
         H5Adelete(data, "units");
         H5Dclose(data);
       },
       named + ": has no attribute 'units'"},
      {"not finite", [&](hid_t f) { set_value(f, acceleration, 2000, HUGE_VAL); },
       named + ": is not finite at 0.2 s", false},
      {"bursts without an end", [](hid_t f) { H5Ldelete(f, "/bursts/end", H5P_DEFAULT); },
       "dataset /bursts/end: is missing", true, false},
      {"burst that ends first", [&](hid_t f) { set_value(f, "/bursts/end", 0, 0.1); },
       "dataset /bursts/end: lies before the start in entry 0", true, false},
      {"burst without frequency", [&](hid_t f) { set_value(f, "/bursts/frequency", 0, NAN); },
       "dataset /bursts/frequency: is not finite in entry 0", true, false},
      {"bursts of different number",
       [](hid_t f) {
         const double values[2] = {1.0, 2.0};
         const hsize_t two = 2;
         H5Ldelete(f, "/bursts/gain", H5P_DEFAULT);
         H5LTmake_dataset_double(f, "/bursts/gain", 1, &two, values);
       },
       "dataset /bursts/gain: has 2 entries, but /bursts/start has 1", true, false},
      {"course of no burst",
       [](hid_t f) {
         const double values[2] = {0.0, 1.0};
         const hsize_t two = 2;
         const hid_t group = H5Gcreate2(f, "/bursts/course", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
         for (const char* name : {"burst", "time", "frequency", "level"})
           H5LTmake_dataset_double(group, name, 1, &two, values);
         H5Gclose(group);
       },
       "dataset /bursts/course/burst: is 1 somewhere, expected an index below 1 or -1", true,
       false},
  };
  for (const Damage& damage : damages) {
    const std::string run = make_run();
    edit(run, damage.action);
    std::vector<std::vector<std::string>> commands{
        {"spectrogram", run, "-o", path("a.svg")},
        {"plot", run, "--kind", "spectrum", "-o", path("a.svg")}};
    if (damage.is_seen_by_info) commands.push_back({"info", run});
    if (damage.is_seen_by_history)
      commands.push_back({"plot", run, "--kind", "history", "-o", path("a.svg")});
    for (const auto& arguments : commands) {
      const ProgramResult result = Program(arguments).run();
      EXPECT_EQ(result.exit_code, 4) << damage.what << ", " << arguments[0] << result.err;
      EXPECT_THAT(result.err, AllOf(HasSubstr("run.h5"), HasSubstr(damage.message)))
          << damage.what << ", " << arguments[0];
    }
  }
  EXPECT_FALSE(exists("a.svg"));
}

TEST_F(Pictures, UnreadableSceneIsNamedWhereItIsNeeded) {
  for (const char* scene : {"spectrogram: [", "measure: 7\n", "spectrogram: {overlap: much}\n"}) {
    RunContents contents;
    contents.scene = scene;
    const ProgramResult result =
        Program({"spectrogram", make_run(contents), "-o", path("a.svg")}).run();
    EXPECT_EQ(result.exit_code, 4) << result.err;
    EXPECT_THAT(result.err, HasSubstr("run.h5: dataset /scene/resolved: cannot be read"));
  }
  EXPECT_FALSE(exists("a.svg"));
}

TEST(DamageGuardDeathTest, CrashWhileAFileIsOpenIsFileTrouble) {
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGABRT}) {
    const auto crash = [&] {
      const DamageGuard guard("bad.h5");
      raise(signal);
    };
    EXPECT_EXIT(crash(), ::testing::ExitedWithCode(4), "I/O error\nbad.h5: is damaged");
  }
  const auto crash_later = [] {
    { const DamageGuard guard("good.h5"); }
    raise(SIGSEGV);
  };
  EXPECT_EXIT(crash_later(), ::testing::KilledBySignal(SIGSEGV), "");
}

TEST(DamageGuardDeathTest, WithJsonTheCrashIsToldAsOneObject) {
  // A name with a quote and a byte that is no UTF-8. Output goes where the test sees it.
  const auto crash = [] {
    DamageGuard::tell_as_json();
    dup2(STDERR_FILENO, STDOUT_FILENO);
    const DamageGuard outer("other.h5");
    { const DamageGuard over("good.h5"); }
    const DamageGuard guard("a\"b\xff.h5");
    raise(SIGSEGV);
  };
  const auto is_one_object = [](const std::string& told) {
    const std::size_t begin = told.find('{');
    const Json object = Json::parse(told.substr(std::min(begin, told.size())), nullptr, false);
    return !object.is_discarded() && object.size() == 1 && object["errors"].size() == 1 &&
           object["errors"][0]["file"] == "a\"b\xef\xbf\xbd.h5" &&
           object["errors"][0]["message"] ==
               "is damaged, as it seems: the program crashed while it had this file open";
  };
  EXPECT_EXIT(crash(), ::testing::ExitedWithCode(4), ::testing::Truly(is_one_object));
}

TEST_F(Pictures, BytesChangedAnywhereNeverEndInAnInternalError) {
  RunContents contents;
  contents.rows = 200;
  const std::string whole = contents_of(make_run(contents));
  std::mt19937 generator(11);
  for (int trial = 0; trial < 15; ++trial) {
    std::string bytes = whole;
    // The description of the data is mostly in the first pages.
    for (int i = 0; i < 20; ++i) bytes[generator() % 16384] = static_cast<char>(generator());
    write_file(path("bad.h5"), bytes);
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"info", path("bad.h5")},
          {"plot", path("bad.h5"), "--kind", "phase", "-o", path("a.svg"), "--force"}}) {
      const ProgramResult result = Program(arguments).run();
      EXPECT_THAT(result.exit_code, ::testing::AnyOf(0, 2, 4)) << trial << result.err;
    }
  }
}

/// A small locus, which is no run.
std::string make_locus(const std::string& path) {
  const ProgramResult result =
      Program({"locus", scene_path("beam_on_beam.yaml"), "--from", "70mm", "--to", "75mm",
               "--points", "3", "--count", "2", "-o", path})
          .run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return path;
}

TEST_F(Pictures, FilesOfOtherVerbsAreListedByInfo) {
  const std::string locus = make_locus(path("locus.h5"));
  const Json object = json_of({"info", locus});
  EXPECT_EQ(object["kind"], "locus");
  EXPECT_THAT(object["command"].get<std::string>(), HasSubstr("stridor locus"));
  Json growth;
  for (const Json& array : object["series"])
    if (array["path"] == "/eigenvalues/growth") growth = array;
  EXPECT_EQ(growth["shape"], Json::array({3, 2}));
  EXPECT_EQ(growth["units"], "1/s");
  EXPECT_FALSE(object["results"].contains("scene_resolved"));

  const ProgramResult text = Program({"info", locus}).run();
  EXPECT_THAT(text.out, AllOf(HasSubstr("kind"), HasSubstr("3 x 2, 1/s")));
  const ProgramResult band = Program({"info", locus, "--band", "1kHz,2kHz"}).run();
  EXPECT_EQ(band.exit_code, 2);
  EXPECT_THAT(band.err, HasSubstr("--band: is for the bursts of a run"));
}

TEST_F(Pictures, FilesOfOtherVerbsAreNamedByTheirKindWhereARunIsMeant) {
  const std::string locus = make_locus(path("locus.h5"));
  const ProgramResult result =
      Program({"plot", locus, "--kind", "history", "-o", path("a.svg")}).run();
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.err, HasSubstr("is not a run file of stridor, but of the kind 'locus'"));
  EXPECT_FALSE(exists("a.svg"));
}

TEST_F(Pictures, NumbersOfASpectrogramSayWhatMadeThem) {
  const std::string run = make_run();
  json_of({"spectrogram", run, "-o", path("a.svg"), "--data", path("data.h5")});
  const Json object = json_of({"info", path("data.h5")});
  EXPECT_EQ(object["kind"], "spectrogram");
  EXPECT_THAT(object["command"].get<std::string>(), HasSubstr("spectrogram"));
  EXPECT_EQ(object["results"]["run_file"], run);
}

}  // namespace
}  // namespace stridor
