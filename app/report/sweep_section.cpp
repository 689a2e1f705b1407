// Of sweeps: runs or limit cycles along a key.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "app/report/curves.hpp"
#include "core/errors.hpp"

namespace stridor {
namespace {

/// "0 periodic, 1 at_rest" as words by number.
std::map<int, std::string> meanings_of(const std::string& text) {
  std::map<int, std::string> meanings;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(", ", begin), text.size());
    const std::string one = text.substr(begin, end - begin);
    const std::size_t gap = one.find(' ');
    if (gap != std::string::npos && one.find_first_not_of("0123456789") == gap) {
      std::string word = one.substr(gap + 1);
      std::replace(word.begin(), word.end(), '_', ' ');
      meanings[std::stoi(one)] = word;
    }
    begin = end + 2;
  }
  return meanings;
}

/// States, which are numbers in the file, become words.
void put_states_in_words(const ResultFile& file, CurveSet& set) {
  const std::map<int, std::string> meanings = meanings_of(file.text("meaning_of_status"));
  WordColumn motion{"motion", {}};
  for (const double status : set.take("status")) {
    const auto found =
        std::isfinite(status) ? meanings.find(static_cast<int>(status)) : meanings.end();
    motion.texts.push_back(found == meanings.end() ? fmt::format("{:g}", status) : found->second);
  }
  if (!motion.texts.empty()) set.words.push_back(std::move(motion));
  WordColumn equilibrium{"equilibrium", {}};
  for (const double is_stable : set.take("equilibrium_stable"))
    equilibrium.texts.emplace_back(is_stable != 0.0 ? "equilibrium stable"
                                                    : "equilibrium unstable");
  if (!equilibrium.texts.empty()) set.words.push_back(std::move(equilibrium));
}

/// Amplitude and frequency, which a file of limit cycles holds as extremes and period.
void add_amplitude_and_frequency(CurveSet& set) {
  const auto values_of = [&](const std::string& name) -> const std::vector<double>* {
    for (const CurveColumn& column : set.columns)
      if (column.name == name) return &column.values;
    return nullptr;
  };
  const std::vector<double>* low = values_of("x_min");
  const std::vector<double>* high = values_of("x_max");
  if (low != nullptr && high != nullptr) {
    CurveColumn amplitude{"amplitude", "m", {}};
    for (std::size_t i = 0; i < low->size(); ++i)
      amplitude.values.push_back(0.5 * ((*high)[i] - (*low)[i]));
    set.columns.push_back(std::move(amplitude));
  }
  CurveColumn frequency{"frequency", "Hz", {}};
  for (const double period : set.take("period"))
    frequency.values.push_back(period > 0.0 ? 1.0 / period
                                            : std::numeric_limits<double>::quiet_NaN());
  if (!frequency.values.empty()) set.columns.push_back(std::move(frequency));
}

CurveSet swept_set(const ResultFile& file, const std::string& group) {
  CurveSet set = curve_set(file, group, "value");
  const std::vector<double> failed = set.take("failed");
  const std::vector<std::string> reasons = file.texts(group + "/reason");
  for (std::size_t i = 0; i < set.over.size(); ++i) {
    const bool has_reason = i < reasons.size() && !reasons[i].empty();
    if (has_reason || (i < failed.size() && failed[i] != 0.0))
      set.failed.push_back({i, has_reason ? reasons[i] : "the file does not say why"});
  }
  put_states_in_words(file, set);
  add_amplitude_and_frequency(set);
  return set;
}

/// "12 periodic, 3 at rest" of the first words of a set.
std::string counted_words(const CurveSet& set) {
  if (set.words.empty() || set.words.front().name != "motion") return "";
  std::map<std::string, int> counts;
  for (const std::string& text : set.words.front().texts) ++counts[text];
  std::vector<std::string> parts;
  for (const auto& [text, count] : counts) parts.push_back(fmt::format("{} {}", count, text));
  return fmt::format("{}", fmt::join(parts, ", "));
}

