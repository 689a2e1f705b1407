// Steps of random bodies in contact, and whether they grow by themselves.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "analysis/step_guard.hpp"
#include "core/errors.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/integrators/make_propagator.hpp"
#include "tests/support/random_bodies.hpp"

namespace stridor::test {

/// What the eigenvalues say of a step.
enum class StepTruth {
  jams,
  harmless,   ///< no motion grows by a tenth until the end
  bodies,     ///< every motion that does is, within a tenth of |s| and a quarter of its growth, one
              ///< of the bodies
  by_itself,  ///< more motions grow than in the bodies
  between,    ///< the bodies grow, but otherwise
};

/// By the dense eigenvalues of the step and of the bodies.
inline StepTruth truth_of(const System& system, const TimeParameters& time, const Pencil& rows) {
  std::vector<std::complex<double>> of_bodies;
  std::vector<std::complex<double>> of_step;
  try {
    for (const std::complex<double> z : FrozenStep(system, time).factors(rows)) {
      const bool grows = std::log(std::abs(z)) * time.end > 0.1 * time.step;
      if (grows && z.imag() >= 0.0) of_step.push_back(std::log(z) / time.step);
    }
    for (const Eigenvalue& one : dense_eigenvalues(rows))
      // Beyond the rounding of undamped bodies.
      if (one.s.real() > 1e-9 * std::abs(one.s) && one.s.imag() >= 0.0) of_bodies.push_back(one.s);
  } catch (const NumericalError&) {
    return StepTruth::jams;
  }
  if (of_step.empty()) return StepTruth::harmless;
  if (of_step.size() > of_bodies.size()) return StepTruth::by_itself;
  for (const std::complex<double> s : of_step) {
    const auto same = std::find_if(of_bodies.begin(), of_bodies.end(), [&](auto other) {
      return std::abs(s - other) < 0.1 * std::abs(s) &&
             std::abs(s.real() - other.real()) < 0.25 * s.real();
    });
    if (same == of_bodies.end()) return StepTruth::between;
    of_bodies.erase(same);
  }
  return StepTruth::bodies;
}

/// How many random cases there were, and what was said of them.
struct StepGrowthCases {
  int cases = 0;
  int harmless = 0;
  int bodies = 0;
  int by_itself = 0;
  int between = 0;
  std::vector<std::string> missed;
  std::vector<std::string> refused;         ///< wrongly
  std::vector<std::string> without_remedy;  ///< that grow by themselves at a hundredth of the step

  void add(const System& system, const TimeParameters& time, const std::string& name) {
    const std::vector<HeldContacts> held = held_contacts(system, time);
    if (held.size() != 1) {
      missed.push_back(name + ": " + std::to_string(held.size()) + " states");
      return;
    }
    const StepTruth truth = truth_of(system, time, held.front().rows);
    if (truth == StepTruth::jams) return;
    ++cases;
    const bool is_refused = own_growth(system, time, held).has_value();
    switch (truth) {
      case StepTruth::harmless:
        ++harmless;
        break;
      case StepTruth::bodies:
        ++bodies;
        break;
      case StepTruth::by_itself:
        ++by_itself;
        if (!is_refused) missed.push_back(name);
        check_remedy(system, time, held, name);
        return;
      default:
        ++between;
        return;
    }
    if (is_refused) refused.push_back(name);
  }

  void check_remedy(const System& system, const TimeParameters& time,
                    const std::vector<HeldContacts>& held, const std::string& name) {
    const StepRemedy remedy = step_remedy(system, time, held);
    if (remedy.is_empty()) without_remedy.push_back(name);
    const auto check = [&](const TimeParameters& other) {
      if (truth_of(system, other, held.front().rows) == StepTruth::by_itself)
        missed.push_back(name + " with its remedy");
    };
    TimeParameters other = time;
    if (remedy.retained) {
      other.retain = RetainParameters{*remedy.retained, {}};
      check(other);
    }
    other = time;
    if (remedy.with_central_difference) other.integrator = Integrator::central_difference;
    if (remedy.with_all_modes || remedy.with_central_difference) other.retain.reset();
    for (const auto& step : {remedy.step, remedy.with_all_modes, remedy.with_central_difference}) {
      if (!step) continue;
      other.step = *step;
      check(other);
    }
  }

  std::string summary() const {
    std::string text = std::to_string(cases) + " cases: " + std::to_string(harmless) +
                       " harmless, " + std::to_string(bodies) + " as the bodies, " +
                       std::to_string(by_itself) + " by the step (" +
                       std::to_string(without_remedy.size()) + " without remedy), " +
                       std::to_string(between) + " between";
    for (const std::string& one : missed) text += "\nmissed: " + one;
    for (const std::string& one : refused) text += "\nrefused: " + one;
    return text;
  }
};

/// For `end` of so many steps.
inline TimeParameters steps_of(Integrator integrator, double step) {
  TimeParameters time;
  time.integrator = integrator;
  time.step = step;
  time.end = 1e4 * step;
  return time;
}

/// Friction at one contact or two, damped or not, both schemes, with and without modes left out.
inline StepGrowthCases uncoupled_cases(unsigned first, unsigned last) {
  StepGrowthCases found;
  for (unsigned seed = first; seed < last; ++seed) {
    for (const int num_points : {1, 2}) {
      const bool is_damped = seed % 2 == 0;
      const double friction = seed % 3 == 0 ? 0.6 : 0.3;
      const System system = random_sliding_bodies(seed, friction, is_damped, num_points);
      const double limit = step_limit(system).step;
      const double lowest =
          std::min(system.bodies[0].modal.omega(0), system.bodies[1].modal.omega(0));
      const auto add = [&](TimeParameters time, double cutoff) {
        if (cutoff > 0.0) {
          time.retain = RetainParameters{cutoff * lowest / (2.0 * std::numbers::pi), {}};
          if (time.step > step_limit(system, time).step) return;
        }
        found.add(system, time,
                  "seed " + std::to_string(seed) + ", " + std::to_string(num_points) + " points, " +
                      (time.integrator == Integrator::exact ? "exact " : "central ") +
                      std::to_string(time.step / limit) + ", cutoff " + std::to_string(cutoff));
      };
      for (const double share : {0.1, 0.5, 0.9, 0.999})
        add(steps_of(Integrator::central_difference, share * limit), 0.0);
      for (const double share : {0.1, 0.5, 1.0, 2.0, 5.0})
        add(steps_of(Integrator::exact, share * limit), 0.0);
      add(steps_of(Integrator::exact, 0.7 * limit), 3.0);
      add(steps_of(Integrator::central_difference, 0.7 * limit), 3.0);
    }
  }
  return found;
}

/// Damped gyroscopic bodies and circulatory ones, with and without friction.
inline StepGrowthCases coupled_cases(unsigned first, unsigned last) {
  StepGrowthCases found;
  for (unsigned seed = first; seed < last; ++seed) {
    const double friction = seed % 2 == 0 ? 0.3 : 0.0;
    const RandomCoupling coupling{
        .gyroscopic = 0.5, .damper = 0.1, .circulatory = seed % 3 == 0 ? 0.2 : 0.0};
    const System system =
        with_coupling(random_sliding_bodies(seed, friction, true), seed, coupling);
    for (const double turn : {0.3, 1.0, 1.5, 1.99}) {
      found.add(system, steps_of(Integrator::exact, turn / fastest_motion(system)),
                "coupled, seed " + std::to_string(seed) + ", turn " + std::to_string(turn));
    }
  }
  return found;
}

}  // namespace stridor::test
