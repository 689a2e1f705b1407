#include "app/runs/error_estimate.hpp"

#include <array>
#include <chrono>
#include <limits>
#include <memory>

#include "app/runs/run_keeping.hpp"

namespace stridor {

ErrorEstimate estimate_error(const StudiedScene& study,
                             const std::function<void(double)>& on_progress) {
  const auto start = std::chrono::steady_clock::now();
  TimeParameters own = *study.loaded.scene.time;
  own.coordinates = Coordinates::modal;  // the published forms make the same numbers
  TimeParameters finer = own;
  finer.integrator = Integrator::exact;
  finer.retain.reset();
  finer.step = 0.5 * own.step;

  const auto run_of = [&](const TimeParameters& time) {
    return std::make_unique<TimedRun>(study.model.system, time, study.observed, study.interval,
                                      study.num_samples);
  };
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  ErrorEstimate estimate;
  estimate.errors = {unknown, unknown, unknown};
  estimate.step = finer.step;
  const std::array runs{run_of(own), run_of(finer)};
  constexpr int turns = 100;
  for (int turn = 1; turn <= turns; ++turn) {
    for (const auto& run : runs) {
      if (run->run_until(study.num_samples * turn / turns) != MarchEnd::finished) {
        estimate.failure = run->failure().empty() ? "stopped on request"
                                                  : with_code(run->failure(), run->refusal());
        estimate.seconds = seconds_since(start);
        return estimate;
      }
    }
    on_progress(static_cast<double>(turn) / turns);
  }
  estimate.errors = ReferenceRun(runs[1]->samples(), study.norms).errors_of(runs[0]->samples());
  estimate.seconds = seconds_since(start);
  return estimate;
}

}  // namespace stridor
