// The spectrograms that the program makes of run files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <hdf5_hl.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/results/locus_file.hpp"
#include "tests/app/pictures_fixture.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using Json = nlohmann::json;

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
