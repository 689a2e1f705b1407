// Pages that the program makes of files of results, and its messages where it cannot.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "io/results/result_file.hpp"
#include "tests/app/pictures_fixture.hpp"
#include "tests/support/report_blocks.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

/// The view of a type in a section; null where there is none.
Json view_of(const Json& section, const std::string& type) {
  for (const Json& view : section["views"])
    if (view["type"] == type) return view;
  return nullptr;
}

class ReportProgram : public Pictures {
 protected:
  static ProgramResult report(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "report");
    return Program(arguments).run();
  }
  /// Expects success. @return the page
  std::string page_of(std::vector<std::string> arguments, const std::string& name = "page.html") const {
    arguments.insert(arguments.end(), {"-o", path(name)});
    const ProgramResult result = report(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return contents_of(path(name));
  }
  static std::string scene(const std::string& name) {
    return std::string(STRIDOR_SOURCE_DIR) + "/scenes/" + name;
  }
  /// Runs a verb that writes a file. @return the file
  std::string made(std::vector<std::string> arguments, const std::string& name) const {
    arguments.insert(arguments.end(), {"-o", path(name)});
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return path(name);
  }
};

TEST_F(ReportProgram, ARunIsShownWithItsVerdictBurstsAndSamples) {
  const std::string page = page_of({make_run()});
  const Json contents = contents_of_report(page);
  ASSERT_EQ(contents["sections"].size(), 1u);
  const Json& section = contents["sections"][0];
  EXPECT_EQ(section["kind"], "run");
  EXPECT_EQ(section["verdict"]["level"], "failed");  // nothing in the file says that it ended
  EXPECT_THAT(section["verdict"]["text"].get<std::string>(), HasSubstr("1 burst"));
  EXPECT_EQ(section["scene_text"], "format: 2\n");
  const Json bursts = view_of(section, "bursts")["bursts"];
  ASSERT_EQ(bursts.size(), 1u);
  EXPECT_EQ(bursts[0]["frequency"], tone);
  const Json histories = view_of(section, "histories");
  ASSERT_EQ(histories["series"].size(), 4u);
  EXPECT_EQ(histories["time"]["count"], num_rows);
  EXPECT_NEAR(histories["time"]["step"].get<double>(), interval, 1e-12);
  for (const Json& series : histories["series"]) {
    const std::string name = series["name"];
    const std::string place =
        name == "contact.force" ? "/contact/contact/force" : "/channels/" + name;
    const std::vector<double> samples = numbers_of(page, series["samples"]);
    ASSERT_EQ(samples.size(), num_rows);
    const double bound = (series["max"].get<double>() - series["min"].get<double>()) / 1.3e5 + 1e-15;
    for (std::size_t i = 0; i < num_rows; ++i)
      ASSERT_NEAR(samples[i], value_at(place, static_cast<double>(i) * interval), bound) << name;
  }
}

// The loudest level stands where the tone is; the levels are peak amplitudes over 1 µm/s².
TEST_F(ReportProgram, TheSpectrogramHasTheToneAtItsPlace) {
  const std::string page = page_of({make_run()});
  const Json contents = contents_of_report(page);
  const Json view = view_of(contents["sections"][0], "spectrogram");
  ASSERT_FALSE(view.is_null());
  const std::vector<double> levels = numbers_of(page, view["levels"]);
  const auto lines = view["frequency"]["count"].get<std::size_t>();
  const auto most = static_cast<std::size_t>(std::max_element(levels.begin(), levels.end()) - levels.begin());
  EXPECT_EQ(levels[most], 255.0);
  const auto centre = [&](const char* axis, std::size_t i) {
    return view[axis]["from"].get<double>() + (static_cast<double>(i) + 0.5) * view[axis]["step"].get<double>();
  };
  EXPECT_NEAR(centre("frequency", most % lines), tone, view["frequency"]["step"].get<double>());
  EXPECT_GT(centre("time", most / lines), 0.2);
  EXPECT_LT(centre("time", most / lines), 0.3);
  // Half-way between two lines a tone under Hann's window reads 1.42 dB too low.
  const double level = 20.0 * std::log10(2.0 / 1e-6);
  EXPECT_LT(view["top"].get<double>(), level + 0.05);
  EXPECT_GT(view["top"].get<double>(), level - 1.45);
}

