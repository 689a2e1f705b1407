#include "solvers/transient/substrate_oscillator.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace stridor {
namespace {

constexpr double machine_epsilon = std::numeric_limits<double>::epsilon();

/// g(y) with its derivative and its terms.
struct Imbalance {
  double value = 0.0;
  double slope = 0.0;
  double size = 0.0;  ///< of the largest term, by which rounding is measured
  double x = 0.0;
  SubstrateForces forces;
};

Imbalance imbalance_at(const SubstrateOscillator& oscillator, double y) {
  const Eigen::Matrix2d& k = oscillator.stiffness;
  Imbalance found;
  found.forces = oscillator.contact.at(y, -oscillator.substrate_speed, -1.0);
  const SubstrateForces& f = found.forces;
  found.x = (oscillator.load.x() + f.tangential.value - k(0, 1) * y) / k(0, 0);
  found.value = k(1, 1) * y + k(1, 0) * found.x - oscillator.load.y() + f.normal.value;
  found.slope = k(1, 1) + k(1, 0) * (f.tangential.by_indentation - k(0, 1)) / k(0, 0) +
                f.normal.by_indentation;
  found.size = std::abs(k(1, 1) * y) + std::abs(k(1, 0) * found.x) + std::abs(oscillator.load.y()) +
               std::abs(f.normal.value);
  return found;
}

/// Monic quartic s⁴ + a_3 s³ + a_2 s² + a_1 s + a_0.
struct Quartic {
  double a3, a2, a1, a0;
};

Quartic characteristic_polynomial(const SmallMotion& motion) {
  const Eigen::Matrix2d& c = motion.damping;
  const Eigen::Matrix2d& k = motion.stiffness;
  return {c(0, 0) + c(1, 1), k(0, 0) + k(1, 1) + c(0, 0) * c(1, 1) - c(0, 1) * c(1, 0),
          c(0, 0) * k(1, 1) + c(1, 1) * k(0, 0) - c(0, 1) * k(1, 0) - c(1, 0) * k(0, 1),
          k(0, 0) * k(1, 1) - k(0, 1) * k(1, 0)};
}

/// Largest real root of z³ + b z² + c z + d.
double largest_cubic_root(double b, double c, double d) {
  const double shift = -b / 3.0;
  const double p = c - b * b / 3.0;
  const double q = d + shift * (c + shift * (b + shift));
  const double half = 0.5 * q;
  const double third = p / 3.0;
  const double discriminant = half * half + third * third * third;
  double z;
  if (discriminant > 0.0) {
    const double root = std::cbrt(std::abs(half) + std::sqrt(discriminant));
    const double signed_root = half > 0.0 ? -root : root;
    z = signed_root == 0.0 ? 0.0 : signed_root - third / signed_root;
  } else {
    const double radius = std::sqrt(-third);
    const double cosine =
        radius == 0.0 ? 1.0 : std::clamp(-half / (radius * radius * radius), -1.0, 1.0);
    z = 2.0 * radius * std::cos(std::acos(cosine) / 3.0);
  }
  z += shift;
  for (int i = 0; i < 2; ++i) {
    const double slope = c + z * (2.0 * b + 3.0 * z);
    if (slope == 0.0) break;
    z -= (d + z * (c + z * (b + z))) / slope;
  }
  return z;
}

/// Roots of s² + p s + q.
std::array<std::complex<double>, 2> quadratic_roots(double p, double q) {
  const double discriminant = 0.25 * p * p - q;
  if (discriminant < 0.0) {
    const double omega = std::sqrt(-discriminant);
    return {std::complex<double>{-0.5 * p, omega}, {-0.5 * p, -omega}};
  }
  const double far = -0.5 * p - std::copysign(std::sqrt(discriminant), p);
  const double near = far == 0.0 ? 0.0 : q / far;
  return {std::complex<double>{far, 0.0}, {near, 0.0}};
}

/// One root after two steps of Newton's method, as far as they make the residual smaller.
std::complex<double> polished(const Quartic& a, std::complex<double> s) {
  const auto value = [&](std::complex<double> z) {
    return a.a0 + z * (a.a1 + z * (a.a2 + z * (a.a3 + z)));
  };
  std::complex<double> residual = value(s);
  for (int i = 0; i < 2; ++i) {
    const std::complex<double> slope = a.a1 + s * (2.0 * a.a2 + s * (3.0 * a.a3 + 4.0 * s));
    if (std::norm(slope) == 0.0) break;
    const std::complex<double> next = s - residual / slope;
    const std::complex<double> left = value(next);
    if (!(std::norm(left) < std::norm(residual))) break;
    s = next;
    residual = left;
  }
  return s;
}

}  // namespace

double imbalance(const SubstrateOscillator& oscillator, double indentation) {
  return imbalance_at(oscillator, indentation).value;
}

