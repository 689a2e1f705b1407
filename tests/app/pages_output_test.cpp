// What pages print below their commands is what the commands print.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>

#include "tests/app/document_fixture.hpp"

namespace stridor {
namespace {

namespace fs = std::filesystem;
using namespace test;

/// Whether a block is what the commands of the one before print: nothing stands between the two.
bool is_output(const std::vector<Block>& blocks, std::size_t i) {
  return i > 0 && blocks[i].language == "text" && blocks[i - 1].language == "sh" &&
         blocks[i].before.empty();
}

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream stream(line);
  return {std::istream_iterator<std::string>(stream), {}};
}

/// Equal words, or numbers with equal ends ("3 %", "12.5,") that differ by no more than 1e-3.
bool are_alike(const std::string& shown, const std::string& printed) {
  if (shown == printed) return true;
  char *end_shown = nullptr, *end_printed = nullptr;
  const double a = std::strtod(shown.c_str(), &end_shown);
  const double b = std::strtod(printed.c_str(), &end_printed);
  return end_shown != shown.c_str() && std::string(end_shown) == end_printed &&
         std::abs(a - b) <= 1e-3 * std::max(std::abs(a), std::abs(b));
}

/// Blanks do not count, nor do the times that a run took.
bool is_shown_as(const std::string& shown, const std::string& printed) {
  if (shown.starts_with("time taken")) return printed.starts_with("time taken");
  const auto a = words_of(shown), b = words_of(printed);
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), are_alike);
}

/// What is printed, without blank lines and those of progress, "run: ..., 42 %, 3 s left".
std::vector<std::string> results_in(const std::string& output) {
  auto lines = lines_of(output);
  std::erase_if(lines, [](const std::string& line) {
    return line.find_first_not_of(' ') == std::string::npos ||
           std::regex_search(line, std::regex("^[a-z]+: .*[0-9] %(, .* left)?$"));
  });
  return lines;
}

/// The first line that is shown and not printed there, "" if there is none. The lines shown follow
/// each other as they are printed; "..." stands for lines left out, as do both ends of the block.
std::string first_that_is_not_printed(const std::string& block, const std::string& output) {
  const auto printed = results_in(output);
  auto at = printed.begin();
  bool may_skip = true;
  for (const std::string& line : results_in(block)) {
    const bool is_gap = line == "...";
    if (!is_gap) {
      const auto is_it = [&](const std::string& one) { return is_shown_as(line, one); };
      const auto found = std::find_if(at, printed.end(), is_it);
      if (found == printed.end() || (found != at && !may_skip)) return line;
      at = found + 1;
    }
    may_skip = is_gap;
  }
  return "";
}

/// Writes the scenes that a page tells to write.
void write_scenes(const UserFolder& folder, const std::vector<Block>& blocks) {
  for (const Block& block : blocks) {
    std::smatch name;
    if (block.language == "yaml" &&
        std::regex_search(block.before, name,
                          std::regex("(?:Write|Save this as) `([a-z_]+\\.yaml)`")))
      write_file(folder / name[1], block.text);
  }
}

/// Whether a block is for the source tree, or installs something: not for a folder of a user's.
bool is_of_source_tree(const Block& block) {
  return std::regex_search(block.text, std::regex("(^|\n)(\\./run|cmake|ctest|sudo) "));
}

/// The pages whose commands are run as printed: all but the list of commands, which `Commands`
/// runs.
std::vector<fs::path> pages_with_commands() {
  std::vector<fs::path> pages{source / "README.md"};
  for (const char* folder : {"docs", "docs/theory", "scenes/examples"})
    for (const auto& entry : fs::directory_iterator(source / folder))
      if (entry.path().extension() == ".md" && entry.path().filename() != "commands.md" &&
          !blocks_of(entry.path(), "sh").empty())
        pages.push_back(entry.path());
  std::ranges::sort(pages);
  return pages;
}

class PagesWithCommands : public testing::TestWithParam<fs::path> {};

