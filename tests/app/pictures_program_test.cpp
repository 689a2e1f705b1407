// The pictures that the program makes of run files, and its messages where it cannot.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "tests/app/pictures_fixture.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using Json = nlohmann::json;

// ---------------------------------------------------------------- history, spectrum, phase

TEST_F(Pictures, HistoryShadesTheBurstsOfTheAcceleration) {
  const std::string run = make_run();
  EXPECT_EQ(json_of({"plot", run, "--kind", "history", "-o", path("a.svg")})["bursts"], 1);
  EXPECT_THAT(contents_of(path("a.svg")), HasSubstr("beam.tip.y  (shaded: bursts)"));
  EXPECT_THAT(contents_of(path("a.svg")), HasSubstr("rgb(251, 227, 189)"));
  json_of({"plot", run, "--kind", "history", "-o", path("b.svg"), "--to", "0.1"});
  EXPECT_THAT(contents_of(path("b.svg")), Not(HasSubstr("shaded")));
}

TEST_F(Pictures, SpectrumGathersChannelsByUnitAndMarksBursts) {
  const std::string run = make_run();
  const Json object = json_of({"plot", run, "--kind", "spectrum", "-o", path("a.svg")});
  ASSERT_EQ(object["channels"].size(), 4u);
  EXPECT_EQ(object["scale"], "db");
  EXPECT_EQ(object["bursts"], 1);
  EXPECT_EQ(object["overlap"], 0.5);
  EXPECT_EQ(object["length_samples"], 500);  // an eighth of 0.4 s
  const std::string svg = contents_of(path("a.svg"));
  for (const char* text : {"(dB re 1 µm/s²)", "(dB re 1 nm/s)", "(dB re 1 pm)", "(dB re 1 µN)",
                           "1: 1 kHz", "contact.force", "50 ms"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
  json_of({"plot", run, "--kind", "spectrum", "-o", path("b.svg"), "--scale", "linear", "--channel",
           "beam.tip.y.velocity"});
  EXPECT_THAT(contents_of(path("b.svg")), AllOf(HasSubstr("m/s"), Not(HasSubstr("dB"))));
}

TEST_F(Pictures, PhaseShowsDisplacementAgainstVelocityOfOnePoint) {
  const std::string run = make_run();
  const Json pair = json_of({"plot", run, "--kind", "phase", "-o", path("a.svg")});
  EXPECT_EQ(pair["across"], "beam.tip.y.displacement");
  EXPECT_EQ(pair["up"], "beam.tip.y.velocity");
  EXPECT_THAT(contents_of(path("a.svg")), AllOf(HasSubstr("beam.tip.y.displacement (nm)"),
                                                HasSubstr("beam.tip.y.velocity (µm/s)"),
                                                HasSubstr("Only 10 samples per period")));
  const Json one = json_of(
      {"plot", run, "--kind", "phase", "-o", path("b.svg"), "--channel", "beam.tip.y.velocity"});
  EXPECT_EQ(one["across"], "beam.tip.y.displacement");
  const Json two = json_of({"plot", run, "--kind", "phase", "-o", path("c.svg"), "--channel",
                            "contact.force", "--channel", "beam.tip.y.velocity"});
  EXPECT_EQ(two["across"], "contact.force");
  EXPECT_EQ(two["up"], "beam.tip.y.velocity");
}

/// Width and height of a PNG in dots.
std::pair<unsigned, unsigned> size_of_png(const std::string& file) {
  const std::string bytes = contents_of(file);
  const auto number = [&](std::size_t at) {
    unsigned value = 0;
    for (std::size_t i = at; i < at + 4; ++i)
      value = value * 256 + static_cast<unsigned char>(bytes.at(i));
    return value;
  };
  return {number(16), number(20)};
}

TEST_F(Pictures, HistoryOfTenContactsShowsTheEightChannelsOfMostUse) {
  RunContents contents;
  contents.rows = 200;
  contents.has_bursts = false;
  for (int i = 0; i < 10; ++i) {
    for (const char* quantity : {"force", "gap", "slip_velocity"})
      contents.channels.push_back("/contact/pad[" + std::to_string(i) + "]/" + quantity);
  }
  const std::string run = make_run(contents);
  const Json object = json_of({"plot", run, "--kind", "history", "-o", path("a.svg")});
  EXPECT_EQ(object["panels"], 8);
  EXPECT_EQ(object["left_out"].size(), 34u - 8u);
  const std::string svg = contents_of(path("a.svg"));
  // One of every quantity, the acceleration first, then the second of those that have one.
  EXPECT_THAT(svg, AllOf(HasSubstr("acceleration"), HasSubstr("slip velocity"), HasSubstr("gap"),
                         HasSubstr("pad[0]"), HasSubstr("pad[1]"), Not(HasSubstr("pad[9]"))));
  EXPECT_THAT(svg, HasSubstr("8 of 34 channels"));
  const ProgramResult plain =
      Program({"plot", run, "--kind", "history", "-o", path("a.png")}).run();
  EXPECT_THAT(plain.out, HasSubstr("26 more channels are left out"));
  EXPECT_LE(size_of_png(path("a.png")).second, 5000u);
  // Whoever names channels gets them, in that order.
  const Json named = json_of({"plot", run, "--kind", "history", "-o", path("b.svg"), "--channel",
                              "pad[9].gap", "--channel", "pad[2].force"});
  EXPECT_EQ(named["panels"], 2);
  EXPECT_TRUE(named["left_out"].empty());
  EXPECT_THAT(contents_of(path("b.svg")), HasSubstr("pad[9]"));
  const Json spectrum = json_of({"plot", run, "--kind", "spectrum", "-o", path("c.svg")});
  EXPECT_EQ(spectrum["channels"].size(), 8u);
}

TEST_F(Pictures, MorePanelsThanAPictureHoldsAreRefused) {
  RunContents contents;
  contents.rows = 10;
  contents.has_bursts = false;
  contents.channels.clear();
  std::vector<std::string> arguments{"plot",    path("run.h5"), "--kind",
                                     "history", "-o",           path("a.png")};
  for (int i = 0; i < 41; ++i) {
    contents.channels.push_back("/contact/pad[" + std::to_string(i) + "]/force");
    arguments.insert(arguments.end(), {"--channel", "pad[" + std::to_string(i) + "].force"});
  }
  make_run(contents);
  const ProgramResult result = Program(arguments).run();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("41 channels, but one picture holds at most 40"));
}

TEST_F(Pictures, ForcesAreDrawnWithTheirExtremesAndTheirSpectraFromTheLowPassedSeries) {
  RunContents contents;
  contents.has_bursts = false;
  contents.channels = {"/contact/contact/force", "/contact/contact/force_low_passed",
                       "/contact/contact/force_max", "/contact/contact/force_min",
                       "/contact/contact/gap"};
  const std::string run = make_run(contents);
  const Json history = json_of({"plot", run, "--kind", "history", "-o", path("a.svg")});
  EXPECT_EQ(history["panels"], 2);
  EXPECT_THAT(contents_of(path("a.svg")), HasSubstr("band: extremes of all steps"));
  const Json spectrum = json_of({"plot", run, "--kind", "spectrum", "-o", path("b.svg")});
  ASSERT_EQ(spectrum["channels"].size(), 2u);
  EXPECT_EQ(spectrum["channels"][0]["channel"], "contact.force_low_passed");
  const Json spectrogram = json_of({"spectrogram", run, "--channel", "contact.force"});
  EXPECT_EQ(spectrogram["channel"], "contact.force_low_passed");
}

TEST_F(Pictures, PhaseTakesTheSlipOfAContactFirst) {
  RunContents contents;
  contents.channels.emplace_back("/contact/contact/position");
  contents.channels.emplace_back("/contact/contact/slip_velocity");
  const Json object = json_of({"plot", make_run(contents), "--kind", "phase", "-o", path("a.svg")});
  EXPECT_EQ(object["across"], "contact.position");
  EXPECT_EQ(object["up"], "contact.slip_velocity");
}

TEST_F(Pictures, PhaseSaysWhatToRecordInsteadOfIntegrating) {
  const auto message = [&](std::vector<std::string> channels, std::vector<std::string> more) {
    RunContents contents;
    contents.channels = std::move(channels);
    std::vector<std::string> arguments{"plot", make_run(contents), "--kind", "phase",
                                       "-o",   path("a.svg")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr("--channel"));
    return result.err;
  };
  EXPECT_THAT(message({"/channels/beam.tip.y.velocity"}, {}),
              AllOf(HasSubstr("nothing is integrated"),
                    HasSubstr("record beam.tip.y.displacement with beam.tip.y.velocity")));
  EXPECT_THAT(message({"/channels/beam.tip.y.acceleration"}, {}),
              HasSubstr("record beam.tip.y.displacement and beam.tip.y.velocity"));
  EXPECT_THAT(message({"/contact/contact/force"}, {}),
              HasSubstr("record a displacement and the velocity of the same point"));
  EXPECT_THAT(
      message({"/channels/beam.tip.y.velocity"}, {"--channel", "beam.tip.y.velocity"}),
      AllOf(HasSubstr("beam.tip.y.displacement is not recorded"), HasSubstr("add it to record")));
  EXPECT_THAT(message({"/contact/contact/force"}, {"--channel", "contact.force"}),
              HasSubstr("name a second channel"));
  EXPECT_THAT(message({"/contact/contact/force"}, {"--channel", "contact.force", "--channel",
                                                   "contact.force", "--channel", "contact.force"}),
              HasSubstr("one channel against one other"));
  EXPECT_FALSE(exists("a.svg"));
}

// ---------------------------------------------------------------- refusals

TEST_F(Pictures, FilesThatExistAreKeptWithoutForce) {
  const std::string run = make_run();
  const std::string before = contents_of(run);
  write_file(path("a.png"), "old");
  write_file(path("data.h5"), "old");
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"spectrogram", run, "-o", path("a.png")},
        {"spectrogram", run, "-o", path("b.png"), "--data", path("data.h5")},
        {"plot", run, "--kind", "spectrogram", "-o", path("a.png")},
        {"plot", run, "--kind", "history", "-o", path("a.png")},
        {"plot", run, "--kind", "spectrum", "-o", path("a.png")},
        {"plot", run, "--kind", "phase", "-o", path("a.png")}}) {
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 4) << result.err;
    EXPECT_THAT(result.err, HasSubstr("exists; use --force to overwrite it"));
  }
  EXPECT_EQ(contents_of(path("a.png")), "old");
  EXPECT_EQ(contents_of(path("data.h5")), "old");
  EXPECT_FALSE(exists("b.png"));
  EXPECT_EQ(Program({"spectrogram", run, "-o", path("a.png"), "--data", path("data.h5"), "--force"})
                .run()
                .exit_code,
            0);
  EXPECT_THAT(contents_of(path("a.png")), StartsWith("\x89PNG"));
  EXPECT_THAT(contents_of(path("data.h5")), StartsWith("\x89HDF"));
  EXPECT_EQ(contents_of(run), before);
}