/// The first failures; all are in the table.
void add_failures(const std::string& parameter, const std::string& units,
                  const std::vector<CurveSet>& sets, Json& remarks) {
  constexpr std::size_t most = 3;
  std::size_t count = 0;
  for (const CurveSet& set : sets) {
    for (const FailedValue& failed : set.failed) {
      if (++count > most) continue;
      remarks.push_back(fmt::format("{}{} = {} failed: {}", set.name.empty() ? "" : set.name + ", ",
                                    parameter, shown(set.over[failed.index], units),
                                    failed.reason));
    }
  }
  if (count > most)
    remarks.push_back(fmt::format("{} more failed; the table says why.", count - most));
}

/// Where bursts were heard, and the value whose acceleration reached most.
std::string loudest_of(const CurveSet& set, const std::string& units) {
  const std::string way = set.name.empty() ? "" : set.name + " ";
  std::string text;
  for (const CurveColumn& column : set.columns) {
    if (column.name == "num_bursts") {
      const auto heard = std::ranges::count_if(column.values, [](double n) { return n > 0.0; });
      text += fmt::format("; {}bursts at {} of them", way, heard);
    }
    if (column.name != "acceleration_peak") continue;
    std::size_t top = column.values.size();
    for (std::size_t i = 0; i < column.values.size(); ++i)
      if (std::isfinite(column.values[i]) &&
          (top == column.values.size() || column.values[i] > column.values[top]))
        top = i;
    if (top < column.values.size())
      text += fmt::format("; {}the acceleration is largest at {}, {}", way,
                          shown(set.over[top], units), shown(column.values[top], column.units));
  }
  return text;
}

std::string sweep_text(const std::string& parameter, const std::string& units,
                       const std::vector<CurveSet>& sets) {
  std::size_t points = 0;
  std::size_t num_failed = 0;
  std::string motions;
  for (const CurveSet& set : sets) {
    points += set.over.size();
    num_failed += set.failed.size();
    const std::string counted = counted_words(set);
    if (counted.empty()) continue;
    motions += motions.empty() ? ": " : "; ";
    motions += set.name.empty() ? counted : set.name + " " + counted;
  }
  std::string text = fmt::format("{} values of {}{}", points, parameter, motions);
  for (const CurveSet& set : sets) text += loudest_of(set, units);
  if (num_failed > 0)
    text += fmt::format("{} {} failed", motions.empty() ? ", of which" : ";", num_failed);
  return text;
}

}  // namespace

Json sweep_section(const ResultFile& file, const ReportContext& context) {
  const std::string parameter = file.text("parameter");
  const bool has_cycles = file.kind() == "sweep of limit cycles";
  Json section =
      section_head(file, file.kind(),
                   fmt::format("{} along {}", has_cycles ? "limit cycles" : "runs", parameter));
  section["remarks"] = Json::array();
  std::vector<std::string> groups;
  if (file.has("/value"))
    groups.emplace_back("");
  else
    for (const std::string name : {"up", "down", "rows"})
      if (file.has("/" + name + "/value")) groups.push_back("/" + name);
  if (groups.empty()) throw FileError(Refusal::file_damaged, file.path(), "/value", "is missing");
  std::vector<CurveSet> sets;
  for (const std::string& group : groups) {
    sets.push_back(swept_set(file, group));
    if (groups.size() > 1) sets.back().name = group.substr(1);
  }
  const std::string units = file.array(groups.front() + "/value").units;
  Json view = curves_view(parameter, units, sets, context.page);
  view["table"] = true;
  section["views"].push_back(std::move(view));
  add_failures(parameter, units, sets, section["remarks"]);
  std::string text = sweep_text(parameter, units, sets);
  const bool has_failed = std::any_of(sets.begin(), sets.end(),
                                      [](const CurveSet& set) { return !set.failed.empty(); });
  std::string level = has_failed ? "failed" : "told";
  if (file.has("/bursts/value") && !file.read("/bursts/value").empty()) {
    CurveSet bursts = curve_set(file, "/bursts", "value");
    (void)bursts.take("number");
    Json points = curves_view(parameter, units, {bursts}, context.page);
    points["title"] = "Bursts of all runs";
    points["points"] = true;
    section["views"].push_back(std::move(points));
    text += fmt::format("; {} bursts of vibration", bursts.over.size());
    if (level == "told") level = "loud";
  }
  section["verdict"] = verdict(level, text + ".");
  return section;
}

}  // namespace stridor
