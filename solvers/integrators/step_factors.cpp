#include "solvers/integrators/step_factors.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/algebra/aligned_array.hpp"
#include "solvers/algebra/small_matrices.hpp"
#include "solvers/eigenvalues/secular_kernel.hpp"
#include "solvers/eigenvalues/zero_iterates.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

constexpr double eps = std::numeric_limits<double>::epsilon();

/// P(w) = det A Π D_i Π (w + w_b)^k by its logarithmic derivative.
class StepFunction {
 public:
  explicit StepFunction(const FrozenModes& given)
      : given_(given),
        n_(given.keep.size()),
        k_(given.gaps.rows()),
        padded_((static_cast<std::size_t>(n_) + secular_block - 1) / secular_block * secular_block),
        omega_(padded_),
        damping_(padded_),
        mask_(padded_),
        value_re_(padded_),
        value_im_(padded_),
        slope_re_(padded_),
        slope_im_(padded_),
        norm_(padded_),
        constant_(Eigen::MatrixXd::Zero(k_, k_)),
        clusters_(static_cast<std::size_t>(n_)) {
    std::fill_n(omega_.data(), padded_, padding_omega);
    for (Eigen::Index i = 0; i < n_; ++i) {
      const auto at = static_cast<std::size_t>(i);
      omega_[at] = std::sqrt(given.pull(i));
      damping_[at] = 1.0 - given.keep(i) + given.pull(i);
      mask_[at] = 1.0;
    }
    for (Eigen::Index b = 0; b < k_; ++b) {
      for (Eigen::Index a = 0; a < k_; ++a) {
        AlignedArray weights(padded_);
        for (Eigen::Index i = 0; i < n_; ++i) {
          weights[static_cast<std::size_t>(i)] =
              given.gaps(a, i) * given.gain(i) * given.forces(b, i);
        }
        weights_.push_back(std::move(weights));
      }
    }
    if (given.is_instantaneous)
      constant_ = given.gaps * given.feedthrough.asDiagonal() * given.forces.transpose();
    if (given.compliance.size() > 0) constant_.diagonal() += given.compliance;
    // Poles so close together that multiplying out one leaves nothing but rounding of the other.
    constexpr double closeness = 1e-5;
    for (std::size_t i = 0; i < clusters_.size(); ++i) {
      for (std::size_t j = 0; j < clusters_.size(); ++j) {
        const double scale = closeness * (omega_[i] + std::abs(damping_[i]));
        if (i != j && std::abs(omega_[j] - omega_[i]) <= scale &&
            std::abs(damping_[j] - damping_[i]) <= scale)
          clusters_[i].push_back(j);
      }
    }
  }

  Eigen::Index num_zeros() const {
    if (!given_.is_instantaneous) return 2 * (n_ - k_);
    return 2 * n_ + k_ * static_cast<Eigen::Index>(given_.left_out.size());
  }

  /// The poles w of mode i.
  std::array<Complex, 2> poles(std::size_t i) const {
    const double half = 0.5 * damping_[i];
    const double square = (omega_[i] - half) * (omega_[i] + half);
    if (square >= 0.0)
      return {Complex(-half, std::sqrt(square)), Complex(-half, -std::sqrt(square))};
    const double far = -half - std::copysign(std::sqrt(-square), half);
    return {Complex(far, 0.0), Complex(far == 0.0 ? 0.0 : omega_[i] * omega_[i] / far, 0.0)};
  }

