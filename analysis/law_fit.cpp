#include "analysis/law_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace stridor {
namespace {

/// Which of the three quantities is meant, in samples and in laws.
struct Quantity {
  double LawSample::*sample;
  LawValue ViscoelasticContact::*law;
};
constexpr Quantity force_quantity{&LawSample::force, &ViscoelasticContact::force};
constexpr Quantity area_quantity{&LawSample::area, &ViscoelasticContact::area};
constexpr Quantity friction_quantity{&LawSample::friction, &ViscoelasticContact::friction};

double determination_of(const ViscoelasticContactLaw& law, const std::vector<LawSample>& samples,
                        const Quantity& quantity) {
  double mean = 0.0;
  for (const LawSample& sample : samples) mean += sample.*quantity.sample;
  mean /= static_cast<double>(samples.size());
  double missed = 0.0;
  double spread = 0.0;
  for (const LawSample& sample : samples) {
    const double value = (law.at(sample.indentation, sample.speed).*quantity.law).value;
    missed += std::pow(value - sample.*quantity.sample, 2);
    spread += std::pow(sample.*quantity.sample - mean, 2);
  }
  return 1.0 - missed / spread;
}

/// Levenberg and Marquardt for one quantity, whose coefficients are an array within all of them.
template <std::size_t Size>
bool fit_quantity(FitCoefficients& all, std::array<double, Size> FitCoefficients::*member,
                  const Quantity& quantity, const std::vector<LawSample>& samples) {
  const auto rows = static_cast<Eigen::Index>(samples.size());
  const auto misses = [&](const std::array<double, Size>& coefficients) {
    FitCoefficients changed = all;
    changed.*member = coefficients;
    const FittedLaw law(changed);
    Eigen::VectorXd miss(rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const LawSample& sample = samples[static_cast<std::size_t>(i)];
      miss[i] =
          (law.at(sample.indentation, sample.speed).*quantity.law).value - sample.*quantity.sample;
    }
    return miss;
  };
  std::array<double, Size> at = all.*member;
  Eigen::VectorXd miss = misses(at);
  double damping = 1e-3;
  bool converged = false;
  for (int step = 0; step < 500 && !converged; ++step) {
    Eigen::MatrixXd jacobian(rows, Size);
    for (std::size_t k = 0; k < Size; ++k) {
      const double h = 1e-5 * std::max(std::abs(at[k]), 0.1);
      std::array<double, Size> above = at;
      std::array<double, Size> below = at;
      above[k] += h;
      below[k] -= h;
      jacobian.col(static_cast<Eigen::Index>(k)) = (misses(above) - misses(below)) / (2.0 * h);
    }
    const Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
    const Eigen::VectorXd gradient = jacobian.transpose() * miss;
    bool is_better = false;
    while (!is_better && damping < 1e12) {
      Eigen::MatrixXd damped = normal;
      damped.diagonal() *= 1.0 + damping;
      const Eigen::VectorXd change = -damped.ldlt().solve(gradient);
      std::array<double, Size> next = at;
      for (std::size_t k = 0; k < Size; ++k) next[k] += change[static_cast<Eigen::Index>(k)];
      const Eigen::VectorXd next_miss = misses(next);
      is_better = next_miss.squaredNorm() < miss.squaredNorm();
      if (is_better) {
        converged = miss.squaredNorm() - next_miss.squaredNorm() < 1e-14 * miss.squaredNorm();
        at = next;
        miss = next_miss;
        damping *= 0.2;
      } else {
        damping *= 5.0;
      }
    }
    // No direction leads down any more: the bottom, to rounding.
    if (!is_better) converged = true;
  }
  all.*member = at;
  return converged;
}

}  // namespace

std::vector<LawSample> law_samples(const ViscoelasticContactLaw& law,
                                   const std::vector<double>& speeds,
                                   const std::vector<double>& indentations) {
  std::vector<LawSample> samples;
  for (const double y : indentations) {
    for (const double v : speeds) {
      const ViscoelasticContact contact = law.at(y, v);
      samples.push_back({v, y, contact.force.value, contact.area.value, contact.friction.value});
    }
  }
  return samples;
}

PerQuantity determination(const ViscoelasticContactLaw& law,
                          const std::vector<LawSample>& samples) {
  if (samples.size() < 2)
    throw std::invalid_argument("determination: fewer than two samples have no spread");
  return {determination_of(law, samples, force_quantity),
          determination_of(law, samples, area_quantity),
          determination_of(law, samples, friction_quantity)};
}

FitCoefficients shifted(const FitCoefficients& coefficients, const PerQuantity& decades) {
  FitCoefficients moved = coefficients;
  moved.force[4] -= moved.force[2] * decades.force;
  moved.area[3] += decades.area;
  moved.friction[2] += decades.friction;
  return moved;
}

PerQuantity best_shift(const FitCoefficients& coefficients, const std::vector<LawSample>& samples,
                       double widest) {
  const auto best = [&](const Quantity& quantity) {
    const auto at = [&](double decades) {
      const FittedLaw law(shifted(coefficients, {decades, decades, decades}));
      return determination_of(law, samples, quantity);
    };
    // The best of a coarse search, then golden sections around it.
    constexpr int num_tries = 80;
    const double width = 2.0 * widest / num_tries;
    double middle = -widest;
    for (int k = 0; k <= num_tries; ++k) {
      if (at(-widest + k * width) > at(middle)) middle = -widest + k * width;
    }
    constexpr double golden = 0.6180339887498949;
    double low = middle - width;
    double high = middle + width;
    while (high - low > 1e-8) {
      const double a = high - golden * (high - low);
      const double b = low + golden * (high - low);
      (at(a) > at(b) ? high : low) = at(a) > at(b) ? b : a;
    }
    return 0.5 * (low + high);
  };
  return {best(force_quantity), best(area_quantity), best(friction_quantity)};
}

LawFit fit_law(const FitCoefficients& start, const std::vector<LawSample>& samples) {
  if (samples.size() < 6)
    throw std::invalid_argument("fit_law: the forms need more than five samples");
  LawFit fit{start, true};
  FitCoefficients& all = fit.coefficients;
  fit.converged &= fit_quantity(all, &FitCoefficients::force, force_quantity, samples);
  fit.converged &= fit_quantity(all, &FitCoefficients::area, area_quantity, samples);
  fit.converged &= fit_quantity(all, &FitCoefficients::friction, friction_quantity, samples);
  return fit;
}

}  // namespace stridor
