// The pictures that the program makes of run files, and its messages where it cannot.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <hdf5_hl.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "io/results/locus_file.hpp"
#include "io/run_file/run_file.hpp"
#include "tests/app/pictures_fixture.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using Json = nlohmann::json;

// ---------------------------------------------------------------- spectrogram

TEST_F(Pictures, SpectrogramIsDrawnBesideTheRunFileAndSaysHow) {
  const std::string run = make_run();
  const Json object = json_of({"spectrogram", run});
  EXPECT_THAT(contents_of(path("run_spectrogram.png")), StartsWith("\x89PNG"));
  EXPECT_EQ(object["figure"], path("run_spectrogram.png"));
  EXPECT_EQ(object["data"], nullptr);
  EXPECT_EQ(object["channel"], "beam.tip.y.acceleration");
  EXPECT_EQ(object["units"], "m/s^2");
  EXPECT_EQ(object["window"], "hann");
  EXPECT_EQ(object["overlap"], 0.75);
  EXPECT_EQ(object["max_frequency"], 2000.0);  // the end of measure.band
  // (0.4 s/2000 Hz)^1/2 is 141 samples; the next length with small prime factors is 144.
  EXPECT_EQ(object["length_samples"], 144);
  EXPECT_NEAR(object["length"].get<double>(), 0.0144, 1e-12);
  EXPECT_EQ(object["pieces"], 1 + (4000 - 144) / 36);
  EXPECT_EQ(object["reference"], 1e-6);
  EXPECT_EQ(object["range"], 60.0);
  EXPECT_EQ(object["bursts"], 1);
  // 1 kHz lies 0.4 of a line beside line 14: a Hann window reads at least 1.42 dB less than 2.
  EXPECT_LE(object["highest_amplitude"].get<double>(), 2.0 + 1e-3);
  EXPECT_GE(object["highest_amplitude"].get<double>(), 2.0 * std::pow(10.0, -1.43 / 20.0));
  EXPECT_NEAR(object["highest_level"].get<double>(), 126.0, 1.5);
}

