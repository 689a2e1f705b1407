// stridor schema: what a scene may hold, for editors and for readers.
#include <cstdio>

#include "app/command.hpp"
#include "core/errors.hpp"
#include "io/contact_scene.hpp"

namespace stridor {
namespace {

struct SchemaOptions {
  CommonOptions common;
  bool is_reference = false;
};

ExitCode print_schema(const SchemaOptions& options) {
  const std::string text = options.is_reference ? all_scenes_reference() : all_scenes_json_schema();
  // As a rule this goes into a file, where half a text would pass for the whole.
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw FileError("stdout", "", "could not be written to the end");
  }
  return ExitCode::done;
}

}  // namespace

void add_schema_command(CLI::App& program, Action& action) {
  auto options = std::make_shared<SchemaOptions>();
  CLI::App* verb = program.add_subcommand("schema", "JSON Schema of scenes, on stdout");
  CLI::Option* reference = verb->add_flag("--reference", options->is_reference,
                                          "Print the reference page of scenes (Markdown) instead");
  add_json_option(*verb, options->common);
  reference->excludes("--json");
  verb->callback([options, &action] { action = [options] { return print_schema(*options); }; });
}

}  // namespace stridor
