// What pages print below their commands is what the commands print.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <regex>

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
        std::regex_search(block.before, name, std::regex("Write `([a-z_]+\\.yaml)`")))
      write_file(folder / name[1], block.text);
  }
}

/// A section that shows what is printed is run from its first command to its last. How many blocks
/// of what is printed the page has.
int expect_shown_is_printed(const fs::path& page) {
  SCOPED_TRACE(page);
  std::ifstream text(page);
  const auto blocks = blocks_in(text);
  std::vector<int> sections;
  for (std::size_t i = 0; i < blocks.size(); ++i)
    if (is_output(blocks, i)) sections.push_back(blocks[i].section);
  if (sections.empty()) return 0;

  const UserFolder folder;
  write_scenes(folder, blocks);
  std::string output;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (std::ranges::find(sections, blocks[i].section) == sections.end()) continue;
    if (blocks[i].language == "sh") {
      const auto outcome = folder.run("set -e\n" + blocks[i].text);
      EXPECT_EQ(outcome.exit_code, 0) << blocks[i].text << outcome.output;
      output = outcome.output;
    } else if (is_output(blocks, i)) {
      EXPECT_EQ(first_that_is_not_printed(blocks[i].text, output), "") << blocks[i].text << output;
    }
  }
  return static_cast<int>(sections.size());
}

TEST(Pages, ShowWhatIsPrinted) {
  int num_blocks = 0;
  for (const char* folder : {"docs", "docs/theory"})
    for (const auto& entry : fs::directory_iterator(source / folder))
      if (entry.path().extension() == ".md") num_blocks += expect_shown_is_printed(entry.path());
  EXPECT_GE(num_blocks, 12);
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