TEST_F(Pictures, SpectrogramMarksBurstsAndNamesReferenceAndSettings) {
  const std::string run = make_run();
  ASSERT_EQ(Program({"spectrogram", run, "-o", path("a.svg")}).run().exit_code, 0);
  const std::string svg = contents_of(path("a.svg"));
  for (const char* text : {"amplitude (dB re 1 µm/s²)", "time (s)", "frequency (kHz)", "1: 1 kHz",
                           "Hann window", "14.4 ms", "75 %", "0123456789abcdef", "Dashed"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
}

TEST_F(Pictures, SpectrogramSetsUnstableWindowsBesideTheBursts) {
  const std::string run = make_run();
  const auto window = [](double from, double to, double frequency) {
    return TimedWindow{{from, to, frequency, 60.0, 0.05, from, 0}, from, to, 4.5};
  };
  Locus locus;
  locus.values = {0.0, 1.0};
  locus.eigenvalues = {{{-1.0, 990.0}}, {{-1.0, 990.0}}};
  const std::string file = path("locus.h5");
  write_locus_file(file, Overwrite::no, locus,
                   {window(0.19, 0.29, 990.0), window(0.3, 0.38, 1500.0)}, "m", {});
  const Json object = json_of({"spectrogram", run, "--predict", file, "-o", path("a.svg")});
  ASSERT_EQ(object["prediction"].size(), 2u);
  const Json& met = object["prediction"][0];
  EXPECT_EQ(met["from"], 0.19);
  EXPECT_EQ(met["frequency"], 990.0);
  EXPECT_EQ(met["gain"], 4.5);
  EXPECT_EQ(met["burst"], 1);
  EXPECT_EQ(met["burst_start"], 0.2);
  EXPECT_EQ(met["burst_frequency"], tone);
  EXPECT_EQ(met["burst_gain"], 5.0);
  EXPECT_EQ(object["prediction"][1]["burst"], nullptr);
  const std::string svg = contents_of(path("a.svg"));
  EXPECT_THAT(svg, HasSubstr("Dotted"));
  json_of({"spectrogram", run, "-o", path("b.svg")});
  EXPECT_GT(svg.size(), contents_of(path("b.svg")).size());  // the marks

  const ProgramResult table =
      Program({"spectrogram", run, "--predict", file, "-o", path("c.png")}).run();
  EXPECT_EQ(table.exit_code, 0) << table.err;
  EXPECT_THAT(table.out,
              AllOf(HasSubstr("predicted, s"),
                    HasSubstr("0.1900 to  0.2900        990.00    4.500       1    0.2000"),
                    HasSubstr("0.3000 to  0.3800       1500.00    4.500       -\n")));
  const ProgramResult refused = Program({"spectrogram", run, "--predict", run}).run();
  EXPECT_EQ(refused.exit_code, 4);
  EXPECT_THAT(refused.err, HasSubstr("a file of `stridor locus -o` is needed"));
}

TEST_F(Pictures, HistoryShadesTheBurstsOfTheAcceleration) {
  const std::string run = make_run();
  EXPECT_EQ(json_of({"plot", run, "--kind", "history", "-o", path("a.svg")})["bursts"], 1);
  EXPECT_THAT(contents_of(path("a.svg")), HasSubstr("beam.tip.y  (shaded: bursts)"));
  EXPECT_THAT(contents_of(path("a.svg")), HasSubstr("rgb(251, 227, 189)"));
  json_of({"plot", run, "--kind", "history", "-o", path("b.svg"), "--to", "0.1"});
  EXPECT_THAT(contents_of(path("b.svg")), Not(HasSubstr("shaded")));
}

TEST_F(Pictures, ALocusOverAnotherKeyThanThePathPredictsNothing) {
  Locus locus;
  locus.values = {0.0, 1.0};
  locus.eigenvalues = {{{-1.0, 990.0}}, {{-1.0, 990.0}}};
  const std::string run = make_run();
  const auto spectrogram = [&](const std::string& key) {
    write_locus_file(path("locus.h5"), Overwrite::yes, locus, {}, "1", {{"parameter", key}});
    return Program(
               {"spectrogram", run, "--predict", path("locus.h5"), "-o", path("a.svg"), "--force"})
        .run();
  };
  const ProgramResult refused = spectrogram("contact.friction.coefficient");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("is a locus over contact.friction.coefficient, which a run "
                                     "does not pass through"));
  EXPECT_EQ(spectrogram("contact.start").exit_code, 0);
}

TEST_F(Pictures, BurstsAreSoughtInAnotherBand) {
  // A result says that the run has ended, else its bursts would be sought.
  const std::string file = make_run({.has_bursts = false, .trusted_frequency = 5000.0});
  EXPECT_EQ(json_of({"info", file})["bursts"], Json::array());
  const Json info = json_of({"info", file, "--band", "800,1.2 kHz"});
  ASSERT_EQ(info["bursts"].size(), 1u);
  // In perfect silence the ringing of the filter before the tone belongs to the burst.
  EXPECT_LT(info["bursts"][0]["start"].get<double>(), 0.2);
  EXPECT_GT(info["bursts"][0]["end"].get<double>(), 0.3);
  EXPECT_NEAR(info["bursts"][0]["peak"].get<double>(), 2.0, 0.4);  // the filter overshoots
  const Json picture = json_of({"spectrogram", file, "-o", path("a.svg"), "--band", "800,1200"});
  EXPECT_EQ(picture["bursts"], 1);
  EXPECT_THAT(contents_of(path("a.svg")), HasSubstr("band 800,1200"));
  EXPECT_THAT(contents_of(path("a.svg")), HasSubstr("<text>1: "));
  const Json spectrum = json_of(
      {"plot", file, "--kind", "spectrum", "-o", path("b.svg"), "--band", "800 Hz,1200 Hz"});
  EXPECT_EQ(spectrum["bursts"], 1);
}

TEST_F(Pictures, SpectrogramWithoutBurstsIsDrawn) {
  RunContents quiet;
  quiet.has_bursts = false;
  quiet.trusted_frequency = 5000.0;  // a result, as of a run that has ended
  const std::string run = make_run(quiet);
  EXPECT_EQ(json_of({"spectrogram", run, "-o", path("a.svg")})["bursts"], 0);
  EXPECT_THAT(contents_of(path("a.svg")), Not(HasSubstr("Dashed")));
}

TEST_F(Pictures, SceneGivesTheSettingsAndTheCommandLineWins) {
  RunContents contents;
  contents.scene +=
      "spectrogram: {channel: beam.tip.y.velocity, window: blackman_harris, length: 0.02, overlap: "
      "0.5, max_frequency: 1500.0}\n";
  const std::string run = make_run(contents);
  const Json scene = json_of({"spectrogram", run, "-o", path("a.svg")});
  EXPECT_EQ(scene["channel"], "beam.tip.y.velocity");
  EXPECT_EQ(scene["window"], "blackman_harris");
  EXPECT_EQ(scene["length_samples"], 200);
  EXPECT_EQ(scene["overlap"], 0.5);
  EXPECT_EQ(scene["max_frequency"], 1500.0);
  EXPECT_EQ(scene["reference"], 1e-9);
  EXPECT_THAT(contents_of(path("a.svg")),
              AllOf(HasSubstr("Blackman-Harris"), HasSubstr("20 ms"), HasSubstr("dB re 1 nm/s")));
  const Json given = json_of(
      {"spectrogram", run,     "-o",       path("b.svg"), "--channel",       "contact.force",
       "--window",    "hann",  "--length", "40 ms",       "--overlap",       "25 %",
       "--range",     "80",    "--from",   "100 ms",      "--max-frequency", "1 kHz",
       "--reference", "20 mN", "--to",     "0.35"});
  EXPECT_EQ(given["channel"], "contact.force");
  EXPECT_EQ(given["window"], "hann");
  EXPECT_EQ(given["length_samples"], 400);
  EXPECT_EQ(given["overlap"], 0.25);
  EXPECT_EQ(given["max_frequency"], 1000.0);
  EXPECT_EQ(given["reference"], 0.02);
  EXPECT_EQ(given["range"], 80.0);
  EXPECT_NEAR(given["from"].get<double>(), 0.1, 1e-12);
  EXPECT_NEAR(given["to"].get<double>(), 0.35, 1e-12);
  EXPECT_THAT(contents_of(path("b.svg")), HasSubstr("dB re 20 mN"));
}

TEST_F(Pictures, PlotMakesTheSameSpectrogram) {
  const std::string run = make_run();
  Json verb = json_of({"spectrogram", run, "-o", path("a.svg"), "--length", "10 ms"});
  Json plot =
      json_of({"plot", run, "--kind", "spectrogram", "-o", path("b.svg"), "--length", "10 ms"});
  verb.erase("figure");
  plot.erase("figure");
  EXPECT_EQ(verb, plot);
  EXPECT_EQ(contents_of(path("a.svg")), contents_of(path("b.svg")));
}

TEST_F(Pictures, DataHoldTheToneWhereItIs) {
  const std::string run = make_run();
  const std::string data = path("data.h5");
  json_of({"spectrogram", run, "-o", path("a.svg"), "--data", data, "--length", "10 ms",
           "--overlap", "0.5", "--window", "hann"});
  const hid_t file = H5Fopen(data.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  hsize_t shape[2] = {};
  H5LTget_dataset_info(file, "/amplitude", shape, nullptr, nullptr);
  ASSERT_EQ(shape[0], 79u);  // 1 + 3900/50
  ASSERT_EQ(shape[1], 51u);
  std::vector<double> amplitude(shape[0] * shape[1]);
  std::vector<double> times(shape[0]);
  H5LTread_dataset_double(file, "/amplitude", amplitude.data());
  H5LTread_dataset_double(file, "/times", times.data());
  for (std::size_t j = 0; j < times.size(); ++j) {
    // Ten periods to a piece: the tone is exactly on line 10. A Hann window weighs its
    // outermost samples by next to nothing.
    const double at_tone = amplitude[j * shape[1] + 10];
    if (times[j] > 0.2051 && times[j] < 0.2949) {
      EXPECT_NEAR(at_tone, 2.0, 1e-3) << times[j];
    }
    if (times[j] < 0.1949 || times[j] > 0.3051) {
      EXPECT_EQ(at_tone, 0.0) << times[j];
    }
  }
  const auto text = [&](const char* name) {
    char buffer[300] = {};
    H5LTget_attribute_string(file, "/", name, buffer);
    return std::string(buffer);
  };
  const auto real = [&](const char* name) {
    double value = 0.0;
    H5LTget_attribute_double(file, "/", name, &value);
    return value;
  };
  EXPECT_EQ(text("window"), "hann");
  EXPECT_EQ(text("channel"), "beam.tip.y.acceleration");
  EXPECT_EQ(text("scene_hash"), "0123456789abcdef");
  EXPECT_EQ(text("run_file"), run);
  EXPECT_NEAR(real("length"), 0.01, 1e-12);
  EXPECT_EQ(real("overlap"), 0.5);
  EXPECT_EQ(real("interval"), interval);
  H5Fclose(file);
}

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

TEST_F(Pictures, RunFileItselfIsNeverReplacedByTheData) {
  const std::string run = make_run();
  const std::string before = contents_of(run);
  const ProgramResult result =
      Program({"spectrogram", run, "--data",
               path("../") + folder_.path().filename().string() + "/run.h5", "--force"})
          .run();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("is the run file itself"));
  EXPECT_EQ(contents_of(run), before);
}

// ---------------------------------------------------------------- other kinds

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

TEST_F(Pictures, RunWithoutAccelerationNamesItsChannels) {
  RunContents contents;
  contents.channels = {"/contact/contact/force"};
  const ProgramResult result =
      Program({"spectrogram", make_run(contents), "-o", path("a.svg")}).run();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err,
              HasSubstr("has no acceleration; name one of its channels: contact.force"));
}

