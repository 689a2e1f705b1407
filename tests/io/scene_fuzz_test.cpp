// Scenes and `--set` assignments damaged at random: whatever is written, it is read or refused with
// a place, and never does anything else.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "core/errors.hpp"
#include "io/scene/assignment.hpp"
#include "io/scene/scene.hpp"
#include "io/scene/scene_reader.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor {
namespace {

using namespace test;

#if defined(__SANITIZE_ADDRESS__)
constexpr int kNumCases = 600;  // instrumented code is some ten times slower
#else
constexpr int kNumCases = 3000;
#endif

/// The shipped scenes, and a text with what YAML has besides.
std::vector<std::string> scene_texts() {
  std::vector<std::filesystem::path> paths;
  for (const auto& file :
       std::filesystem::directory_iterator(std::string(STRIDOR_SOURCE_DIR) + "/scenes")) {
    if (file.path().extension() == ".yaml") paths.push_back(file.path());
  }
  std::sort(paths.begin(), paths.end());
  std::vector<std::string> texts;
  for (const auto& path : paths) texts.push_back(contents_of(path));
  texts.push_back(
      "format: 2\nsubstructures:\n  a: &x {type: beam, 'length': [1, 2]}\n  b: *x\n"
      "drive: {velocity: \"30 mm/s\"}\nexpect:\n  - result: 1\n    value: |\n      text\n"
      "  - >-\n    folded\n");
  return texts;
}

/// Damages texts, always in the same way.
class Damage {
 public:
  std::size_t below(std::size_t bound) {
    return std::uniform_int_distribution<std::size_t>(0, bound - 1)(generator_);
  }

  /// One to `most` damages to a text, which is changed.
  void inflict(std::string& text, std::size_t most) {
    for (std::size_t i = 0, count = 1 + below(most); i < count && !text.empty(); ++i) {
      inflict(text);
    }
  }

 private:
  void inflict(std::string& text) {
    static constexpr std::array<std::string_view, 47> kPieces{
        ":",     ": ",    "-",     "- ",    "?",    "? ",
        ",",     "[",     "]",     "{",     "}",    "&a",
        "*a",    "!",     "!!x ",  "|",     ">",    "'",
        "\"",    "#",     " #",    "%",     "@",    "`",
        "<<: ",  "~",     "\t",    "\n",    "\r\n", "\n\n  ",
        "---\n", "...\n", "\\",    "é",     "日",   "\xEF\xBB\xBF",
        "\xFF",  "\x04",  "\x1B[", "1e999", ".nan", "99999999999999999999",
        "µm",    "\\x",   "=1/0",  "=sqrt(2)", "=mu"};
    const std::size_t at = below(text.size());
    const std::size_t length = std::min(1 + below(below(2) == 0 ? 3 : 60), text.size() - at);
    switch (below(7)) {
      case 0:
        text.erase(at, length);
        break;
      case 1: {  // doubled somewhere else
        const std::string piece = text.substr(at, length);
        text.insert(below(text.size()), piece);
        break;
      }
      case 2:
        std::swap(text[at], text[below(text.size())]);
        break;
      case 3:
        text[at] = static_cast<char>(below(256));
        break;
      case 4:
        erase_or_double_line(text, at);
        break;
      default:
        text.insert(at, kPieces[below(kPieces.size())]);
    }
  }

  void erase_or_double_line(std::string& text, std::size_t at) {
    const std::size_t begin = text.rfind('\n', at) + 1;  // 0 where there is none before
    if (begin >= text.size()) return;
    const std::size_t end = std::min(text.find('\n', begin), text.size() - 1) + 1;
    const std::string line = text.substr(begin, end - begin);
    if (below(2) == 0) {
      text.erase(begin, end - begin);
    } else {
      text.insert(begin, line);
    }
  }

