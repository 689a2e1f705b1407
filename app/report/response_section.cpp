// Of frequency responses: those of one unit together.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "app/report/curves.hpp"
#include "app/report/report_section.hpp"
#include "app/report/tables.hpp"
#include "core/errors.hpp"
#include "io/results/response_file.hpp"

namespace stridor {
namespace {

/// A response as the page draws it, and where it is largest.
struct PagedResponse {
  std::string units;
  Json curve;
  double peak = 0.0;
  double at = 0.0;  ///< Hz
};

PagedResponse paged_response(const ResultFile& file, const std::string& output,
                             const std::string& input, const std::vector<double>& frequencies,
                             ReportPage& page) {
  const std::string group = "/responses/" + output + "/" + input;
  const std::vector<double> real = file.read(group + "/real");
  const std::vector<double> imaginary = file.read(group + "/imaginary");
  if (real.size() != frequencies.size() || imaginary.size() != frequencies.size())
    throw FileError(Refusal::file_damaged, file.path(), group, "is unlike /frequency in length");
  PagedResponse response{file.array(group + "/real").units, {}, 0.0, 0.0};
  for (std::size_t i = 0; i < real.size(); ++i) {
    const double size = std::hypot(real[i], imaginary[i]);
    if (!(size > response.peak)) continue;
    response.peak = size;
    response.at = frequencies[i];
  }
  response.curve = {{"name", output + " per force at " + input},
                    {"real", page.add_numbers(real)},
                    {"imaginary", page.add_numbers(imaginary)}};
  if (file.has(group + "/truncation_error")) {
    const std::vector<double> error = file.read(group + "/truncation_error");
    if (error.size() != frequencies.size())
      throw FileError(Refusal::file_damaged, file.path(), group + "/truncation_error",
                      "is unlike /frequency in length");
    // Zeros have no place on the scale of levels.
    if (std::ranges::any_of(error, [](double off) { return off > 0.0; }))
      response.curve["error"] = page.add_numbers(error);
  }
  return response;
}

/// A measured response and the computed one at its frequencies, as a view of their own.
Json compared_view(const ResultFile& file, std::size_t number, const std::string& name,
                   ReportPage& page) {
  const std::string group = "/compared/" + std::to_string(number);
  const std::vector<double> frequencies = file.read(group + "/frequency");
  const std::string units = file.array(group + "/measured_real").units;
  Json curves = Json::array();
  for (const char* which : {"measured", "computed"}) {
    Json curve = {{"name", std::string(which) + ": " + name}};
    for (const char* part : {"real", "imaginary"}) {
      const std::string dataset = group + "/" + which + "_" + part;
      const std::vector<double> values = file.read(dataset);
      if (values.size() != frequencies.size())
        throw FileError(Refusal::file_damaged, file.path(), dataset,
                        "is unlike " + group + "/frequency in length");
      curve[part] = page.add_numbers(values);
    }
    curves.push_back(std::move(curve));
  }
  return {
      {"type", "responses"},
      {"frequency", page.add_numbers(frequencies)},
      {"groups", {{{"quantity", response_quantity(units)}, {"units", units}, {"curves", curves}}}}};
}

/// A table of measured responses beside computed ones, and their curves.
void add_compared(const ResultFile& file, ReportPage& page, Json& section) {
  const std::vector<std::string> outputs = file.texts("/compared/output");
  const std::vector<std::string> inputs = file.texts("/compared/input");
  if (outputs.empty()) return;
  if (inputs.size() != outputs.size())
    throw FileError(Refusal::file_damaged, file.path(), "/compared/input",
                    "is unlike /compared/output in length");
  std::vector<TableColumn> columns =
      columns_in(file, {{"/compared/frac", "FRAC", 4}, {"/compared/ratio", "ratio", 4}});
  columns.insert(columns.begin(), {{"motion", "", {}, outputs}, {"force at", "", {}, inputs}});
  section["views"].push_back(table_view("Measured beside computed", columns));
  constexpr std::size_t most_shown = 12;
  for (std::size_t i = 0; i < std::min(most_shown, outputs.size()); ++i)
    section["views"].push_back(
        compared_view(file, i + 1, outputs[i] + " per force at " + inputs[i], page));
  if (outputs.size() > most_shown)
    section["remarks"].push_back(
        fmt::format("{} more measured responses are in the file.", outputs.size() - most_shown));
}

/// The shapes under a force, as the file holds them.
ComparedShapes kept_shapes(const ResultFile& file, std::size_t number, const std::string& input) {
  const std::string group = "/shapes/" + std::to_string(number);
  ComparedShapes shapes;
  shapes.input = input;
  shapes.frequencies = file.read(group + "/frequency");
  shapes.assurance = file.read(group + "/mac");
  if (shapes.assurance.size() != shapes.frequencies.size())
    throw FileError(Refusal::file_damaged, file.path(), group + "/mac",
                    "is unlike " + group + "/frequency in length");
  if (!file.has(group + "/peak_mac")) return shapes;
  shapes.measured_peaks = file.read(group + "/measured_peak");
  shapes.computed_peaks = file.read(group + "/computed_peak");
  const std::vector<double> rows = file.read(group + "/peak_mac", 2);
  const std::size_t num_measured = shapes.measured_peaks.size();
  const std::size_t num_computed = shapes.computed_peaks.size();
  if (rows.size() != num_measured * num_computed)
    throw FileError(Refusal::file_damaged, file.path(), group + "/peak_mac",
                    "is unlike the peaks in length");
  shapes.peak_assurance =
      Eigen::Map<const Eigen::MatrixXd>(rows.data(), static_cast<Eigen::Index>(num_measured),
                                        static_cast<Eigen::Index>(num_computed))
          .transpose();
  return shapes;
}

/// A table of peaks for every force that moves several measured points, and MAC over the frequency.
void add_shapes(const ResultFile& file, ReportPage& page, Json& section) {
  const std::vector<std::string> inputs = file.texts("/shapes/input");
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const ComparedShapes shapes = kept_shapes(file, i + 1, inputs[i]);
    std::vector<double> measured, computed, difference, criteria;
    for (const PeakPair& pair : peak_pairs(shapes)) {
      measured.push_back(shapes.measured_peaks[pair.measured]);
      computed.push_back(shapes.computed_peaks[pair.computed]);
      difference.push_back(100.0 * (computed.back() / measured.back() - 1.0));
      criteria.push_back(pair.assurance);
    }
    if (!measured.empty())
      section["views"].push_back(table_view("Shapes by a force at " + inputs[i] + ", at peaks",
                                            {{"measured", "Hz", measured},
                                             {"computed", "Hz", computed},
                                             {"difference", "%", difference, {}, 3},
                                             {"MAC", "", criteria, {}, 4}}));
    section["views"].push_back(
        curve_of_columns({"frequency", "Hz", shapes.frequencies},
                         {"MAC, force at " + inputs[i], "1", shapes.assurance}, page));
  }
}

}  // namespace

