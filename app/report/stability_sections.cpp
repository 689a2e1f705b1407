// Of loci and maps.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "app/report/mode_frames.hpp"
#include "app/stability/map_study.hpp"
#include "core/errors.hpp"

namespace stridor {
namespace {

/// Rows of a rectangle, of which the first `sizes` entries each are of a list and the rest is NaN.
using RowSizes = std::vector<std::size_t>;

RowSizes row_sizes(const ResultFile& file, const std::string& path) {
  const std::vector<double> numbers = file.read(path, 2);
  const std::size_t width = file.array(path).shape.back();
  RowSizes sizes(file.array(path).shape.front());
  for (std::size_t row = 0; row < sizes.size(); ++row) {
    const auto begin = numbers.begin() + static_cast<std::ptrdiff_t>(row * width);
    const auto end = begin + static_cast<std::ptrdiff_t>(width);
    sizes[row] = static_cast<std::size_t>(
        std::find_if(begin, end, [](double one) { return std::isnan(one); }) - begin);
  }
  return sizes;
}

/// The lists that a rectangle holds.
std::vector<std::vector<double>> lists_in(const ResultFile& file, const std::string& path,
                                          const RowSizes& sizes) {
  const std::vector<double> numbers = file.read(path, 2);
  const ResultArray& array = file.array(path);
  const std::size_t width = array.shape.back();
  const auto is_too_long = [&](std::size_t size) { return size > width; };
  if (array.shape.front() != sizes.size() || std::ranges::any_of(sizes, is_too_long))
    throw FileError(Refusal::file_damaged, file.path(), path,
                    "is unlike the others of its group in extent");
  std::vector<std::vector<double>> lists;
  for (std::size_t row = 0; row < sizes.size(); ++row) {
    const auto begin = numbers.begin() + static_cast<std::ptrdiff_t>(row * width);
    lists.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(sizes[row]));
  }
  return lists;
}

/// Numbers of one column of all branches, one after the other.
std::vector<double> of_branches(const ResultFile& file, const RowSizes& sizes,
                                const std::string& column) {
  std::vector<double> all;
  for (const std::vector<double>& list : lists_in(file, "/branches/" + column, sizes))
    all.insert(all.end(), list.begin(), list.end());
  return all;
}

/// Eigenvalues that were followed as curves; where none was, those of every value as points, a row for
/// each place in the order of their frequencies.
Json branches_view(const ResultFile& file, ReportPage& page) {
  Json sizes = Json::array();
  const RowSizes of_each =
      file.has("/branches/value") ? row_sizes(file, "/branches/value") : RowSizes{};
  if (!of_each.empty()) {
    return {{"sizes", of_each},
            {"value", page.add_numbers(of_branches(file, of_each, "value"))},
            {"growth", page.add_numbers(of_branches(file, of_each, "growth"))},
            {"frequency", page.add_numbers(of_branches(file, of_each, "frequency"))}};
  }
  const std::vector<double> values = file.read("/values");
  const std::vector<double> growth = file.read("/eigenvalues/growth", 2);
  const std::vector<double> frequency = file.read("/eigenvalues/frequency", 2);
  const std::size_t most = values.empty() ? 0 : growth.size() / values.size();
  if (growth.size() != most * values.size() || frequency.size() != growth.size())
    throw FileError(Refusal::file_damaged, file.path(), "/eigenvalues",
                    "is unlike /values in extent");
  std::vector<double> all_values;
  std::vector<double> all_growth;
  std::vector<double> all_frequency;
  for (std::size_t k = 0; k < most; ++k) {
    sizes.push_back(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      all_values.push_back(values[i]);
      all_growth.push_back(growth[i * most + k]);
      all_frequency.push_back(frequency[i * most + k]);
    }
  }
  return {{"sizes", sizes},
          {"points", true},
          {"value", page.add_numbers(all_values)},
          {"growth", page.add_numbers(all_growth)},
          {"frequency", page.add_numbers(all_frequency)}};
}

Json windows_of(const std::vector<TimedWindow>& windows) {
  Json rows = Json::array();
  for (const TimedWindow& one : windows) {
    rows.push_back({{"from", one.window.from},
                    {"to", one.window.to},
                    {"frequency", one.window.frequency},
                    {"growth_max", one.window.growth_max},
                    {"value_max", one.window.value_max},
                    {"from_time", number(one.from_time)},
                    {"to_time", number(one.to_time)},
                    {"gain", number(one.gain)}});
  }
  return rows;
}

/// Up to where a locus has looked, where its file says so.
std::string reach_of(const ResultFile& file) {
  const std::optional<double> highest = file.told("highest_frequency");
  if (!highest) return "";
  const std::optional<double> trusted = file.told("trusted_frequency");
  std::string text = fmt::format(" Looked at: all up to {}", shown(*highest, "Hz"));
  if (trusted && *highest < *trusted)
    text += fmt::format("; the bodies resolve {}, --below {:.0f} looks up to there",
                        shown(*trusted, "Hz"), std::ceil(*trusted));
  return text + ".";
}

Json locus_verdict(const std::vector<TimedWindow>& windows, const std::string& parameter,
                   const std::string& units, const std::string& reach) {
  if (windows.empty())
    return verdict("stable",
                   fmt::format("No vibration grows anywhere along {}.{}", parameter, reach));
  const auto worst = std::max_element(windows.begin(), windows.end(), [](const auto& a, const auto& b) {
    return a.window.growth_max < b.window.growth_max;
  });
  return verdict("unstable",
                 fmt::format("{} unstable {} of {}; the fastest growth, {:.4g} 1/s at {}, is "
                             "between {:.6g} and {:.6g}{}.{}",
                             windows.size(), windows.size() == 1 ? "window" : "windows", parameter,
                             worst->window.growth_max, shown(worst->window.frequency, "Hz"),
                             worst->window.from, worst->window.to,
                             units.empty() || units == "1" ? "" : " " + units, reach));
}

/// Where each window grows fastest, the fastest first.
std::vector<double> fastest_places(std::vector<TimedWindow> windows) {
  std::ranges::sort(windows, std::ranges::greater{},
                    [](const TimedWindow& one) { return one.window.growth_max; });
  std::vector<double> places;
  for (const TimedWindow& one : windows) places.push_back(one.window.value_max);
  return places;
}

/// The growth over two parameters as a field of the page.
Json map_view(const ResultFile& file, ReportPage& page) {
  const std::vector<double> x = file.read("/x");
  const std::vector<double> y = file.read("/y");
  const std::vector<double> growth = file.read("/growth", 2);
  if (growth.size() != x.size() * y.size())
    throw FileError(
        Refusal::file_damaged, file.path(), "/growth",
        fmt::format("has {} entries, /x and /y {} and {}", growth.size(), x.size(), y.size()));
  Json lines = Json::array();
  const RowSizes sizes = file.has("/boundary/x") ? row_sizes(file, "/boundary/x") : RowSizes{};
  if (!sizes.empty()) {
    const auto of_x = lists_in(file, "/boundary/x", sizes);
    const auto of_y = lists_in(file, "/boundary/y", sizes);
    for (std::size_t line = 0; line < sizes.size(); ++line)
      lines.push_back(page.add_numbers(points_of(of_x[line], of_y[line])));
  }
  Json view = {
      {"type", "field"},
      {"x",
       {{"name", file.text("x")},
        {"units", file.array("/x").units},
        {"values", page.add_numbers(x)}}},
      {"y",
       {{"name", file.text("y")},
        {"units", file.array("/y").units},
        {"values", page.add_numbers(y)}}},
      {"value",
       {{"name", "largest growth rate"}, {"units", "1/s"}, {"values", page.add_numbers(growth)}}},
      {"missing", "no growth rate was found"},
      {"scale", "signed"},
      {"lines", lines},
      {"reproduce", file.text("point_command")}};
  if (file.has("/failure")) {
    const std::vector<double> failure = file.read("/failure", 2);
    if (failure.size() != growth.size())
      throw FileError(Refusal::file_damaged, file.path(), "/failure",
                      "is unlike /growth in extent");
    view["failure"] = page.add_numbers(failure);
    view["reasons"] = file.texts("/failures/reason");
  }
  return view;
}

/// Why points of a map failed, what most of them share first.
Json failure_remarks(const ResultFile& file) {
  constexpr std::size_t most_remarks = 5;
  Json remarks = Json::array();
  if (!file.has("/failure")) return remarks;
  const std::vector<FailedPoints> all =
      failed_points(file.texts("/failures/reason"), file.read("/failure", 2));
  for (std::size_t k = 0; k < std::min(most_remarks, all.size()); ++k)
    remarks.push_back(fmt::format("{} points failed: {}", all[k].num_points, all[k].reason));
  if (all.size() > most_remarks)
    remarks.push_back(
        fmt::format("There are {} other reasons (/failures)", all.size() - most_remarks));
  return remarks;
}

}  // namespace