  /// P′/P; infinite at a zero.
  Complex log_slope(Complex w) {
    const SecularModes modes{omega_.data(), damping_.data(), padded_};
    const double least = invert_modes(
        modes, w.real(), w.imag(),
        {value_re_.data(), value_im_.data(), slope_re_.data(), slope_im_.data(), norm_.data()});
    const double* const end = norm_.data() + n_ - 1;  // the last where none is least: not a number
    const auto nearest =
        static_cast<std::size_t>(std::find(std::as_const(norm_).data(), end, least) - norm_.data());
    near_.assign(1, nearest);
    near_.insert(near_.end(), clusters_[nearest].begin(), clusters_[nearest].end());
    for (const std::size_t i : near_)
      value_re_[i] = value_im_[i] = slope_re_[i] = slope_im_[i] = mask_[i] = 0.0;
    double re = 0.0;
    double im = 0.0;
    sum_pole_slopes(modes, mask_.data(), w.real(), w.imag(), &re, &im);
    for (const std::size_t i : near_) mask_[i] = 1.0;
    Complex slope(re, im);
    for (const FrozenModes::LeftOut& body : given_.left_out)
      slope += static_cast<double>(k_) * reciprocal(w + body.share);
    form_bordered(w);
    if (!equilibrate(bordered_, bordered_slope_)) return at_zero;
    const std::optional<Complex> trace = trace_of_solution(bordered_, bordered_slope_);
    return trace ? slope + *trace : at_zero;
  }

  static constexpr double at_zero = std::numeric_limits<double>::infinity();

 private:
  /// det of it is det A Π_near D_i.
  void form_bordered(Complex w) {
    const auto num_near = static_cast<Eigen::Index>(near_.size());
    bordered_.setZero(k_ + num_near, k_ + num_near);
    bordered_slope_.setZero(k_ + num_near, k_ + num_near);
    // The factor e is multiplied by, z or 1.
    const Complex factor = given_.is_instantaneous ? 1.0 + w : Complex(1.0);
    const double factor_slope = given_.is_instantaneous ? 1.0 : 0.0;
    for (Eigen::Index b = 0; b < k_; ++b) {
      for (Eigen::Index a = 0; a < k_; ++a) {
        const double* weights = weights_[static_cast<std::size_t>(a + k_ * b)].data();
        double re = 0.0;
        double im = 0.0;
        weigh(weights, value_re_.data(), value_im_.data(), padded_, &re, &im);
        const Complex value(re, im);
        weigh(weights, slope_re_.data(), slope_im_.data(), padded_, &re, &im);
        bordered_(a, b) = constant_(a, b) + factor * value;
        bordered_slope_(a, b) = factor_slope * value - factor * Complex(re, im);
        for (const FrozenModes::LeftOut& body : given_.left_out) {
          // w_b z/(z − 1 + w_b) and its derivative.
          const Complex inverse = reciprocal(w + body.share);
          const double closed = body.share * body.closed(a, b);
          bordered_(a, b) += closed * (1.0 + w) * inverse;
          bordered_slope_(a, b) += closed * (body.share - 1.0) * inverse * inverse;
        }
      }
    }
    for (Eigen::Index j = 0; j < num_near; ++j) {
      const std::size_t i = near_[static_cast<std::size_t>(j)];
      const auto mode = static_cast<Eigen::Index>(i);
      const Eigen::Index border = k_ + j;
      for (Eigen::Index a = 0; a < k_; ++a) {
        const double row = -given_.gain(mode) * given_.forces(a, mode);
        bordered_(a, border) = given_.gaps(a, mode);
        bordered_(border, a) = factor * row;
        bordered_slope_(border, a) = factor_slope * row;
      }
      const double x = w.real();
      const double y = w.imag();
      bordered_(border, border) = {(omega_[i] - y) * (omega_[i] + y) + x * (damping_[i] + x),
                                   y * (damping_[i] + 2.0 * x)};
      bordered_slope_(border, border) = 2.0 * w + damping_[i];
    }
  }

  const FrozenModes& given_;
  Eigen::Index n_, k_;
  std::size_t padded_;
  AlignedArray omega_, damping_, mask_;
  AlignedArray value_re_, value_im_, slope_re_, slope_im_, norm_;
  Eigen::MatrixXd constant_;           ///< c + Σ C_i g_i E_i
  std::vector<AlignedArray> weights_;  ///< C_i e_i E_i, columns of A fastest
  std::vector<std::vector<std::size_t>> clusters_;
  std::vector<std::size_t> near_;
  Eigen::MatrixXcd bordered_, bordered_slope_;
};

