// Links between the documents, and references of the code to sections of the theory, lead somewhere.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

std::string whole_text(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  EXPECT_TRUE(stream) << file;
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// The anchor that hosts of repositories give a heading: lower case, blanks as hyphens, no punctuation.
std::string anchor_of(const std::string& heading) {
  std::string anchor;
  for (const char c : heading) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == ' ') anchor += '-';
    if (c == '-' || c == '_' || byte >= 0x80 || std::isalnum(byte) != 0)
      anchor += static_cast<char>(byte < 0x80 ? std::tolower(byte) : c);
  }
  return anchor;
}

/// The lines of a page outside of fenced blocks.
std::vector<std::string> prose_of(const std::string& page) {
  std::vector<std::string> prose;
  bool is_fenced = false;
  std::istringstream lines(page);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("```")) is_fenced = !is_fenced;
    if (!is_fenced) prose.push_back(line);
  }
  return prose;
}

std::set<std::string> anchors_of(const std::string& page) {
  static const std::regex heading("^#+ +(.*)$");
  std::set<std::string> anchors;
  std::smatch match;
  for (const std::string& line : prose_of(page))
    if (std::regex_match(line, match, heading)) anchors.insert(anchor_of(match[1]));
  return anchors;
}

/// Relative links of a page in a folder to files or headings that do not exist.
std::vector<std::string> dead_links(const std::string& page, const fs::path& folder) {
  static const std::regex link("\\]\\(([^)#\\s]*)(#[^)\\s]*)?\\)");
  std::vector<std::string> dead;
  for (const std::string& line : prose_of(page)) {
    for (std::sregex_iterator it(line.begin(), line.end(), link), end; it != end; ++it) {
      const std::string target = (*it)[1], anchor = (*it)[2];
      if (target.find(':') != std::string::npos) continue;
      const fs::path file = folder / target;
      const bool is_found = target.empty() || fs::exists(file);
      const bool has_anchor =
          anchor.empty() ||
          (is_found && anchors_of(target.empty() ? page : whole_text(file)).contains(anchor.substr(1)));
      if (!is_found || !has_anchor) dead.push_back(target + anchor);
    }
  }
  return dead;
}

const fs::path root_folder = STRIDOR_SOURCE_DIR;

std::vector<fs::path> pages() {
  std::vector<fs::path> all{root_folder / "README.md", root_folder / "CONTRIBUTING.md",
                            root_folder / "CHANGELOG.md"};
  for (const char* folder : {"docs", "bench", "scenes"})
    for (const auto& entry : fs::recursive_directory_iterator(root_folder / folder))
      if (entry.path().extension() == ".md") all.push_back(entry.path());
  return all;
}

TEST(Links, OfDocumentsLeadSomewhere) {
  for (const fs::path& page : pages())
    EXPECT_THAT(dead_links(whole_text(page), page.parent_path()), testing::IsEmpty()) << page;
}

TEST(Links, ThatAreDeadAreFound) {
  const std::string page =
      "# A `b` c, d\n[1](#a-b-c-d) [2](#a) [3](README.md) [4](no.md)\n[5](https://no.no)\n"
      "[6](README.md#no)\n```\n[7](no.md)\n```\n";
  EXPECT_THAT(dead_links(page, root_folder), testing::ElementsAre("#a", "no.md", "README.md#no"));
}

/// The numbers of chapters and sections that the index of the theory lists.
std::set<std::string> sections_of_theory() {
  static const std::regex entry("^ *(?:-|[0-9]+\\.) \\[.*\\]\\((theory/[^)#]*)");
  static const std::regex heading("^#+ ([0-9]+(?:\\.[0-9]+)?) .*$");
  std::set<std::string> sections;
  std::smatch match;
  for (const std::string& line : prose_of(whole_text(root_folder / "docs/theory.md"))) {
    if (!std::regex_search(line, match, entry)) continue;
    for (const std::string& of_chapter : prose_of(whole_text(root_folder / "docs" / match[1].str()))) {
      std::smatch number;
      if (std::regex_match(of_chapter, number, heading)) sections.insert(number[1]);
    }
  }
  return sections;
}

TEST(Links, OfTheCodeToSectionsOfTheTheoryLeadSomewhere) {
  const std::set<std::string> sections = sections_of_theory();
  ASSERT_GE(sections.size(), 50u);
  static const std::regex reference("docs/theory\\.md,? \\(?([0-9]+(?:\\.[0-9]+)?)");
  int num_references = 0;
  for (const char* folder : {"core", "substructures", "coupling", "solvers", "models", "analysis",
                             "io", "app", "tests", "bench"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root_folder / folder)) {
      const std::string extension = entry.path().extension();
      if (extension != ".cpp" && extension != ".hpp") continue;
      const std::string text = whole_text(entry.path());
      for (std::sregex_iterator it(text.begin(), text.end(), reference), end; it != end; ++it) {
        EXPECT_TRUE(sections.contains((*it)[1])) << entry.path() << ": " << (*it)[0];
        ++num_references;
      }
    }
  }
  EXPECT_GE(num_references, 80);
}

TEST(Gallery, ListsEveryScene) {
  const std::string gallery = whole_text(root_folder / "docs/gallery.md");
  const std::string index = whole_text(root_folder / "scenes/examples/README.md");
  int num_scenes = 0;
  for (const std::string folder : {"scenes", "scenes/examples"}) {
    for (const auto& entry : fs::directory_iterator(root_folder / folder)) {
      if (entry.path().extension() != ".yaml") continue;
      const std::string name = entry.path().filename().string();
      const std::string in_index = folder == "scenes" ? "](../" + name + ")" : "](" + name + ")";
      EXPECT_NE(index.find(in_index), std::string::npos) << name << ": run docs/make_gallery.py";
      EXPECT_NE(gallery.find("](../" + folder + "/" + name + ")"), std::string::npos)
          << name << ": run docs/make_gallery.py";
      ++num_scenes;
    }
  }
  EXPECT_GE(num_scenes, 40);
}

}  // namespace
