// Linear viscoelastic material with any number of creep times.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "core/schema.hpp"

namespace stridor {

/// An isotropic material with constant Poisson's ratio and the complex modulus E(ω)
/// (docs/theory.md, 8.1; PPH Appendix A):
///
///     1/E(ω) = 1/E_∞ + (1/E_0 − 1/E_∞) Σ_k s_k/(1 + i ω τ_k),   Σ s_k = 1
///
/// The τ_k are **creep** (retardation) times. With one of them the relaxation time is τ E_0/E_∞.
struct ViscoelasticMaterial {
  double rubbery_modulus = 0.0;      ///< E_0 = E(0), Pa, > 0
  double glassy_modulus = 0.0;       ///< E_∞, Pa, > E_0
  double poissons_ratio = 0.0;       ///< in (−1, 0.5]
  std::vector<double> creep_times;   ///< τ_k, s, > 0; the first is the unit of time of results
  std::vector<double> creep_shares;  ///< s_k > 0, sum 1; may be empty where there is one time
  static const Schema& schema();

  /// E_0* = E_0/(1 − ν²), Pa.
  double composite_modulus() const;
  /// e_0 = E_0/E_∞.
  double modulus_ratio() const { return rubbery_modulus / glassy_modulus; }
  /// w_k = (1 − e_0) s_k: contribution of the time τ_k to the compliance, over 1/E_0.
  double creep_weight(std::size_t k) const;
  /// E(ω), Pa, of e^{iωt}; ω in rad/s.
  std::complex<double> modulus(double omega) const;
};

}  // namespace stridor
