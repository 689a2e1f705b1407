// Messages of the program about a wrong scene: the place in a line of its own, the line, a caret.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;
using Json = nlohmann::json;

/// The main scene with every first `from` replaced.
std::string main_scene_with(const std::vector<std::pair<std::string, std::string>>& changes) {
  std::string text = contents_of(scene_path("beam_on_beam.yaml"));
  for (const auto& [from, to] : changes) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  }
  return text;
}

TEST(Check, ShowsTheLineOfEveryErrorWithACaret) {
  const TemporaryFolder folder;
  const std::string path = folder / "bad.yaml";
  write_file(path,
             "format: 2  # µ\nsubstructures: {}\ndrive: {velocity: 1 kg, load: 1, ramp: 0}\n"
             "time: {step: 1e-7, end: 1, stepp: 2}\n");
  const ProgramResult result = Program({"check", path}).run();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(
      result.err,
      "stridor: the input is wrong\n" + path +
          ":3:19: drive.velocity: '1 kg' has unit kg, expected a velocity in m s-1 [wrong-unit]\n"
          "    3 | drive: {velocity: 1 kg, load: 1, ramp: 0}\n"
          "      |                   ^\n" +
          path +
          ":4:28: time.stepp: unknown key 'stepp', did you mean 'step'? [unknown-key]\n"
          "    4 | time: {step: 1e-7, end: 1, stepp: 2}\n"
          "      |                            ^\n");
}

TEST(Check, ShowsTheAssignmentWhereTheErrorLiesInOne) {
  const ProgramResult result = Program({"check", scene_path("beam_on_beam.yaml"), "--set",
                                        "contact.strat=30 mm", "--set", "time.step=2e-7 kg"})
                                   .run();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err,
            "stridor: the input is wrong\n"
            "--set contact.strat=30 mm: contact.strat: unknown key 'strat', did you mean "
            "'start'? [unknown-key]\n"
            "      | --set contact.strat=30 mm\n"
            "      |               ^\n"
            "--set time.step=2e-7 kg: time.step: '2e-7 kg' has unit kg, expected a time in s "
            "[wrong-unit]\n"
            "      | --set time.step=2e-7 kg\n"
            "      |                 ^\n");
}

TEST(Check, ErrorsThatOnlyTheModelFindsAreShownInTheirLine) {
  const TemporaryFolder folder;
  const std::string path = folder / "bad.yaml";
  write_file(path, main_scene_with({{"master: cantilever.top", "master: cantilever.tpo"}}));
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"check", path},
        std::vector<std::string>{"run", path, "-o", folder / "a.h5"}}) {
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr("|   master: cantilever.tpo\n      |           ^\n"));
  }
}

TEST(Check, FindsWhatRunFindsBeforeItsFirstStep) {
  const std::string scene = scene_path("beam_on_beam.yaml");
  for (const auto& [settings, key] :
       {std::pair{std::vector<std::string>{"record.energy=true", "time.integrator=exact"},
                  "record.energy: the energy ledger takes"},
        std::pair{std::vector<std::string>{"initial.state=equilibrium"},
                  "initial.state: equilibrium is that under the loads of t = 0"},
        std::pair{std::vector<std::string>{"time.step=1e-6"},
                  "time.step: 1e-06 s is above the largest stable step"}}) {
    std::vector<std::string> arguments{"check", scene};
    for (const std::string& one : settings) arguments.insert(arguments.end(), {"--set", one});
    const ProgramResult check = Program(arguments).run();
    EXPECT_EQ(check.exit_code, 2);
    EXPECT_THAT(check.err, HasSubstr(key));
    const TemporaryFolder folder;
    arguments[0] = "run";
    arguments.insert(arguments.end(), {"-o", (folder / "x.h5").string()});
    EXPECT_EQ(Program(arguments).run().err, check.err);
  }
}

