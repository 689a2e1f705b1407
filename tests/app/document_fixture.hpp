// Documents, and a folder in which their commands are run as a user runs them.
#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program.hpp"

namespace stridor::test {

inline const std::filesystem::path source = STRIDOR_SOURCE_DIR;

/// A fenced block, and where it stands.
struct Block {
  std::string language;
  std::string text;
  std::string before;  ///< what stands between it and the block or heading before
  int section = 0;     ///< number of headings of the second level above it
};

/// The fenced blocks in the order of the document.
inline std::vector<Block> blocks_in(std::istream& text) {
  std::vector<Block> blocks;
  Block next;
  bool is_inside = false;
  for (std::string line; std::getline(text, line);) {
    if (is_inside && line == "```") {
      is_inside = false;
      blocks.push_back(next);
      next = {"", "", "", next.section};
    } else if (is_inside) {
      next.text += line + "\n";
    } else if (line.starts_with("```")) {
      is_inside = true;
      next.language = line.substr(3);
    } else if (line.starts_with("## ")) {
      next = {"", "", line, next.section + 1};
    } else {
      next.before += line;
    }
  }
  return blocks;
}

/// The texts of those of a language.
inline std::vector<std::string> blocks_in(std::istream& text, const std::string& language) {
  std::vector<std::string> texts;
  for (const Block& block : blocks_in(text))
    if (block.language == language) texts.push_back(block.text);
  return texts;
}

inline std::vector<std::string> blocks_of(const std::filesystem::path& document,
                                          const std::string& language) {
  std::ifstream file(document);
  return blocks_in(file, language);
}

inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// A folder as a user has it: the scenes beside it, the program on the path, nothing else.
class UserFolder {
 public:
  UserFolder() {
    std::filesystem::create_directory(folder_ / "bin");
    std::filesystem::create_directory(folder_ / "work");
    std::filesystem::create_symlink(STRIDOR_PROGRAM, folder_ / "bin" / "stridor");
    std::filesystem::copy(source / "scenes", folder_ / "work" / "scenes", std::filesystem::copy_options::recursive);
  }
  std::filesystem::path operator/(const std::string& name) const { return folder_ / "work" / name; }

  struct Outcome {
    int exit_code;
    std::string output;
  };
  /// Runs lines of a shell in the folder.
  Outcome run(const std::string& lines) const {
    write_file(folder_ / "lines.sh", lines + "\n");
    const std::string command = "cd '" + (folder_ / "work").string() + "' && PATH='" +
                                (folder_ / "bin").string() + "':\"$PATH\" bash ../lines.sh" +
                                " >../output 2>&1 </dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents_of(folder_ / "output")};
  }
  bool has_command(const std::string& line) const { return run(line).exit_code == 0; }

 private:
  TemporaryFolder folder_;
};

}  // namespace stridor::test
