#include "app/report/histories.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/stop_token.hpp"
#include "io/report/sample_coding.hpp"

namespace stridor {
namespace {

/// Series shown where the user names none.
constexpr std::size_t most_series = 12;

/// Bytes of the page that a sample takes: two, of which packing leaves three quarters, in base 64.
constexpr double bytes_per_sample = 2.0;

Json times_json(const RecordedStretch& run) {
  return {{"from", run.first_time()}, {"step", run.interval}, {"count", run.samples.size()}};
}

/// The names behind the numbers of a state, from its attribute `meaning`: "0 open, 1 stick".
Json state_names(const std::string& meaning) {
  Json names = Json::object();
  std::size_t begin = 0;
  while (begin < meaning.size()) {
    const std::size_t end = std::min(meaning.find(',', begin), meaning.size());
    std::string one = meaning.substr(begin, end - begin);
    one.erase(0, one.find_first_not_of(' '));
    if (const std::size_t blank = one.find(' '); blank != std::string::npos)
      names[one.substr(0, blank)] = one.substr(blank + 1);
    begin = end + 1;
  }
  return names;
}

Json series_json(const RecordedStretch& run, const std::string& series, std::size_t factor,
                 ReportPage& page) {
  const auto attributes = run.file.attributes(series);
  Json one = {{"name", channel_name(series)}, {"units", run.file.units(series)}};
  if (const auto found = attributes.find("long_name"); found != attributes.end()) {
    if (const auto* text = std::get_if<std::string>(&found->second)) one["title"] = *text;
  }
  if (const std::string note = filter_note(run.file, series); !note.empty()) one["filter"] = note;
  const std::vector<double> values = run.values(series);
  if (const auto found = attributes.find("meaning"); found != attributes.end()) {
    const auto* text = std::get_if<std::string>(&found->second);
    one["states"] = state_names(text == nullptr ? "" : *text);
    one["samples"] = page.add_bytes(std::vector<unsigned char>(values.begin(), values.end()));
    return one;
  }
  double least = std::numeric_limits<double>::infinity();
  double most = -least;
  std::size_t missing = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) {
      ++missing;
      continue;
    }
    least = std::min(least, value);
    most = std::max(most, value);
  }
  one["min"] = number(least);
  one["max"] = number(most);
  if (missing > 0) one["not_finite"] = missing;
  one["factor"] = factor;
  one["samples"] = page.add_samples(factor == 1 ? values : extremes(values, factor));
  return one;
}

/// Least power of two by which so many samples are to be put together; 1 where all fit.
std::size_t factor_for(double samples, double budget) {
  std::size_t factor = 1;
  // Two numbers of every `factor` samples.
  while (samples * (factor == 1 ? 1.0 : 2.0 / static_cast<double>(factor)) * bytes_per_sample >
         budget)
    factor *= factor == 1 ? 4 : 2;
  return factor;
}

}  // namespace

Json histories_view(const RecordedStretch& run, const ReportContext& context, double budget) {
  std::vector<std::string> shown_series;
  for (const std::string& channel : context.options.channels)
    shown_series.push_back(find_series(run, channel, "--channel"));
  if (shown_series.empty())
    shown_series = chosen_series(run.file, SeriesUse::history, most_series);
  Json view = {{"type", "histories"}, {"time", times_json(run)}, {"series", Json::array()}};
  const double samples =
      static_cast<double>(run.samples.size()) * static_cast<double>(shown_series.size());
  const std::size_t factor =
      context.options.is_full || shown_series.empty() ? 1 : factor_for(samples, budget);
  for (const std::string& series : shown_series) {
    if (stop_requested()) throw Interrupted("nothing has been written");
    view["series"].push_back(series_json(run, series, factor, context.page));
  }
  if (factor > 1) {
    view["note"] = fmt::format(
        "Of every {} samples the least and the largest are here; stridor report --full keeps all.",
        factor);
  }
  Json left_out = Json::array();
  for (const std::string& series : series_by_use(run.file, SeriesUse::history)) {
    if (std::find(shown_series.begin(), shown_series.end(), series) == shown_series.end())
      left_out.push_back(channel_name(series));
  }
  view["left_out"] = left_out;
  return view;
}

Json column_histories(const ResultFile& file, const std::vector<std::string>& columns,
                      const std::vector<double>& times, ReportPage& page) {
  Json view = {{"type", "histories"},
               {"time", {{"values", page.add_numbers(times)}, {"count", times.size()}}},
               {"series", Json::array()}};
  for (const std::string& path : columns) {
    const std::vector<double> values = file.read(path);
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    std::string name = path.substr(1);
    std::replace(name.begin(), name.end(), '/', '.');
    if (name.starts_with("channels.") || name.starts_with("contact.")) name.erase(0, name.find('.') + 1);
    if (path.ends_with("/state")) {
      view["series"].push_back(
          {{"name", name},
           {"units", "1"},
           {"states", {{"0", "open"}, {"1", "stick"}, {"2", "slip"}}},
           {"samples", page.add_bytes(std::vector<unsigned char>(values.begin(), values.end()))}});
      continue;
    }
    view["series"].push_back({{"name", name},
                              {"units", file.array(path).units},
                              {"min", number(values.empty() ? 0.0 : *least)},
                              {"max", number(values.empty() ? 0.0 : *most)},
                              {"factor", 1},
                              {"samples", page.add_samples(values)}});
  }
  view["left_out"] = Json::array();
  return view;
}

}  // namespace stridor