TEST(Check, SeesTheStateInWhichARunStarts) {
  // At rest the full load of t = 0 would not hold this contact closed.
  const ProgramResult good = Program({"check", scene_path("examples/frozen_growth.yaml")}).run();
  EXPECT_EQ(good.exit_code, 0) << good.err;
  const ProgramResult bad = Program({"check", scene_path("examples/frozen_growth.yaml"), "--set",
                                     "initial.perturbation.eigenvalue=9999"})
                                .run();
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_THAT(bad.err, HasSubstr("initial.perturbation.eigenvalue"));
}

TEST(Check, ConditionsBetweenKeysAreNamed) {
  const std::string disc = scene_path("disc_and_pads.yaml");
  const std::string beams = scene_path("beam_on_beam.yaml");
  const struct {
    std::string scene;
    std::vector<std::string> settings;
    const char* message;
  } cases[] = {
      {disc, {"contacts.upper.normal={law: penalty}"}, "contacts.upper.normal.stiffness"},
      {disc,
       {"substructures.disc.outer_radius=100 mm"},
       "contacts.lower.start.radius: must lie between the edges of the plate, 0.08 and 0.1 m, got "
       "0.13 m"},
      {disc,
       {"substructures.disc.outer_radius=70 mm"},
       "disc.outer_radius: must be larger than inner_radius = 0.08 m, got 0.07 m"},
      {disc,
       {"substructures.disc.radial_modes=9"},
       "disc.radial_modes: must not exceed radial_terms = 8, got 9"},
      // 6.4e7 N/m is more than √(4e7·1e8) N/m.
      {disc,
       {"substructures.upper.springs.backing.stiffness.xy=6.4e7"},
       "substructures.upper.springs.backing.stiffness"},
      {beams,
       {"time.coordinates=craig_bampton", "time.integrator=exact"},
       "time.integrator: exact takes coordinates: modal"},
      {beams, {"time.step=1e-16"}, "time.step: the run would take more than 1e15 steps"},
      {scene_path("viscoelastic_sphere.yaml"),
       {"time.integrator=exact", "time.step=1e-15"},
       "time.step: the run would take more than 1e15 steps"},
      {scene_path("viscoelastic_contact.yaml"),
       {"contacts.tip.normal.solver.grid=33"},
       "contacts.tip.normal.solver.grid: 33 is not even"}};
  for (const auto& [scene, settings, message] : cases) {
    std::vector<std::string> arguments{"check", scene};
    for (const std::string& one : settings) arguments.insert(arguments.end(), {"--set", one});
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_THAT(result.err, HasSubstr(message));
  }
}

TEST(Check, JsonHoldsPlaceKeyAndMessageAlone) {
  const TemporaryFolder folder;
  const std::string path = folder / "bad.yaml";
  write_file(path, main_scene_with({{"ramp: 0.1}", "ramp: -1}"}}));
  const ProgramResult result = Program({"check", path, "--json", "--set", "time.step=x"}).run();
  EXPECT_EQ(result.exit_code, 2);
  const Json errors = Json::parse(result.out)["errors"];
  ASSERT_EQ(errors.size(), 2u) << result.out;
  for (const Json& error : errors) {
    std::vector<std::string> names;
    for (const auto& [name, value] : error.items()) names.push_back(name);
    EXPECT_THAT(
        names, ::testing::UnorderedElementsAre("code", "file", "line", "column", "key", "message"));
  }
  EXPECT_EQ(errors[0]["code"], "wrong-value");
  EXPECT_EQ(errors[0]["file"], path);
  EXPECT_EQ(errors[0]["key"], "drive.ramp");
  EXPECT_EQ(errors[1]["file"], "--set time.step=x");
  EXPECT_EQ(errors[1]["line"], 0);
  EXPECT_EQ(errors[1]["column"], 0);
}

// ---------------------------------------------------------------- gaps at the start

