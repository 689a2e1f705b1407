// Interrupted runs that are resumed: data bit-identical to an uninterrupted run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <chrono>
#include <filesystem>
#include <future>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/runs/transient.hpp"
#include "core/stop_token.hpp"
#include "tests/app/resume_fixture.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

struct Interruption {
  const char* name;
  const char* scene;
  std::vector<std::string> sets;
  double end;  ///< of the run, s
};

void PrintTo(const Interruption& one, std::ostream* stream) {
  *stream << one.name;
}

class Resume : public ::testing::TestWithParam<Interruption> {};

TEST_P(Resume, GoesOnBitwiseAsIfTheRunHadNotStopped) {
  const TemporaryFolder folder;
  const std::string whole = (folder / "whole.h5").string();
  const std::string broken = (folder / "broken.h5").string();
  std::vector<std::string> sets = GetParam().sets;
  const double end = GetParam().end;
  sets.push_back("time.end=" + std::to_string(end));
  const LoadedScene loaded = load_scene(scene_path(GetParam().scene), sets);
  {
    Transient transient(loaded, {whole, Overwrite::no, "test"});
    ASSERT_EQ(transient.run_to_end(), MarchEnd::finished) << transient.failure();
    transient.finish();
  }
  {
    Transient transient(loaded, {broken, Overwrite::no, "test"});
    transient.run_until(0.21 * end);
    transient.write_checkpoint();
    transient.run_until(0.35 * end);  // more rows than the checkpoint knows
  }
  for (const double stop : {0.47, 0.66, 0.83}) {
    const InterruptedRun interrupted = find_interrupted_run(broken);
    const LoadedScene again = load_resolved_scene(interrupted.scene_text, broken);
    Transient transient(again, interrupted);
    transient.run_until(stop * end);
    transient.write_checkpoint();
    if (stop == 0.66) {
      request_stop();
      EXPECT_EQ(transient.run_to_end(), MarchEnd::stopped);
      request_stop(false);
      transient.write_checkpoint();
      transient.finish();
    }
  }
  const InterruptedRun interrupted = find_interrupted_run(broken);
  const LoadedScene again = load_resolved_scene(interrupted.scene_text, broken);
  Transient transient(again, interrupted);
  ASSERT_EQ(transient.run_to_end(), MarchEnd::finished);
  transient.finish();
  EXPECT_EQ(difference(whole, broken), "");
}

// Windows of the statistics begin before the first interruption and end after the second.
INSTANTIATE_TEST_SUITE_P(
    Of, Resume,
    ::testing::Values(
        Interruption{"LandingWithStickSlipAndLiftOff",
                     "examples/landing.yaml",
                     {"measure.from=0.0005", "measure.to=0.003", "record.interval=1e-6"},
                     0.004},
        Interruption{"StickSlip", "examples/stick_slip.yaml", {"measure.from=0"}, 0.1},
        Interruption{
            "DampingScheduleAndEnergy",
            "beam_on_beam.yaml",
            {"substructures.oblique.damping.hold=1e-3", "substructures.oblique.damping.fade=1.5e-3",
             "record.energy=true", "contact.assumption=film", "drive.ramp=1e-3",
             "measure.from=5e-4", "measure.band=[]", "record.interval=2e-6"},
            0.003},
        Interruption{"ExactWithResidual",
                     "beam_on_beam.yaml",
                     {"time.integrator=exact", "time.step=2.5e-6", "time.retain.frequency=50kHz",
                      "measure.from=0.05"},
                     0.12},
        Interruption{"SeveralDrives",
                     "examples/opposite_drives.yaml",
                     {"measure.from=0", "drives.belt.ramp=0.5", "drives.piston.ramp=1"},
                     1.5},
        Interruption{"PublishedForm",
                     "beam_on_beam.yaml",
                     {"time.coordinates=craig_bampton", "measure.from=0", "measure.band=[]",
                      "record.interval=2e-6"},
                     0.0002},
        // From a large perturbation, so that contacts lift off and stick at every stop.
        Interruption{"ElasticPads",
                     "examples/elastic_pads.yaml",
                     {"initial.perturbation.amplitude=20um", "record.interval=1e-5"},
                     0.004},
        Interruption{"DiscSqueal",
                     "examples/disc_squeal.yaml",
                     {"initial.perturbation.amplitude=50um"},
                     0.01},
        // With stick and slip; the window of the cycles begins before the first interruption, in
        // which turns are between samples.
        Interruption{"EventDriven", "viscoelastic_sphere.yaml", {"measure.from=1"}, 7.5},
        Interruption{"EventDrivenInFewSamples",
                     "viscoelastic_sphere.yaml",
                     {"measure.from=1", "record.interval=0.7"},
                     7.5},
        Interruption{"HalfSpaceByExactSteps",
                     "viscoelastic_sphere.yaml",
                     {"time.integrator=exact", "time.step=2.5e-4", "measure.from=1"},
                     7.5},
        Interruption{"HalfSpaceByCentralDifference",
                     "viscoelastic_sphere.yaml",
                     {"time.integrator=central_difference", "time.step=2.5e-4", "measure.from=1"},
                     7.5}),
    [](const auto& tested) { return std::string(tested.param.name); });

