// Of studies of precision: errors against run times, and what the reductions are right to.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/report/report_section.hpp"
#include "core/errors.hpp"

namespace stridor {
namespace {

/// A column of settings. @throws FileError if it is unlike the methods in length
template <typename Values>
Values of_length(const ResultFile& file, const std::string& path, Values values, std::size_t length) {
  if (values.size() != length)
    throw FileError(Refusal::file_damaged, file.path(), path,
                    "is unlike /settings/method in length");
  return values;
}

Json settings_of(const ResultFile& file) {
  const std::vector<std::string> methods = file.texts("/settings/method");
  const std::vector<std::string> status =
      of_length(file, "/settings/status", file.texts("/settings/status"), methods.size());
  Json rows = Json::array();
  for (std::size_t i = 0; i < methods.size(); ++i)
    rows.push_back({{"method", methods[i]}, {"status", status[i]}});
  for (const char* name : {"step", "tolerance", "modes", "run_time", "error", "error_of_force",
                           "error_of_acceleration", "error_of_envelope", "on_front"}) {
    const std::string path = std::string("/settings/") + name;
    const std::vector<double> values = of_length(file, path, file.read(path), methods.size());
    for (std::size_t i = 0; i < methods.size(); ++i) rows[i][name] = number(values[i]);
  }
  return rows;
}

Json reductions_of(const ResultFile& file) {
  Json rows = Json::array();
  if (!file.has("/reduction/error")) return rows;
  const std::vector<std::string> bodies = file.texts("/reduction/body");
  const auto frequencies = file.read("/reduction/frequency");
  const auto errors = file.read("/reduction/error");
  if (frequencies.size() != bodies.size() || errors.size() != bodies.size())
    throw FileError(Refusal::file_damaged, file.path(), "/reduction",
                    "has columns of different lengths");
  for (std::size_t i = 0; i < bodies.size(); ++i)
    rows.push_back({{"body", bodies[i]},
                    {"frequency", number(frequencies[i])},
                    {"error", number(errors[i])}});
  return rows;
}

}  // namespace

Json precision_section(const ResultFile& file, const ReportContext&) {
  Json section = section_head(file, file.kind(), "errors against run time");
  section["file"] = name_with_folder(file);
  const auto told_json = [&](const char* name) {
    return number(file.told(name).value_or(std::nan("")));
  };
  Json view = {{"type", "errors"},
               {"norm", file.text("norm")},
               {"channel", file.text("channel")},
               {"reference_error", told_json("reference_error")},
               {"wanted_error", told_json("wanted_error")},
               {"settings", settings_of(file)},
               {"reductions", reductions_of(file)}};
  const Json& settings = view["settings"];
  const auto num_useful = std::count_if(settings.begin(), settings.end(),
                                        [](const Json& row) { return !row["error"].is_null(); });
  std::string text = fmt::format("{} settings measured, of which {} came to an end in good order.",
                                 settings.size(), num_useful);
  if (!view["reference_error"].is_null())
    text += fmt::format(" The reference itself errs by {:.2g}.", view["reference_error"].get<double>());
  if (!view["wanted_error"].is_null())
    text += fmt::format(" The cheapest within {:g}: {}.", view["wanted_error"].get<double>(),
                        file.text("tuned"));
  section["verdict"] = verdict("told", text);
  section["views"].push_back(std::move(view));
  return section;
}

}  // namespace stridor