Json locus_section(const ResultFile& file, const ReportContext& context) {
  const std::string parameter = file.text("parameter");
  const std::vector<double> values = file.read("/values");
  std::string what = "eigenvalues along " + parameter;
  if (!values.empty()) {
    const std::string units = file.array("/values").units;
    what +=
        fmt::format(" from {} to {}", shown(values.front(), units), shown(values.back(), units));
  }
  Json section = section_head(file, "locus", what);
  section["remarks"] = Json::array();
  const std::vector<TimedWindow> windows = read_locus_windows(file.path());
  section["verdict"] =
      locus_verdict(windows, parameter, file.array("/values").units, reach_of(file));
  section["views"].push_back({{"type", "windows"},
                              {"parameter", parameter},
                              {"units", file.array("/values").units},
                              {"windows", windows_of(windows)}});
  ReportPage& page = context.page;
  Json view = {{"type", "locus"},
               {"parameter", parameter},
               {"units", file.array("/values").units},
               {"windows", windows_of(windows)}};
  view.update(branches_view(file, page));
  section["views"].push_back(std::move(view));
  const std::string scene = file.text("scene_resolved");
  if (!context.options.without_shapes && !scene.empty()) {
    const FramedRange range{parameter, values, file.text("about"), fastest_places(windows)};
    add_mode_frames({scene, file.path() + ":scene_resolved", file.text("scene"),
                     file.text("scene_hash")},
                    range,
                    {0.5 * context.bytes_per_file, 41}, page, section);
  }
  return section;
}