// ---------------------------------------------------------------- the program

TEST(ResumeProgram, ATimeLimitStopsDiscsAndSpheres) {
  const TemporaryFolder folder;
  const std::string disc = (folder / "disc.h5").string();
  ProgramResult result = Program({"run", scene_path("examples/elastic_pads.yaml"), "-o", disc,
                                  "--set", "time.end=10", "--max-wall", "0.3"})
                             .run();
  ASSERT_EQ(result.exit_code, 5) << result.err;
  EXPECT_THAT(result.err, HasSubstr("--resume '" + disc + "'"));
  result = Program({"run", "--resume", disc, "--max-wall", "0.3", "--json"}).run();
  ASSERT_EQ(result.exit_code, 5) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out)["status"], "stopped");
  const std::string sphere = (folder / "sphere.h5").string();
  result = Program({"run", scene_path("viscoelastic_sphere.yaml"), "-o", sphere, "--set",
                    "time.end=2e5", "--max-wall", "0.3"})
               .run();
  ASSERT_EQ(result.exit_code, 5) << result.err;
  EXPECT_THAT(result.err, HasSubstr("--resume '" + sphere + "'"));
  const std::size_t count = RunFileReader(sphere).times().size();
  result = Program({"run", "--resume", sphere, "--max-wall", "0.3", "--json"}).run();
  ASSERT_EQ(result.exit_code, 5) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out)["status"], "stopped");
  EXPECT_GT(RunFileReader(sphere).times().size(), count);
}

TEST(ResumeProgram, KilledRunsGoOnBitwise) {
  kill_and_resume(5, 400);
}

TEST(ResumeProgram, ARequestToStopAndATimeLimitLeaveARunThatGoesOn) {
  const TemporaryFolder folder;
  const std::string whole = (folder / "whole.h5").string();
  const std::string broken = (folder / "broken.h5").string();
  ASSERT_EQ(Program(long_run(whole, "1.5")).run().exit_code, 0);
  ProgramResult result;
  // On a busy machine a run may be over before it is asked to stop.
  for (result.exit_code = 0; result.exit_code == 0;) {
    std::filesystem::remove(broken);
    Program program(long_run(broken, "1.5"));
    program.start();
    wait_for(broken);
    program.send(SIGTERM);
    result = program.wait();
  }
  ASSERT_EQ(result.exit_code, 5) << result.err;
  EXPECT_THAT(result.err, HasSubstr("--resume '" + broken + "'"));
  result = Program({"run", "--resume", broken, "--max-wall", "0.001"}).run();
  ASSERT_EQ(result.exit_code, 5) << result.err;
  result = Program({"run", "--resume", broken, "--json"}).run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out)["status"], "done");
  EXPECT_EQ(difference(whole, broken), "");

  // A whole run is left alone, and a loop that resumes until all is done ends.
  const std::string bytes = contents_of(broken);
  result = Program({"run", "--resume", broken}).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("holds the whole run, there is nothing left to do"));
  result = Program({"run", "--resume", broken, "--json"}).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto stored = nlohmann::json::parse(result.out);
  EXPECT_EQ(stored["status"], "done");
  EXPECT_TRUE(stored["contact_force"]["max"].is_number());
  EXPECT_EQ(contents_of(broken), bytes);
}