/// Beside a pole, the count-th of the starts.
Complex start_beside(Complex pole, std::size_t count) {
  const double turn = 0.5 + static_cast<double>(count);
  return pole + std::polar(1e-3 * std::abs(pole) + 1e-9, turn);
}

/// As many starts as there are zeros, beside the smallest poles and those of the modes left out.
struct Starts {
  std::vector<Complex> upper;  ///< beside the poles of oscillations, of positive imaginary part
  std::vector<Complex> alone;

  Starts(const StepFunction& function, const FrozenModes& modes) {
    const auto size = static_cast<std::size_t>(function.num_zeros());
    for (const FrozenModes::LeftOut& body : modes.left_out) {
      for (Eigen::Index i = 0; i < modes.gaps.rows(); ++i)
        alone.push_back(start_beside(-body.share, count()));
    }
    std::vector<Complex> poles;  // one of two conjugates
    for (Eigen::Index i = 0; i < modes.keep.size(); ++i) {
      const auto [first, second] = function.poles(static_cast<std::size_t>(i));
      poles.push_back(first);
      if (first.imag() == 0.0) poles.push_back(second);
    }
    std::sort(poles.begin(), poles.end(),
              [](Complex a, Complex b) { return std::abs(a) < std::abs(b); });
    for (std::size_t i = 0; count() < size; ++i) {
      const Complex start = start_beside(poles[i], count());
      const bool has_conjugate = poles[i].imag() > 0.0 && count() + 2 <= size;
      (has_conjugate ? upper : alone).push_back(start);
    }
  }

  std::size_t count() const { return 2 * upper.size() + alone.size(); }

  /// None of them the conjugate of another.
  Starts apart() const {
    Starts other = *this;
    for (std::size_t j = 0; j < upper.size(); ++j) {
      const Complex mirrored = std::conj(upper[j]);
      other.alone.push_back(upper[j]);
      other.alone.push_back(start_beside(mirrored, other.alone.size()));
    }
    other.upper.clear();
    return other;
  }
};

/// Ehrlich and Aberth's iteration (docs/theory.md, 7.3); whether all have converged.
bool improve(StepFunction& function, ZeroIterates& zeros) {
  constexpr int max_sweeps = 60;
  constexpr int num_expected = 20;
  std::vector<bool> is_done(zeros.num_free(), false);
  std::vector<double> last(zeros.num_free(), std::numeric_limits<double>::infinity());
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
    bool all_done = true;
    for (std::size_t j = 0; j < zeros.num_free(); ++j) {
      if (is_done[j]) continue;
      const Complex slope = function.log_slope(zeros[j]);
      if (slope == StepFunction::at_zero) {
        is_done[j] = true;
        continue;
      }
      const auto [repulsion, spacing] = zeros.around(j);
      Complex step = -reciprocal(slope - repulsion);
      double length = std::abs(step);
      if (!std::isfinite(length)) return false;
      // Beyond its surroundings a step tells nothing.
      constexpr double farthest = 0.5;
      if (length > farthest) step *= farthest / length;
      length = std::min(length, farthest);
      const Complex zero = zeros[j] + step;
      zeros.set(j, zero);
      const double rounding = eps * std::abs(zero);
      const bool has_stalled =
          sweep > num_expected && length >= 0.9 * last[j] && length <= 1e-7 * std::abs(zero);
      // A small step next to another iterate is the other's doing, unless a zero is as close.
      is_done[j] = (length * length <= 1e-2 * rounding * spacing || length <= 4.0 * rounding ||
                    has_stalled) &&
                   1.0 <= std::abs(slope) * std::max(spacing, 1e-6 * std::abs(zero));
      last[j] = length;
      all_done = all_done && is_done[j];
    }
    if (all_done) return true;
  }
  return false;
}

struct Traces {
  double of_step = 0.0;
  double of_square = 0.0;
};

