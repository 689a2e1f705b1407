// Reports of eigenvalues, comparisons and contact laws.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "io/results/column_file.hpp"
#include "io/results/result_file.hpp"
#include "tests/app/pictures_fixture.hpp"
#include "tests/support/report_blocks.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;
using Json = nlohmann::json;

/// The table with a title; null where there is none.
Json table_of(const Json& section, const std::string& title) {
  for (const Json& view : section["views"])
    if (view["type"] == "table" && view["title"].get<std::string>().starts_with(title)) return view;
  return nullptr;
}

/// A column of a table, numbers or words.
Json column_of(const Json& table, const std::string& name) {
  for (const Json& column : table["columns"])
    if (column["name"] == name) return column.contains("texts") ? column["texts"] : column["values"];
  return nullptr;
}

class ReportTables : public Pictures {
 protected:
  /// Expects success. @return what the program prints as JSON
  static Json answer_of(std::vector<std::string> arguments) {
    arguments.emplace_back("--json");
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(result.out);
  }
  /// The only section of the page of a file.
  Json section_of(const std::string& file) const {
    const ProgramResult result =
        Program({"report", file, "-o", path("page.html"), "--force"}).run();
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return contents_of_report(contents_of(path("page.html")))["sections"][0];
  }
};

TEST_F(ReportTables, EigenvaluesStandWithTheirModesAndTheirReason) {
  const std::string file = path("eig.h5");
  const Json told = answer_of({"eig", scene_path("beam_on_beam.yaml"), "--at", "82 mm", "--about",
                               "deformed", "--explain", "-o", file});
  EXPECT_EQ(told["file"], file);
  const ResultFile kept(file);
  EXPECT_EQ(kept.kind(), "eigenvalues");
  const std::vector<double> growth = kept.read("/eigenvalues/growth");
  const std::vector<double> frequency = kept.read("/eigenvalues/frequency");
  const std::vector<double> ratio = kept.read("/eigenvalues/damping_ratio");
  ASSERT_EQ(growth.size(), told["eigenvalues"].size());
  for (std::size_t i = 0; i < growth.size(); ++i) {
    const double imaginary = told["eigenvalues"][i][1];
    EXPECT_EQ(growth[i], told["eigenvalues"][i][0]);
    EXPECT_DOUBLE_EQ(2.0 * std::numbers::pi * frequency[i], imaginary);
    EXPECT_NEAR(ratio[i], -growth[i] / std::hypot(growth[i], imaginary), 1e-15);
  }
  EXPECT_EQ(kept.read("/equilibrium/force")[0], told["equilibrium"]["force"]);

  const Json section = section_of(file);
  EXPECT_EQ(section["title"], "beam_on_beam: eigenvalues at contact.start = 82 mm");
  EXPECT_EQ(section["verdict"]["level"], "unstable");
  EXPECT_THAT(section["verdict"]["text"].get<std::string>(),
              HasSubstr("Up to 17 kHz 1 motion grows; the fastest, at 3.52 kHz, by 76.5"));
  EXPECT_EQ(column_of(table_of(section, "Eigenvalues"), "Frequency").size(), frequency.size());
  const Json why = column_of(table_of(section, "Why the mode of 3.52 kHz"), "Growth rate");
  EXPECT_NEAR(why[0].get<double>() + why[1].get<double>(),
              told["explanation"]["growth"].get<double>(), 1e-6);
  const Json frames = section["views"].back();
  ASSERT_EQ(frames["type"], "modes");
  ASSERT_EQ(frames["frames"].size(), 1u);
  EXPECT_NEAR(frames["frames"][0]["value"].get<double>(), 0.082, 1e-12);
  EXPECT_TRUE(std::ranges::any_of(frames["frames"][0]["modes"], [](const Json& mode) {
    return mode["growth"].get<double>() > 0.0;
  }));
}

TEST_F(ReportTables, AStableSceneSaysSoAndAnOpenContactHasItsGap) {
  const std::string file = path("eig.h5");
  answer_of({"eig", scene_path("disc_and_pads.yaml"), "-o", file});
  const Json section = section_of(file);
  EXPECT_EQ(section["verdict"]["level"], "stable");
  const Json contacts = table_of(section, "Sliding equilibrium");
  EXPECT_EQ(column_of(contacts, "Contact"), (Json{"lower", "upper"}));
  EXPECT_TRUE(column_of(contacts, "Gap").is_null());  // both are closed
  EXPECT_TRUE(table_of(section, "Why").is_null());    // nobody asked
}

TEST_F(ReportTables, AnEigenvalueFileIsNotOverwrittenUnasked) {
  const std::string file = path("eig.h5");
  answer_of({"eig", scene_path("disc_and_pads.yaml"), "-o", file});
  for (const char* verb : {"eig", "threshold"}) {
    std::vector<std::string> arguments{verb, scene_path("disc_and_pads.yaml"), "-o", file};
    if (std::string(verb) == "threshold")
      arguments.insert(arguments.end(),
                       {"--parameter", "parameters.mu", "--from", "0.2", "--to", "0.5"});
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 4) << verb;
    EXPECT_THAT(result.err, HasSubstr("exists; use --force"));
  }
}