TEST_F(ReportProgram, BeyondTheBudgetThereAreExtremesAndThePageSaysSo) {
  RunContents contents;
  contents.rows = 200000;
  const std::string run = make_run(contents);
  const std::string small = page_of({run, "--budget", "600kB"}, "small.html");
  EXPECT_LE(small.size(), 700000u);
  const Json view = view_of(contents_of_report(small)["sections"][0], "histories");
  const auto factor = view["series"][0]["factor"].get<std::size_t>();
  ASSERT_GT(factor, 1u);
  EXPECT_THAT(view["note"].get<std::string>(), HasSubstr("--full"));
  const std::vector<double> pairs = numbers_of(small, view["series"][0]["samples"]);
  ASSERT_EQ(pairs.size(), 2 * ((contents.rows + factor - 1) / factor));
  const auto [least, most] = std::minmax_element(pairs.begin(), pairs.end());
  EXPECT_NEAR(*least, view["series"][0]["min"].get<double>(), 1e-4);
  EXPECT_NEAR(*most, view["series"][0]["max"].get<double>(), 1e-4);
  const std::string full = page_of({run, "--budget", "600kB", "--full"}, "full.html");
  EXPECT_EQ(view_of(contents_of_report(full)["sections"][0], "histories")["series"][0]["factor"], 1);
}

TEST_F(ReportProgram, TwoCallsGiveEqualBytes) {
  const std::string run = make_run();
  const std::string first = page_of({run, "--force"});
  EXPECT_EQ(page_of({run, "--force"}), first);
}

// The scene slides over half of its way, where the locus has windows; both are in one page.
TEST_F(ReportProgram, ALocusIsSetBesideTheRunOfItsScene) {
  const std::string beams = scene("beam_on_beam.yaml");
  const std::string locus = made({"locus", beams, "--from", "88mm", "--to", "95mm", "--points", "36", "--about", "deformed"}, "locus.h5");
  const std::string run = made({"run", beams}, "run.h5");
  const std::string page = page_of({run, locus});
  const Json contents = contents_of_report(page);
  ASSERT_EQ(contents["sections"].size(), 2u);
  EXPECT_EQ(ResultFile(run).text("title"), "run of beam_on_beam.yaml");
  EXPECT_THAT(page, HasSubstr("<title>beam_on_beam: run, locus – stridor</title>"));
  EXPECT_THAT(contents["sections"][0]["title"].get<std::string>(), ::testing::StartsWith("beam_on_beam: run to "));
  EXPECT_EQ(contents["sections"][0]["verdict"]["level"], "loud");
  EXPECT_THAT(contents["sections"][0]["purpose"].get<std::string>(), ::testing::EndsWith("."));
  EXPECT_EQ(contents["sections"][1]["title"], "beam_on_beam: eigenvalues along contact.start from 88 mm to 95 mm");
  EXPECT_EQ(contents["sections"][1]["verdict"]["level"], "unstable");
  const Json predicted = view_of(contents["sections"][0], "bursts")["predicted"];
  ASSERT_GE(predicted.size(), 2u);
  EXPECT_TRUE(std::any_of(predicted.begin(), predicted.end(), [](const Json& row) { return !row["burst"].is_null(); }));
  EXPECT_TRUE(view_of(contents["sections"][0], "modes").is_null());  // they are with the locus
  const Json& expectations = contents["sections"][0]["expectations"];
  EXPECT_FALSE(expectations.empty());
  for (const Json& row : expectations) EXPECT_TRUE(row["is_met"].get<bool>()) << row;

  // A run that was set beside the locus holds the same.
  const std::string heard = made({"run", beams, "--predict", locus}, "heard.h5");
  const Json alone = contents_of_report(page_of({heard, "--no-shapes"}, "alone.html"));
  const Json again = view_of(alone["sections"][0], "bursts")["predicted"];
  ASSERT_EQ(again.size(), predicted.size());
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    for (const char* key : {"from", "to", "frequency", "gain", "burst"})
      EXPECT_EQ(again[i][key], predicted[i][key]) << key;
  }

  const Json modes = view_of(contents["sections"][1], "modes");
  ASSERT_FALSE(modes.is_null());
  EXPECT_TRUE(modes["planar"].get<bool>());
  ASSERT_GE(modes["frames"].size(), 8u);
  const Json& frame = modes["frames"][0];
  EXPECT_EQ(frame["value"], 0.088);
  const auto nodes = modes["nodes"].get<std::size_t>();
  EXPECT_EQ(numbers_of(page, frame["places"]).size(), 3 * nodes);
  const std::vector<double> moved = numbers_of(page, frame["displacements"]);
  ASSERT_EQ(moved.size(), 6 * nodes * frame["modes"].size());
  // Every mode is scaled to a largest displacement of 1.
  for (std::size_t m = 0; m < frame["modes"].size(); ++m) {
    const auto begin = moved.begin() + static_cast<std::ptrdiff_t>(6 * nodes * m);
    const auto end = begin + static_cast<std::ptrdiff_t>(3 * nodes);
    EXPECT_NEAR(std::max(*std::max_element(begin, end), -*std::min_element(begin, end)), 1.0, 1e-3);
  }
  // The modes are those that `eig` finds there.
  const Json eig = json_of({"eig", beams, "--at", "88mm", "--about", "deformed"});
  for (const Json& one : eig["eigenvalues"]) {
    const double frequency = one[1].get<double>() / (2.0 * std::numbers::pi);
    if (frequency <= 0.0) continue;
    EXPECT_TRUE(std::any_of(frame["modes"].begin(), frame["modes"].end(), [&](const Json& mode) {
      return std::abs(mode["frequency"].get<double>() - frequency) < 1e-6 * frequency;
    })) << frequency;
  }
}