TEST(ResumeProgram, OfTwoAtOnceOneIsRefused) {
  const TemporaryFolder folder;
  const std::string whole = (folder / "whole.h5").string();
  const std::string broken = (folder / "broken.h5").string();
  ASSERT_EQ(Program(long_run(whole, "1.5")).run().exit_code, 0);
  std::vector<std::string> stopped = long_run(broken, "1.5");
  stopped.insert(stopped.end(), {"--max-wall", "0.05"});
  ASSERT_EQ(Program(stopped).run().exit_code, 5);

  const std::string kept = (folder / "kept.h5").string();
  std::filesystem::copy_file(broken, kept);
  // On a busy machine one may be over before the other begins.
  ProgramResult refused;
  do {
    std::filesystem::copy_file(kept, broken, std::filesystem::copy_options::overwrite_existing);
    Program one({"run", "--resume", broken});
    Program other({"run", "--resume", broken});
    one.start();
    other.start();
    const ProgramResult first = one.wait();
    const ProgramResult second = other.wait();
    ASSERT_THAT((std::vector<int>{first.exit_code, second.exit_code}),
                ::testing::UnorderedElementsAre(0, 4))
        << first.err << second.err;
    refused = first.exit_code == 4 ? first : second;
  } while (was_over(refused));
  EXPECT_THAT(refused.err,
              HasSubstr(broken + ": another process is writing it, a run that goes on"));
  EXPECT_EQ(difference(whole, broken), "") << "the run that was refused has left it alone";
}

TEST(ResumeProgram, AFileThatIsBeingWrittenIsNotReplaced) {
  const TemporaryFolder folder;
  const std::string file = (folder / "run.h5").string();
  const auto is_refused = HasSubstr(file + ": another process is writing it, a run that goes on");
  Program running(endless_run(file));
  running.start();
  wait_for(file);
  const std::string sphere = scene_path("viscoelastic_sphere.yaml");
  const std::vector<std::vector<std::string>> intruders{
      long_run(file),
      {"run", scene_path("examples/elastic_pads.yaml"), "-o", file},
      {"run", sphere, "-o", file},
      {"locus", scene_path("beam_on_beam.yaml"), "--from", "30mm", "--to", "40mm", "--points", "2",
       "-o", file},
      {"sweep", scene_path("beam_on_beam.yaml"), "--from", "30mm", "--to", "40mm", "--points", "2",
       "-o", file}};
  for (std::vector<std::string> intruder : intruders) {
    intruder.emplace_back("--force");
    const ProgramResult result = Program(intruder).run();
    EXPECT_EQ(result.exit_code, 4) << intruder[0] << ' ' << intruder[1] << result.err;
    EXPECT_THAT(result.err, is_refused) << intruder[0] << ' ' << intruder[1];
  }
  running.send(SIGTERM);
  const ProgramResult stopped = running.wait();
  ASSERT_EQ(stopped.exit_code, 5) << stopped.err;
  const double reached = RunFileReader(file).times().back();

  // It is whole, and once nobody writes it any more it goes on or may be replaced.
  double now = reached;
  for (int i = 0; i < 50 && now == reached; ++i) {  // set-up may take all of the time given
    const ProgramResult resumed = Program({"run", "--resume", file, "--max-wall", "0.1"}).run();
    ASSERT_EQ(resumed.exit_code, 5) << resumed.err;
    now = RunFileReader(file).times().back();
  }
  EXPECT_GT(now, reached);
  std::vector<std::string> next = long_run(file, "0.01");
  next.insert(next.end(), {"--set", "measure.from=0", "--force"});
  EXPECT_EQ(Program(next).run().exit_code, 0);
}

TEST(ResumeProgram, OfTwoThatMakeOrReplaceAFileAtOnceOneIsRefused) {
  const TemporaryFolder folder;
  const std::string file = (folder / "run.h5").string();
  std::vector<std::string> command = endless_run(file);
  command.emplace_back("--force");
  for (const char* what : {"made", "replaced", "replaced again"}) {
    Program one(command);
    Program other(command);
    one.start();
    other.start();
    std::future<ProgramResult> first = std::async(std::launch::async, [&] { return one.wait(); });
    std::future<ProgramResult> second =
        std::async(std::launch::async, [&] { return other.wait(); });
    constexpr std::chrono::milliseconds pause(10);
    while (first.wait_for(pause) != std::future_status::ready &&
           second.wait_for(pause) != std::future_status::ready) {
    }
    const bool is_first = first.wait_for(pause) == std::future_status::ready;
    const ProgramResult refused = (is_first ? first : second).get();
    EXPECT_EQ(refused.exit_code, 4) << what;
    EXPECT_THAT(refused.err, HasSubstr(file + ": another process is writing it")) << what;
    (is_first ? other : one).send(SIGTERM);
    EXPECT_EQ((is_first ? second : first).get().exit_code, 5) << what;
    EXPECT_EQ(std::get<std::string>(RunFileReader(file).results().at("status")), "stopped");
  }
}

