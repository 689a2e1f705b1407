#include "app/stability/prediction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/errors.hpp"
#include "io/results/result_file.hpp"
#include "io/scene/scene_family.hpp"

namespace stridor {

std::vector<TimedWindow> read_predictions(const std::string& file, const SceneInFile& of_run,
                                          double highest_burst) {
  const std::string parameter = read_locus_parameter(file);
  if (!parameter.empty() && !parameter.ends_with(".start") &&
      parameter != drive_displacement_name) {
    throw ConfigError(
        Refusal::wrong_value, "--predict",
        fmt::format("'{}' is a locus over {}, which a run does not pass through; give "
                    "one over the contact position (`locus` without --parameter)",
                    file, parameter));
  }
  std::vector<TimedWindow> windows = read_locus_windows(file);
  const ResultFile locus(file);
  const SceneInFile of_locus{locus.text("scene_hash"), locus.text("scene_resolved")};
  // Another program's file may not say of which scene it is.
  std::vector<Problem> warnings;
  if (!of_locus.hash.empty() && !has_same_mechanics(of_locus, of_run))
    warnings.push_back({Refusal::contradiction, "--predict",
                        fmt::format("'{}' is of another scene ({} instead of {}): other bodies, "
                                    "contacts, drives or terms, whose windows may be elsewhere",
                                    file, of_locus.hash, of_run.hash)});
  // A file of an earlier version does not say how far it looked.
  constexpr double unknown = std::numeric_limits<double>::infinity();
  const double highest = locus.told("highest_frequency").value_or(unknown);
  const double needed = std::min(highest_burst, locus.told("trusted_frequency").value_or(unknown));
  if (highest < needed)
    warnings.push_back(
        {Refusal::contradiction, "--predict",
         fmt::format(
             "'{}' looked up to {:.6g} Hz alone, bursts are sought up to {:.6g} Hz: windows "
             "between are not in it; `locus --below {:.0f}` finds them",
             file, highest, highest_burst, std::ceil(needed))});
  print_warnings(warnings);
  return windows;
}

std::vector<PredictedBurst> match_bursts(const std::vector<TimedWindow>& windows,
                                         const std::vector<NumberedBurst>& bursts) {
  constexpr double largest_delay = 0.05;  // s
  constexpr double frequency_tolerance = 0.02;
  std::vector<PredictedBurst> predictions;
  std::vector<double> overlaps;  // of each window with its burst, s
  for (const TimedWindow& window : windows) {
    if (!std::isfinite(window.from_time) || !std::isfinite(window.to_time)) continue;
    PredictedBurst prediction{window, std::nullopt};
    double best = -largest_delay;
    for (const NumberedBurst& one : bursts) {
      const double overlap =
          std::min(window.to_time, one.burst.end) - std::max(window.from_time, one.burst.start);
      const double off = std::abs(one.burst.frequency - window.window.frequency);
      if (overlap > best && off <= frequency_tolerance * window.window.frequency) {
        best = overlap;
        prediction.burst = one;
      }
    }
    predictions.push_back(prediction);
    overlaps.push_back(best);
  }
  // A burst belongs to the one window that it overlaps most.
  for (std::size_t i = 0; i < predictions.size(); ++i) {
    for (std::size_t k = 0; k < predictions.size() && predictions[i].burst; ++k) {
      const bool is_same = predictions[k].burst && k != i &&
                           predictions[k].burst->number == predictions[i].burst->number;
      if (is_same && (overlaps[k] > overlaps[i] || (overlaps[k] == overlaps[i] && k < i)))
        predictions[i].burst.reset();
    }
  }
  return predictions;
}

std::vector<std::optional<std::size_t>> windows_of(const std::vector<PredictedBurst>& predictions,
                                                   const std::vector<NumberedBurst>& bursts) {
  std::vector<std::optional<std::size_t>> windows(bursts.size());
  for (std::size_t k = 0; k < bursts.size(); ++k) {
    for (std::size_t i = 0; i < predictions.size(); ++i) {
      const auto& burst = predictions[i].burst;
      if (burst && burst->number == bursts[k].number) windows[k] = i;
    }
  }
  return windows;
}

std::vector<std::size_t> unexplained(const std::vector<PredictedBurst>& predictions,
                                     const std::vector<NumberedBurst>& bursts) {
  const auto windows = windows_of(predictions, bursts);
  std::vector<std::size_t> numbers;
  for (std::size_t k = 0; k < bursts.size(); ++k)
    if (!windows[k] && !bursts[k].burst.harmonic) numbers.push_back(bursts[k].number);
  return numbers;
}

std::string unexplained_text(const std::vector<std::size_t>& numbers) {
  std::string text;
  for (std::size_t first = 0; first < numbers.size();) {
    std::size_t last = first;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    text += fmt::format("{}{}", text.empty() ? "" : ", ", numbers[first]);
    if (last > first) text += fmt::format("{}{}", last == first + 1 ? ", " : " to ", numbers[last]);
    first = last + 1;
  }
  return numbers.size() == 1 ? fmt::format("burst {} belongs to no window", text)
                             : fmt::format("bursts {} belong to no window", text);
}

std::vector<SpectrogramMark> predicted_marks(const std::vector<PredictedBurst>& predictions) {
  std::vector<SpectrogramMark> marks;
  for (const PredictedBurst& prediction : predictions) {
    SpectrogramMark mark;
    mark.from = prediction.window.from_time;
    mark.to = prediction.window.to_time;
    mark.frequency = prediction.window.window.frequency;
    mark.style = MarkStyle::predicted;
    marks.push_back(std::move(mark));
  }
  return marks;
}

Json prediction_json(const std::vector<PredictedBurst>& predictions) {
  Json rows = Json::array();
  for (const auto& [timed, burst] : predictions) {
    Json row = {{"from", timed.from_time},
                {"to", timed.to_time},
                {"frequency", timed.window.frequency},
                {"growth_max", timed.window.growth_max},
                {"value_max", timed.window.value_max},
                {"gain", number(timed.gain)},
                {"burst", nullptr},
                {"burst_start", nullptr},
                {"burst_frequency", nullptr},
                {"burst_gain", nullptr}};
    if (burst) {
      row["burst"] = burst->number;
      row["burst_start"] = burst->burst.start;
      row["burst_frequency"] = burst->burst.frequency;
      row["burst_gain"] = number(burst->burst.gain);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

void print_prediction(const std::vector<PredictedBurst>& predictions) {
  fmt::print("{:>20}  {:>12} {:>8}   {:>5} {:>9}  {:>12} {:>8}\n", "predicted, s", "Hz", "gain",
             "burst", "from, s", "Hz", "gain");
  for (const auto& [timed, burst] : predictions) {
    fmt::print("{:>9.4f} to {:>7.4f}  {:>12.2f} {:>8.3f}   ", timed.from_time, timed.to_time,
               timed.window.frequency, timed.gain);
    if (burst) {
      fmt::print("{:>5} {:>9.4f}  {:>12.2f} {:>8.3f}\n", burst->number, burst->burst.start,
                 burst->burst.frequency, burst->burst.gain);
    } else {
      fmt::print("{:>5}\n", "-");
    }
  }
}

}  // namespace stridor
