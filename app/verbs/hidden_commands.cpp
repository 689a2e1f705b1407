// Verbs for programs rather than people: what shells complete, and the pages of the manual.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "app/terminal/command.hpp"
#include "app/terminal/completion.hpp"
#include "app/terminal/manual.hpp"
#include "core/errors.hpp"
#include "io/hdf5/part_file.hpp"
#include "io/scene/scene.hpp"
#include "io/scene/scene_reference.hpp"

namespace stridor {
namespace {

namespace fs = std::filesystem;

struct ManualOptions {
  std::string folder;
  std::string documents;  ///< the folder with files.md and commands.md
};

std::string text_of_file(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw FileError(Refusal::cannot_read, path, "", "cannot be opened");
  return {std::istreambuf_iterator<char>(stream), {}};
}

ExitCode write_manual(const CLI::App& program, const ManualOptions& options) {
  const fs::path documents = options.documents;
  const std::string files = text_of_file((documents / "files.md").string());
  const std::string commands = text_of_file((documents / "commands.md").string());
  std::error_code error;
  fs::create_directories(options.folder, error);
  if (error)
    throw FileError(Refusal::cannot_write, options.folder, "",
                    "cannot be made: " + error.message());
  const auto write = [&](const std::string& name, const std::string& page) {
    write_text_file((fs::path(options.folder) / name).string(), page);
  };
  std::vector<std::string> names;
  for (const CLI::App* verb : verbs_of(program)) names.push_back(verb->get_name());
  for (const CLI::App* verb : verbs_of(program))
    write("stridor-" + verb->get_name() + ".1",
          manual_of_verb(*verb, names, examples_of(verb->get_name(), commands)));
  write("stridor.1", manual_of_program(program));
  write("stridor-scene.5", manual_of_document("stridor-scene", "5", "keys of the scenes of stridor",
                                              scene_reference(Scene::schema())));
  write("stridor-files.5",
        manual_of_document("stridor-files", "5", "what the result files of stridor hold", files));
  fmt::print("{} pages in {}\n", names.size() + 3, options.folder);
  return ExitCode::done;
}

}  // namespace

void add_hidden_commands(CLI::App& program, Action& action) {
  auto manual = std::make_shared<ManualOptions>();
  CLI::App* man = program.add_subcommand("manual", "Pages of the manual")->group("");
  man->add_option("folder", manual->folder, "Where they are written")->required();
  man->add_option("documents", manual->documents, "Folder of files.md and commands.md")->required();
  man->callback([manual, &program, &action] {
    action = [manual, &program] { return write_manual(program, *manual); };
  });
}

void print_candidates(const CLI::App& program, const std::vector<std::string>& words,
                      const std::vector<std::string>& behind) {
  try {
    for (const Candidate& one : candidates(program, words, behind))
      fmt::print("{}{}{}\n", one.word, one.meaning.empty() ? "" : "\t", one.meaning);
  } catch (const std::exception&) {
    // A file that cannot be read gives no candidates: somebody is typing.
  }
}

}  // namespace stridor