TEST_F(ReportProgram, ALocusOfWholeNumbersIsShownByItsEigenvalues) {
  const std::string locus = made({"locus", scene("beam_on_beam.yaml"), "--parameter", "substructures.cantilever.mesh.along",
                                  "--from", "100", "--to", "200", "--points", "2", "--count", "3"},
                                 "locus.h5");
  const Json view = view_of(contents_of_report(page_of({locus}))["sections"][0], "locus");
  EXPECT_TRUE(view["points"].get<bool>());
  EXPECT_EQ(view["sizes"], Json::array({2, 2, 2}));
}

// The spectra of matrices that nothing touches are sampled.
TEST_F(ReportProgram, ASampledLocusIsShownByItsBranches) {
  const std::string locus = made({"locus", scene("examples/two_springs_on_a_belt.yaml"), "--parameter", "parameters.mu",
                                  "--from", "0", "--to", "1", "--points", "11"},
                                 "locus.h5");
  const std::string page = page_of({locus});
  const Json contents = contents_of_report(page);
  const Json view = view_of(contents["sections"][0], "locus");
  EXPECT_FALSE(view.contains("points"));
  ASSERT_EQ(view["sizes"].size(), 2u);
  const auto first = view["sizes"][0].get<std::size_t>();
  EXPECT_GT(first, 60u);
  const std::vector<double> frequency = numbers_of(page, view["frequency"]);
  ASSERT_EQ(frequency.size(), first + view["sizes"][1].get<std::size_t>());
  // K = [[2, 1], [1, 2]] without friction: sqrt(2 -+ 1)/2 pi.
  EXPECT_NEAR(frequency[0], 1.0 / (2.0 * std::numbers::pi), 1e-9);
  EXPECT_NEAR(frequency[first], std::sqrt(3.0) / (2.0 * std::numbers::pi), 1e-9);
}

TEST_F(ReportProgram, ALocusOfAnotherSceneIsNotSetBesideARun) {
  const std::string locus =
      made({"locus", scene("beam_on_beam.yaml"), "--from", "90mm", "--to", "93mm", "--points", "7", "--about", "deformed"}, "locus.h5");
  const Json contents = contents_of_report(page_of({make_run(), locus, "--no-shapes"}));
  const Json& section = contents["sections"][0];
  ASSERT_EQ(section["remarks"].size(), 1u);
  EXPECT_THAT(section["remarks"][0].get<std::string>(), HasSubstr("is of another scene"));
  EXPECT_TRUE(view_of(section, "bursts")["predicted"].empty());
}

TEST_F(ReportProgram, PointsOfAMapWithoutAnEigenvalueInTheWindowHaveNotFailed) {
  const std::string map =
      made({"map", scene("beam_on_beam.yaml"), "--x", "contact.start", "50mm", "51mm", "2", "--y",
            "contact.friction.coefficient", "0.3", "0.4", "2", "--below", "1Hz"},
           "map.h5");
  const Json contents = contents_of_report(page_of({map}));
  EXPECT_EQ(contents["sections"][0]["verdict"]["text"], "Of 4 points 0 are unstable.");
}