SubstrateEquilibrium find_equilibrium(const SubstrateOscillator& oscillator, double guess) {
  SubstrateEquilibrium result;
  const Eigen::Matrix2d& k = oscillator.stiffness;
  // Without contact the body would be at this height.
  const double free = oscillator.load.y() - k(1, 0) * oscillator.load.x() / k(0, 0);
  if (!(free > 0.0)) return result;
  double low = 0.0;
  double high = std::numeric_limits<double>::infinity();
  double y = guess > 0.0 && std::isfinite(guess) ? guess : 1.0;
  constexpr int most = 2000;
  while (result.evaluations < most) {
    const Imbalance found = imbalance_at(oscillator, y);
    ++result.evaluations;
    if (!std::isfinite(found.value)) return result;
    (found.value < 0.0 ? low : high) = y;
    const double step = -found.value / found.slope;
    double next = y + step;
    const bool is_at_rounding = std::abs(found.value) <= 2.0 * machine_epsilon * found.size;
    // A last step of Newton's method in any case: it costs no further evaluation.
    if (is_at_rounding || std::abs(step) <= 1e-9 * y) {
      const bool improves = !is_at_rounding && next > low && next < high;
      if (improves && std::abs(step) > 4.0 * machine_epsilon * y) {
        y = next;
        const Imbalance last = imbalance_at(oscillator, y);
        ++result.evaluations;
        result.displacement = {last.x, y};
        result.forces = last.forces;
      } else {
        result.displacement = {found.x, y};
        result.forces = found.forces;
      }
      result.converged = true;
      return result;
    }
    if (!(next > low && next < high)) {
      next = std::isinf(high) ? 8.0 * y : low == 0.0 ? 0.125 * high : std::sqrt(low * high);
      if (!(next > low && next < high)) next = 0.5 * (low + high);
    }
    // Nothing lies between neighbouring numbers.
    if (next == y || !(next > low && next < high)) {
      result.displacement = {found.x, y};
      result.forces = found.forces;
      result.converged = true;
      return result;
    }
    y = next;
  }
  return result;
}

SmallMotion small_motion(const SubstrateOscillator& oscillator,
                         const SubstrateEquilibrium& equilibrium, SmallMotionTerms terms) {
  const SubstrateForces& f = equilibrium.forces;
  SmallMotion motion{oscillator.damping, oscillator.stiffness};
  motion.stiffness(0, 1) -= f.tangential.by_indentation;
  motion.stiffness(1, 1) += f.normal.by_indentation;
  motion.damping(0, 0) -= f.tangential.by_slip;
  motion.damping(1, 0) += f.normal.by_slip;
  if (terms == SmallMotionTerms::without_damping) motion.damping.setZero();
  return motion;
}

Pencil make_pencil(const SubstrateOscillator& oscillator, const SmallMotion& motion) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> modes(oscillator.stiffness);
  Pencil pencil;
  pencil.omega = modes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  pencil.damping = Eigen::Vector2d::Zero();
  pencil.ports = modes.eigenvectors();
  pencil.compatibility.resize(0, 2);
  pencil.equilibrium.resize(0, 2);
  pencil.port_stiffness = motion.stiffness - oscillator.stiffness;
  pencil.port_damping = motion.damping;
  return pencil;
}

std::array<std::complex<double>, 4> eigenvalues(const SmallMotion& motion) {
  const Quartic a = characteristic_polynomial(motion);
  if (a.a3 == 0.0 && a.a1 == 0.0) {
    const double discriminant = 0.25 * a.a2 * a.a2 - a.a0;
    if (discriminant < 0.0) {
      const std::complex<double> s =
          std::sqrt(std::complex<double>(-0.5 * a.a2, std::sqrt(-discriminant)));
      return {s, std::conj(s), -s, -std::conj(s)};
    }
    const auto squares = quadratic_roots(a.a2, a.a0);
    const std::complex<double> first = std::sqrt(squares[0]);
    const std::complex<double> second = std::sqrt(squares[1]);
    return {first, -first, second, -second};
  }
  // (s² + p_1 s + q_1)(s² + p_2 s + q_2) with z = q_1 + q_2.
  const double z = largest_cubic_root(-a.a2, a.a1 * a.a3 - 4.0 * a.a0,
                                      4.0 * a.a0 * a.a2 - a.a1 * a.a1 - a.a0 * a.a3 * a.a3);
  const double q_half = std::sqrt(std::max(0.0, 0.25 * z * z - a.a0));
  const double p_half = std::sqrt(std::max(0.0, 0.25 * a.a3 * a.a3 - a.a2 + z));
  // p_1 q_2 + p_2 q_1 = a_1 says which p goes with which q.
  const double as_is = 0.5 * a.a3 * z - 2.0 * p_half * q_half;
  const double crossed = 0.5 * a.a3 * z + 2.0 * p_half * q_half;
  const double sign = std::abs(as_is - a.a1) <= std::abs(crossed - a.a1) ? 1.0 : -1.0;
  const double q1 = 0.5 * z + std::copysign(q_half, z);
  const double q2 = q1 == 0.0 ? 0.0 : a.a0 / q1;
  const double side = z < 0.0 ? -sign : sign;
  const auto first = quadratic_roots(0.5 * a.a3 + side * p_half, q1);
  const auto second = quadratic_roots(0.5 * a.a3 - side * p_half, q2);
  return {polished(a, first[0]), polished(a, first[1]), polished(a, second[0]),
          polished(a, second[1])};
}

std::complex<double> leading_eigenvalue(const SmallMotion& motion) {
  const auto all = eigenvalues(motion);
  std::complex<double> leading = all[0];
  for (const std::complex<double>& s : all)
    if (s.real() > leading.real()) leading = s;
  return {leading.real(), std::abs(leading.imag())};
}

double stability_margin(const SmallMotion& motion) {
  if (!motion.damping.isZero(0.0)) return leading_eigenvalue(motion).real();
  const Eigen::Matrix2d& k = motion.stiffness;
  return std::max(-flutter_discriminant(motion), -4.0 * (k(0, 0) * k(1, 1) - k(0, 1) * k(1, 0)));
}

double flutter_discriminant(const SmallMotion& motion) {
  const Eigen::Matrix2d& k = motion.stiffness;
  const double difference = k(0, 0) - k(1, 1);
  return 4.0 * k(0, 1) * k(1, 0) + difference * difference;
}

}  // namespace stridor