struct BadUsage {
  std::vector<std::string> arguments;  ///< behind the verb and the run file
  std::string message;
};

void PrintTo(const BadUsage& usage, std::ostream* stream) {
  for (const std::string& word : usage.arguments) *stream << word << ' ';
}

class BadUsageTest : public Pictures, public ::testing::WithParamInterface<BadUsage> {};

TEST_P(BadUsageTest, IsRefusedWithTheRemedyAndLeavesNoFile) {
  const std::string run = make_run();
  std::vector<std::string> arguments = GetParam().arguments;
  arguments.insert(arguments.begin() + 1, run);
  if (std::find(arguments.begin(), arguments.end(), "-o") == arguments.end()) {
    arguments.emplace_back("-o");
    arguments.push_back(path("a.svg"));
  }
  const ProgramResult result = Program(arguments).run();
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_THAT(result.err, HasSubstr(GetParam().message));
  EXPECT_TRUE(result.out.empty()) << result.out;
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 1);
}

INSTANTIATE_TEST_SUITE_P(
    Options, BadUsageTest,
    ::testing::Values(
        BadUsage{{"spectrogram", "--channel", "beam.tip.y.acelleration"},
                 "did you mean 'beam.tip.y.acceleration'?"},
        BadUsage{{"spectrogram", "-o", "both.png", "--data", "both.png"},
                 "--data: 'both.png' is also the figure"},
        BadUsage{{"spectrogram", "--band", "2000,1000"},
                 "must be a lower and an upper frequency below 5000 Hz"},
        BadUsage{{"spectrogram", "--channel", "contact.force", "--channel", "contact.force"},
                 "a spectrogram shows one channel"},
        BadUsage{{"spectrogram", "--channel", "contact.force", "--band", "800,1200"},
                 "--band: seeks bursts in beam.tip.y.acceleration, but the spectrogram is that of "
                 "contact.force"},
        BadUsage{{"spectrogram", "--window", "han"}, "--window: there is no window 'han', did you"},
        BadUsage{{"spectrogram", "--length", "1 s"}, "a piece of 1 s is longer than the 0.4 s of"},
        BadUsage{{"spectrogram", "--length", "1 s"}, "give at most --length 0.4"},
        BadUsage{{"spectrogram", "--length", "30 ms", "--to", "20 ms"},
                 "give at most --length 0.0201, or choose a longer stretch"},
        BadUsage{{"spectrogram", "--length", "10 us"}, "less than two samples"},
        BadUsage{{"spectrogram", "--length", "5 Hz"}, "--length: '5 Hz' has unit Hz"},
        BadUsage{{"spectrogram", "--length=-1"}, "--length: must be > 0 s"},
        BadUsage{{"spectrogram", "--overlap", "1"}, "--overlap: must be in [0, 1)"},
        BadUsage{{"spectrogram", "--overlap", "0.999", "--length", "10 ms"},
                 "moves a piece of 100 samples on by less than one; allowed: up to 0.99"},
        BadUsage{{"spectrogram", "--from", "1"}, "holds no sample there, only from 0 to 0.3999 s"},
        BadUsage{{"spectrogram", "--from", "0.3", "--to", "0.1"},
                 "--from: 0.3 s is after --to = 0.1 s"},
        BadUsage{{"spectrogram", "--from", "0.1", "--to", "0.1"}, "needs a longer stretch"},
        BadUsage{{"spectrogram", "--max-frequency", "6 kHz"},
                 "6000 Hz is above 5000 Hz, the highest frequency"},
        BadUsage{{"spectrogram", "--reference", "0"}, "--reference: must be > 0 m/s^2"},
        BadUsage{{"spectrogram", "--reference", "1 N"}, "--reference: '1 N' has unit N"},
        BadUsage{{"spectrogram", "--range", "-3"}, "--range: must be > 0"},
        BadUsage{{"spectrogram", "--band", "800"}, "--band: '800' is no band; write LOWER,UPPER"},
        BadUsage{{"spectrogram", "--band", "800,1 m"}, "--band: '1 m' has unit m"},
        BadUsage{{"spectrogram", "--band", "1200,800"}, "must be a lower and an upper frequency"},
        BadUsage{{"spectrogram", "--band", "1 kHz,5 kHz"}, "below 5000 Hz, half the sampling rate"},
        BadUsage{{"plot", "--kind", "phase", "--band", "1,2"}, "--band: means nothing"},
        BadUsage{{"spectrogram", "-o", "figure.bmp"}, "must end with .png, .svg or .pdf"},
        BadUsage{{"plot", "--kind", "spectrogram", "--length", "1 s"}, "is longer than the 0.4 s"},
        BadUsage{{"plot", "--kind", "spectrogram", "-o", "figure.jpg"}, "must end with"},
        BadUsage{{"plot", "--kind", "spectrum", "-o", "figure"}, "must end with"},
        BadUsage{{"plot", "--kind", "phase", "-o", "figure.gif"}, "must end with"},
        BadUsage{{"plot", "--kind", "waterfall"}, "--kind"},
        BadUsage{{"plot", "--kind", "history", "--channel", "contact.forc"},
                 "did you mean 'contact.force'?"},
        BadUsage{{"plot", "--kind", "phase", "--channel", "contact.forc"},
                 "did you mean 'contact.force'?"},
        BadUsage{{"plot", "--kind", "spectrum", "--channel", "contact.forc"},
                 "did you mean 'contact.force'?"},
        BadUsage{{"plot", "--kind", "spectrum", "--length", "1 s"}, "give at most --length 0.4"},
        BadUsage{{"plot", "--kind", "spectrum", "--scale", "log"},
                 "'log' is neither db nor linear"},
        BadUsage{{"plot", "--kind", "spectrum", "--reference", "1e-6"},
                 "the channels have several units (m/s^2, N)"},
        BadUsage{{"plot", "--kind", "history", "--overlap", "0.5"},
                 "--overlap: means nothing for --kind history"},
        BadUsage{{"plot", "--kind", "phase", "--scale", "db"},
                 "--scale: means nothing for --kind phase"},
        BadUsage{{"plot", "--kind", "spectrum", "--data", "x.h5"},
                 "--data: 'x.h5' ends neither in .uff nor in .unv"},
        BadUsage{{"plot", "--kind", "history", "--from", "7 N"}, "--from: '7 N' has unit N"}));

}  // namespace
}  // namespace stridor