TEST_F(ReportTables, AThresholdKeepsItsLocus) {
  const std::string file = path("threshold.h5");
  const Json told = answer_of({"threshold", scene_path("disc_and_pads.yaml"), "--parameter",
                               "parameters.mu", "--from", "0.2", "--to", "0.5", "--points", "7",
                               "-o", file});
  ASSERT_EQ(told["roots"].size(), 1u);
  EXPECT_EQ(told["file"], file);
  const ResultFile kept(file);
  EXPECT_EQ(kept.kind(), "locus");
  EXPECT_EQ(kept.text("parameter"), "parameters.mu");
  EXPECT_NEAR(kept.read("/unstable/from")[0], told["roots"][0]["value"].get<double>(), 1e-9);
  EXPECT_EQ(section_of(file)["verdict"]["level"], "unstable");
  // Also where the margin is known without a locus.
  const Json fast = answer_of({"threshold", scene_path("viscoelastic_sphere.yaml"), "--parameter",
                               "parameters.v", "--from", "0.01", "--to", "1", "--points", "5",
                               "-o", path("sphere.h5")});
  EXPECT_EQ(ResultFile(path("sphere.h5")).kind(), "locus");
  EXPECT_EQ(fast["file"], path("sphere.h5"));
}

TEST_F(ReportTables, AComparisonHasARowForEachRun) {
  const Json told = answer_of({"compare", scene_path("beam_on_beam.yaml"), "--set",
                               "time.end=0.01", "--set", "measure.from=0.005", "-o",
                               path("compared")});
  const Json section = section_of(path("compared") + "/comparison.h5");
  EXPECT_EQ(section["file"], "compared/comparison.h5");
  EXPECT_EQ(section["verdict"]["text"], "4 runs, of which 4 came to their end.");
  const Json runs = table_of(section, "Runs");
  EXPECT_EQ(column_of(runs, "Assumption"), (Json{"subs_a", "subs_b", "subs_c", "film"}));
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(column_of(runs, "Peak")[i], told["rows"][i]["peak"]);
    EXPECT_EQ(column_of(runs, "Largest force")[i], told["rows"][i]["contact_force"]["max"]);
  }
}

TEST_F(ReportTables, AContactLawIsShownOverSpeedAndIndentation) {
  const std::string file = path("law.h5");
  const Json told = answer_of({"contact", scene_path("viscoelastic_contact.yaml"), "--table", file,
                               "--speeds", "0.1", "1", "4", "--indentations", "0.01", "0.1", "5",
                               "--set", "contacts.tip.normal.solver.grid=32"});
  const Json section = section_of(file);
  EXPECT_EQ(section["views"].size(), 3u);
  const std::string page = contents_of(path("page.html"));
  const Json& friction = section["views"][2];
  EXPECT_EQ(numbers_of(page, friction["x"]["values"]).size(), 4u);
  EXPECT_EQ(numbers_of(page, friction["y"]["values"]).size(), 5u);
  EXPECT_EQ(numbers_of(page, friction["value"]["values"]),
            told["friction"].get<std::vector<double>>());
}

TEST_F(ReportTables, AMasterCurveIsShownOverBeta) {
  const auto contact = [&](const std::string& file) {
    return Program({"contact", scene_path("viscoelastic_contact.yaml"), "--master-curve", file,
                    "--set", "contacts.tip.normal.solver.grid=32", "--json"})
        .run();
  };
  const std::string file = path("curve.h5");
  const ProgramResult made = contact(file);
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const Json points = Json::parse(made.out)["points"];
  const ResultFile kept(file);
  EXPECT_EQ(kept.kind(), "master curve");
  const std::vector<double> beta = kept.read("/beta");
  ASSERT_EQ(beta.size(), points.size());
  for (std::size_t k = 0; k < beta.size(); ++k) {
    EXPECT_EQ(beta[k], points[k]["beta"]);
    EXPECT_EQ(kept.read("/f")[k], points[k]["force"]);
    EXPECT_EQ(kept.read("/m")[k], points[k]["friction"]);
  }
  const Json section = section_of(file);
  EXPECT_EQ(section["title"], "viscoelastic_contact: master curve of sliding paraboloids");
  EXPECT_EQ(section["views"][0]["panels"].size(), 4u);
  // A file of another program; what is wrong with it is told apart.
  const std::string odd = path("odd.h5");
  write_column_file(odd, Overwrite::no, "master curve", {{"/f", "1", {1.0}}}, {});
  const ProgramResult report = Program({"report", odd, "-o", path("odd.html"), "--json"}).run();
  EXPECT_EQ(report.exit_code, 4);
  EXPECT_THAT(report.err, HasSubstr(odd + ": dataset /beta: is missing"));
  const Json error = Json::parse(report.out)["errors"][0];
  EXPECT_EQ(error["file"], odd);
  EXPECT_EQ(error["dataset"], "/beta");
  // The rows for compilers have endings of their own, and no other form is made.
  for (const char* name : {"curve.csv", "curve.png", "curve"}) {
    const ProgramResult refused = contact(path(name));
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, HasSubstr("--master-curve: '" + path(name) + "' ends neither in .h5"));
  }
}

}  // namespace
}  // namespace stridor
