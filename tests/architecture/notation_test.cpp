// Names that docs/notation.md gives must exist in the code.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

/// The files in which each word of the code occurs, comments left out.
using Words = std::map<std::string, std::set<std::string>>;

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  EXPECT_TRUE(stream) << file;
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

Words words_below(const fs::path& root) {
  Words words;
  for (const char* folder :
       {"core", "substructures", "coupling", "solvers", "models", "analysis", "io", "app"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const std::string extension = entry.path().extension();
      if (extension != ".cpp" && extension != ".hpp") continue;
      std::istringstream lines(text_of(entry.path()));
      for (std::string line; std::getline(lines, line);) {
        line.resize(std::min(line.size(), line.find("//")));
        std::string word;
        for (const char c : line + ' ') {
          if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_') {
            word += c;
          } else if (!word.empty()) {
            words[word].insert(entry.path());
            word.clear();
          }
        }
      }
    }
  }
  return words;
}

/// Words and files of the quoted code in the tables of a page that do not exist, and members that no
/// file names together with their class.
/// @return "line: name"
Strings names_without_code(std::string_view page, const fs::path& root, const Words& words) {
  static const std::regex quoted("`([^`]+)`");
  static const std::regex identifier("[A-Za-z_]\\w*");
  static const std::regex member("(\\w+)::(\\w+)");
  Strings missing;
  std::istringstream lines{std::string(page)};
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (!line.starts_with('|')) continue;
    const auto report = [&](const std::string& name) {
      missing.push_back(std::to_string(number) + ": " + name);
    };
    for (std::sregex_iterator code(line.begin(), line.end(), quoted), end; code != end; ++code) {
      const std::string text = (*code)[1];
      if (text.find('/') != std::string::npos) {
        if (!fs::exists(root / text)) report(text);
        continue;
      }
      if (text.ends_with(".cpp")) continue;
      bool has_all = true;
      for (std::sregex_iterator name(text.begin(), text.end(), identifier); name != end; ++name) {
        if (words.contains(name->str())) continue;
        report(name->str());
        has_all = false;
      }
      std::smatch both;
      if (!has_all || !std::regex_match(text, both, member)) continue;
      const auto& of_class = words.at(both[1]);
      const auto& of_member = words.at(both[2]);
      const bool are_together = std::any_of(of_class.begin(), of_class.end(), [&](const auto& file) {
        return of_member.contains(file);
      });
      if (!are_together) report(text);
    }
  }
  return missing;
}

TEST(Notation, NamesExistInTheCode) {
  const fs::path root = STRIDOR_SOURCE_DIR;
  EXPECT_THAT(names_without_code(text_of(root / "docs/notation.md"), root, words_below(root)),
              testing::IsEmpty());
}

TEST(Notation, NamesThatAreNotInTheCodeAreFound) {
  const Words words{{"Beam", {"a"}}, {"length", {"a"}}, {"width", {"b"}}};
  EXPECT_THAT(names_without_code("| `Beam::length`, `length_` |\n`x`\n| `Beam::width` | `no/file.hpp` |",
                                 STRIDOR_SOURCE_DIR, words),
              testing::ElementsAre("1: length_", "3: Beam::width", "3: no/file.hpp"));
}

}  // namespace
