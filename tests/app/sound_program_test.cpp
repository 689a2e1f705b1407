// Sounds that the program makes of run files, and its messages where it cannot.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/app/pictures_fixture.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using Json = nlohmann::json;

class SoundProgram : public Pictures {
 protected:
  static unsigned number(const std::string& bytes, std::size_t at, int count) {
    unsigned value = 0;
    for (int i = count - 1; i >= 0; --i)
      value = 256 * value + static_cast<unsigned char>(bytes[at + static_cast<std::size_t>(i)]);
    return value;
  }

  /// The samples of a channel of a file of 24 bits.
  static std::vector<double> samples_of(const std::string& file, std::size_t channel = 0) {
    const std::string bytes = contents_of(file);
    EXPECT_THAT(bytes, StartsWith("RIFF"));
    const std::size_t frame = number(bytes, 32, 2);
    std::vector<double> samples;
    for (std::size_t at = 44 + 3 * channel; at + 3 <= bytes.size(); at += frame) {
      const int value = static_cast<int>(number(bytes, at, 3) << 8) >> 8;
      samples.push_back(value / 8388607.0);
    }
    return samples;
  }

  /// Changes of sign of a stretch over twice its length: the frequency of a tone.
  static double frequency_of(const std::vector<double>& samples, double rate, double from,
                             double to) {
    int crossings = 0;
    for (auto i = static_cast<std::size_t>(from * rate); i < static_cast<std::size_t>(to * rate);
         ++i)
      if ((samples[i] > 0.0) != (samples[i + 1] > 0.0)) ++crossings;
    return 0.5 * crossings / (to - from);
  }

  static ProgramResult sound(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "sound");
    return Program(arguments).run();
  }
};

TEST_F(SoundProgram, TheAccelerationIsWrittenBesideTheRunFile) {
  const std::string run = make_run();
  const Json object = json_of({"sound", run});
  EXPECT_EQ(object["sound"], path("run.wav"));
  EXPECT_EQ(object["channels"], Json::array({"beam.tip.y.acceleration"}));
  EXPECT_EQ(object["units"], "m/s^2");
  EXPECT_EQ(object["rate"], 48000);
  EXPECT_NEAR(object["full_scale"].get<double>(), 2.0 / 0.9, 0.03 * 2.0 / 0.9);
  EXPECT_NEAR(object["lost"].get<double>(), 0.0, 1e-3);
  const std::vector<double> samples = samples_of(path("run.wav"));
  ASSERT_NEAR(static_cast<double>(samples.size()), 0.4 * 48000, 10.0);
  EXPECT_NEAR(frequency_of(samples, 48000, 0.21, 0.29), tone, 15.0);
  EXPECT_NEAR(*std::max_element(samples.begin(), samples.end()), 0.9, 0.03);
  EXPECT_LT(std::abs(samples[static_cast<std::size_t>(0.1 * 48000)]), 1e-3);
}

TEST_F(SoundProgram, SlowAndStretchedAsAsked) {
  const std::string run = make_run();
  json_of({"sound", run, "--slow", "4", "--from", "0.2", "--to", "0.3", "--rate", "44100", "-o",
           path("slow.wav")});
  const std::vector<double> samples = samples_of(path("slow.wav"));
  ASSERT_NEAR(static_cast<double>(samples.size()), 4 * 0.1 * 44100, 10.0);
  EXPECT_NEAR(frequency_of(samples, 44100, 0.1, 0.3), tone / 4.0, 5.0);
}

TEST_F(SoundProgram, TwoChannelsAreLeftAndRight) {
  RunContents contents;
  contents.channels.emplace_back("/channels/beam.root.y.acceleration");
  const std::string run = make_run(contents);
  const ProgramResult result =
      sound({run, "--channel", "beam.tip.y.acceleration", "--channel", "beam.root.y.acceleration"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("beam.tip.y.acceleration (left) and "
                                    "beam.root.y.acceleration (right)"));
  EXPECT_EQ(samples_of(path("run.wav"), 0), samples_of(path("run.wav"), 1));
}

TEST_F(SoundProgram, ASlowerRateSaysWhatIsNotHeard) {
  const std::string run = make_run();
  const ProgramResult fast = sound({run, "--slow", "0.1", "--rate", "8000"});  // 10 kHz of 4
  EXPECT_EQ(fast.exit_code, 0) << fast.err;
  EXPECT_THAT(fast.out, HasSubstr("% of the power lies above 0.4 kHz and is not in it"));
  EXPECT_THAT(sound({run, "--force"}).out, Not(HasSubstr("of the power")));
}

TEST_F(SoundProgram, WhatDoesNotMoveIsSilent) {
  const std::string run = make_run();
  const ProgramResult result = sound({run, "--to", "0.1"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("the sound is silent"));
  for (const double sample : samples_of(path("run.wav"))) EXPECT_EQ(sample, 0.0);
}

TEST_F(SoundProgram, RefusalsSayWhatToDo) {
  const std::string run = make_run();
  const auto refused = [&](std::vector<std::string> arguments, const char* text) {
    arguments.insert(arguments.begin(), run);
    const ProgramResult result = sound(arguments);
    EXPECT_EQ(result.exit_code, 2) << result.out;
    EXPECT_THAT(result.err, HasSubstr(text));
    EXPECT_FALSE(exists("run.wav"));
  };
  refused({"-o", path("run.mp3")}, "does not end in .wav");
  refused({"--channel", "beam.tip.y.acceleration", "--channel", "beam.tip.y.velocity"},
          "a left and a right channel are in one unit");
  refused({"--channel", "beam.tip.y.acceleraton"}, "beam.tip.y.acceleration");
  refused({"--from", "0.2", "--to", "0.2"}, "choose a longer stretch");
  refused({"--slow", "1e6"}, "do not fit into a file");
  refused({"--rate", "10"}, "--rate");
}

TEST_F(SoundProgram, ARunWithoutAccelerationIsToldItsChannelsAndAnExistingSoundIsKept) {
  const std::string run = make_run({.channels = {"/channels/beam.tip.y.velocity"},
                                    .scene = "format: 2\n",
                                    .has_bursts = false});
  const ProgramResult none = sound({run});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("name one of its channels: beam.tip.y.velocity"));
  EXPECT_EQ(sound({run, "--channel", "beam.tip.y.velocity"}).exit_code, 0);
  const ProgramResult again = sound({run, "--channel", "beam.tip.y.velocity"});
  EXPECT_NE(again.exit_code, 0);
  EXPECT_THAT(again.err, HasSubstr("--force"));
  const ProgramResult missing = sound({path("none.h5")});
  EXPECT_EQ(missing.exit_code, 4);
  EXPECT_FALSE(exists("none.wav"));
}

}  // namespace
}  // namespace stridor