TEST_F(ReportProgram, EveryKindOfFileHasASection) {
  const std::string belt = scene("examples/mass_on_belt.yaml");
  const std::string sphere = scene("viscoelastic_sphere.yaml");
  const std::string reed = scene("examples/reed.yaml");
  const std::vector<std::pair<std::string, std::string>> files{
      {made({"map", sphere, "--x", "parameters.v", "1e-3", "1", "4", "--y", "parameters.tau0",
             "1e-3", "1", "3"},
            "map.h5"),
       "field"},
      {made({"sweep", sphere, "--set", "parameters.v=0.03", "--parameter", "parameters.tau0",
             "--from", "0.01", "--to", "0.1", "--points", "3"},
            "sweep.h5"),
       "curves"},
      {made({"cycle", sphere}, "cycle.h5"), "histories"},
      {made({"frf", reed, "--input", "reed.middle.y", "--output", "reed.tip.y.displacement",
             "--from", "100Hz", "--to", "2kHz", "--points", "50"},
            "frf.h5"),
       "responses"},
      {made({"contact", scene("viscoelastic_contact.yaml"), "--speed", "0.1,1", "--indentation",
             "0.01", "--set", "contacts.tip.normal.solver.grid=32"},
            "contact.h5"),
       "field"}};
  std::vector<std::string> arguments;
  for (const auto& file : files) arguments.push_back(file.first);
  const std::string page = page_of(arguments);
  const Json contents = contents_of_report(page);
  ASSERT_EQ(contents["sections"].size(), files.size());
  for (std::size_t i = 0; i < files.size(); ++i) {
    const Json& section = contents["sections"][i];
    EXPECT_FALSE(view_of(section, files[i].second).is_null()) << section["kind"];
    EXPECT_FALSE(section["verdict"]["text"].get<std::string>().empty());
    EXPECT_NE(section["verdict"]["level"], "loud") << section["kind"];  // nothing was heard
    EXPECT_THAT(section["command"].get<std::string>(), HasSubstr("stridor"));
  }
  EXPECT_EQ(contents["sections"][2]["verdict"]["level"], "stable");
  EXPECT_THAT(contents["sections"][2]["verdict"]["text"].get<std::string>(),
              AllOf(HasSubstr("A period of 154 ms, 6.5 Hz; r.m.s. displacement 132"),
                    HasSubstr("; sticks 40.3 % of the time; a disturbance is multiplied by ")));
  const Json map = view_of(contents["sections"][0], "field");
  EXPECT_EQ(numbers_of(page, map["value"]["values"]).size(), 12u);
  EXPECT_THAT(map["reproduce"].get<std::string>(), HasSubstr("--set parameters.v=@X@"));
}

TEST_F(ReportProgram, ResponsesOfOneUnitStandTogether) {
  const std::string mass =
      made({"frf", scene("examples/reed.yaml"), "--input", "reed.middle.y", "--output",
            "reed.middle.y.displacement", "--output", "reed.middle.y.acceleration", "--output",
            "reed.tip.x.acceleration", "--from", "100Hz", "--to", "2kHz", "--points", "20"},
           "frf.h5");
  const std::string page = page_of({mass});
  const Json contents = contents_of_report(page);
  const Json& section = contents["sections"][0];
  EXPECT_EQ(section["title"], "reed: frequency responses from 100 Hz to 2 kHz");
  EXPECT_THAT(page, HasSubstr("<title>reed: frequency responses – stridor</title>"));
  const Json groups = view_of(section, "responses")["groups"];
  ASSERT_EQ(groups.size(), 2u);
  for (const Json& group : groups) {
    const bool is_receptance = group["units"] == "m/N";
    EXPECT_EQ(group["quantity"], is_receptance ? "receptance" : "accelerance");
    EXPECT_EQ(group["curves"].size(), is_receptance ? 1u : 2u);
    for (const Json& curve : group["curves"])
      EXPECT_EQ(numbers_of(page, curve["imaginary"]).size(), 20u);
  }
}

