#include "app/runs/reduction_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "io/scene/scene_family.hpp"
#include "models/reduction_error.hpp"

namespace stridor {

Json reductions_json(const LoadedScene& loaded, const std::vector<std::string>& frequencies) {
  const NumericKey key{"frequency", "Hz", Range::positive()};
  std::vector<double> hertz;
  for (const std::string& one : frequencies) hertz.push_back(parse_value(key, one, "--frequencies"));
  std::sort(hertz.begin(), hertz.end());
  BodyCache cache;
  std::vector<ReductionError> errors;
  try {
    require_bodies(loaded);
    errors = reduction_errors(parameters_with_files(loaded, cache), hertz, cache);
  } catch (const ConfigError& error) {
    throw loaded.located(error);
  }
  Json list = Json::array();
  for (const ReductionError& error : errors) {
    list.push_back({{"body", error.body},
                    {"unknowns", error.num_unknowns},
                    {"interface", error.num_interface},
                    {"modes", error.num_modes},
                    {"interface_modes",
                     error.num_interface_modes ? Json(*error.num_interface_modes) : Json(nullptr)},
                    {"compared", error.dofs.size()},
                    {"frequencies", error.frequencies},
                    {"errors", Json::array()}});
    for (const double one : error.errors) list.back()["errors"].push_back(number(one));
  }
  return list;
}

void print_reductions(const Json& reductions) {
  if (reductions.empty()) {
    fmt::print("no body is reduced and has an interface\n");
    return;
  }
  fmt::print("\nreduced bodies against full ones: relative difference of the displacements per force "
             "between DoFs of the interface\n");
  for (const Json& one : reductions) {
    const Json& of_interface = one["interface_modes"];
    fmt::print("{}: {} of {} unknowns{} and {} modes, between {} of the interface\n",
               one["body"].get<std::string>(), one["interface"].get<Eigen::Index>(),
               one["unknowns"].get<Eigen::Index>(),
               of_interface.is_null() ? std::string()
                                      : fmt::format(" in {} modes", of_interface.get<Eigen::Index>()),
               one["modes"].get<Eigen::Index>(), one["compared"].get<std::size_t>());
    for (std::size_t i = 0; i < one["errors"].size(); ++i) {
      const Json& error = one["errors"][i];
      fmt::print("  {:>12.6g} Hz  {}\n", one["frequencies"][i].get<double>(),
                 error.is_null() ? std::string("-") : fmt::format("{:.2g}", error.get<double>()));
    }
  }
}

}  // namespace stridor
