// Of contacts that slide on rubber, and of their laws.
#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "app/report/curves.hpp"
#include "core/errors.hpp"

namespace stridor {

Json contact_section(const ResultFile& file, const ReportContext& context) {
  Json section = section_head(file, "sliding contacts", "sliding contacts");
  const bool has_speed = file.has("/rows/speed");
  if (has_speed) {
    CurveSet rows = curve_set(file, "/rows", "speed");
    WordColumn solution{"solution", {}};
    for (const double converged : rows.take("converged"))
      solution.texts.emplace_back(converged != 0.0 ? "converged" : "not converged");
    if (!solution.texts.empty()) rows.words.push_back(std::move(solution));
    Json view = curves_view("speed", file.array("/rows/speed").units, {rows}, context.page);
    view["x_log"] = true;
    view["table"] = true;
    section["views"].push_back(std::move(view));
  }
  const std::vector<std::string> contacts = file.names_in("/contacts");
  for (const std::string& name : contacts) {
    const std::string group = "/contacts/" + name;
    Json lines = Json::array();
    if (file.has(group + "/edge_x")) {
      const std::vector<double> edge_x = file.read(group + "/edge_x");
      const std::vector<double> edge_y = file.read(group + "/edge_y");
      if (edge_x.size() != edge_y.size())
        throw FileError(Refusal::file_damaged, file.path(), group + "/edge_y",
                        "is unlike edge_x in length");
      lines.push_back(context.page.add_numbers(points_of(edge_x, edge_y)));
    }
    section["views"].push_back(
        {{"type", "field"},
         {"title", "contact " + name},
         {"x",
          {{"name", "x"},
           {"units", "m"},
           {"values", context.page.add_numbers(file.read(group + "/x"))}}},
         {"y",
          {{"name", "y"},
           {"units", "m"},
           {"values", context.page.add_numbers(file.read(group + "/y"))}}},
         {"value",
          {{"name", "pressure"},
           {"units", "Pa"},
           {"values", context.page.add_numbers(file.read(group + "/pressure", 2))}}},
         {"scale", "linear"},
         {"lines", lines}});
  }
  section["verdict"] =
      verdict("told", fmt::format("{} sliding {} on a viscoelastic half-space.", contacts.size(),
                                  contacts.size() == 1 ? "contact" : "contacts"));
  return section;
}

Json contact_law_section(const ResultFile& file, const ReportContext& context) {
  Json section = section_head(file, file.kind(), "contact law over speed and indentation");
  const std::vector<double> speeds = file.read("/speed");
  const std::vector<double> indentations = file.read("/indentation");
  struct Quantity {
    const char* path;
    const char* name;
    const char* scale;
  };
  for (const auto& [path, name, scale] :
       {Quantity{"/force", "normal force F/(E₀* R²)", "log"},
        Quantity{"/area", "area of contact A/R²", "log"},
        Quantity{"/friction", "friction coefficient", "linear"}}) {
    const std::vector<double> values = file.read(path, 2);
    if (values.size() != speeds.size() * indentations.size())
      throw FileError(Refusal::file_damaged, file.path(), path,
                      "is unlike /speed and /indentation in extent");
    const auto axis = [&](const char* title, const std::vector<double>& numbers) {
      return Json{{"name", title}, {"units", "1"}, {"values", context.page.add_numbers(numbers)}};
    };
    section["views"].push_back({{"type", "field"},
                                {"title", name},
                                {"x", axis("speed v τ/R", speeds)},
                                {"y", axis("indentation y/R", indentations)},
                                {"value", axis(name, values)},
                                {"scale", scale},
                                {"lines", Json::array()}});
  }
  section["verdict"] = verdict("told", fmt::format("Force, area and friction at {} speeds and {} "
                                                   "indentations.",
                                                   speeds.size(), indentations.size()));
  return section;
}

Json master_curve_section(const ResultFile& file, const ReportContext& context) {
  Json section = section_head(file, file.kind(), "master curve of sliding paraboloids");
  if (!file.has("/beta"))
    throw FileError(Refusal::file_damaged, file.path(), "/beta", "is missing");
  CurveSet points = curve_set(file, "", "beta");
  for (CurveColumn& column : points.columns) {
    for (const auto& [name, of] : {std::pair{"f", "force"}, {"g", "area"}, {"m", "friction"}})
      if (column.name == name) column.name += fmt::format(", of the {}", of);
  }
  Json view = curves_view("β", file.array("/beta").units, {points}, context.page);
  view["x_log"] = true;
  view["table"] = true;
  section["views"].push_back(std::move(view));
  section["verdict"] = verdict(
      "told",
      fmt::format("Force, area and friction of paraboloids at {} speeds: β is v τ/R over the "
                  "root of the indentation y/R.",
                  points.over.size()));
  return section;
}

}  // namespace stridor