  std::mt19937 generator_{20240229};
};

/// Length of a line of a text in bytes, without its break; −1 where there is no such line.
int length_of_line(const std::string& text, int line) {
  std::size_t begin = text.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  for (int i = 1; i < line; ++i) {
    begin = text.find('\n', begin);
    if (begin == std::string::npos) return -1;
    ++begin;
  }
  return static_cast<int>(std::min(text.find('\n', begin), text.size()) - begin);
}

/// Empty where a problem can be shown, written as JSON and found in its text.
std::string fault_of(const Problem& problem, const std::string& text) {
  if (problem.message.empty()) return "no message";
  if (problem.text().find('\n') != std::string::npos) return "a text of several lines";
  try {
    nlohmann::json({problem.source, problem.key, problem.message, problem.excerpt}).dump();
  } catch (const nlohmann::json::exception& error) {
    return error.what();
  }
  if (problem.source != "s.yaml") {
    const bool is_of_set = problem.source.starts_with("--set ") && problem.line == 0;
    return is_of_set ? "" : "no source";
  }
  if (problem.line < 1 || problem.column < 1) return "no place";
  const int length = length_of_line(text, problem.line);
  if (problem.column > length + 1) return "a place outside of the text";
  const bool has_excerpt = problem.excerpt.find("\n      | ") != std::string::npos;
  return has_excerpt || length < 2 ? "" : "no excerpt";
}

/// Calls what reads a scene; anything but success and a ConfigError fails the test.
/// @param text what is read, for the places in it
/// @return whether it was read
template <class Read>
bool reads_or_refuses(const std::string& text, Read read) {
  try {
    read();
    return true;
  } catch (const ConfigError& error) {
    EXPECT_FALSE(error.problems().empty());
    for (const Problem& problem : error.problems()) {
      const std::string fault = fault_of(problem, text);
      EXPECT_EQ(fault, "") << problem.text() << "\n" << problem.excerpt << "\nin\n" << text;
    }
  } catch (const std::exception& error) {
    ADD_FAILURE() << error.what() << "\nof\n" << text;
  }
  return false;
}

bool reads_or_refuses(const std::string& text) {
  return reads_or_refuses(text, [&] { read_as<Scene>(read_scene_text(text, "s.yaml")); });
}

TEST(SceneFuzz, DamagedScenesAreReadOrRefusedWithAPlace) {
  const std::vector<std::string> scenes = scene_texts();
  ASSERT_GT(scenes.size(), 1u);
  Damage damage;
  int num_read = 0;
  for (int i = 0; i < kNumCases; ++i) {
    std::string text = scenes[damage.below(scenes.size())];
    damage.inflict(text, 4);
    num_read += reads_or_refuses(text) ? 1 : 0;
  }
  // Some fall into comments and blanks, most do not.
  EXPECT_GT(num_read, kNumCases / 50);
  EXPECT_LT(num_read, kNumCases / 2);
}

TEST(SceneFuzz, DamagedAssignmentsAreReadOrRefused) {
  const std::string scene = scene_texts().at(0);
  const SceneNode root = read_scene_text(scene, "s.yaml");
  const std::vector<std::string> assignments{
      "time.step=1e-7",
      "contact.friction.coefficient=0.3",
      "drive.velocity={times: [0, 100 ms], values: [0, 30 mm/s]}",
      "record.channels=[contact.force, \"contact.gap\"]",
      "expect.0.value='0.2'",
      "substructures.oblique={type: beam, length: 75 mm}",
      "measure.band=[2.5 kHz, 15 kHz]"};
  Damage damage;
  int num_read = 0;
  for (int i = 0; i < kNumCases; ++i) {
    std::string assignment = assignments[damage.below(assignments.size())];
    damage.inflict(assignment, 3);
    const bool is_read = reads_or_refuses(scene, [&] {
      SceneNode changed = root;
      set_value(changed, assignment);
      read_as<Scene>(changed);
    });
    num_read += is_read ? 1 : 0;
  }
  EXPECT_GT(num_read, kNumCases / 50);
  EXPECT_LT(num_read, kNumCases / 2);
}

TEST(SceneFuzz, BytesWithoutAnyStructureAreReadOrRefused) {
  Damage damage;
  for (int i = 0; i < kNumCases; ++i) {
    std::string text(1 + damage.below(200), ' ');
    for (char& c : text) c = static_cast<char>(damage.below(256));
    if (i % 2 == 0) {  // text, at least
      for (char& c : text) c = static_cast<char>(32 + static_cast<unsigned char>(c) % 95);
    }
    reads_or_refuses(text);
  }
}

TEST(SceneFuzz, DamagedFilesAreLoadedOrRefused) {
  const TemporaryFolder folder;
  const std::vector<std::string> scenes = scene_texts();
  Damage damage;
  for (int i = 0; i < 100; ++i) {
    std::string text = scenes[damage.below(scenes.size())];
    damage.inflict(text, 4);
    write_file(folder / "s.yaml", text);
    try {
      load_scene((folder / "s.yaml").string(), {});
    } catch (const ConfigError& error) {
      EXPECT_FALSE(error.report().empty());
    }
  }
}

}  // namespace
}  // namespace stridor