TEST_F(Pictures, WrongSettingsOfTheSceneAreToldByTheirKey) {
  RunContents contents;
  contents.scene += "spectrogram: {length: 3.0}\n";
  const ProgramResult result =
      Program({"spectrogram", make_run(contents), "-o", path("a.svg")}).run();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("spectrogram.length: a piece of 3 s is longer than the 0.4 s"));
}

TEST_F(Pictures, SettingsOfASceneReachThePictureOfItsRun) {
  const std::string run = path("run.h5");
  std::vector<std::string> arguments{"run", scene_path("beam_on_beam.yaml"), "-o", run};
  for (const char* set :
       {"time.end=2e-3", "measure.from=5e-4", "spectrogram.length=1 ms", "spectrogram.overlap=50 %",
        "spectrogram.channel=contact.force", "spectrogram.window=rectangular"}) {
    arguments.emplace_back("--set");
    arguments.emplace_back(set);
  }
  const ProgramResult made = Program(arguments).run();
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const Json object = json_of({"spectrogram", run, "-o", path("a.svg")});
  EXPECT_EQ(object["channel"], "contact.force_low_passed");  // what a spectrum is made of
  EXPECT_EQ(object["length_samples"], 100);
  EXPECT_EQ(object["overlap"], 0.5);
  EXPECT_EQ(object["window"], "rectangular");
  EXPECT_EQ(object["max_frequency"], 15000.0);
}

}  // namespace
}  // namespace stridor
