// stridor schema: keys of a scene, for editors and for readers.
#include <fmt/format.h>

#include "app/terminal/command.hpp"
#include "io/scene/scene.hpp"
#include "io/scene/scene_reference.hpp"
#include "io/scene/schema_json.hpp"

namespace stridor {
namespace {

struct SchemaOptions {
  CommonOptions common;
  bool is_reference = false;
};

ExitCode print_schema(const SchemaOptions& options) {
  fmt::print("{}", options.is_reference ? scene_reference(Scene::schema())
                                          : json_schema_text(Scene::schema()));
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
