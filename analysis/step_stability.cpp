#include "analysis/step_stability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/errors.hpp"
#include "solvers/contact_path.hpp"
#include "solvers/dense_eigenvalues.hpp"
#include "solvers/equilibrium.hpp"
#include "solvers/linearise.hpp"
#include "solvers/secular_eigenvalues.hpp"

namespace stridor {
namespace {

/// Of a radius.
constexpr double rounding = 1e-10;
/// Share of the growth that may be the error of the scheme.
constexpr double growth_error = 0.1;

/// The bodies in contact with the same rows, without what turns them.
class BodiesInContact {
 public:
  explicit BodiesInContact(const Pencil& contacts) : contacts_(&contacts) {}

  /// Largest real part of the eigenvalues that may belong to a motion of the steps; nothing where
  /// there are none. The central difference makes frequencies too high, at its limit by π/2.
  std::optional<double> growth_near(double frequency) {
    const double highest = 1.1 * frequency;
    if (searched_ < highest) search(highest);
    std::optional<double> growth;
    for (const Eigenvalue& eigenvalue : eigenvalues_) {
      const double own = eigenvalue.frequency();
      if (own < frequency / 1.6 || own > highest) continue;
      growth = std::max(growth.value_or(eigenvalue.growth()), eigenvalue.growth());
    }
    return growth;
  }

 private:
  /// All eigenvalues up to a frequency.
  void search(double frequency) {
    Pencil rows = *contacts_;
    drop_contact_terms(rows);
    rows = with_springs(rows);
    SecularFunction function(rows);
    SecularSpectrum found = secular_spectrum(function, SpectrumWindow::below(frequency));
    eigenvalues_ = found.is_complete ? std::move(found.eigenvalues)
                                     : dense_eigenvalues(rows, DenseWork::eigenvalues);
    searched_ = found.is_complete ? frequency : std::numeric_limits<double>::infinity();
  }

  const Pencil* contacts_;
  std::vector<Eigenvalue> eigenvalues_;
  double searched_ = -1.0;  ///< Hz, up to which they are known
};

StepStability stability_of(const FrozenStep& step, const Pencil& contacts,
                           BodiesInContact& bodies) {
  const std::vector<std::complex<double>> factors = step.factors(contacts);
  StepStability found;
  const auto largest =
      std::max_element(factors.begin(), factors.end(),
                       [](const auto& a, const auto& b) { return std::abs(a) < std::abs(b); });
  if (largest == factors.end()) return found;
  found.radius = std::abs(*largest);
  found.growth = std::log(found.radius) / step.step();
  found.frequency = std::abs(std::arg(*largest)) / (2.0 * std::numbers::pi * step.step());
  if (found.radius <= 1.0 + rounding) return found;
  found.growth_of_bodies = bodies.growth_near(found.frequency);
  const double own = found.growth - std::max(0.0, found.growth_of_bodies.value_or(0.0));
  found.verdict =
      own > growth_error * found.growth ? StepVerdict::step_grows : StepVerdict::bodies_grow;
  return found;
}

}  // namespace

StepStability step_stability(const FrozenStep& step, const Pencil& contacts) {
  BodiesInContact bodies(contacts);
  return stability_of(step, contacts, bodies);
}

std::optional<double> stable_step(const System& system, const TimeParameters& time,
                                  const Pencil& contacts) {
  BodiesInContact bodies(contacts);
  const auto grows = [&](double step) {
    TimeParameters at = time;
    at.step = step;
    return stability_of(FrozenStep(system, at), contacts, bodies).verdict ==
           StepVerdict::step_grows;
  };
  double high = time.step;
  if (!grows(high)) return high;
  double low = 0.5 * high;
  while (grows(low)) {
    high = low;
    low *= 0.5;
    if (low < 0.01 * time.step) return std::nullopt;
  }
  while (high > low * (1.0 + 1e-4)) {
    const double middle = std::sqrt(low * high);
    (grows(middle) ? high : low) = middle;
  }
  return low;
}

std::vector<PathStability> stability_along_path(const System& system, const TimeParameters& time,
                                                int num_places,
                                                const std::function<void(int)>& on_place) {
  const FrozenStep step(system, time);
  const auto [least, most] = drive_range(system.drive, time.end);
  std::vector<PathStability> path;
  for (int i = 0; i < num_places; ++i) {
    if (on_place) on_place(i);
    PathStability place;
    place.drive_displacement =
        num_places == 1 ? least : least + (most - least) * i / (num_places - 1);
    place.stability.verdict = StepVerdict::no_equilibrium;
    try {
      const Equilibrium equilibrium =
          find_equilibrium(system, sliding_state(system, place.drive_displacement));
      place.failure = equilibrium.failure;
      for (const ContactEquilibrium& contact : equilibrium.contacts)
        place.positions.push_back(contact.position);
      if (equilibrium.status == EquilibriumStatus::converged) {
        place.contacts = linearise_constraints(system, equilibrium);
        place.stability = step_stability(step, place.contacts);
      }
    } catch (const NumericalError& error) {
      place.failure = error.what();
    }
    path.push_back(std::move(place));
    if (least == most) break;
  }
  return path;
}

}  // namespace stridor
