// Results of a sweep of transients, as file, picture and text.
#pragma once

#include <string>
#include <vector>

#include "app/runs/sweep.hpp"
#include "app/terminal/command.hpp"
#include "core/refusals.hpp"
#include "io/scene/scene_family.hpp"

namespace stridor {

/// The transient at one value of a sweep.
// NOLINTNEXTLINE(bugprone-exception-escape): the moves of Json are declared not to throw.
struct SweptTransient {
  double value = 0.0;
  Json results;
  std::string failure;                  ///< why it ended early, or did not start
  Refusal refusal = Refusal::diverged;  ///< its kind

  /// Both, or "" where it came to its end.
  std::string reason() const { return failure.empty() ? "" : with_code(failure, refusal); }
  /// A number among the results; NaN where there is none.
  double number_at(const char* pointer) const { return pointed_number(results, pointer); }
  /// Whether bursts were searched for in it.
  bool has_bursts() const { return results.contains("bursts") && results["bursts"].is_array(); }
  /// The burst of the highest peak; null where there is none.
  Json largest_burst() const {
    Json largest;
    if (!has_bursts()) return largest;
    for (const Json& burst : results["bursts"]) {
      if (largest.is_null() || burst["peak"].get<double>() > largest["peak"].get<double>())
        largest = burst;
    }
    return largest;
  }
};

/// In ascending order of the value.
using SweptTransients = std::vector<SweptTransient>;

/// Writes the results of every transient and all bursts as columns.
void write_swept(const SweepOptions& options, const LoadedScene& loaded, const NumericKey& key,
                 const SweptTransients& points);
/// Draws acceleration, bursts and contact force over the key.
void draw_swept(const SweepOptions& options, const LoadedScene& loaded, const NumericKey& key,
                const SweptTransients& points);
/// A line for every transient, and why some have failed.
void print_swept(const NumericKey& key, const SweptTransients& points);
/// The same as a list.
Json json_of_swept(const SweptTransients& points);

}  // namespace stridor
