// Of eigenvalues at one position.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "app/report/mode_frames.hpp"
#include "app/report/tables.hpp"
#include "core/errors.hpp"

namespace stridor {
namespace {

Json eigenvalue_verdict(const ResultFile& file, const std::vector<double>& growth,
                        const std::vector<double>& frequency) {
  const std::optional<double> highest = file.told("highest_frequency");
  const std::string limit = highest ? shown(*highest, "Hz") : std::string();
  if (file.told("stable").value_or(0.0) != 0.0)
    return verdict("stable", limit.empty() ? "All vibrations decay."
                                           : fmt::format("All vibrations up to {} decay.", limit));
  const std::vector<double> growing = file.read("/eigenvalues/growing");
  std::optional<std::size_t> fastest;
  std::size_t num_growing = 0;
  for (std::size_t i = 0; i < growth.size(); ++i) {
    if (growing[i] == 0.0 || (highest && frequency[i] > *highest)) continue;
    ++num_growing;
    if (!fastest || growth[i] > growth[*fastest]) fastest = i;
  }
  if (!fastest) return verdict("unstable", "A motion grows.");
  const std::string of = frequency[*fastest] > 0.0
                             ? fmt::format("at {}", shown(frequency[*fastest], "Hz"))
                             : "without oscillation";
  return verdict(
      "unstable",
      fmt::format("{}{} {}; the fastest, {}, by {:.4g} 1/s.",
                  limit.empty() ? "" : fmt::format("Up to {} ", limit), num_growing,
                  num_growing == 1 ? "motion grows" : "motions grow", of, growth[*fastest]));
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
  for (const char* other : {"/eigenvalues/frequency", "/eigenvalues/growing"})
    if (file.read(other).size() != growth.size())
      throw FileError(Refusal::file_damaged, file.path(), other,
                      "is unlike /eigenvalues/growth in length");
  const std::string parameter = file.text("parameter");
  const std::optional<double> value = file.told("value");
  std::string what = "eigenvalues";
  if (!parameter.empty() && value)
    what += fmt::format(" at {} = {}", parameter, shown(*value, file.text("units")));
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
    if (!frequency.empty()) range.highest = std::ranges::max(frequency);
    add_mode_frames(
        {scene, file.path() + ":scene_resolved", file.text("scene"), file.text("scene_hash")},
        range, {0.8 * context.bytes_per_file, 1}, context.page, section);
  }
  return section;
}

}  // namespace stridor