/// Both of `check` and `run`, which must agree.
ProgramResult refused_start(const std::string& scene, const std::vector<std::string>& settings) {
  const TemporaryFolder folder;
  std::vector<std::string> check{"check", scene};
  for (const std::string& one : settings) check.insert(check.end(), {"--set", one});
  std::vector<std::string> run = check;
  run[0] = "run";
  run.insert(run.end(), {"-o", (folder / "x.h5").string()});
  const ProgramResult result = Program(check).run();
  EXPECT_EQ(result.exit_code, 2) << scene;
  const ProgramResult of_run = Program(run).run();
  EXPECT_EQ(of_run.exit_code, 2) << scene;
  EXPECT_EQ(of_run.err, result.err);
  EXPECT_FALSE(std::filesystem::exists(folder / "x.h5"));
  return result;
}

TEST(CheckStart, OverlapIsRefusedWithTheSmallestLiftThatRemovesIt) {
  const std::string landing = scene_path("examples/landing.yaml");
  EXPECT_THAT(refused_start(landing, {"initial.displacement=[{at: arm, y: -1 um}]"}).err,
              AllOf(HasSubstr("initial.displacement: 'contact' starts 1e-06 m inside its master "
                              "'rigid'"),
                    HasSubstr("move 'arm' by x: 0 m, y: 1e-06 m")));
  // On a master that is inclined against the axes the lift is along its normal.
  const std::vector<std::string> inclined{
      "contact.assumption=film", "substructures.cantilever.angle=20 deg",
      "initial={state: rest, displacement: [{at: oblique, y: -1 mm}]}"};
  EXPECT_THAT(refused_start(scene_path("extreme/plain.yaml"), inclined).err,
              HasSubstr("starts 0.000939693 m inside its master 'cantilever.top'"));
}

TEST(CheckStart, TheLiftThatIsNamedIsEnough) {
  const auto check = [](const char* displacement) {
    return Program({"check", scene_path("extreme/plain.yaml"), "--set", "contact.assumption=film",
                    "--set", std::string("initial={state: rest, displacement: ") + displacement})
        .run();
  };
  const ProgramResult refused = check("[{at: oblique, y: -1.2345678 um}]}");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("y: 1.2345678e-06 m"));
  const ProgramResult lifted =
      check("[{at: oblique, y: -1.2345678 um}, {at: oblique, y: 1.2345678e-06}]}");
  EXPECT_EQ(lifted.exit_code, 0) << lifted.err;
}

TEST(CheckStart, ABilateralContactStartsWithoutAnyGap) {
  const std::string plain = scene_path("extreme/plain.yaml");
  for (const char* assumption : {"subs_a", "subs_b", "subs_c"}) {
    const std::string set = std::string("contact.assumption=") + assumption;
    EXPECT_THAT(refused_start(plain, {set, "initial={displacement: [{at: oblique, y: 1 um}]}"}).err,
                AllOf(HasSubstr("starts 1e-06 m away from its master"), HasSubstr("y: -1e-06 m")));
    EXPECT_THAT(
        refused_start(plain, {set, "initial={displacement: [{at: oblique, y: -1 um}]}"}).err,
        HasSubstr("starts 1e-06 m inside its master"));
  }
  // Where a contact can open, the load closes the gap in time.
  const ProgramResult open = Program({"check", plain, "--set", "contact.assumption=film", "--set",
                                      "initial={displacement: [{at: oblique, y: 1 um}]}"})
                                 .run();
  EXPECT_EQ(open.exit_code, 0) << open.err;
}

// ---------------------------------------------------------------- input formerly accepted silently

