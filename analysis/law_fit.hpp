// Accuracy of the functional forms of PPH for a contact law.
#pragma once

#include <vector>

#include "coupling/laws/viscoelastic_law.hpp"

namespace stridor {

/// A contact that a form is to meet: v̂, ŷ, F̃, Ã, μ.
struct LawSample {
  double speed = 0.0;
  double indentation = 0.0;
  double force = 0.0;
  double area = 0.0;
  double friction = 0.0;
};

/// Values of a law at every pair of speed and indentation.
std::vector<LawSample> law_samples(const ViscoelasticContactLaw& law,
                                   const std::vector<double>& speeds,
                                   const std::vector<double>& indentations);

/// One number for each of the three quantities.
struct PerQuantity {
  double force = 0.0;
  double area = 0.0;
  double friction = 0.0;
};

/// Coefficients of determination r² = 1 − Σ(fit − sample)²/Σ(sample − mean)² of a law.
/// @throws std::invalid_argument if there are fewer than two samples
PerQuantity determination(const ViscoelasticContactLaw& law, const std::vector<LawSample>& samples);

/// The forms with their speed axis moved: the result says at v̂ what `coefficients` say at
/// v̂/10^decades.
FitCoefficients shifted(const FitCoefficients& coefficients, const PerQuantity& decades);

/// The shifts, in decades, with which given forms meet the samples best.
/// @param widest the shifts are sought within ± this, > 0
PerQuantity best_shift(const FitCoefficients& coefficients, const std::vector<LawSample>& samples,
                       double widest);

struct LawFit {
  FitCoefficients coefficients;
  bool converged = false;
};

/// Least squares of each form by Levenberg and Marquardt.
/// @param start    not too far off
/// @param samples  more than five
/// @throws std::invalid_argument if there are fewer
LawFit fit_law(const FitCoefficients& start, const std::vector<LawSample>& samples);

}  // namespace stridor