TEST_F(ReportProgram, MeasuredResponsesStandBesideComputedOnes) {
  const std::vector<std::string> asked{"frf",      scene("examples/reed.yaml"),
                                       "--input",  "reed.middle.y",
                                       "--from",   "100Hz",
                                       "--to",     "2kHz",
                                       "--points", "20"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), asked.begin(), asked.end());
    return more;
  };
  const std::string measured = made(with({}), "measured.uff");
  const std::string file = made(with({"--compare", measured, "--set", "parameters.mu=0.1", "--set",
                                      "time.retain.frequency=2kHz"}),
                                "compared.h5");
  const std::string page = page_of({file});
  const Json section = contents_of_report(page)["sections"][0];
  std::vector<Json> responses;
  for (const Json& view : section["views"])
    if (view["type"] == "responses") responses.push_back(view);
  ASSERT_EQ(responses.size(), 2u);
  // Of the four modes of the reed none is left out.
  EXPECT_FALSE(responses[0]["groups"][0]["curves"][0].contains("error"));
  const Json& curves = responses[1]["groups"][0]["curves"];
  ASSERT_EQ(curves.size(), 2u);
  EXPECT_EQ(curves[0]["name"], "measured: reed.middle.y.acceleration per force at reed.middle.y");
  EXPECT_FALSE(curves[0].contains("error"));
  EXPECT_EQ(numbers_of(page, curves[1]["real"]).size(), 20u);
  const Json& table = view_of(section, "table");
  EXPECT_EQ(table["title"], "Measured beside computed");
  EXPECT_EQ(table["columns"][2]["name"], "FRAC");
}

TEST_F(ReportProgram, ShapesOfMeasuredPointsHaveATableOfPeaks) {
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(),
                {"frf", scene("examples/reed.yaml"), "--input", "reed.middle.y", "--output",
                 "reed.middle.y.acceleration", "--output", "reed.tip.y.acceleration", "--from",
                 "100Hz", "--to", "2kHz", "--points", "381"});
    return more;
  };
  const std::string measured = made(with({}), "measured.uff");
  const std::string file = made(with({"--compare", measured, "--node", "1=reed.middle", "--node",
                                      "2=reed.tip", "--set", "parameters.mu=0.1"}),
                                "shapes.h5");
  const std::string page = page_of({file});
  const Json section = contents_of_report(page)["sections"][0];
  std::vector<Json> tables;
  for (const Json& view : section["views"])
    if (view["type"] == "table") tables.push_back(view);
  ASSERT_EQ(tables.size(), 2u);
  EXPECT_EQ(tables[1]["title"], "Shapes by a force at reed.middle.y, at peaks");
  EXPECT_EQ(tables[1]["columns"][3]["name"], "MAC");
  EXPECT_GE(tables[1]["columns"][3]["values"].size(), 1u);
  const Json panel = view_of(section, "curves")["panels"][0];
  EXPECT_EQ(panel["curves"][0]["name"], "MAC, force at reed.middle.y");
  EXPECT_EQ(numbers_of(page, panel["curves"][0]["values"]).size(), 381u);
}

TEST_F(ReportProgram, TheErrorOfTheModesThatARunKeepsIsACurve) {
  const std::string file =
      made({"frf", scene("beam_on_beam.yaml"), "--input", "cantilever.free_end.y", "--from",
            "100Hz", "--to", "2kHz", "--points", "20", "--set", "time.integrator=exact", "--set",
            "time.step=5e-6", "--set", "time.retain.frequency=15kHz"},
           "kept.h5");
  const std::string page = page_of({file});
  const Json section = contents_of_report(page)["sections"][0];
  const Json view = view_of(section, "responses");
  const Json& curve = view["groups"][0]["curves"][0];
  const auto error = numbers_of(page, curve["error"]);
  EXPECT_EQ(error.size(), 20u);
  EXPECT_GT(*std::max_element(error.begin(), error.end()), 0.0);
}

