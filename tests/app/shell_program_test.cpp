// Completion in shells, and manual pages.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/app/pictures_fixture.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using ::testing::Not;
using ::testing::StartsWith;
using Words = std::vector<std::string>;

Words lines_of(const std::string& text) {
  Words lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string beams_path() {
  return std::string(STRIDOR_SOURCE_DIR) + "/scenes/beam_on_beam.yaml";
}

/// Candidates for the last word, a line each. Whatever is typed, nothing is an error.
Words completed(Words words) {
  words.insert(words.begin(), {"complete", "--"});
  const ProgramResult result = Program(words).run();
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  return lines_of(result.out);
}

/// All verbs, as completion gives them.
Words verb_names() {
  Words names;
  for (const std::string& line : completed({""})) names.push_back(line.substr(0, line.find('\t')));
  return names;
}

TEST(Completion, OfTheFirstWordIsAVerbWithWhatItDoes) {
  EXPECT_THAT(completed({"lo"}), ElementsAre("locus\tEigenvalues along one key of a scene"));
  EXPECT_THAT(verb_names(), IsSupersetOf({"run", "eig", "locus", "report", "sound"}));
  EXPECT_THAT(verb_names(), Not(Contains("complete")));
  EXPECT_THAT(verb_names(), Not(Contains("manual")));
}

TEST(Completion, OfAKeyIsAKeyOfTheSceneWithItsUnit) {
  EXPECT_THAT(completed({"locus", beams_path(), "--parameter", "drive.sp"}), IsEmpty());
  EXPECT_THAT(completed({"locus", beams_path(), "--parameter", "contact.start"}),
              ElementsAre("contact.start\tm", "contact.start.along\tm"));
  EXPECT_THAT(completed({"run", beams_path(), "--set", "contact.start"}),
              ElementsAre("contact.start=\tm", "contact.start.along=\tm", "contact.start.at="));
  EXPECT_THAT(completed({"run", beams_path(), "--set", "contact.friction.coe"}),
              ElementsAre("contact.friction.coefficient="));
  EXPECT_THAT(completed({"run", beams_path(), "--set", "time.st"}), ElementsAre("time.step=\ts"));
  // Only numbers can be varied.
  EXPECT_THAT(completed({"locus", beams_path(), "--parameter", "contact.friction.law"}), IsEmpty());
  EXPECT_THAT(completed({"map", beams_path(), "--x", "contact.friction.coe"}),
              ElementsAre("contact.friction.coefficient"));
}

TEST(Completion, OfAValueIsOneOfTheChoicesOfItsKey) {
  EXPECT_THAT(completed({"run", beams_path(), "--set", "contact.assumption="}),
              ElementsAre("contact.assumption=subs_a", "contact.assumption=subs_b",
                          "contact.assumption=subs_c", "contact.assumption=film"));
  EXPECT_THAT(completed({"run", beams_path(), "--set=contact.assumption=f"}),
              ElementsAre("--set=contact.assumption=film"));
  EXPECT_THAT(completed({"run", beams_path(), "--set", "contact.friction.coefficient="}),
              ElementsAre("contact.friction.coefficient=0.3\tpresent value"));
  EXPECT_THAT(completed({"run", beams_path(), "--set", "contact.friction.coefficient=0.25"}),
              IsEmpty());
  EXPECT_THAT(completed({"run", "--set", "contact.friction.coefficient="}), IsEmpty());
  EXPECT_THAT(completed({"locus", beams_path(), "--parameter=time.st"}),
              ElementsAre("--parameter=time.step\ts"));
}

TEST(Completion, LooksForTheSceneBehindTheWordToo) {
  const ProgramResult result =
      Program({"complete", beams_path(), "--", "locus", "--parameter", "contact.friction.coe"})
          .run();
  EXPECT_EQ(result.out, "contact.friction.coefficient\n");
}

TEST(Completion, OfAFrequencyResponseIsAMotionOfTheScene) {
  EXPECT_THAT(completed({"frf", beams_path(), "--input", "cantilever.free_end."}),
              ElementsAre("cantilever.free_end.x\tN", "cantilever.free_end.y\tN"));
  EXPECT_THAT(completed({"frf", beams_path(), "--output", "oblique.tip.x"}),
              ElementsAre("oblique.tip.x.displacement\tm", "oblique.tip.x.velocity\tm/s",
                          "oblique.tip.x.acceleration\tm/s^2"));
  // Of files too, and along z where bodies move there.
  const std::string scenes = std::string(STRIDOR_SOURCE_DIR) + "/scenes/";
  EXPECT_THAT(completed({"frf", scenes + "examples/bracket.yaml", "--input", ""}), Not(IsEmpty()));
  EXPECT_THAT(completed({"frf", scenes + "disc_and_pads.yaml", "--input", ""}),
              Contains(HasSubstr(".z\t")));
  EXPECT_THAT(completed({"frf", "none.yaml", "--input", ""}), IsEmpty());
  EXPECT_THAT(completed({"frf", "--output", ""}), IsEmpty());
  EXPECT_THAT(completed({"run", beams_path(), "--output", ""}), IsEmpty());
}

class CompletionOfRuns : public Pictures {};

TEST_F(CompletionOfRuns, AChannelIsOneOfTheFile) {
  const std::string run = make_run();
  EXPECT_THAT(completed({"spectrogram", run, "--channel", "beam.tip.y.a"}),
              ElementsAre("beam.tip.y.acceleration\tm/s^2"));
  EXPECT_THAT(completed({"sound", run, "--channel", ""}), Contains("contact.force\tN"));
}

TEST(Completion, OfAnOptionOrOneOfItsValues) {
  EXPECT_THAT(completed({"eig", beams_path(), "--abo"}), ElementsAre(StartsWith("--about\t")));
  EXPECT_THAT(completed({"eig", beams_path(), "--about", ""}),
              ElementsAre("undeformed", "deformed"));
  EXPECT_THAT(completed({"plot", "run.h5", "--kind", "sp"}), ElementsAre("spectrogram", "spectrum"));
}

TEST(Completion, IsEmptyWhereAFileStandsOrNothingIsKnown) {
  EXPECT_THAT(completed({"run", "scenes/"}), IsEmpty());
  EXPECT_THAT(completed({"run", "none.yaml", "--set", ""}), IsEmpty());
  EXPECT_THAT(completed({"nothing", "--set", ""}), IsEmpty());
  EXPECT_THAT(completed({"run", beams_path(), "-o", ""}), IsEmpty());
  const TemporaryFolder folder;
  const std::string broken = (folder / "broken.yaml").string();
  std::ofstream(broken) << "format: [";
  EXPECT_THAT(completed({"run", broken, "--set", ""}), IsEmpty());
}

// Both beside bash, where the machine has them: a word in the middle of the line, the scene behind
// it.
TEST(Completion, InFishAndZsh) {
  const TemporaryFolder folder;
  const std::string link = "mkdir -p '" + (folder / "bin").string() + "'; ln -sf '" +
                           STRIDOR_PROGRAM + "' '" + (folder / "bin/stridor").string() +
                           "'; export PATH='" + (folder / "bin").string() + "':$PATH HOME='" +
                           folder.path().string() + "'; ";
  const std::string out = (folder / "out").string();
  const std::string completions = std::string(STRIDOR_SOURCE_DIR) + "/cmake/completions/";
  int num_tried = 0;
  if (std::system("command -v fish >/dev/null") == 0) {
    ++num_tried;
    const std::string words = "stridor locus " + beams_path() + " --parameter contact.friction.c";
    const std::string command = link + "fish --no-config -c \"source '" + completions +
                                "stridor.fish'; complete -C '" + words + "'\" > '" + out + "' 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0);
    EXPECT_EQ(contents_of(out), "contact.friction.coefficient\n");
    // A file stands behind --output, but for frf, where it is a motion.
    std::ofstream(folder / "result.h5") << "";
    for (const std::string verb : {"run", "frf"}) {
      const std::string files = link + "cd '" + folder.path().string() +
                                "'; fish --no-config -c \"source '" + completions +
                                "stridor.fish'; complete -C 'stridor " + verb +
                                " none.yaml --output res'\" > '" + out + "' 2>&1";
      ASSERT_EQ(std::system(files.c_str()), 0);
      EXPECT_EQ(contents_of(out), verb == "run" ? "result.h5\n" : "");
    }
  }
  if (std::system("command -v zsh >/dev/null") == 0) {
    ++num_tried;
    // The functions of its completion system, of which one is taken, print what they are given.
    const std::string script =
        "_describe() { shift; print -l -- ${(P)1} }; _files() { print files }; words=(stridor "
        "locus --parameter "
        "contact.friction.c '" +
        beams_path() + "'); CURRENT=4; () { source '" + completions + "_stridor' }";
    const std::string file = (folder / "script.zsh").string();
    std::ofstream(file) << script;
    ASSERT_EQ(std::system((link + "zsh -f '" + file + "' > '" + out + "' 2>&1").c_str()), 0);
    EXPECT_EQ(contents_of(out), "contact.friction.coefficient\n");
  }
  if (num_tried == 0) GTEST_SKIP() << "neither fish nor zsh";
}

// bash itself, as far as its function goes.
TEST(Completion, InBash) {
  const TemporaryFolder folder;
  const std::string out = (folder / "out").string();
  const std::string script = std::string("source '") + STRIDOR_SOURCE_DIR +
                             "/cmake/completions/stridor.bash'; COMP_WORDS=('" + STRIDOR_PROGRAM +
                             "' locus '" + beams_path() +
                             "' --parameter contact.friction.c); COMP_CWORD=4; _stridor; printf "
                             "'%s\\n' \"${COMPREPLY[@]}\" > '" +
                             out + "'";
  const std::string file = (folder / "script.sh").string();
  std::ofstream(file) << script;
  ASSERT_EQ(std::system(("bash '" + file + "'").c_str()), 0);
  EXPECT_EQ(contents_of(out), "contact.friction.coefficient\n");
}

class Manual : public ::testing::Test {
 protected:
  void SetUp() override {
    const ProgramResult result =
        Program({"manual", folder_.path().string(), std::string(STRIDOR_SOURCE_DIR) + "/docs"}).run();
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  std::string page(const std::string& name) const { return contents_of(folder_ / name); }

  TemporaryFolder folder_;
};

TEST_F(Manual, EveryOptionOfEveryVerbIsInItsPage) {
  for (const std::string& verb : verb_names()) {
    const std::string help = Program({verb, "--help"}).run().out;
    const std::string text = page("stridor-" + verb + ".1");
    EXPECT_THAT(text, HasSubstr(".SH SYNOPSIS")) << verb;
    const std::regex option("--([a-z]+(-[a-z]+)*)");
    std::set<std::string> names;
    for (auto found = std::sregex_iterator(help.begin(), help.end(), option); found != std::sregex_iterator(); ++found) {
      // At the start of a line alone it is an option of this verb, not one of a text.
      const std::size_t at = static_cast<std::size_t>(found->position());
      const std::size_t line = help.rfind('\n', at);
      const std::string before = help.substr(line + 1, at - line - 1);
      if (before.find_first_not_of(" ,-ohx") == std::string::npos) names.insert((*found)[1]);
    }
    EXPECT_GT(names.size(), 1u) << verb;
    for (std::string name : names) {
      name = std::regex_replace(name, std::regex("-"), "\\-");
      EXPECT_THAT(text, HasSubstr("\\-\\-" + name)) << verb;
    }
    EXPECT_THAT(page("stridor.1"), HasSubstr("\\fB" + verb + "\\fR"));
  }
}

TEST_F(Manual, EveryVerbHasAnExampleAndNamesOfItsValues) {
  for (const std::string& verb : verb_names()) {
    const std::string text = page("stridor-" + verb + ".1");
    EXPECT_THAT(text, HasSubstr(".SH EXAMPLES")) << verb;
    EXPECT_THAT(text, HasSubstr("\nstridor " + verb + " ")) << verb;
    EXPECT_THAT(text, Not(HasSubstr("TEXT"))) << verb;
    EXPECT_THAT(Program({verb, "--help"}).run().out, Not(HasSubstr("TEXT"))) << verb;
  }
  EXPECT_THAT(page("stridor-run.1"), HasSubstr("\\fB\\-\\-vtu\\fR \\fIFOLDER\\fR"));
}

TEST_F(Manual, ScenesAndFilesHavePages) {
  EXPECT_THAT(page("stridor-scene.5"), HasSubstr("\\fBformat\\fR"));
  EXPECT_THAT(page("stridor-scene.5"), Not(HasSubstr("Generated by")));
  EXPECT_THAT(page("stridor-files.5"), HasSubstr("\\fB/time\\fR"));
  for (const std::string& name : folder_.files()) {
    const std::string text = page(name);
    EXPECT_THAT(text, StartsWith(".TH ")) << name;
    // Lines of text that begin with a dot would be commands.
    for (const std::string& line : lines_of(text)) {
      if (!line.starts_with(".")) continue;
      EXPECT_TRUE(std::regex_search(line, std::regex("^\\.(TH|SH|TP|PP|IP|nf|fi)\\b")))
          << name << ": " << line;
    }
  }
}

TEST_F(Manual, PassesTheChecksOfMandoc) {
  if (std::system("command -v mandoc >/dev/null") != 0) GTEST_SKIP() << "no mandoc";
  const std::string command = "mandoc -Tlint -W style '" + folder_.path().string() + "'/*";
  EXPECT_EQ(std::system(command.c_str()), 0);
}

TEST_F(Manual, IsEqualForEqualDates) {
  const TemporaryFolder again;
  const std::string command = std::string("SOURCE_DATE_EPOCH=86400 '") + STRIDOR_PROGRAM + "' manual '" +
                              again.path().string() + "' '" + STRIDOR_SOURCE_DIR + "/docs' >/dev/null";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_THAT(contents_of(again / "stridor.1"), StartsWith(".TH STRIDOR 1 1970-01-02"));
}

TEST(HiddenVerbs, AreNotAdvertised) {
  EXPECT_THAT(Program({"--help"}).run().out, Not(HasSubstr("manual")));
  const ProgramResult wrong = Program({"nothing"}).run();
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, Not(HasSubstr("manual")));
}

}  // namespace
}  // namespace stridor
