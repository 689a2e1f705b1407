#include "app/results/step_stability_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/results/body_report.hpp"
#include "app/terminal/progress.hpp"
#include "core/activity.hpp"
#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "solvers/integrators/make_propagator.hpp"

namespace stridor {
namespace {

const char* text_of(StepVerdict verdict) {
  switch (verdict) {
    case StepVerdict::stable:
      return "stable";
    case StepVerdict::bodies_grow:
      return "grows as in the bodies";
    case StepVerdict::step_grows:
      return "grows by the step";
    case StepVerdict::no_equilibrium:
      return "no sliding equilibrium";
  }
  return "";
}

std::vector<PathStability>::const_iterator worst_of(const std::vector<PathStability>& path) {
  return std::max_element(path.begin(), path.end(),
                          [](const PathStability& a, const PathStability& b) {
                            const auto rank = [](const PathStability& place) {
                              const bool grows = place.stability.verdict == StepVerdict::step_grows;
                              return grows ? place.stability.growth : 0.0;
                            };
                            return rank(a) < rank(b);
                          });
}

std::size_t num_with(const StepStabilityReport& report, StepVerdict verdict) {
  return static_cast<std::size_t>(std::count_if(
      report.path.begin(), report.path.end(),
      [&](const PathStability& place) { return place.stability.verdict == verdict; }));
}

std::string growth_text(const std::optional<double>& growth) {
  return growth ? fmt::format("{:.6g}", *growth) : "-";
}

}  // namespace

bool StepStabilityReport::steps_grow() const {
  return num_with(*this, StepVerdict::step_grows) > 0;
}

StepStabilityReport check_step_stability(const Model& model, const TimeParameters& time,
                                         int num_places) {
  const System& system = model.system;
  if (std::any_of(system.contacts.begin(), system.contacts.end(),
                  [](const ContactPoint& contact) { return contact.substrate.has_value(); })) {
    throw ConfigError(Refusal::contradiction, "--stability",
                      "takes contacts that a constraint closes; the step of a contact with a "
                      "substrate has no frozen form");
  }
  StepStabilityReport report;
  report.time = time;
  report.limit = step_limit(system, time).step;
  report.matrix_bodies = matrix_bodies_json(model);
  Progress progress("check");
  report.path = stability_along_path(system, time, num_places, [&](int place) {
    if (stop_requested()) throw Interrupted("the check is not complete");
    progress.report(static_cast<double>(place) / num_places,
                    fmt::format("place {} of {}", place + 1, num_places));
  });
  progress.finish();
  const Activity seeking("a step that would be stable");
  if (report.steps_grow())
    report.stable_step = stable_step(system, time, worst_of(report.path)->contacts);
  return report;
}

Json step_stability_json(const StepStabilityReport& report) {
  Json object = {{"step", report.time.step},
                 {"step_limit", number(report.limit)},
                 {"steps_grow", report.steps_grow()},
                 {"stable_step", report.stable_step ? Json(*report.stable_step) : Json()},
                 {"matrix_bodies", report.matrix_bodies},
                 {"places", Json::array()}};
  for (const PathStability& place : report.path) {
    const StepStability& stability = place.stability;
    Json row = {{"drive_displacement", place.drive_displacement},
                {"positions", place.positions},
                {"verdict", text_of(stability.verdict)}};
    if (stability.verdict == StepVerdict::no_equilibrium) {
      row["failure"] = place.failure;
    } else {
      row["radius"] = number(stability.radius);
      row["growth"] = number(stability.growth);
      row["frequency"] = stability.frequency;
      row["growth_of_bodies"] = number_or_null(stability.growth_of_bodies);
    }
    object["places"].push_back(row);
  }
  return object;
}

void print_step_stability(const StepStabilityReport& report) {
  if (report.time.integrator == Integrator::central_difference) {
    fmt::print("step {:.6g} s, largest stable step of the bodies {:.6g} s\n", report.time.step,
               report.limit);
  } else {
    fmt::print("step {:.6g} s; the bodies by themselves are stable at every step\n",
               report.time.step);
  }
  fmt::print("{:>12} {:>14} {:>13} {:>13} {:>15}  {}\n", "position, m", "radius - 1", "growth, 1/s",
             "frequency, Hz", "of bodies, 1/s", "verdict");
  for (const PathStability& place : report.path) {
    const StepStability& stability = place.stability;
    const std::string position =
        place.positions.empty() ? "-" : fmt::format("{:.6g}", place.positions.front());
    if (stability.verdict == StepVerdict::no_equilibrium) {
      fmt::print("{:>12} {:>14} {:>13} {:>13} {:>15}  {}: {}\n", position, "-", "-", "-", "-",
                 text_of(stability.verdict), place.failure);
      continue;
    }
    fmt::print("{:>12} {:>14.4g} {:>13.6g} {:>13.6g} {:>15}  {}\n", position,
               stability.radius - 1.0, stability.growth, stability.frequency,
               growth_text(stability.growth_of_bodies), text_of(stability.verdict));
  }
  const std::size_t by_step = num_with(report, StepVerdict::step_grows);
  const std::size_t by_bodies = num_with(report, StepVerdict::bodies_grow);
  if (by_step == 0) {
    fmt::print("the step adds no growth of its own\n");
  } else if (report.stable_step) {
    fmt::print("at {} of {} places the step adds growth of its own; take time.step: {:.4g}\n",
               by_step, report.path.size(), *report.stable_step);
  } else {
    fmt::print("at {} of {} places the step adds growth of its own, and at a hundredth of it too\n",
               by_step, report.path.size());
  }
  if (by_bodies > 0) {
    fmt::print("at {} of {} places the sliding itself is unstable (stridor eig, locus)\n",
               by_bodies, report.path.size());
  }
}

}  // namespace stridor
