#include "io/figures/run_panels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <map>

#include "io/figures/axes.hpp"
#include "io/run_file/run_summary.hpp"

namespace stridor {
namespace {

/// Quantities in the order in which they matter.
constexpr std::array<const char*, 10> ranked_quantities{
    "acceleration", "force",    "slip_velocity", "state",    "friction_force",
    "gap",          "velocity", "displacement",  "position", "area"};

constexpr std::array<const char*, 8> accompanying{"force_min",          "force_max",
                                                  "friction_force_min", "friction_force_max",
                                                  "force_low_passed",   "friction_force_low_passed",
                                                  "stick_fraction",     "open_fraction"};

std::size_t rank_of(const std::string& series) {
  if (series.starts_with("/energy/")) return ranked_quantities.size() + 1;
  const std::string quantity = split_name(channel_name(series)).second;
  const auto found = std::find(ranked_quantities.begin(), ranked_quantities.end(), quantity);
  return static_cast<std::size_t>(found - ranked_quantities.begin());
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Whether a comes before b where runs of digits count as numbers: "pad[2]" before "pad[10]".
bool is_before(const std::string& a, const std::string& b) {
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_digit(a[i]) && is_digit(b[j])) {
      std::size_t in_a = i;
      std::size_t in_b = j;
      while (i < a.size() && is_digit(a[i])) ++i;
      while (j < b.size() && is_digit(b[j])) ++j;
      while (in_a + 1 < i && a[in_a] == '0') ++in_a;
      while (in_b + 1 < j && b[in_b] == '0') ++in_b;
      if (i - in_a != j - in_b) return i - in_a < j - in_b;
      const int order = a.compare(in_a, i - in_a, b, in_b, j - in_b);
      if (order != 0) return order < 0;
      continue;
    }
    if (a[i] != b[j]) return a[i] < b[j];
    ++i;
    ++j;
  }
  return a.size() - i < b.size() - j;
}

bool is_accompanying(const std::string& series) {
  const std::string quantity = series.substr(series.rfind('/') + 1);
  return series.starts_with("/contact/") &&
         std::find(accompanying.begin(), accompanying.end(), quantity) != accompanying.end();
}

bool has_spectrum(const std::string& series) {
  const std::string quantity = split_name(channel_name(series)).second;
  return !series.starts_with("/energy/") && quantity != "state" && quantity != "position";
}

std::string text_attribute(const RunFileReader& file, const std::string& series, const char* name) {
  const auto all = file.attributes(series);
  const auto found = all.find(name);
  const std::string* text = found == all.end() ? nullptr : std::get_if<std::string>(&found->second);
  return text == nullptr ? "" : *text;
}

/// "0 open, 1 stick, 2 slip" as values with names.
std::vector<NamedValue> named_values(const std::string& meaning) {
  std::vector<NamedValue> values;
  for (std::size_t begin = 0; begin < meaning.size();) {
    const std::size_t end = std::min(meaning.find(", ", begin), meaning.size());
    const std::string one = meaning.substr(begin, end - begin);
    const std::size_t blank = one.find(' ');
    double value = 0.0;
    const auto read = std::from_chars(one.data(), one.data() + std::min(blank, one.size()), value);
    if (read.ec == std::errc() && blank != std::string::npos)
      values.push_back({value, one.substr(blank + 1)});
    begin = end + 2;
  }
  return values;
}

}  // namespace

std::string channel_name(const std::string& series) {
  if (series.rfind("/channels/", 0) == 0) return series.substr(10);
  std::string name = series.substr(series.find('/', 1) + 1);
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

std::pair<std::string, std::string> split_name(const std::string& name) {
  const std::size_t dot = name.rfind('.');
  if (dot == std::string::npos) return {name, name};
  return {name.substr(0, dot), name.substr(dot + 1)};
}

std::string filter_note(const RunFileReader& file, const std::string& series) {
  const std::string filter = text_attribute(file, series, "filter");
  if (filter.empty() || filter == "none") return "";
  const std::string before = "pass band to ";
  const std::size_t at = filter.find(before);
  if (at == std::string::npos) return "low-passed";
  const double edge = std::strtod(filter.c_str() + at + before.size(), nullptr);
  return "low-passed to " + quantity_text(edge, "Hz");
}

std::string spectral_series(const RunFileReader& file, const std::string& series) {
  const std::string low_passed = series + "_low_passed";
  return file.has(low_passed) ? low_passed : series;
}

std::vector<std::string> series_by_use(const RunFileReader& file, SeriesUse use) {
  std::vector<std::string> series = file.series_names();
  std::erase_if(series, [&](const std::string& one) {
    return is_accompanying(one) || (use == SeriesUse::spectrum && !has_spectrum(one));
  });
  const std::string first = acceleration_channel(file).value_or("");
  std::stable_sort(series.begin(), series.end(), [&](const auto& a, const auto& b) {
    if ((a == first) != (b == first)) return a == first;
    if (rank_of(a) != rank_of(b)) return rank_of(a) < rank_of(b);
    return is_before(a, b);
  });
  return series;
}

std::vector<std::string> chosen_series(const RunFileReader& file, SeriesUse use, std::size_t most) {
  const std::vector<std::string> all = series_by_use(file, use);
  // How many of its quantity come before each; the first of all before the second of any.
  std::map<std::size_t, std::size_t> num_seen;
  std::vector<std::pair<std::size_t, std::size_t>> order;
  for (std::size_t i = 0; i < all.size(); ++i) order.emplace_back(num_seen[rank_of(all[i])]++, i);
  std::sort(order.begin(), order.end());
  if (order.size() > most) order.resize(most);
  std::sort(order.begin(), order.end(),
            [](const auto& a, const auto& b) { return a.second < b.second; });
  std::vector<std::string> chosen;
  for (const auto& [number, i] : order) chosen.push_back(all[i]);
  return chosen;
}

Panel panel_of(const RunFileReader& file, const std::string& series, IndexRange samples) {
  const auto part = [&](const std::vector<double>& all) {
    const auto values = samples.of(all);
    return std::vector<double>(values.begin(), values.end());
  };
  const auto [place, quantity] = split_name(channel_name(series));
  Panel panel;
  panel.title = series.starts_with("/energy/") ? "energy" : place;
  panel.label = quantity;
  std::replace(panel.label.begin(), panel.label.end(), '_', ' ');
  panel.units = typeset_units(file.units(series));
  panel.curves = {{part(file.times()), part(file.series(series)), ""}};
  panel.named_values = named_values(text_attribute(file, series, "meaning"));
  if (const std::string note = filter_note(file, series); !note.empty())
    panel.title += " (" + note + ")";
  if (file.has(series + "_min") && file.has(series + "_max")) {
    panel.band = {panel.curves[0].times, part(file.series(series + "_min")),
                  part(file.series(series + "_max"))};
    panel.title += " (band: extremes of all steps)";
  }
  return panel;
}

}  // namespace stridor