// Up and down in one picture, amplitudes first, states in words.
TEST_F(ReportProgram, CyclesSweptUpAndDownShareTheirPictures) {
  const std::string swept =
      made({"sweep", scene("viscoelastic_sphere.yaml"), "--set", "parameters.v=0.03", "--parameter",
            "parameters.tau0", "--from", "0.01", "--to", "0.1", "--points", "4", "--up-down"},
           "cycles.h5");
  const std::string page = page_of({swept});
  const Json section = contents_of_report(page)["sections"][0];
  EXPECT_EQ(section["title"], "viscoelastic_sphere: limit cycles along parameters.tau0");
  EXPECT_THAT(section["verdict"]["text"].get<std::string>(), HasSubstr("at rest"));
  const Json view = view_of(section, "curves");
  ASSERT_EQ(view["sets"].size(), 2u);
  EXPECT_EQ(view["sets"][0]["name"], "up");
  EXPECT_EQ(view["sets"][1]["name"], "down");
  EXPECT_EQ(numbers_of(page, view["sets"][1]["values"]).front(), 0.1);
  EXPECT_EQ(view["sets"][0]["states"][0]["texts"].size(), 4u);
  EXPECT_EQ(view["sets"][0]["states"][0]["texts"][0], "at rest");
  std::vector<std::string> names;
  for (const Json& panel : view["panels"]) {
    names.push_back(panel["curves"][0]["name"]);
    ASSERT_EQ(panel["curves"].size(), 2u) << names.back();
    EXPECT_EQ(panel["curves"][1]["set"], 1);
  }
  ASSERT_GE(names.size(), 3u);
  EXPECT_EQ((std::vector<std::string>{names.begin(), names.begin() + 3}),
            (std::vector<std::string>{"amplitude", "r.m.s. displacement", "frequency"}));
  for (const char* no_curve : {"status", "equilibrium_stable", "period"})
    EXPECT_EQ(std::count(names.begin(), names.end(), no_curve), 0) << no_curve;
}

// The plate is a ring in space that bends along its axis, z; pads stand on it, below and above.
TEST_F(ReportProgram, APlateBendsOutOfItsPlane) {
  const std::string locus = made({"locus", scene("examples/elastic_pads.yaml"), "--parameter",
                                  "parameters.mu", "--from", "0.3", "--to", "0.5", "--points", "3"},
                                 "locus.h5");
  const std::string page = page_of({locus});
  const Json section = contents_of_report(page)["sections"][0];
  EXPECT_EQ(section["verdict"]["level"], "unstable");
  const Json modes = view_of(section, "modes");
  ASSERT_FALSE(modes.is_null());
  EXPECT_FALSE(modes["planar"].get<bool>());
  const Json& frame = modes["frames"][0];
  const std::vector<double> places = numbers_of(page, frame["places"]);
  const std::vector<double> moved = numbers_of(page, frame["displacements"]);
  for (const Json& part : modes["parts"]) {
    const bool is_disc = part["name"] == "disc";
    EXPECT_TRUE(part.contains("faces")) << part["name"];
    const auto first = part["first"].get<std::size_t>();
    double most = 0.0, inner = 1.0, outer = 0.0;
    for (std::size_t node = first; node < first + part["count"].get<std::size_t>(); ++node) {
      const double radius = std::hypot(places[3 * node], places[3 * node + 1]);
      inner = std::min(inner, radius);
      outer = std::max(outer, radius);
      most = std::max(most, std::abs(moved[3 * node + 2]));
      if (is_disc) {
        EXPECT_NEAR(moved[3 * node], 0.0, 1e-4);
        EXPECT_NEAR(moved[3 * node + 1], 0.0, 1e-4);
        EXPECT_LT(std::abs(places[3 * node + 2]), 1e-4);
      } else {
        EXPECT_EQ(places[3 * node + 2] > 0.0, part["name"] == "upper");
      }
    }
    EXPECT_NEAR(inner, is_disc ? 0.08 : outer, 1e-6);
    if (is_disc) {
      EXPECT_NEAR(outer, 0.16, 1e-6);
      EXPECT_GT(most, 0.1);
    }
  }
}

TEST_F(ReportProgram, HasTheFrequencyThatTheBodiesResolve) {
  const auto resolved = [&](const RunContents& run) {
    const Json contents = contents_of_report(page_of({make_run(run), "--force"}));
    return view_of(contents["sections"][0], "bursts")["resolved"];
  };
  EXPECT_TRUE(resolved({}).is_null());
  RunContents doubtful;
  doubtful.trusted_frequency = 0.8 * tone;
  EXPECT_EQ(resolved(doubtful), 0.8 * tone);
}

TEST_F(ReportProgram, AStudyOfPrecisionIsShownAsErrorsOverTimes) {
  made({"precision", scene("viscoelastic_sphere.yaml"), "--points", "2", "--tune", "1e-3"},
       "study");
  const Json study = Json::parse(contents_of(path("study") + "/precision.json"));
  const Json contents = contents_of_report(page_of({path("study") + "/precision.h5"}));
  const Json& section = contents["sections"][0];
  EXPECT_EQ(section["file"], "study/precision.h5");
  EXPECT_THAT(section["verdict"]["text"].get<std::string>(),
              HasSubstr("The cheapest within 0.001: event_driven, tolerance "));
  const Json view = view_of(section, "errors");
  EXPECT_EQ(view["wanted_error"], 1e-3);
  ASSERT_EQ(view["settings"].size(), study["rows"].size());
  for (std::size_t i = 0; i < study["rows"].size(); ++i) {
    const Json& row = study["rows"][i];
    EXPECT_EQ(view["settings"][i]["method"], row["integrator"]);
    EXPECT_EQ(view["settings"][i]["error"], row["error"]);
    EXPECT_EQ(view["settings"][i]["run_time"], row["wall_s"]);
  }
}

