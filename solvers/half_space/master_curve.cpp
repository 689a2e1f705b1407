#include "solvers/half_space/master_curve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace stridor {

std::vector<double> master_curve_betas() {
  std::vector<double> betas;
  for (int k = -24; k <= 32; ++k) betas.push_back(std::pow(10.0, k / 8.0));
  return betas;
}

bool ComputedMasterCurve::converged() const {
  return std::all_of(results.begin(), results.end(),
                     [](const SlidingContactResult& result) { return result.converged; });
}

ComputedMasterCurve compute_master_curve(double modulus_ratio, const std::vector<double>& betas,
                                         const SlidingContactParameters& parameters,
                                         const std::function<void(std::size_t)>& advanced) {
  if (!(modulus_ratio > 0.0) || !(modulus_ratio < 1.0)) {
    throw std::invalid_argument(fmt::format(
        "compute_master_curve: the modulus ratio {:g} is not in (0, 1)", modulus_ratio));
  }
  // With R = δ = 1 the elastic contact radius is 1, so that v τ = β.
  ProfileParameters profile;
  profile.radius = 1.0;
  SlidingContact contact(parameters, IndenterProfile(profile));
  ComputedMasterCurve computed;
  computed.curve.modulus_ratio = modulus_ratio;
  for (const double beta : betas) {
    const SlidingContactResult result = contact.indent(1.0, {{1.0 - modulus_ratio, beta}});
    computed.results.push_back(result);
    computed.curve.points.push_back(
        {beta, result.force, result.area, result.friction, result.memory_in_cells});
    if (advanced) advanced(computed.results.size());
  }
  return computed;
}

}  // namespace stridor
