#include "app/report/curves.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace stridor {
namespace {

/// Place of a quantity among others; those that are not named stand in the middle.
std::size_t rank_of(const std::string& name) {
  constexpr std::array<std::string_view, 9> first{
      "amplitude", "x_rms", "acceleration_rms", "acceleration_peak", "peak",
      "frequency", "gain",  "num_bursts",       "force_max"};
  constexpr std::array<std::string_view, 7> last{
      "stick_fraction", "free_fraction", "violations", "start", "end", "iterations", "steps"};
  const auto wanted = std::find(first.begin(), first.end(), name);
  if (wanted != first.end()) return static_cast<std::size_t>(wanted - first.begin());
  const auto unwanted = std::find(last.begin(), last.end(), name);
  if (unwanted == last.end()) return first.size();
  return first.size() + 1 + static_cast<std::size_t>(unwanted - last.begin());
}

/// A quantity of a file in words, where its name is not.
std::string in_words(const std::string& name) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 14> words{
      {{"acceleration_rms", "r.m.s. acceleration"},
       {"acceleration_peak", "largest acceleration"},
       {"num_bursts", "number of bursts"},
       {"force_min", "least contact force"},
       {"force_max", "largest contact force"},
       {"stick_fraction", "share in stick"},
       {"free_fraction", "share without contact"},
       {"violations", "steps against persistent sliding"},
       {"x_rms", "r.m.s. displacement"},
       {"x_mean", "mean displacement"},
       {"x_min", "least displacement"},
       {"x_max", "largest displacement"},
       {"start_frequency", "frequency at the start"},
       {"end_frequency", "frequency at the end"}}};
  const auto* const found =
      std::find_if(words.begin(), words.end(), [&](const auto& one) { return one.first == name; });
  return found == words.end() ? name : std::string(found->second);
}

Json curve_json(const CurveColumn& column, std::size_t set, ReportPage& page) {
  return {{"name", in_words(column.name)},
          {"units", column.units},
          {"set", set},
          {"values", page.add_numbers(column.values)}};
}

Json set_json(const CurveSet& set, ReportPage& page) {
  Json one = {{"name", set.name},
              {"values", page.add_numbers(set.over)},
              {"states", Json::array()},
              {"failed", Json::array()}};
  for (const WordColumn& words : set.words)
    one["states"].push_back({{"name", words.name}, {"texts", words.texts}});
  for (const FailedValue& failed : set.failed)
    one["failed"].push_back({{"index", failed.index}, {"reason", failed.reason}});
  return one;
}

}  // namespace

std::vector<double> CurveSet::take(const std::string& wanted) {
  const auto found = std::find_if(columns.begin(), columns.end(),
                                  [&](const CurveColumn& one) { return one.name == wanted; });
  if (found == columns.end()) return {};
  std::vector<double> values = std::move(found->values);
  columns.erase(found);
  return values;
}

CurveSet curve_set(const ResultFile& file, const std::string& group, const std::string& over) {
  CurveSet set;
  set.over = file.read(group + "/" + over);
  for (const std::string& name : file.names_in(group)) {
    const std::string path = group + "/" + name;
    if (name == over || !file.has(path)) continue;
    const ResultArray& array = file.array(path);
    if (array.shape.size() != 1 || array.shape.front() != set.over.size()) continue;
    set.columns.push_back({name, array.units, file.read(path)});
  }
  return set;
}

Json curves_view(const std::string& name, const std::string& units,
                 const std::vector<CurveSet>& sets, ReportPage& page) {
  Json view = {{"type", "curves"},
               {"x", {{"name", name}, {"units", units}}},
               {"sets", Json::array()},
               {"panels", Json::array()}};
  for (const CurveSet& set : sets) view["sets"].push_back(set_json(set, page));
  std::vector<std::string> names;
  for (const CurveColumn& column : sets.front().columns) names.push_back(column.name);
  std::stable_sort(names.begin(), names.end(), [](const std::string& a, const std::string& b) {
    return rank_of(a) < rank_of(b);
  });
  for (const std::string& quantity : names) {
    Json curves = Json::array();
    for (std::size_t i = 0; i < sets.size(); ++i)
      for (const CurveColumn& column : sets[i].columns)
        if (column.name == quantity) curves.push_back(curve_json(column, i, page));
    view["panels"].push_back({{"curves", std::move(curves)}});
  }
  return view;
}

Json curve_of_columns(const CurveColumn& over, const CurveColumn& column, ReportPage& page) {
  return curves_view(over.name, over.units, {{"", over.values, {column}, {}, {}}}, page);
}

}  // namespace stridor