TEST(Check, RefusesWhatCannotBeMeant) {
  const struct {
    const char* scene;
    std::vector<std::string> settings;
    const char* message;
  } cases[] = {
      {"beam_on_beam.yaml",
       {"contact.friction.coefficient=1e300"},
       "contact.friction.coefficient: is beyond what can be computed with"},
      {"beam_on_beam.yaml",
       {"contact.friction.coefficient=1e60"},
       "contact.friction.coefficient: must be at most 100, got 1e+60: solids in contact have"},
      {"disc_and_pads.yaml",
       {"contacts.upper.friction.coefficient=101"},
       "contacts.upper.friction.coefficient: must be at most 100, got 101"},
      {"beam_on_beam.yaml",
       {"contact.slave=[oblique.tip, oblique.tip]"},
       "contact.slave: 'oblique.tip' names a node that is slave point 1 already"},
      {"examples/slave_edge.yaml",
       {"contact.slave=[post.start_face, post.start_top]"},
       "names a node that is slave point"},
      {"examples/two_pairs.yaml",
       {"contacts.rear.slave=front.tip", "contacts.rear.start=50 mm"},
       "contacts.rear.slave: shares a node with the pair 'front' on the same master"},
      {"beam_on_beam.yaml",
       {"substructures.oblique.angle=-30 deg", "contact.slave=oblique.start_top"},
       "contact.slave: 'oblique' starts on the inner side of its master 'cantilever.top'"}};
  for (const auto& [scene, settings, message] : cases)
    EXPECT_THAT(refused_start(scene_path(scene), settings).err, HasSubstr(message));
}

TEST(Check, WarnsOfWhatIsHardlyMeantWithoutRefusing) {
  const struct {
    const char* scene;
    std::vector<std::string> settings;
    const char* message;
  } cases[] = {
      {"beam_on_beam.yaml",
       {"measure.from=3"},
       "measure.from: 3 s is not before time.end = 2.25 s: the window of the statistics is empty"},
      {"beam_on_beam.yaml",
       {"drive.load=0.2"},
       "drive: the loads pull the bodies apart: no contact presses in the equilibrium"},
      {"beam_on_beam.yaml",
       {"drive.load=0"},
       "drive: nothing presses the bodies together: every contact force is 0 in equilibrium"},
      {"extreme/runs_off.yaml", {}, "time.end: the drive carries 'contact' off the end of its"},
      {"beam_on_beam.yaml",
       {"substructures.oblique.width=50"},
       "substructures.oblique.width: is 50 m, since bare numbers are in SI units"},
      {"beam_on_beam.yaml",
       {"substructures.oblique.material.youngs_modulus=71"},
       "substructures.oblique.material.youngs_modulus: is 71 Pa"},
      {"beam_on_beam.yaml",
       {"record.channels=[cantilever.start.y.displacement, cantilever.free_end.y.acceleration]"},
       "record.channels.0: 'cantilever.start.y.displacement' will be recorded as zeros: "
       "'cantilever' is held in y at this point"},
      {"disc_and_pads.yaml",
       {"substructures.disc.outer_radius=160", "initial={}"},
       "disc.outer_radius: is 160 m, since bare numbers are in SI units"},
      {"beam_on_beam.yaml",
       {"substructures.cantilever.thickness=0.2"},
       "substructures.cantilever.thickness: is 0.2 m on a length of 0.1 m: thicker than long"}};
  for (const auto& [scene, settings, message] : cases) {
    std::vector<std::string> arguments{"check", scene_path(scene)};
    for (const std::string& one : settings) arguments.insert(arguments.end(), {"--set", one});
    const ProgramResult text = Program(arguments).run();
    EXPECT_EQ(text.exit_code, 0) << text.err;
    EXPECT_THAT(text.err, AllOf(HasSubstr("stridor: warning\n"), HasSubstr(message)));
    EXPECT_THAT(text.out, HasSubstr("no errors, 1 warning\n"));
    arguments.emplace_back("--json");
    const Json json = Json::parse(Program(arguments).run().out);
    EXPECT_EQ(json["errors"].size(), 0u);
    ASSERT_EQ(json["warnings"].size(), 1u);
    EXPECT_THAT(json["warnings"][0]["key"].get<std::string>() + ": " +
                    json["warnings"][0]["message"].get<std::string>(),
                HasSubstr(message));
  }
  // A unit that is written is meant.
  const ProgramResult meant =
      Program({"check", scene_path("disc_and_pads.yaml"), "--set",
               "substructures.disc.outer_radius=160 m"})
          .run();
  EXPECT_THAT(meant.err, ::testing::Not(HasSubstr("warning")));
}