TEST_P(PagesWithCommands, RunFromTheFirstToTheLastAndPrintWhatIsShown) {
  std::ifstream text(GetParam());
  const auto blocks = blocks_in(text);
  const UserFolder folder;
  write_scenes(folder, blocks);
  std::string output;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (blocks[i].language == "sh" && !is_of_source_tree(blocks[i])) {
      const auto outcome =
          folder.run("set -e\ntrap 'echo \"exit code $?: $BASH_COMMAND\"' ERR\n" + blocks[i].text);
      EXPECT_EQ(outcome.exit_code, 0) << blocks[i].text << outcome.output;
      output = outcome.output;
    } else if (is_output(blocks, i)) {
      EXPECT_EQ(first_that_is_not_printed(blocks[i].text, output), "") << blocks[i].text << output;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Docs, PagesWithCommands, testing::ValuesIn(pages_with_commands()),
                         [](const auto& page) { return page.param.stem().string(); });

TEST(Pages, WithCommandsForTheSourceTreeAreThese) {
  std::set<std::string> pages;
  for (const fs::path& page : pages_with_commands()) {
    std::ifstream text(page);
    if (std::ranges::any_of(blocks_in(text), is_of_source_tree)) pages.insert(page.filename());
  }
  EXPECT_EQ(pages,
            (std::set<std::string>{"python.md", "robustness.md", "tutorial.md", "verified.md"}));
}

TEST(Pages, ShowWhatIsPrinted) {
  int num_shown = 0;
  for (const fs::path& page : pages_with_commands()) {
    std::ifstream text(page);
    const auto blocks = blocks_in(text);
    for (std::size_t i = 0; i < blocks.size(); ++i) num_shown += is_output(blocks, i);
  }
  EXPECT_GE(num_shown, 13);
}

TEST(Pages, OfWhatIsVerifiedNameSuitesThatThereAre) {
  const UserFolder folder;
  int num_commands = 0;
  for (const std::string& block : blocks_of(source / "docs" / "verified.md", "sh")) {
    for (const std::string& line : lines_of(block)) {
      std::smatch suites;
      ASSERT_TRUE(std::regex_search(line, suites, std::regex(R"('(.*?)')"))) << line;
      const auto listed =
          folder.run("ctest --test-dir '" + fs::path(STRIDOR_PROGRAM).parent_path().string() +
                     "' -N -R '" + suites[1].str() + "'");
      EXPECT_FALSE(listed.output.find("Total Tests: 0") != std::string::npos)
          << line << listed.output;
      // Each suite of an alternative by itself.
      const std::regex name("[A-Z][A-Za-z]+");
      for (std::sregex_iterator it(line.begin(), line.end(), name), end; it != end; ++it)
        if (it->str() != "R" && it->str() != "Scene")
          EXPECT_NE(listed.output.find(it->str() + "."), std::string::npos) << it->str();
      ++num_commands;
    }
  }
  EXPECT_EQ(num_commands, 3);
}

/// The number behind a word in the first line of a text that has both words; NaN where none has.
double number_behind(const std::string& word, const std::string& of, const std::string& text) {
  for (const std::string& line : lines_of(text)) {
    std::smatch found;
    if (line.find(of) != std::string::npos &&
        std::regex_search(line, found, std::regex(word + " ([0-9.]+[0-9])")))
      return std::stod(found[1]);
  }
  return std::nan("");
}

TEST(Pages, OfBeamOnBeamGiveTheirPeaks) {
  const UserFolder folder;
  const std::string page = contents_of(source / "docs" / "beam_on_beam.md");
  int num_commands = 0;
  std::string output;
  const std::regex row("\\| Fig[^|]*\\| `([a-z]+) S ([^`]*)`");
  for (std::sregex_iterator it(page.begin(), page.end(), row), end; it != end; ++it) {
    const std::string verb = (*it)[1], rest = (*it)[2];
    const auto outcome = folder.run("stridor " + verb + " scenes/beam_on_beam.yaml " + rest);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    if (verb == "compare") output = outcome.output;
    ++num_commands;
  }
  EXPECT_EQ(num_commands, 2);
  for (const char* assumption : {"a", "b", "c"}) {
    const double stated = number_behind("peak", std::string("Subs-") + assumption, page);
    double computed = std::nan("");
    for (const std::string& line : lines_of(output)) {
      const auto words = words_of(line);
      if (words.size() > 5 && words[0] == std::string("subs_") + assumption)
        computed = std::stod(words[5]);
    }
    EXPECT_NEAR(computed, stated, 2e-3 * stated) << assumption;
  }
}

TEST(ShownOutput, IsComparedLineByLine) {
  const std::string output =
      "status   done\nrun: t = 1 of 2, 50 %, 3 s left\ntime taken  0.2 s\n\nburst  2193 Hz, gain "
      "14.24\n";
  EXPECT_EQ(
      first_that_is_not_printed("status done\ntime taken 9 s\nburst 2193 Hz, gain 14.25\n", output),
      "");
  EXPECT_EQ(first_that_is_not_printed("status done\n...\nburst 2194 Hz, gain 14.24\n", output), "");
  EXPECT_EQ(first_that_is_not_printed("burst 2200 Hz, gain 14.24\n", output),
            "burst 2200 Hz, gain 14.24");
  EXPECT_EQ(first_that_is_not_printed("status done\nburst 2193 Hz, gain 14.24\n", output),
            "burst 2193 Hz, gain 14.24");
  EXPECT_EQ(first_that_is_not_printed("time taken 0.2 s\n...\nstatus done\n", output),
            "status done");
  EXPECT_EQ(first_that_is_not_printed("burst 2193 Hz, gain 14.24 more\n", output),
            "burst 2193 Hz, gain 14.24 more");
}

}  // namespace
}  // namespace stridor
