#include "app/runs/heard_windows.hpp"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "app/stability/prediction.hpp"

namespace stridor {
namespace {

/// An index as any reader of HDF5 can take it.
double index_or_none(const std::optional<std::size_t>& index) {
  return index ? static_cast<double>(*index) : -1.0;
}

void store_windows(RunFileWriter& writer, const std::vector<PredictedBurst>& predictions) {
  const auto store = [&](const std::string& name, const char* units, const auto& value_of) {
    std::vector<double> values;
    values.reserve(predictions.size());
    for (const PredictedBurst& one : predictions) values.push_back(value_of(one));
    writer.write_static({"/windows/" + name, std::move(values), units});
  };
  store("from", "s", [](const PredictedBurst& one) { return one.window.from_time; });
  store("to", "s", [](const PredictedBurst& one) { return one.window.to_time; });
  store("frequency", "Hz", [](const PredictedBurst& one) { return one.window.window.frequency; });
  store("growth_max", "1/s",
        [](const PredictedBurst& one) { return one.window.window.growth_max; });
  store("gain", "1", [](const PredictedBurst& one) { return one.window.gain; });
  store("burst", "1", [](const PredictedBurst& one) {
    return index_or_none(one.burst ? std::optional(one.burst->number - 1) : std::nullopt);
  });
}

void store_harmonics(RunFileWriter& writer, const std::vector<Burst>& bursts) {
  std::vector<double> of, orders;
  for (const Burst& burst : bursts) {
    of.push_back(index_or_none(burst.harmonic ? std::optional(burst.harmonic->of) : std::nullopt));
    orders.push_back(burst.harmonic ? burst.harmonic->order : 1);
  }
  writer.write_static({"/bursts/harmonic_of", std::move(of), "1"});
  writer.write_static({"/bursts/order", std::move(orders), "1"});
}

/// The courses one behind the other, every point with the index of its burst.
void store_courses(RunFileWriter& writer, const std::vector<Burst>& bursts) {
  std::vector<double> indices, times, frequencies, levels;
  for (std::size_t i = 0; i < bursts.size(); ++i) {
    for (const BurstPoint& point : bursts[i].course) {
      indices.push_back(static_cast<double>(i));
      times.push_back(point.time);
      frequencies.push_back(point.frequency);
      levels.push_back(point.level);
    }
  }
  if (indices.empty()) return;
  writer.write_static({"/bursts/course/burst", std::move(indices), "1"});
  writer.write_static({"/bursts/course/time", std::move(times), "s"});
  writer.write_static({"/bursts/course/frequency", std::move(frequencies), "Hz"});
  writer.write_static({"/bursts/course/level", std::move(levels), "m/s^2"});
}

}  // namespace

void store_bursts(RunFileWriter& writer, const std::vector<Burst>& bursts) {
  if (bursts.empty()) return;
  const std::vector<std::tuple<const char*, double Burst::*, const char*>> properties{
      {"start", &Burst::start, "s"},
      {"end", &Burst::end, "s"},
      {"frequency", &Burst::frequency, "Hz"},
      {"peak", &Burst::peak, "m/s^2"},
      {"gain", &Burst::gain, "1"},
      {"start_frequency", &Burst::start_frequency, "Hz"},
      {"end_frequency", &Burst::end_frequency, "Hz"}};
  for (const auto& [name, member, units] : properties) {
    std::vector<double> values;
    values.reserve(bursts.size());
    for (const Burst& burst : bursts) values.push_back(burst.*member);
    writer.write_static({std::string("/bursts/") + name, std::move(values), units});
  }
  store_harmonics(writer, bursts);
  store_courses(writer, bursts);
}

void store_heard_windows(RunFileWriter& writer, const std::vector<TimedWindow>& windows,
                         const std::vector<Burst>& bursts, Json& results) {
  std::vector<NumberedBurst> numbered;
  numbered.reserve(bursts.size());
  for (const Burst& burst : bursts) numbered.push_back({numbered.size() + 1, burst});
  const std::vector<PredictedBurst> predictions = match_bursts(windows, numbered);
  const auto explained_by = windows_of(predictions, numbered);

  if (!predictions.empty()) store_windows(writer, predictions);
  if (!bursts.empty()) {
    std::vector<double> indices;
    indices.reserve(bursts.size());
    for (const auto& index : explained_by) indices.push_back(index_or_none(index));
    writer.write_static({"/bursts/window", std::move(indices), "1"});
  }
  results["prediction"] = prediction_json(predictions);
  results["unexplained"] = unexplained(predictions, numbered);
  for (std::size_t i = 0; i < bursts.size(); ++i)
    results["bursts"][i]["window"] = explained_by[i] ? Json(*explained_by[i] + 1) : Json(nullptr);
}

void print_heard_windows(const Json& results) {
  if (!results.contains("prediction")) return;
  if (results["prediction"].is_null()) {
    fmt::print("{:<24}not compared, no acceleration was recorded in the window of `measure`\n",
               "windows predicted");
    return;
  }
  if (results["prediction"].empty()) fmt::print("{:<24}none\n", "windows predicted");
  for (const Json& row : results["prediction"]) {
    const std::string heard =
        row["burst"].is_null() ? "not heard" : fmt::format("burst {}", row["burst"].get<int>());
    const std::string gain =
        row["gain"].is_null() ? "-" : fmt::format("{:.2f}", row["gain"].get<double>());
    fmt::print("{:<24}{:.3f} to {:.3f} s, {:.0f} Hz, gain {}: {}\n", "window predicted",
               row["from"].get<double>(), row["to"].get<double>(), row["frequency"].get<double>(),
               gain, heard);
  }
  const auto others = results["unexplained"].get<std::vector<std::size_t>>();
  if (!others.empty()) fmt::print("{:<24}{}\n", "unexplained", unexplained_text(others));
}

}  // namespace stridor
