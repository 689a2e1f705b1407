// Of results that are curves and fields: sweeps, cycles, frequency responses, spectrograms, contacts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/report/histories.hpp"
#include "core/errors.hpp"

namespace stridor {
namespace {

/// A column of curves or a table.
Json column_json(const ResultFile& file, const std::string& path, ReportPage& page) {
  return {{"name", path.substr(path.rfind('/') + 1)},
          {"units", file.array(path).units},
          {"values", page.add_numbers(file.read(path))}};
}

/// Curves of all columns of a group over one of them.
Json curves_of_group(const ResultFile& file, const std::string& group, const std::string& over,
                     ReportPage& page) {
  const std::string x = group + "/" + over;
  Json view = {{"type", "curves"}, {"x", column_json(file, x, page)}, {"panels", Json::array()}};
  const std::size_t count = file.array(x).shape.front();
  for (const std::string& name : file.names_in(group)) {
    const std::string path = group + "/" + name;
    if (name == over || !file.has(path)) continue;
    const ResultArray& array = file.array(path);
    if (array.shape.size() != 1 || array.shape.front() != count) continue;
    view["panels"].push_back({{"curves", Json::array({column_json(file, path, page)})}});
  }
  return view;
}

}  // namespace

Json sweep_section(const ResultFile& file, const ReportContext& context) {
  Json section = section_head(file, file.kind());
  section["remarks"] = Json::array();
  std::vector<std::string> groups;
  if (file.has("/value")) {
    groups.emplace_back("");
  } else {
    for (const std::string& name : file.names_in(""))
      if (file.has("/" + name + "/value")) groups.push_back("/" + name);
  }
  if (groups.empty()) throw FileError(Refusal::file_damaged, file.path(), "/value", "is missing");
  std::size_t points = 0;
  for (const std::string& group : groups) {
    Json view = curves_of_group(file, group, "value", context.page);
    view["x"]["name"] = file.text("parameter");
    if (!group.empty()) view["title"] = group.substr(1);
    const std::vector<std::string> reasons = file.texts(group + "/reason");
    const std::vector<double> values = file.read(group + "/value");
    for (std::size_t i = 0; i < std::min(reasons.size(), values.size()); ++i) {
      if (reasons[i].empty()) continue;
      section["remarks"].push_back(
          fmt::format("{} = {:g} failed: {}", file.text("parameter"), values[i], reasons[i]));
    }
    view["table"] = true;
    points += file.array(group + "/value").shape.front();
    section["views"].push_back(std::move(view));
  }
  std::string text = fmt::format("{} values of {}", points, file.text("parameter"));
  std::string level = "told";
  if (file.has("/failed")) {
    const std::vector<double> failed = file.read("/failed");
    const auto num_failed = std::count_if(failed.begin(), failed.end(), [](double f) { return f != 0.0; });
    if (num_failed > 0) {
      text += fmt::format(", of which {} failed", num_failed);
      level = "failed";
    }
  }
  if (file.has("/bursts/value") && !file.read("/bursts/value").empty()) {
    Json view = curves_of_group(file, "/bursts", "value", context.page);
    view["x"]["name"] = file.text("parameter");
    view["title"] = "bursts of all runs";
    view["points"] = true;
    section["views"].push_back(std::move(view));
    text += fmt::format("; {} bursts of vibration", file.array("/bursts/value").shape.front());
    if (level == "told") level = "loud";
  }
  section["verdict"] = verdict(level, text + ".");
  return section;
}

Json cycle_section(const ResultFile& file, const ReportContext& context) {
  Json section = section_head(file, "limit cycle");
  const std::vector<double> times = file.read("/time");
  std::vector<std::string> columns;
  for (const ResultArray& array : file.arrays()) {
    if (array.path != "/time" && array.shape.size() == 1 && array.shape.front() == times.size())
      columns.push_back(array.path);
  }
  const double period = times.empty() ? 0.0 : times.back() - times.front();
  section["verdict"] = verdict(
      "told", period > 0.0 ? fmt::format("One period of {}, {}.", shown(period, "s"),
                                         shown(1.0 / period, "Hz"))
                           : "One period.");
  section["views"].push_back(column_histories(file, columns, times, context.page));
  const auto of = [&](const char* end) {
    return std::find_if(columns.begin(), columns.end(),
                        [&](const std::string& path) { return path.ends_with(end); });
  };
  const auto place = of("displacement");
  auto speed = of("velocity");
  if (place != columns.end() && speed != columns.end()) {
    section["views"].push_back({{"type", "curves"},
                                {"title", "one against the other"},
                                {"x", column_json(file, *place, context.page)},
                                {"panels", Json::array({{{"curves", Json::array({column_json(
                                                                        file, *speed, context.page)})}}})}});
  }
  return section;
}

Json response_section(const ResultFile& file, const ReportContext& context) {
  Json section = section_head(file, "frequency responses");
  section["remarks"] = Json::array();
  const std::vector<double> frequencies = file.read("/frequency");
  Json magnitude = {{"title", "magnitude"}, {"log", true}, {"curves", Json::array()}};
  Json phase = {{"title", "phase"}, {"curves", Json::array()}};
  std::size_t count = 0;
  double peak = 0.0;
  double at = 0.0;
  std::string peak_units;
  for (const std::string& output : file.names_in("/responses")) {
    for (const std::string& input : file.names_in("/responses/" + output)) {
      const std::string group = "/responses/" + output + "/" + input;
      const std::vector<double> real = file.read(group + "/real");
      const std::vector<double> imaginary = file.read(group + "/imaginary");
      if (real.size() != frequencies.size() || imaginary.size() != frequencies.size())
        throw FileError(Refusal::file_damaged, file.path(), group,
                        "is unlike /frequency in length");
      std::vector<double> size;
      std::vector<double> angle;
      for (std::size_t i = 0; i < real.size(); ++i) {
        size.push_back(std::hypot(real[i], imaginary[i]));
        angle.push_back(std::atan2(imaginary[i], real[i]) * 180.0 / std::acos(-1.0));
        if (size.back() > peak) {
          peak = size.back();
          at = frequencies[i];
          peak_units = file.array(group + "/real").units;
        }
      }
      const std::string name = output + " per force at " + input;
      if (const auto truncation = file.number(group + "/truncation")) {
        section["remarks"].push_back(fmt::format(
            "{}: off by {:.2g} with the modes that a run keeps (time.retain)", name, *truncation));
      }
      magnitude["curves"].push_back({{"name", name},
                                     {"units", file.array(group + "/real").units},
                                     {"values", context.page.add_numbers(size)}});
      phase["curves"].push_back(
          {{"name", name}, {"units", "deg"}, {"values", context.page.add_numbers(angle)}});
      ++count;
    }
  }
  section["verdict"] = verdict(
      "told", count == 0 ? "No responses."
                         : fmt::format("{} {} from {} to {}; the largest is {:.4g} {} at {}.", count,
                                       count == 1 ? "response" : "responses",
                                       shown(frequencies.front(), "Hz"), shown(frequencies.back(), "Hz"),
                                       peak, peak_units, shown(at, "Hz")));
  section["views"].push_back(
      {{"type", "curves"},
       {"x", {{"name", "frequency"}, {"units", "Hz"}, {"values", context.page.add_numbers(frequencies)}}},
       {"panels", Json::array({magnitude, phase})}});
  return section;
}

Json spectrogram_section(const ResultFile& file, const ReportContext& context) {
  Json section = section_head(file, "spectrogram");
  const std::vector<double> times = file.read("/times");
  const std::vector<double> frequencies = file.read("/frequencies");
  const std::vector<double> amplitude = file.read("/amplitude", 2);
  if (amplitude.size() != times.size() * frequencies.size() || frequencies.empty())
    throw FileError(Refusal::file_damaged, file.path(), "/amplitude",
                    "is unlike /times and /frequencies in extent");
  const Eigen::Map<const Eigen::MatrixXd> levels(amplitude.data(),
                                                 static_cast<Eigen::Index>(frequencies.size()),
                                                 static_cast<Eigen::Index>(times.size()));
  Json view = levels_view(times, frequencies, levels, frequencies.back(),
                          file.array("/amplitude").units, context.page);
  view["channel"] = file.text("channel");
  view["caption"] = "";
  section["verdict"] = verdict(
      "told", fmt::format("Levels of {} over time and frequency.", file.text("channel")));
  section["views"].push_back(std::move(view));
  return section;
}

Json contact_section(const ResultFile& file, const ReportContext& context) {
  Json section = section_head(file, "sliding contacts");
  const bool has_speed = file.has("/rows/speed");
  if (has_speed) {
    Json view = curves_of_group(file, "/rows", "speed", context.page);
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
         {"x", {{"name", "x"}, {"units", "m"}, {"values", context.page.add_numbers(file.read(group + "/x"))}}},
         {"y", {{"name", "y"}, {"units", "m"}, {"values", context.page.add_numbers(file.read(group + "/y"))}}},
         {"value", {{"name", "pressure"},
                    {"units", "Pa"},
                    {"values", context.page.add_numbers(file.read(group + "/pressure", 2))}}},
         {"scale", "linear"},
         {"lines", lines}});
  }
  section["verdict"] = verdict(
      "told", fmt::format("{} sliding {} on a viscoelastic half-space.", contacts.size(),
                          contacts.size() == 1 ? "contact" : "contacts"));
  return section;
}

}  // namespace stridor
