#include "analysis/step_stability.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

#include "core/errors.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/eigenvalues/secular_eigenvalues.hpp"
#include "solvers/equilibrium/equilibrium.hpp"
#include "solvers/equilibrium/linearise.hpp"
#include "solvers/integrators/contact_path.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

/// Of a radius.
constexpr double radius_rounding = 1e-10;
/// How far the motion of a step may be from that of the bodies, relative to |s|.
constexpr double largest_shift = 0.2;
/// The same where the growth of the bodies excuses that of the step: another motion that grows may
/// be as near as the above.
constexpr double shift_of_excuse = 0.02;

/// The bodies in contact with the same rows, without what turns them.
class BodiesInContact {
 public:
  explicit BodiesInContact(const Pencil& contacts) : contacts_(&contacts) {}

  /// Eigenvalues s with Im s >= 0, at least those up to a size.
  const std::vector<Complex>& up_to(double size) {
    if (searched_ < size) search(size);
    return eigenvalues_;
  }

 private:
  void search(double size) {
    Pencil rows = *contacts_;
    drop_contact_terms(rows);
    rows = with_springs(rows);
    SecularSpectrum found;
    if (!is_dense_cheaper(rows)) {
      SecularFunction function(rows);
      const double frequency = size / (2.0 * std::numbers::pi);
      found = secular_spectrum(function, SpectrumWindow::below(frequency));
    }
    if (!found.is_complete) found.eigenvalues = dense_eigenvalues(rows, DenseWork::eigenvalues);
    searched_ = found.is_complete ? size : std::numeric_limits<double>::infinity();
    eigenvalues_.clear();
    for (const Eigenvalue& one : found.eigenvalues)
      if (one.s.imag() >= 0.0) eigenvalues_.push_back(one.s);
  }

  const Pencil* contacts_;
  std::vector<Complex> eigenvalues_;
  double searched_ = -1.0;  ///< |s| up to which they are known
};

/// A motion that grows from step to step.
struct GrowingMotion {
  double growth = 0.0;     ///< ln|z|/h, 1/s
  double frequency = 0.0;  ///< Hz
  Complex represented;     ///< s of the bodies that it stands for
  std::optional<double> growth_of_bodies{};
  double shift = 0.0;  ///< from their eigenvalue, relative to |s|

  double own_growth() const { return growth - std::max(0.0, growth_of_bodies.value_or(0.0)); }
};

GrowingMotion motion_of(Complex z, const FrozenStep& step) {
  const double h = step.step();
  GrowingMotion motion{std::log(std::abs(z)) / h,
                       std::abs(std::arg(z)) / (2.0 * std::numbers::pi * h), std::log(z) / h};
  if (step.integrator() == Integrator::central_difference)
    motion.represented = std::sqrt((z - 1.0) * (z - 1.0) / z) / h;
  if (motion.represented.imag() < 0.0) motion.represented = std::conj(motion.represented);
  return motion;
}

/// Gives an eigenvalue to every motion that has none, the nearest pairs first.
void match(std::vector<GrowingMotion>& motions, std::vector<Complex> eigenvalues) {
  while (!eigenvalues.empty()) {
    double least = largest_shift;
    GrowingMotion* nearest = nullptr;
    std::size_t taken = 0;
    for (GrowingMotion& motion : motions) {
      if (motion.growth_of_bodies) continue;
      for (std::size_t j = 0; j < eigenvalues.size(); ++j) {
        const double distance =
            std::abs(eigenvalues[j] - motion.represented) / std::abs(motion.represented);
        if (!(distance < least)) continue;
        least = distance;
        nearest = &motion;
        taken = j;
      }
    }
    if (nearest == nullptr) return;
    nearest->growth_of_bodies = eigenvalues[taken].real();
    nearest->shift = least;
    eigenvalues.erase(eigenvalues.begin() + static_cast<std::ptrdiff_t>(taken));
  }
}

StepStability stability_of(const FrozenStep& step, const Pencil& contacts, BodiesInContact& bodies,
                           const GrowthTolerance& tolerance) {
  const std::vector<Complex> factors = step.factors(contacts);
  StepStability found;
  std::vector<GrowingMotion> growing;
  double highest = 0.0;
  for (const Complex z : factors) {
    const double radius = std::abs(z);
    if (radius > found.radius) {
      const GrowingMotion motion = motion_of(z, step);
      found.radius = radius;
      found.growth = motion.growth;
      found.frequency = motion.frequency;
    }
    if (!(radius > 1.0 + radius_rounding) || z.imag() < 0.0) continue;
    growing.push_back(motion_of(z, step));
    highest = std::max(highest, std::abs(growing.back().represented));
  }
  if (growing.empty()) return found;
  std::vector<Complex> of_bodies = bodies.up_to((1.0 + largest_shift) * highest);
  const auto decaying = std::stable_partition(of_bodies.begin(), of_bodies.end(),
                                              [](Complex s) { return s.real() > 0.0; });
  match(growing, {of_bodies.begin(), decaying});
  match(growing, {decaying, of_bodies.end()});
  const auto by_step = [&](const GrowingMotion& motion) {
    const double of_nearest = motion.growth_of_bodies.value_or(0.0);
    const bool is_near = motion.shift < shift_of_excuse;
    if (is_near && of_nearest > tolerance.share_of_bodies * motion.growth) return false;
    return motion.own_growth() > std::max(tolerance.share * motion.growth, tolerance.least);
  };
  const auto worst = std::max_element(
      growing.begin(), growing.end(), [&](const GrowingMotion& a, const GrowingMotion& b) {
        const auto rank = [&](const GrowingMotion& motion) {
          return std::pair(by_step(motion), by_step(motion) ? motion.own_growth() : motion.growth);
        };
        return rank(a) < rank(b);
      });
  found.verdict = by_step(*worst) ? StepVerdict::step_grows : StepVerdict::bodies_grow;
  found.growth = worst->growth;
  found.frequency = worst->frequency;
  found.growth_of_bodies = worst->growth_of_bodies;
  return found;
}

}  // namespace

StepStability step_stability(const FrozenStep& step, const Pencil& contacts,
                             const GrowthTolerance& tolerance) {
  BodiesInContact bodies(contacts);
  return stability_of(step, contacts, bodies, tolerance);
}

std::optional<double> stable_step(const System& system, const TimeParameters& time,
                                  const Pencil& contacts) {
  BodiesInContact bodies(contacts);
  const auto grows = [&](double step) {
    TimeParameters at = time;
    at.step = step;
    return stability_of(FrozenStep(system, at), contacts, bodies, {}).verdict ==
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
  const auto [least, most] = drive_range(system.leading_drive(), time.end);
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
      if (!equilibrium.failure.empty())
        place.failure = with_code(equilibrium.failure, Refusal::no_equilibrium);
      for (const ContactEquilibrium& contact : equilibrium.contacts)
        place.positions.push_back(contact.position);
      if (equilibrium.status == EquilibriumStatus::converged) {
        place.contacts = linearise_constraints(system, equilibrium);
        place.stability = step_stability(step, place.contacts);
      }
    } catch (const NumericalError& error) {
      place.failure = error.report();
    }
    path.push_back(std::move(place));
    if (least == most) break;
  }
  return path;
}

}  // namespace stridor
