#include "app/report/report_section.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "core/errors.hpp"
#include "io/figures/axes.hpp"
#include "io/hdf5/output_options.hpp"

namespace stridor {

Json report_section(const ResultFile& file, const ReportContext& context) {
  using Make = Json (*)(const ResultFile&, const ReportContext&);
  static const std::vector<std::pair<std::string, Make>> kinds{
      {"run", run_section},
      {"locus", locus_section},
      {"stability map", map_section},
      {"sweep of transients", sweep_section},
      {"sweep of limit cycles", sweep_section},
      {"limit cycle", cycle_section},
      {"frequency responses", response_section},
      {"spectrogram", spectrogram_section},
      {"sliding contacts", contact_section},
      {"study of precision", precision_section},
      {"eigenvalues", eigenvalue_section},
      {"comparison of assumptions", comparison_section},
      {"contact law", contact_law_section},
      {"master curve", master_curve_section}};
  const std::string kind = file.kind();
  std::vector<std::string> names;
  for (const auto& [name, make] : kinds) {
    if (name == kind) return make(file, context);
    names.push_back(name);
  }
  throw FileError(Refusal::other_kind_of_file, file.path(), "",
                  kind.empty() ? "is no file of results of stridor (no attribute 'kind')"
                               : fmt::format("is of the kind '{}'; a report shows: {}", kind,
                                             fmt::join(names, ", ")));
}

std::string scene_name(const ResultFile& file) {
  std::string scene = file.text("scene");
  if (scene.empty()) scene = scene_of_command(file.text("command"));
  return std::filesystem::path(scene).stem().string();
}

std::string name_with_folder(const ResultFile& file) {
  const std::filesystem::path path = std::filesystem::absolute(file.path());
  return (path.parent_path().filename() / path.filename()).string();
}

Json section_head(const ResultFile& file, const std::string& kind, const std::string& what) {
  const std::string scene = scene_name(file);
  Json head = {{"kind", kind},
               {"title", scene.empty() ? what : scene + ": " + what},
               {"file", std::filesystem::path(file.path()).filename().string()}};
  for (const char* name : {"command", "date", "version", "commit", "scene", "scene_hash", "about",
                           "method", "parameter"}) {
    if (const std::string text = file.text(name); !text.empty()) head[name] = text;
  }
  if (const std::string resolved = file.text("scene_resolved"); !resolved.empty())
    head["scene_resolved"] = resolved;
  head["views"] = Json::array();
  return head;
}

Json verdict(const std::string& level, const std::string& text) {
  return {{"level", level}, {"text", text}};
}

std::vector<double> points_of(const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<double> points;
  points.reserve(2 * x.size());
  for (std::size_t i = 0; i < x.size(); ++i) points.insert(points.end(), {x[i], y[i]});
  return points;
}

std::string shown(double value, const std::string& units) {
  if (units.empty() || units == "1") return fmt::format("{:.4g}", value);
  return quantity_text(value, units);
}

}  // namespace stridor
