#include "solvers/integrators/two_step_scheme.hpp"

#include <cmath>

namespace stridor {

namespace {

/// s, k and, as gain, the whole static response k/ω² of a step.
StepCoefficients exact_free_motion(double omega, double damping, double step) {
  const double half = 0.5 * damping;
  if (omega == 0.0) {
    const double lost = -std::expm1(-damping * step);
    return {1.0 - lost, 0.0, damping == 0.0 ? step * step : step * lost / damping};
  }
  const double decay = std::exp(-half * step);
  const double square_frequency = (omega - half) * (omega + half);
  double pull;
  if (square_frequency >= 0.0) {
    // (1 − r₁)(1 − r₂) = (1 − E)² + 4 E sin²(ω_d h/2) with r = E exp(±i ω_d h).
    const double lost = std::expm1(-half * step);
    const double sine = std::sin(0.5 * step * std::sqrt(square_frequency));
    pull = lost * lost + 4.0 * decay * sine * sine;
  } else {
    // Real roots −c/2 ∓ κ; their product is ω², and the smaller is found from the larger.
    const double kappa = std::sqrt(-square_frequency);
    const double larger = half + std::copysign(kappa, half);
    pull = std::expm1(-larger * step) * std::expm1(-omega * omega / larger * step);
  }
  return {decay * decay, pull, pull / (omega * omega)};
}

/// g without added feedthrough, over h².
double feedthrough_share(double pull, double x, double lag) {
  // Terms that the subtraction below would cancel are omitted: ε/x² against x².
  constexpr double smallest = 1e-4;
  if (x > smallest) {
    const double loss = lag == 0.0 ? 1.0 : -lag / std::expm1(-lag);
    return (1.0 - pull / (x * x) * loss) / (x * x);
  }
  // The limit without stiffness, 1/(z (e^z − 1)) − 1/z² + 1/(2z).
  const double square = lag * lag;
  if (std::abs(lag) < 0.1) return 1.0 / 12.0 - square * (1.0 / 720.0 - square / 30240.0);
  return (1.0 / std::expm1(lag) - 1.0 / lag + 0.5) / lag;
}

/// Takes an instantaneous response out of that of the step. It is at most the whole flexibility
/// 1/ω²; with more the impulses would change their sign, e < 0, and the mode would feed the
/// contacts.
StepCoefficients with_feedthrough(StepCoefficients c, double feedthrough) {
  if (c.pull * feedthrough >= c.gain) return {c.keep, c.pull, 0.0, c.gain / c.pull};
  return {c.keep, c.pull, c.gain - c.pull * feedthrough, feedthrough};
}

}  // namespace

StepCoefficients central_difference(double omega, double damping, double step, double added) {
  const double square = step * step;
  return with_feedthrough({1.0 - step * damping, square * omega * omega, square}, added * square);
}

StepCoefficients exact_propagation(double omega, double damping, double step, double added) {
  const StepCoefficients c = exact_free_motion(omega, damping, step);
  const double share = feedthrough_share(c.pull, omega * step, damping * step);
  return with_feedthrough(c, step * step * share + added * c.gain);
}

StartCoefficients central_difference_start(double damping, double step) {
  return {step * (1.0 - step * damping), 1.0};
}

StartCoefficients exact_start(double omega, double damping, double step) {
  const double half = 0.5 * damping;
  const double square_frequency = (omega - half) * (omega + half);
  const double gain = exact_free_motion(omega, damping, step).gain;
  if (omega == 0.0) {
    // Velocity v exp(−c t) under no force; h²/2 − c h³/6 + … per unit force.
    const double x = damping * step;
    const double drift = x == 0.0 ? step : -step * std::expm1(-x) / x;
    const double share = std::abs(x) < 1e-3
                             ? step * step * (0.5 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x / 120.0)))
                             : (x + std::expm1(-x)) / (damping * damping);
    return {drift, share / gain};
  }
  double rate;
  double lost;  // 1 − A
  if (square_frequency >= 0.0) {
    const double decay = std::exp(-half * step);
    const double angle = step * std::sqrt(square_frequency);
    const double sine = std::sin(0.5 * angle);
    rate = decay * step * (angle == 0.0 ? 1.0 : std::sin(angle) / angle);
    lost = 2.0 * decay * sine * sine - std::expm1(-half * step) - half * rate;
  } else {
    const double kappa = std::sqrt(-square_frequency);
    const double larger = half + std::copysign(kappa, half);
    const double smaller = omega * omega / larger;
    const double larger_lost = -std::expm1(-larger * step);
    const double smaller_lost = -std::expm1(-smaller * step);
    rate = (larger_lost - smaller_lost) / (larger - smaller);
    lost = (larger * smaller_lost - smaller * larger_lost) / (larger - smaller);
  }
  return {rate, lost / (omega * omega * gain)};
}

}  // namespace stridor