Json response_section(const ResultFile& file, const ReportContext& context) {
  const std::vector<double> frequencies = file.read("/frequency");
  std::string what = "frequency responses";
  if (!frequencies.empty())
    what += fmt::format(" from {} to {}", shown(frequencies.front(), "Hz"),
                        shown(frequencies.back(), "Hz"));
  Json section = section_head(file, "frequency responses", what);
  std::vector<PagedResponse> responses;
  section["remarks"] = Json::array();
  for (const std::string& output : file.names_in("/responses")) {
    for (const std::string& input : file.names_in("/responses/" + output)) {
      responses.push_back(paged_response(file, output, input, frequencies, context.page));
      if (const auto truncation = file.number("/responses/" + output + "/" + input + "/truncation"))
        section["remarks"].push_back(fmt::format(
            "{}: off by {:.2g} with the modes that a run keeps (time.retain)",
            responses.back().curve["name"].get<std::string>(), *truncation));
    }
  }
  Json groups = Json::array();
  std::string text =
      fmt::format("{} {}", responses.size(), responses.size() == 1 ? "response" : "responses");
  for (const PagedResponse& response : responses) {
    const auto known = std::find_if(groups.begin(), groups.end(), [&](const Json& group) {
      return group["units"] == response.units;
    });
    if (known != groups.end()) {
      (*known)["curves"].push_back(response.curve);
      continue;
    }
    groups.push_back({{"quantity", response_quantity(response.units)},
                      {"units", response.units},
                      {"curves", Json::array({response.curve})}});
    const PagedResponse* largest = &response;
    for (const PagedResponse& other : responses)
      if (other.units == response.units && other.peak > largest->peak) largest = &other;
    text += fmt::format("{} the largest {} is {:.4g} {} at {}", groups.size() == 1 ? ":" : ",",
                        response_quantity(response.units), largest->peak, largest->units,
                        shown(largest->at, "Hz"));
  }
  section["verdict"] = verdict("told", responses.empty() ? "No responses." : text + ".");
  section["views"].push_back({{"type", "responses"},
                              {"frequency", context.page.add_numbers(frequencies)},
                              {"groups", groups}});
  add_compared(file, context.page, section);
  add_shapes(file, context.page, section);
  return section;
}

}  // namespace stridor
