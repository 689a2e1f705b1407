#include "app/terminal/command.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <utility>

#include "core/errors.hpp"
#include "io/figures/gnuplot.hpp"

namespace stridor {
namespace {

std::optional<Json> json_to_print;
std::optional<Json> told_warnings;  ///< a list, of a verb that looks for warnings

}  // namespace

void add_scene_options(CLI::App& verb, CommonOptions& options) {
  verb.add_option("--set", options.sets,
                  "Change a key of the scene: --set key.path=value (repeatable)")
      ->take_all()
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
  verb.add_option("--threads", options.threads, "Threads to use; a single run uses one")
      ->check(CLI::Range(1, 1024));
}

void add_json_option(CLI::App& verb, CommonOptions& options) {
  verb.add_flag("--json", options.json, "Print one JSON object on stdout and nothing else there");
}

void add_force_option(CLI::App& verb, CommonOptions& options) {
  verb.add_flag("--force", options.force, "Overwrite the output file if it exists");
}

void check_figure(const std::filesystem::path& figure, const CommonOptions& options) {
  check_figure_name(figure);
  check_replaceable(figure.string(), options.overwrite());
}

namespace {

Json problem_json(const Problem& problem) {
  Json object = {
      {"code", code_of(problem.refusal)}, {"file", problem.source}, {"line", problem.line},
      {"column", problem.column},         {"key", problem.key},     {"message", problem.message}};
  if (!problem.dataset.empty()) object["dataset"] = problem.dataset;
  return object;
}

}  // namespace

Json problems_json(const std::vector<Problem>& problems) {
  Json list = Json::array();
  for (const Problem& problem : problems) list.push_back(problem_json(problem));
  return list;
}

void print_warnings(const std::vector<Problem>& warnings) {
  for (const Problem& warning : warnings)
    fmt::print(stderr, "stridor: warning\n{}\n{}", warning.text(),
               warning.excerpt.empty() ? "" : warning.excerpt + "\n");
  if (!told_warnings) told_warnings.emplace(Json::array());
  for (Json& one : problems_json(warnings)) told_warnings->push_back(std::move(one));
}

void print_json(Json object) {
  json_to_print = std::move(object);
}

void finish_json(const std::vector<Problem>& errors) {
  if (!errors.empty()) {
    if (!json_to_print) json_to_print.emplace(Json::object());
    (*json_to_print)["errors"] = problems_json(errors);
  }
  if (!json_to_print) return;
  if (told_warnings) (*json_to_print)["warnings"] = std::move(*told_warnings);
  told_warnings.reset();
  // Names of files need not be UTF-8.
  const std::string text = json_to_print->dump(2, ' ', false, Json::error_handler_t::replace);
  // If nothing can be printed this does not throw; main() looks at stdout at the end.
  std::fputs((text + "\n").c_str(), stdout);
  json_to_print.reset();
}

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json number_or_null(const std::optional<double>& value) {
  return value ? number(*value) : Json(nullptr);
}

double pointed_number(const Json& object, const char* pointer) {
  const Json::json_pointer at(pointer);
  return object.contains(at) && object[at].is_number() ? object[at].get<double>()
                                                       : std::numeric_limits<double>::quiet_NaN();
}

std::vector<double> spaced_values(const char* option, const std::vector<double>& range) {
  const double count = range[2];
  if (!(range[0] > 0.0) || !(range[1] > range[0]) || !std::isfinite(range[1]))
    throw ConfigError(Refusal::wrong_value, option,
                      "needs two positive numbers, the smaller one first");
  if (!(count >= 4.0) || !(count <= 1000.0) || count != std::trunc(count))
    throw ConfigError(Refusal::wrong_value, option,
                      fmt::format("{:g} points are not a whole number, 4 to 1000", count));
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < static_cast<int>(count); ++k)
    values.push_back(range[0] * std::pow(range[1] / range[0], k / (count - 1.0)));
  return values;
}

}  // namespace stridor
