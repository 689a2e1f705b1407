// Of eigenvalues at one position, of runs that were compared, and of contact laws.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

#include "app/report/curves.hpp"
#include "app/report/mode_frames.hpp"
#include "app/report/tables.hpp"
#include "core/errors.hpp"

namespace stridor {
namespace {

Json eigenvalue_verdict(const ResultFile& file, const std::vector<double>& growth,
                        const std::vector<double>& frequency) {
  const std::optional<double> highest = file.told("highest_frequency");
  const std::string reach =
      highest ? fmt::format(" up to {}", shown(*highest, "Hz")) : std::string();
  if (file.told("stable").value_or(0.0) != 0.0)
    return verdict("stable", fmt::format("All vibrations{} decay.", reach));
  std::optional<std::size_t> fastest;
  std::size_t num_growing = 0;
  for (std::size_t i = 0; i < growth.size(); ++i) {
    if (!(growth[i] > 0.0) || (highest && frequency[i] > *highest)) continue;
    if (frequency[i] >= 0.0) ++num_growing;
    if (!fastest || growth[i] > growth[*fastest]) fastest = i;
  }
  if (!fastest) return verdict("unstable", fmt::format("A motion{} grows.", reach));
  const std::string of = frequency[*fastest] > 0.0
                             ? fmt::format("at {}", shown(frequency[*fastest], "Hz"))
                             : "without oscillation";
  return verdict("unstable", fmt::format("{} {}{}; the fastest, {}, by {:.4g} 1/s.", num_growing,
                                         num_growing == 1 ? "motion grows" : "motions grow", reach,
                                         of, growth[*fastest]));
}

/// Why the mode explained grows, and of what it is made.
void add_explanation(const ResultFile& file, Json& section) {
  const auto told = [&](const std::string& name) {
    return file.told("explanation." + name).value_or(std::nan(""));
  };
  if (!file.told("explanation.frequency")) return;
  TableColumn what{"Comes from", "", {}, {"the contacts", "damping"}};
  TableColumn growth{"Growth rate",
                     "1/s",
                     {told("energy.growth_from_contact"), told("energy.growth_by_damping")}};
  if (const double coupled = told("energy.growth_by_coupled_terms"); coupled != 0.0) {
    what.texts.emplace_back("coupled terms of bodies");
    growth.values.push_back(coupled);
  }
  Json view = table_view(
      fmt::format("Why the mode of {} grows or decays", shown(told("frequency"), "Hz")),
      {what, growth});
  section["views"].push_back(std::move(view));
  const auto shares = columns_in(file, {{"/frictionless_modes/frequency", "Frequency"},
                                        {"/frictionless_modes/share", "Share", 3}});
  if (shares.size() == 2)
    section["views"].push_back(table_view("Modes without friction of which it is made", shares));
}

/// Forces and sliding of the contacts; a gap where one is open.
void add_contacts(const ResultFile& file, Json& section) {
  if (!file.has("/equilibrium/closed")) return;
  std::vector<WantedColumn> wanted{{"/equilibrium/contact", "Contact"},
                                   {"/equilibrium/force", "Force"},
                                   {"/equilibrium/friction_force", "Friction"},
                                   {"/equilibrium/slip_velocity", "Slip velocity"},
                                   {"/equilibrium/position", "Position"}};
  const std::vector<double> force = file.read("/equilibrium/force");
  const std::vector<double> across = file.read("/equilibrium/friction_across");
  const auto largest = [](const std::vector<double>& numbers) {
    double most = 0.0;
    for (const double one : numbers) most = std::max(most, std::abs(one));
    return most;
  };
  constexpr double rounding = 1e-9;
  if (largest(across) > rounding * largest(force))
    wanted.push_back({"/equilibrium/friction_across", "Friction across"});
  if (std::ranges::count(file.read("/equilibrium/closed"), 0.0) > 0)
    wanted.push_back({"/equilibrium/gap", "Gap", 4});
  section["views"].push_back(table_view("Sliding equilibrium", columns_in(file, wanted)));
}

}  // namespace

Json eigenvalue_section(const ResultFile& file, const ReportContext& context) {
  const std::vector<double> growth = file.read("/eigenvalues/growth");
  const std::vector<double> frequency = file.read("/eigenvalues/frequency");
  if (growth.size() != frequency.size())
    throw FileError(Refusal::file_damaged, file.path(), "/eigenvalues/frequency",
                    "is unlike /eigenvalues/growth in length");
  const std::string parameter = file.text("parameter");
  const std::optional<double> value = file.told("value");
  std::string what = "eigenvalues";
  if (!parameter.empty() && value) what += fmt::format(" at {} = {:.6g}", parameter, *value);
  Json section = section_head(file, "eigenvalues", what);
  section["remarks"] = Json::array();
  section["verdict"] = eigenvalue_verdict(file, growth, frequency);
  std::vector<TableColumn> columns = columns_in(file, {{"/eigenvalues/frequency", "Frequency"},
                                                       {"/eigenvalues/growth", "Growth rate"},
                                                       {"/eigenvalues/damping_ratio", "Damping ratio", 4},
                                                       {"/eigenvalues/residual", "Residual", 2}});
  if (const std::vector<double> doubtful = file.read("/eigenvalues/doubtful");
      std::ranges::count(doubtful, 1.0) > 0) {
    TableColumn remark{"Remark", "", {}};
    for (const double one : doubtful)
      remark.texts.emplace_back(one != 0.0 ? "doubtful: rounding may have made it" : "");
    columns.push_back(std::move(remark));
  }
  Json modes = table_view("Eigenvalues", columns);
  modes["follows"] = true;
  section["views"].push_back(std::move(modes));
  add_explanation(file, section);
  add_contacts(file, section);
  const std::string scene = file.text("scene_resolved");
  if (!context.options.without_shapes && !scene.empty()) {
    FramedRange range{parameter, {}, file.text("about")};
    if (!parameter.empty() && value) range.values = {*value};
    if (const auto fastest = std::ranges::max_element(frequency); fastest != frequency.end())
      range.highest = *fastest;
    add_mode_frames(
        {scene, file.path() + ":scene_resolved", file.text("scene"), file.text("scene_hash")},
        range, {0.8 * context.bytes_per_file, 1}, context.page, section);
  }
  return section;
}

Json comparison_section(const ResultFile& file, const ReportContext&) {
  Json section = section_head(file, file.kind(), "contact assumptions side by side");
  // The file has the same name in every folder of a comparison.
  const std::filesystem::path path = std::filesystem::absolute(file.path());
  section["file"] = (path.parent_path().filename() / path.filename()).string();
  const std::vector<TableColumn> columns =
      columns_in(file, {{"/runs/assumption", "Assumption"},
                        {"/runs/coordinates", "Coordinates"},
                        {"/runs/step_time", "Time per step", 4},
                        {"/runs/ratio", "Of FiLM's", 4},
                        {"/runs/acceleration_peak", "Peak", 5},
                        {"/runs/acceleration_rms", "R.m.s.", 5},
                        {"/runs/difference", "Difference", 3},
                        {"/runs/force_min", "Least force", 4},
                        {"/runs/force_max", "Largest force", 4},
                        {"/runs/num_bursts", "Bursts"},
                        {"/runs/status", "Status"}});
  if (columns.empty())
    throw FileError(Refusal::file_damaged, file.path(), "/runs", "holds no run");
  const std::vector<std::string> status = file.texts("/runs/status");
  const auto num_done = std::ranges::count(status, "done");
  section["verdict"] =
      verdict(num_done < std::ssize(status) ? "failed" : "told",
              fmt::format("{} runs, of which {} came to their end.", status.size(), num_done));
  section["views"].push_back(table_view("Runs; differences are from FiLM", columns));
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
