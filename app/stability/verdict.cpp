#include "app/stability/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "app/stability/key_range.hpp"

namespace stridor {

double verdict_limit(std::span<const std::complex<double>> eigenvalues,
                     const SpectrumWindow& window, double trusted) {
  const auto num_vibrating = std::count_if(eigenvalues.begin(), eigenvalues.end(),
                                           [](const auto& s) { return s.imag() > 0.0; });
  double highest = std::min(trusted, window.frequency);
  if (window.count && num_vibrating >= *window.count)
    highest = std::min(highest, eigenvalues.back().imag() / (2.0 * std::numbers::pi));
  return highest;
}

double verdict_limit(const Locus& locus, const SpectrumWindow& window, double trusted) {
  double highest = trusted;
  for (const auto& eigenvalues : locus.eigenvalues)
    highest = std::min(highest, verdict_limit(eigenvalues, window, trusted));
  return highest;
}

std::string window_text(double highest) {
  if (!std::isfinite(highest)) return "the verdict holds at all frequencies";
  return fmt::format("the verdict holds between 0 and {:.6g} Hz", highest);
}

std::string limit_text(double highest, double trusted) {
  if (!std::isfinite(highest)) return "";
  if (highest < trusted && std::isfinite(trusted))
    return fmt::format(
        " (nothing above was asked for; --below {:.4g}kHz looks as high as the bodies resolve)",
        1e-3 * trusted);
  return highest < trusted
             ? " (nothing above was asked for)"
             : " (what the bodies resolve, by a rule of thumb: half the frequency of the highest "
               "mode kept, of a plate that of the lowest mode left out)";
}

std::string reach_text(const Locus& locus) {
  const bool is_resolved = locus.unresolved == 0.0 && locus.unverified.empty();
  return is_resolved ? "everywhere" : "at all values looked at";
}

void print_resolution(const Locus& locus, const NumericKey& key) {
  if (locus.unresolved > 0.0) {
    fmt::print(
        "a window narrower than {:.3g}{} may have been missed: there eigenvalues could not be told "
        "apart from one value looked at to the next; ask for more --points or a shorter range\n",
        locus.unresolved, key.unit.empty() ? "" : " " + printed_units(key));
  }
  if (!locus.unverified.empty()) {
    fmt::print(
        "at {} value(s) it could not be verified that no eigenvalue is missing, the first "
        "is {:.9g}; compare with --method dense\n",
        locus.unverified.size(), locus.unverified.front());
  }
}

double trusted_frequency(const System& system) {
  double lowest = std::numeric_limits<double>::infinity();
  double omitted = lowest;  // of bodies that are modes as they are
  for (const SystemBody& body : system.bodies) {
    omitted = std::min(omitted, body.lowest_omitted / (2.0 * std::numbers::pi));
    const Eigen::Index n = body.reduced.size();
    if (const Eigen::Index nb = body.reduced.num_interface;
        body.reduced.interface_modes.size() > 0 && nb > 0 &&
        nb < body.reduced.interface_modes.rows()) {
      // Likewise that of interface modes.
      const double highest = std::sqrt(std::max(0.0, body.reduced.stiffness(nb - 1, nb - 1)));
      lowest = std::min(lowest, highest / (2.0 * std::numbers::pi));
    }
    if (n == body.reduced.num_interface) continue;
    // The stiffness of fixed-interface modes is diagonal and ascends.
    const double omega = std::sqrt(body.reduced.stiffness(n - 1, n - 1));
    lowest = std::min(lowest, omega / (2.0 * std::numbers::pi));
  }
  return std::min(0.5 * lowest, omitted);
}

}  // namespace stridor