class ResumeRefusal : public ::testing::Test {
 protected:
  void SetUp() override {
    const LoadedScene loaded =
        load_scene(scene_path("beam_on_beam.yaml"), {"time.end=1e-4", "measure.band=[]"});
    Transient transient(loaded, {file_, Overwrite::no, "test"});
    transient.run_until(5e-5);
    transient.write_checkpoint();
  }
  template <class Change>
  void change(const Change& change) const {
    const hid_t id = H5Fopen(file_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    ASSERT_GE(id, 0);
    change(id);
    ASSERT_GE(H5Fclose(id), 0);
  }
  /// Overwrites the middle of a checkpoint.
  static void spoil(hid_t file, const char* path) {
    const hid_t set = H5Dopen2(file, path, H5P_DEFAULT);
    const hid_t space = H5Dget_space(set);
    hsize_t length = 0;
    H5Sget_simple_extent_dims(space, &length, nullptr);
    std::vector<unsigned char> bytes(length);
    if (length > 0) {
      H5Dread(set, H5T_NATIVE_UCHAR, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data());
      bytes[length / 2] ^= 1;
      H5Dwrite(set, H5T_NATIVE_UCHAR, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data());
    }
    H5Sclose(space);
    H5Dclose(set);
  }
  ProgramResult resume() const { return Program({"run", "--resume", file_}).run(); }

  TemporaryFolder folder_;
  const std::string file_ = (folder_ / "run.h5").string();
};

TEST_F(ResumeRefusal, NamesAMissingCheckpoint) {
  change([](hid_t file) { H5Ldelete(file, "/checkpoint", H5P_DEFAULT); });
  const ProgramResult result = resume();
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.err, HasSubstr("there is no whole checkpoint to go on from"));
}

TEST_F(ResumeRefusal, TakesTheOtherCheckpointWhereOneIsDamaged) {
  EXPECT_EQ(find_interrupted_run(file_).checkpoint.number, 2u);
  change([](hid_t file) { spoil(file, "/checkpoint/b"); });
  EXPECT_EQ(find_interrupted_run(file_).checkpoint.number, 1u);
  change([](hid_t file) { spoil(file, "/checkpoint/a"); });
  const ProgramResult result = resume();
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.err, HasSubstr("no whole checkpoint"));
}

TEST_F(ResumeRefusal, NamesAnotherVersion) {
  change([](hid_t file) {
    const hid_t attribute = H5Aopen(file, "version", H5P_DEFAULT);
    const hid_t type = H5Aget_type(attribute);
    const std::string other(H5Tget_size(type) - 1, '9');
    H5Awrite(attribute, type, other.c_str());
    H5Tclose(type);
    H5Aclose(attribute);
  });
  const ProgramResult result = resume();
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.err, HasSubstr("was written by stridor 9"));
}

TEST_F(ResumeRefusal, NamesAForeignFileAndAMissingOne) {
  std::filesystem::resize_file(file_, 700);
  EXPECT_EQ(resume().exit_code, 4);
  std::filesystem::remove(file_);
  EXPECT_EQ(resume().exit_code, 4);
}

TEST(ResumeProgram, RefusesOptionsThatDoNotGoWithIt) {
  for (const std::vector<std::string>& more : {std::vector<std::string>{"-o", "b.h5"},
                                               {"--set", "time.end=1"},
                                               {"--force"},
                                               {scene_path("beam_on_beam.yaml")}}) {
    std::vector<std::string> command{"run", "--resume", "a.h5"};
    command.insert(command.end(), more.begin(), more.end());
    const ProgramResult result = Program(command).run();
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr("leave scene, --output, --set and --force away"));
  }
  EXPECT_EQ(Program({"run"}).run().exit_code, 2);
  EXPECT_EQ(Program({"run", scene_path("beam_on_beam.yaml")}).run().exit_code, 2);
}

}  // namespace
}  // namespace stridor