TEST_F(ReportProgram, SaysWhyThereAreNoShapes) {
  const std::string page = page_of({make_run()});
  const Json contents = contents_of_report(page);
  const Json& remarks = contents["sections"][0]["remarks"];
  ASSERT_EQ(remarks.size(), 1u);
  EXPECT_THAT(remarks[0].get<std::string>(), HasSubstr("No shapes of modes: "));
}

TEST_F(ReportProgram, AKilledRunIsShownAsFarAsItGot) {
  RunContents contents;
  contents.has_bursts = false;
  contents.rows = 100;
  const ProgramResult result = report({make_run(contents), "-o", path("page.html")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("Has not ended, or was killed; rows up to 9.9 ms"));
}

TEST_F(ReportProgram, BurstsOfAKilledRunAreSought) {
  const std::string run =
      made({"run", scene("beam_on_beam.yaml"), "--set", "time.end=1.75"}, "run.h5");
  const Json whole = json_of({"info", run})["bursts"];
  ASSERT_GT(whole.size(), 0U);
  const hid_t file = H5Fopen(run.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  for (const char* group : {"/bursts", "/results", "/final"}) H5Ldelete(file, group, H5P_DEFAULT);
  H5Fclose(file);
  const Json sought = json_of({"info", run})["bursts"];
  ASSERT_EQ(sought.size(), whole.size());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    EXPECT_NEAR(sought[i]["frequency"].get<double>(), whole[i]["frequency"].get<double>(), 20.0);
    EXPECT_NEAR(sought[i]["start"].get<double>(), whole[i]["start"].get<double>(), 2e-3);
  }
  const std::string locus = made({"locus", scene("beam_on_beam.yaml"), "--from", "75mm", "--to",
                                  "95mm", "--points", "21", "--about", "deformed"},
                                 "locus.h5");
  const Json section = contents_of_report(page_of({run, locus, "--no-shapes"}))["sections"][0];
  const std::string verdict = section["verdict"]["text"];
  EXPECT_THAT(verdict, HasSubstr("Has not ended, or was killed"));
  EXPECT_THAT(verdict, HasSubstr(std::to_string(whole.size()) + " burst"));
  // Of the windows of the path the run has come to those before 83 mm.
  EXPECT_FALSE(view_of(section, "bursts")["predicted"].empty());
  for (const Json& window : view_of(section, "bursts")["predicted"])
    EXPECT_LE(window["from"].get<double>(), 1.75);
  EXPECT_FALSE(section.contains("expectations"));
}

TEST_F(ReportProgram, RefusesWhatIsNoFileOfResults) {
  const std::string run = make_run();
  const auto refused = [](const ProgramResult& result, int code, const std::string& message) {
    EXPECT_EQ(result.exit_code, code) << result.out;
    EXPECT_THAT(result.err, HasSubstr(message));
  };
  refused(report({run, "-o", path("page.png")}), 2, "does not end in .html");
  refused(report({path("missing.h5"), "-o", path("page.html")}), 4, "cannot be opened");
  refused(report({scene("beam_on_beam.yaml"), "-o", path("page.html")}), 4, "is not an HDF5 file");
  refused(report({run, "-o", path("page.html"), "--budget", "20kB"}), 2, "give at least 300kB");
  refused(report({run, "-o", path("page.html"), "--budget", "much"}), 2, "--budget");
  refused(report({run, "-o", path("page.html"), "--channel", "nothing"}), 2, "nothing");
  edit(run, [](hid_t file) {
    H5Adelete(file, "format");
    H5Adelete(file, "kind");
  });
  refused(report({run, "-o", path("page.html")}), 4, "is no file of results");
  EXPECT_FALSE(exists("page.html"));
  page_of({make_run({}, "other.h5")});
  refused(report({path("other.h5"), "-o", path("page.html")}), 4, "exists; use --force to overwrite it");
}

}  // namespace
}  // namespace stridor