TEST(Check, ScenesOfTheProgramRaiseNoWarning) {
  for (const char* scene :
       {"beam_on_beam_leading.yaml", "disc_and_pads.yaml", "viscoelastic_contact.yaml",
        "viscoelastic_sphere.yaml", "examples/beam_on_substrate.yaml",
        "examples/clamped_bridge.yaml", "examples/flutter.yaml", "examples/landing.yaml",
        "examples/rough_surface.yaml", "examples/slave_edge.yaml", "examples/thrown_bar.yaml",
        "examples/two_feet.yaml", "examples/two_pairs.yaml"}) {
    const ProgramResult result = Program({"check", scene_path(scene)}).run();
    EXPECT_EQ(result.exit_code, 0) << scene;
    EXPECT_EQ(result.err, "") << scene;
  }
}

TEST(CheckStability, SaysWhereTheSlidingItselfGrows) {
  // The burst near 3.52 kHz of the main scene, which its sagged geometry makes.
  const std::vector<std::string> arguments{"check", scene_path("beam_on_beam.yaml"), "--stability",
                                           "--places", "11"};
  const ProgramResult text = Program(arguments).run();
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("step 2e-07 s, largest stable step of the bodies 2.9162e-07 s"));
  EXPECT_THAT(text.out, HasSubstr("grows as in the bodies"));
  EXPECT_THAT(text.out, HasSubstr("the step adds no growth of its own"));

  std::vector<std::string> with_json = arguments;
  with_json.push_back("--json");
  const Json found = Json::parse(Program(with_json).run().out)["stability"];
  EXPECT_EQ(found["steps_grow"], false);
  EXPECT_EQ(found["stable_step"], nullptr);
  ASSERT_EQ(found["places"].size(), 11u);
  for (const Json& place : found["places"]) {
    const bool grows = place["verdict"] == "grows as in the bodies";
    EXPECT_EQ(grows, place["radius"] > 1.0);
    if (!grows) continue;
    EXPECT_NEAR(place["frequency"].get<double>(), 3520.0, 20.0);
    EXPECT_NEAR(place["growth"].get<double>(), place["growth_of_bodies"].get<double>(), 0.1);
  }
}

TEST(CheckStability, RefusesAStepThatFrictionMakesTooLarge) {
  // Below the limit of the reed by itself; pushed ahead, friction lowers it.
  const auto check = [](const std::string& step) {
    return Program({"check", scene_path("examples/stick_slip.yaml"), "--stability", "--places", "3",
                    "--json", "--set", "substructures.reed.angle=150 deg", "--set",
                    "contact.friction.dynamic=0.4", "--set", "time.step=" + step, "--set",
                    "record.interval=" + step})
        .run();
  };
  const ProgramResult refused = check("8e-6");
  EXPECT_EQ(refused.exit_code, 3) << refused.err;
  const Json found = Json::parse(refused.out)["stability"];
  EXPECT_EQ(found["steps_grow"], true);
  EXPECT_LT(8e-6, found["step_limit"].get<double>());
  EXPECT_EQ(found["places"][0]["verdict"], "grows by the step");
  const double cured = found["stable_step"].get<double>();
  EXPECT_LT(cured, 8e-6);
  EXPECT_EQ(check(std::to_string(0.99e6 * cured) + "e-6").exit_code, 0);
  EXPECT_EQ(check(std::to_string(1.01e6 * cured) + "e-6").exit_code, 3);
}

TEST(CheckStability, IsOfStepsWithContactsThatAConstraintCloses) {
  const std::vector<std::pair<std::string, std::string>> refused{
      {"viscoelastic_sphere.yaml", "event_driven has no steps of a given length"},
      {"viscoelastic_contact.yaml", "without bodies to march"},
      {"examples/beam_on_substrate.yaml", "--stability: takes contacts that a constraint closes"}};
  for (const auto& [scene, why] : refused) {
    const ProgramResult result = Program({"check", scene_path(scene), "--stability"}).run();
    EXPECT_EQ(result.exit_code, 2) << scene;
    EXPECT_THAT(result.err, HasSubstr(why)) << scene;
  }
}

}  // namespace
}  // namespace stridor
