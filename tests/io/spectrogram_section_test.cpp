// The section `spectrogram` of a scene.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "io/scene/scene.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;
using ::testing::Not;

LoadedScene main_scene_with(const std::vector<std::string>& sets) {
  return load_scene(scene_path("beam_on_beam.yaml"), sets);
}

std::string refusal_of(const std::string& set, const std::string& more = "format=2") {
  return message_of<ConfigError>([&] { main_scene_with({set, more}); });
}

TEST(SpectrogramSection, AbsentSectionIsNotResolved) {
  const LoadedScene loaded = main_scene_with({});
  EXPECT_FALSE(loaded.scene.spectrogram.has_value());
  EXPECT_THAT(loaded.resolved(), Not(HasSubstr("spectrogram")));
}

TEST(SpectrogramSection, HoldsWhatIsGivenAndDefaultsForTheRest) {
  const SpectrogramSection section =
      main_scene_with({"spectrogram={length: 12.5 ms, max_frequency: 12 kHz}"})
          .scene.spectrogram.value();
  EXPECT_EQ(section.length, 0.0125);
  EXPECT_EQ(section.max_frequency, 12000.0);
  EXPECT_EQ(section.window, WindowKind::hann);
  EXPECT_EQ(section.overlap, 0.75);
  EXPECT_FALSE(section.channel.has_value());
}

TEST(SpectrogramSection, ResolvedSceneReadsBackToTheSame) {
  const LoadedScene loaded = main_scene_with(
      {"spectrogram={channel: contact.force, window: blackman_harris, overlap: 50 %}"});
  EXPECT_THAT(loaded.resolved(), HasSubstr("window: blackman_harris"));
  const TemporaryFolder folder;
  write_file(folder / "resolved.yaml", loaded.resolved());
  EXPECT_EQ(load_scene((folder / "resolved.yaml").string(), {}).resolved(), loaded.resolved());
}

TEST(SpectrogramSection, ValuesOutOfRangeAreRefused) {
  EXPECT_THAT(refusal_of("spectrogram.window=han"), HasSubstr("did you mean 'hann'?"));
  EXPECT_THAT(refusal_of("spectrogram.overlap=1"), HasSubstr("spectrogram.overlap"));
  EXPECT_THAT(refusal_of("spectrogram.overlap=-0.1"), HasSubstr("spectrogram.overlap"));
  EXPECT_THAT(refusal_of("spectrogram.length=0"), HasSubstr("spectrogram.length"));
  EXPECT_THAT(refusal_of("spectrogram.length=5 Hz"), HasSubstr("spectrogram.length"));
  EXPECT_THAT(refusal_of("spectrogram.lenght=1"), HasSubstr("did you mean 'length'?"));
}

TEST(SpectrogramSection, WhatTheRecordCannotGiveIsRefused) {
  EXPECT_THAT(refusal_of("spectrogram.channel=contact.forc"),
              HasSubstr("spectrogram.channel: 'contact.forc' is not among record.channels, did you "
                        "mean 'contact.force'?"));
  EXPECT_THAT(refusal_of("spectrogram.length=15 us"),
              HasSubstr("must be at least two times record.interval = 1e-05 s"));
  EXPECT_THAT(refusal_of("spectrogram.length=3"), HasSubstr("at most time.end = 2.25 s"));
  EXPECT_THAT(refusal_of("spectrogram.max_frequency=51 kHz"),
              HasSubstr("51000 Hz is above 50000 Hz, the highest frequency"));
}

TEST(SpectrogramSection, OnePointOfAPairMayBeNamed) {
  EXPECT_EQ(main_scene_with({"spectrogram.channel=contact[3].force"}).scene.spectrogram->channel,
            "contact[3].force");
}

}  // namespace
}  // namespace stridor