/// Of the matrix of the step of (r, d, λ~_b), F₀ + U V with λ_n = V (r, d, λ~_b).
Traces traces_of(const FrozenModes& modes) {
  const Eigen::ArrayXd& s = modes.keep.array();
  const Eigen::ArrayXd& k = modes.pull.array();
  const Eigen::Index num_contacts = modes.gaps.rows();
  Eigen::MatrixXd from_r = modes.gaps;
  Eigen::MatrixXd from_d = Eigen::MatrixXd::Zero(num_contacts, modes.gaps.cols());
  if (!modes.is_instantaneous) {
    from_r = modes.gaps * (1.0 - k).matrix().asDiagonal();
    from_d = modes.gaps * modes.keep.asDiagonal();
  }
  const Eigen::MatrixXd pushed = -(modes.gain.asDiagonal() * modes.forces.transpose());
  // V U and V F₀ U, before λ_n is solved for.
  Eigen::MatrixXd once = (from_r + from_d) * pushed;
  Eigen::MatrixXd twice = from_r * ((1.0 - k + s).matrix().asDiagonal() * pushed) +
                          from_d * ((s - k).matrix().asDiagonal() * pushed);
  Traces traces;
  traces.of_step = (1.0 - k + s).sum();
  traces.of_square = ((1.0 - k).square() - 2.0 * s * k + s.square()).sum();
  for (const FrozenModes::LeftOut& body : modes.left_out) {
    const double kept = 1.0 - body.share;
    once -= kept * body.share * body.closed;
    twice -= kept * kept * body.share * body.closed;
    traces.of_step += static_cast<double>(num_contacts) * kept;
    traces.of_square += static_cast<double>(num_contacts) * kept * kept;
  }
  const Eigen::PartialPivLU<Eigen::MatrixXd> close(modes.closed());
  once = close.solve(once).eval();
  traces.of_step += once.trace();
  traces.of_square += 2.0 * close.solve(twice).trace() + (once * once).trace();
  return traces;
}

/// The factors, if the iteration ends at as many as the traces ask for.
std::optional<std::vector<Complex>> factors_from(const Starts& starts, StepFunction& function,
                                                 const FrozenModes& modes) {
  ZeroIterates iterates(starts.upper, starts.alone);
  if (!improve(function, iterates)) return std::nullopt;
  std::vector<Complex> factors = iterates.all();
  Complex found = 0.0;
  Complex found_squares = 0.0;
  for (Complex& factor : factors) {
    factor += 1.0;
    found += factor;
    found_squares += factor * factor;
  }
  constexpr double largest_error = 1e-9;
  const double largest = largest_error * static_cast<double>(factors.size());
  const Traces traces = traces_of(modes);
  if (!(std::abs(found - traces.of_step) <= largest &&
        std::abs(found_squares - traces.of_square) <= largest))
    return std::nullopt;
  return factors;
}

}  // namespace

Eigen::MatrixXd FrozenModes::closed() const {
  Eigen::MatrixXd sum = gaps * (is_instantaneous ? feedthrough : gain).asDiagonal() * forces.transpose();
  for (const LeftOut& body : left_out) sum += body.share * body.closed;
  if (compliance.size() > 0) sum.diagonal() += compliance;
  return sum;
}

std::optional<std::vector<Complex>> step_factors(const FrozenModes& modes) {
  if (modes.gaps.rows() == 0 || modes.keep.size() <= modes.gaps.rows()) return std::nullopt;
  if (!modes.is_instantaneous && (!modes.left_out.empty() || modes.compliance.size() > 0))
    return std::nullopt;
  if ((modes.pull.array() < 0.0).any()) return std::nullopt;
  StepFunction function(modes);
  const Starts starts(function, modes);
  // Conjugates cannot part; where two become real, all iterates go their own ways.
  auto factors = factors_from(starts, function, modes);
  if (!factors) factors = factors_from(starts.apart(), function, modes);
  if (factors && !modes.is_instantaneous)
    factors->insert(factors->end(), 2 * static_cast<std::size_t>(modes.gaps.rows()), 0.0);
  return factors;
}

}  // namespace stridor