/// Points of a map without a growth rate for a reason; one where nothing lies in the window is
/// none.
std::ptrdiff_t num_failed(const ResultFile& file, const std::vector<double>& growth) {
  if (!file.has("/failure"))
    return std::count_if(growth.begin(), growth.end(),
                         [](double value) { return std::isnan(value); });
  const std::vector<double> failure = file.read("/failure", 2);
  return std::count_if(failure.begin(), failure.end(), [](double number) { return number > 0.0; });
}

Json map_section(const ResultFile& file, const ReportContext& context) {
  Json section =
      section_head(file, "stability map",
                   fmt::format("stability over {} and {}", file.text("x"), file.text("y")));
  const std::vector<double> growth = file.read("/growth", 2);
  const auto is_unstable = [](double value) { return value > 0.0; };
  const auto unstable = std::count_if(growth.begin(), growth.end(), is_unstable);
  const auto failed = num_failed(file, growth);
  std::string text = fmt::format("Of {} points {} are unstable", growth.size(), unstable);
  if (failed > 0) text += fmt::format(", {} failed", failed);
  if (unstable > 0) {
    double most = 0.0;
    for (const double value : growth)
      if (value > most) most = value;
    text += fmt::format("; the fastest growth is {:.4g} 1/s", most);
  }
  section["verdict"] = verdict(unstable > 0 ? "unstable" : "stable", text + ".");
  section["remarks"] = failure_remarks(file);
  section["views"].push_back(map_view(file, context.page));
  return section;
}

}  // namespace stridor
