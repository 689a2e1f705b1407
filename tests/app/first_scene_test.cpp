// What the README and the index of examples promise.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

const fs::path source_folder = STRIDOR_SOURCE_DIR;

/// The text of the first block of a language in a document.
std::string first_block(const std::string& text, const std::string& language) {
  const std::string fence = "```" + language + "\n";
  const std::size_t begin = text.find(fence);
  EXPECT_NE(begin, std::string::npos) << language;
  if (begin == std::string::npos) return "";
  const std::size_t start = begin + fence.size();
  return text.substr(start, text.find("```", start) - start);
}

// Its scene, its command and what that prints.
TEST(Readme, FirstSceneGivesWhatIsPrinted) {
  const std::string text = contents_of(source_folder / "README.md");
  const TemporaryFolder folder;
  const std::string scene = (folder / "squeal.yaml").string();
  std::ofstream(scene) << first_block(text, "yaml");
  std::istringstream block(first_block(text, "sh"));
  std::string command;
  std::getline(block, command);
  ASSERT_TRUE(command.starts_with("$ stridor ")) << command;
  std::vector<std::string> words;
  std::istringstream split(command.substr(10));
  for (std::string word; split >> word;) words.push_back(word == "squeal.yaml" ? scene : word);
  const ProgramResult result = Program(words).run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  int num_lines = 0;
  for (std::string line; std::getline(block, line); ++num_lines)
    EXPECT_THAT(result.out, HasSubstr(line + "\n"));
  EXPECT_GE(num_lines, 2);
}

// Where two modes of K = k [[2, 1 - 4 mu/3], [1, 2]] meet, mu = 3/4, both have k/m (2 -+ 0): 4,502 Hz.
TEST(Readme, FirstSceneIsThatOfTheTextbook) {
  const std::string text = contents_of(source_folder / "README.md");
  const double frequency = std::sqrt(2.0 * 2e7 / 0.05) / (2.0 * std::numbers::pi);
  EXPECT_NEAR(frequency, 4501.582, 0.001);
  EXPECT_THAT(text, HasSubstr("4501.582 Hz"));
}

TEST(Examples, EverySceneIsInTheIndexAndEveryEntryIsThere) {
  const std::string index = contents_of(source_folder / "scenes/examples/README.md");
  for (const auto& entry : fs::directory_iterator(source_folder / "scenes/examples")) {
    if (entry.path().extension() != ".yaml") continue;
    const std::string name = entry.path().filename().string();
    EXPECT_THAT(index, HasSubstr("[`" + name + "`](" + name + ")"));
  }
  const std::regex link("\\]\\(([a-z_]+\\.yaml)\\)");
  for (std::sregex_iterator found(index.begin(), index.end(), link), end; found != end; ++found)
    EXPECT_TRUE(fs::exists(source_folder / "scenes/examples" / (*found)[1].str())) << (*found)[1];
}

// Links of all documents to files of the tree.
TEST(Documents, LinkToWhatIsThere) {
  std::vector<fs::path> pages{source_folder / "README.md", source_folder / "CONTRIBUTING.md",
                              source_folder / "scenes/examples/README.md"};
  for (const auto& entry : fs::directory_iterator(source_folder / "docs"))
    if (entry.path().extension() == ".md") pages.push_back(entry.path());
  const std::regex link("\\]\\(([^)#\\s]+)(#[^)]*)?\\)");
  std::size_t count = 0;
  for (const fs::path& page : pages) {
    const std::string text = contents_of(page);
    for (std::sregex_iterator found(text.begin(), text.end(), link), end; found != end; ++found) {
      const std::string target = (*found)[1];
      if (target.find("://") != std::string::npos) continue;
      EXPECT_TRUE(fs::exists(page.parent_path() / target)) << page << ": " << target;
      ++count;
    }
  }
  EXPECT_GT(count, 60u);
}

}  // namespace
}  // namespace stridor
