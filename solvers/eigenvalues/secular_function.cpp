#include "solvers/eigenvalues/secular_function.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "solvers/algebra/small_matrices.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

std::size_t padded_size(Eigen::Index size) {
  return (static_cast<std::size_t>(size) + secular_block - 1) / secular_block * secular_block;
}

/// |z| without the care for overflow that the library takes: no number here is near it.
double magnitude(Complex z) {
  return std::sqrt(std::norm(z));
}

/// Angle from a to b, −π … π.
double turn(Complex a, Complex b) {
  return std::arg(b * std::conj(a));
}

}  // namespace

SecularFunction::SecularFunction(const Pencil& pencil) {
  assign(pencil);
}

void SecularFunction::assign(const Pencil& pencil) {
  check_pencil(pencil);
  const bool has_same_modes = pencil.num_modes() == num_modes_ && pencil.omega == given_omega_ &&
                              pencil.damping == given_damping_ &&
                              body_terms(pencil) == given_terms_;
  if (!has_same_modes) assign_modes(pencil);
  assign_rows(pencil);
}

bool SecularFunction::BodyTerms::operator==(const BodyTerms& other) const {
  const auto is_same = [](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return a.rows() == b.rows() && a.cols() == b.cols() && a == b;
  };
  return is_same(ports, other.ports) && is_same(stiffness, other.stiffness) &&
         is_same(damping, other.damping);
}

SecularFunction::BodyTerms SecularFunction::body_terms(const Pencil& pencil) {
  const Eigen::Index size = pencil.num_body_ports;
  if (size == 0) return {};
  const auto between = [&](const Eigen::MatrixXd& terms) -> Eigen::MatrixXd {
    if (terms.size() == 0) return {};
    return terms.bottomRightCorner(size, size);
  };
  return {pencil.ports.bottomRows(size), between(pencil.port_stiffness),
          between(pencil.port_damping)};
}

void SecularFunction::assign_modes(const Pencil& pencil) {
  num_modes_ = pencil.num_modes();
  given_omega_ = pencil.omega;
  given_damping_ = pencil.damping;
  given_terms_ = body_terms(pencil);
  // Terms that have no eigenvectors stay between ports, where they cost more.
  coupled_ = coupled_modes(pencil).value_or(CoupledModes{});

  // Pairs of coupled modes come after the modes of the pencil.
  const Eigen::Index num_pairs = coupled_.num_pairs();
  Eigen::VectorXd omega(num_modes_ + num_pairs);
  Eigen::VectorXd damping(num_modes_ + num_pairs);
  omega.head(num_modes_) = pencil.omega;
  damping.head(num_modes_) = pencil.damping;
  for (Eigen::Index j = 0; j < num_pairs; ++j) {
    const Complex first = coupled_.poles(2 * j);
    const Complex second = coupled_.poles(2 * j + 1);
    omega(num_modes_ + j) = std::sqrt(std::abs(first) * std::abs(second));
    damping(num_modes_ + j) = -(first + second).real();
  }
  std::vector<bool> is_coupled(static_cast<std::size_t>(num_modes_ + num_pairs), false);
  for (const Eigen::Index mode : coupled_.modes) is_coupled[static_cast<std::size_t>(mode)] = true;
  order_.clear();
  for (Eigen::Index i = 0; i < num_modes_ + num_pairs; ++i)
    if (!is_coupled[static_cast<std::size_t>(i)]) order_.push_back(i);
  std::sort(order_.begin(), order_.end(), [&](Eigen::Index a, Eigen::Index b) {
    return std::pair(omega(a), damping(a)) < std::pair(omega(b), damping(b));
  });
  sort_modes(omega, damping);
}

/// Sets up the quantities that depend on the poles, in the order of order_.
void SecularFunction::sort_modes(const Eigen::VectorXd& omega, const Eigen::VectorXd& damping) {
  padded_ = padded_size(num_modes_);
  omega_ = AlignedArray(padded_);
  damping_ = AlignedArray(padded_);
  for (AlignedArray* scratch : {&mask_, &value_re_, &value_im_, &slope_re_, &slope_im_, &norm_}) {
    *scratch = AlignedArray(padded_);
  }
  std::fill_n(omega_.data(), padded_, padding_omega);
  extent_ = 0.0;
  smallest_pole_ = std::numeric_limits<double>::infinity();
  height_of_.clear();
  for (std::size_t i = 0; i < order_.size(); ++i) {
    omega_[i] = omega(order_[i]);
    damping_[i] = damping(order_[i]);
    height_of_.push_back(std::max(0.0, height_of(poles(static_cast<Eigen::Index>(i)).front())));
    extent_ = std::max({extent_, omega_[i], std::abs(damping_[i])});
    for (const Complex pole : poles(static_cast<Eigen::Index>(i)))
      if (pole != 0.0) smallest_pole_ = std::min(smallest_pole_, std::abs(pole));
  }
  if (extent_ == 0.0) extent_ = 1.0;
  smallest_pole_ = std::min(smallest_pole_, extent_);
  heights_ = height_of_;
  std::sort(heights_.begin(), heights_.end());

  // Poles so close together that multiplying out one leaves nothing but rounding of the other.
  constexpr double closeness = 1e-5;
  clusters_.assign(order_.size(), {});
  for (std::size_t i = 0; i < order_.size(); ++i) {
    for (std::size_t j = i + 1; j < order_.size() && omega_[j] <= omega_[i] * (1.0 + closeness);
         ++j) {
      if (std::abs(damping_[j] - damping_[i]) > closeness * omega_[i]) continue;
      clusters_[i].push_back(static_cast<int>(j));
      clusters_[j].push_back(static_cast<int>(i));
    }
  }
  lines_.clear();
  mask_height_ = -1.0;
}

void SecularFunction::assign_rows(const Pencil& pencil) {
  if (has_coupled()) {
    const Eigen::Index num_ports = pencil.num_ports() - pencil.num_body_ports;
    Pencil contacts;
    contacts.omega = pencil.omega;
    contacts.ports = pencil.ports.topRows(num_ports);
    contacts.compatibility = pencil.compatibility.leftCols(num_ports);
    contacts.equilibrium = pencil.equilibrium.leftCols(num_ports);
    for (const auto terms : {&Pencil::port_stiffness, &Pencil::port_damping}) {
      if ((pencil.*terms).size() > 0)
        contacts.*terms = (pencil.*terms).topLeftCorner(num_ports, num_ports);
    }
    rows_ = modal_rows(contacts);
    coupled_outputs_ =
        rows_.outputs(Eigen::all, coupled_.modes).cast<Complex>().lazyProduct(coupled_.shapes);
    coupled_inputs_ =
        rows_.inputs(Eigen::all, coupled_.modes).cast<Complex>().lazyProduct(coupled_.adjoint);
  } else {
    rows_ = modal_rows(pencil);
  }
  constexpr Eigen::Index most_powers = 3;
  const Eigen::Index size = num_rows();
  weights_.resize(static_cast<std::size_t>(size * size * most_powers));
  for (Eigen::Index b = 0; b < size; ++b) {
    for (Eigen::Index power = 0; power < num_powers(b); ++power) {
      for (Eigen::Index a = 0; a < size; ++a) {
        AlignedArray& weights = weights_of(a, b, power);
        if (weights.size() != padded_) {
          weights = AlignedArray(padded_);
        } else if (has_coupled()) {
          std::fill_n(weights.data(), padded_, 0.0);
        }
      }
    }
  }
  for (std::size_t i = 0; i < order_.size(); ++i)
    order_[i] < num_modes_ ? add_weights(i) : add_coupled_weights(i);
}

void SecularFunction::add_weights(std::size_t i) {
  const Eigen::Index k = rows_.num_constraints;
  const Eigen::Index size = num_rows();
  const Eigen::Index mode = order_[i];
  for (Eigen::Index b = 0; b < size; ++b) {
    for (Eigen::Index a = 0; a < size; ++a) {
      weights_of(a, b, 0)[i] = rows_.outputs(a, mode) * rows_.inputs(b, mode);
      if (b >= k)
        weights_of(a, b, 1)[i] = rows_.outputs(a, mode) * rows_.inputs(b + rows_.rank, mode);
    }
  }
}

/// a/(s − p) + a'/(s − p') = ((a + a') s − (a p' + a' p))/d of the two poles of a pair, where a and
/// a' are conjugates if p and p' are.
void SecularFunction::add_coupled_weights(std::size_t i) {
  const Eigen::Index k = rows_.num_constraints;
  const Eigen::Index size = num_rows();
  const Eigen::Index at = 2 * (order_[i] - num_modes_);
  const Complex p = coupled_.poles(at);
  const Complex other = coupled_.poles(at + 1);
  for (Eigen::Index b = 0; b < size; ++b) {
    for (Eigen::Index a = 0; a < size; ++a) {
      const auto add = [&](Eigen::Index input, Eigen::Index power) {
        const Complex residue = coupled_outputs_(a, at) * coupled_inputs_(input, at);
        const Complex other_residue = coupled_outputs_(a, at + 1) * coupled_inputs_(input, at + 1);
        weights_of(a, b, power)[i] -= (residue * other + other_residue * p).real();
        weights_of(a, b, power + 1)[i] += (residue + other_residue).real();
      };
      add(b, 0);
      if (b >= k) add(b + rows_.rank, 1);
    }
  }
}

std::array<Complex, 2> SecularFunction::poles(Eigen::Index i) const {
  const auto mode = static_cast<std::size_t>(i);
  const double half = 0.5 * damping_[mode];
  const double square = (omega_[mode] - half) * (omega_[mode] + half);
  if (square >= 0.0) {
    const double height = std::sqrt(square);
    return {Complex(-half, height), Complex(-half, -height)};
  }
  // The one farther from zero first, the other from the product of both: no difference of equals.
  const double far = -half - std::copysign(std::sqrt(-square), half);
  const double near = far == 0.0 ? 0.0 : omega_[mode] * omega_[mode] / far;
  return {Complex(std::max(far, near), 0.0), Complex(std::min(far, near), 0.0)};
}

Complex SecularFunction::denominator(std::size_t i, Complex s) const {
  const double x = s.real();
  const double y = s.imag();
  return {(omega_[i] - y) * (omega_[i] + y) + x * (damping_[i] + x), y * (damping_[i] + 2.0 * x)};
}

Complex SecularFunction::denominator_slope(std::size_t i, Complex s) const {
  return 2.0 * s + damping_[i];
}

int SecularFunction::nearest_mode(Complex s) const {
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const double norm = std::norm(denominator(i, s));
    if (norm < least) {
      least = norm;
      nearest = i;
    }
  }
  return static_cast<int>(nearest);
}

void SecularFunction::find_near(Complex s, double least, int& hint) {
  // Somewhat farther than the nearest is as good, and saves the search.
  const bool is_good = hint >= 0 && hint < num_modes_ &&
                       std::norm(denominator(static_cast<std::size_t>(hint), s)) <= 4.0 * least;
  if (!is_good) hint = nearest_mode(s);
  near_.assign(1, hint);
  const auto& cluster = clusters_[static_cast<std::size_t>(hint)];
  near_.insert(near_.end(), cluster.begin(), cluster.end());
}

SecularFunction::LogSlope SecularFunction::log_slope(Complex s, int& hint) {
  return is_scalar() ? scalar_log_slope(s, hint) : matrix_log_slope(s, hint);
}

SecularFunction::LogSlope SecularFunction::scalar_log_slope(Complex s, int& hint) {
  AlignedArray& weights = weights_.front();
  if (hint < 0 || hint >= num_modes_) hint = nearest_mode(s);
  for (;;) {
    const auto i = static_cast<std::size_t>(hint);
    if (!clusters_[i].empty()) return matrix_log_slope(s, hint);
    const double weight = std::exchange(weights[i], 0.0);
    const SecularSums sums =
        sum_modes({omega_.data(), damping_.data(), padded_}, weights.data(), s.real(), s.imag());
    weights[i] = weight;
    const Complex d = denominator(i, s);
    if (std::norm(d) > 4.0 * sums.least) {
      const int nearest = nearest_mode(s);
      if (nearest != hint) {
        hint = nearest;
        continue;
      }
    }
    near_.assign(1, hint);
    const Complex g(sums.value_re, sums.value_im);
    const Complex slope(sums.slope_re, sums.slope_im);
    const Complex value = weight + d * g;
    if (value == 0.0) return {0.0, true};
    return {(denominator_slope(i, s) * g - d * slope) * reciprocal(value), false};
  }
}

void SecularFunction::form_bordered(Complex s) {
  const Eigen::Index size = num_rows();
  Eigen::Index num_borders = 0;
  for (const int i : near_) {
    const auto mode = static_cast<std::size_t>(i);
    for (AlignedArray* array : {&value_re_, &value_im_, &slope_re_, &slope_im_}) {
      (*array)[mode] = 0.0;
    }
    num_borders += order_[mode] < num_modes_ ? 1 : 2;
  }
  bordered_.setZero(size + num_borders, size + num_borders);
  bordered_slope_.setZero(size + num_borders, size + num_borders);
  for (Eigen::Index a = 0; a < size; ++a) {
    for (Eigen::Index b = 0; b < size; ++b) {
      // Σ over powers p of s^p T_p, and its derivative.
      Complex factor = 1.0;
      Complex factor_slope = 0.0;
      for (Eigen::Index power = 0; power < num_powers(b); ++power) {
        const double* weights = weights_of(a, b, power).data();
        double re = 0.0;
        double im = 0.0;
        weigh(weights, value_re_.data(), value_im_.data(), padded_, &re, &im);
        bordered_(a, b) += factor * Complex(re, im);
        bordered_slope_(a, b) += factor_slope * Complex(re, im);
        weigh(weights, slope_re_.data(), slope_im_.data(), padded_, &re, &im);
        bordered_slope_(a, b) -= factor * Complex(re, im);
        factor_slope = static_cast<double>(power + 1) * factor;
        factor *= s;
      }
      if (b >= rows_.num_constraints && a == b) bordered_(a, b) += 1.0;
    }
  }
  Eigen::Index border = size;
  for (const int i : near_) {
    const Eigen::Index mode = order_[static_cast<std::size_t>(i)];
    if (mode < num_modes_) {
      border_mode(s, mode, static_cast<std::size_t>(i), border++);
    } else {
      border_pole(s, 2 * (mode - num_modes_), border++);
      border_pole(s, 2 * (mode - num_modes_) + 1, border++);
    }
  }
}

void SecularFunction::border_mode(Complex s, Eigen::Index mode, std::size_t i,
                                  Eigen::Index border) {
  for (Eigen::Index a = 0; a < num_rows(); ++a) {
    bordered_(a, border) = rows_.outputs(a, mode);
    bordered_(border, a) = -rows_.inputs(a, mode);
    if (a < rows_.num_constraints) continue;
    bordered_(border, a) -= s * rows_.inputs(a + rows_.rank, mode);
    bordered_slope_(border, a) = -rows_.inputs(a + rows_.rank, mode);
  }
  bordered_(border, border) = denominator(i, s);
  bordered_slope_(border, border) = denominator_slope(i, s);
}

void SecularFunction::border_pole(Complex s, Eigen::Index pole, Eigen::Index border) {
  for (Eigen::Index a = 0; a < num_rows(); ++a) {
    bordered_(a, border) = coupled_outputs_(a, pole);
    bordered_(border, a) = -coupled_inputs_(a, pole);
    if (a < rows_.num_constraints) continue;
    bordered_(border, a) -= s * coupled_inputs_(a + rows_.rank, pole);
    bordered_slope_(border, a) = -coupled_inputs_(a + rows_.rank, pole);
  }
  bordered_(border, border) = s - coupled_.poles(pole);
  bordered_slope_(border, border) = 1.0;
}

SecularFunction::LogSlope SecularFunction::matrix_log_slope(Complex s, int& hint) {
  const double least = invert_modes(
      {omega_.data(), damping_.data(), padded_}, s.real(), s.imag(),
      {value_re_.data(), value_im_.data(), slope_re_.data(), slope_im_.data(), norm_.data()});
  find_near(s, least, hint);
  form_bordered(s);
  // Rows and columns differ by many orders of magnitude in unit; pivoting wants them alike. The
  // trace of B⁻¹ B′ does not change.
  if (!equilibrate(bordered_, bordered_slope_)) return {0.0, true};
  const std::optional<Complex> trace = trace_of_solution(bordered_, bordered_slope_);
  if (!trace) return {0.0, true};
  return {*trace, false};
}

SecularFunction::LogSlope SecularFunction::log_slope_below(Complex s, double height, int& hint) {
  if (height != mask_height_) {
    for (std::size_t i = 0; i < order_.size(); ++i) mask_[i] = height_of_[i] < height ? 1.0 : 0.0;
    mask_height_ = height;
  }
  LogSlope slope = log_slope(s, hint);
  if (slope.is_zero) return slope;
  // The poles near s are out of F already: one of them below the limit must not count twice, one
  // above it comes back.
  std::vector<double> present;
  for (const int i : near_)
    present.push_back(std::exchange(mask_[static_cast<std::size_t>(i)], 0.0));
  double re = 0.0;
  double im = 0.0;
  sum_pole_slopes({omega_.data(), damping_.data(), padded_}, mask_.data(), s.real(), s.imag(), &re,
                  &im);
  slope.value += Complex(re, im);
  for (std::size_t j = 0; j < near_.size(); ++j) {
    const auto i = static_cast<std::size_t>(near_[j]);
    mask_[i] = present[j];
    if (present[j] == 0.0) slope.value -= denominator_slope(i, s) / denominator(i, s);
  }
  return slope;
}

SecularFunction::Zero SecularFunction::find_zero(Complex guess, double spacing, int& hint) {
  Zero zero{guess, false, 0};
  constexpr int max_evaluations = 60;
  constexpr int num_expected = 20;
  constexpr double eps = std::numeric_limits<double>::epsilon();
  double last = std::numeric_limits<double>::infinity();
  while (zero.evaluations < max_evaluations) {
    const LogSlope slope = log_slope(zero.s, hint);
    ++zero.evaluations;
    if (slope.is_zero) {
      zero.is_converged = true;
      return zero;
    }
    Complex step = -reciprocal(slope.value);
    if (guess.imag() == 0.0) step.imag(0.0);
    zero.s += step;
    const double size = magnitude(step);
    const double distance_to_origin = magnitude(zero.s);
    const double size_of_zero = std::max(distance_to_origin, smallest_pole_);
    const double rounding = eps * size_of_zero;
    if (!std::isfinite(size)) return zero;
    // Poles that were not multiplied out bend F as other zeros do.
    for (const int i : {hint - 1, hint + 1}) {
      if (i < 0 || i >= num_modes_) continue;
      const double distance =
          0.5 * magnitude(denominator(static_cast<std::size_t>(i), zero.s)) / distance_to_origin;
      spacing = std::min(spacing, 0.2 * distance);
    }
    // Newton's error after a small step is step²/spacing. Next to a double zero steps end when they
    // have reached the rounding of F; between two close zeros they go astray for a while, so that
    // growing ones alone do not mean much.
    const bool has_stalled =
        zero.evaluations > num_expected && size >= 0.9 * last && size <= 1e-7 * size_of_zero;
    if (size * size <= rounding * spacing || size <= 4.0 * rounding || has_stalled) {
      zero.is_converged = true;
      return zero;
    }
    last = size;
  }
  return zero;
}

Complex SecularFunction::determinant(const double* inverse_re, const double* inverse_im,
                                     Complex s) {
  const Eigen::Index size = num_rows();
  const auto sum = [&](Eigen::Index a, Eigen::Index b, Eigen::Index power) {
    double re = 0.0;
    double im = 0.0;
    weigh(weights_of(a, b, power).data(), inverse_re, inverse_im, padded_, &re, &im);
    return Complex(re, im);
  };
  if (is_scalar()) return sum(0, 0, 0);
  if (size == 0) return 1.0;
  Eigen::MatrixXcd matrix(size, size);
  for (Eigen::Index a = 0; a < size; ++a) {
    for (Eigen::Index b = 0; b < size; ++b) {
      matrix(a, b) = sum(a, b, 0);
      Complex factor = s;
      for (Eigen::Index power = 1; power < num_powers(b); ++power, factor *= s)
        matrix(a, b) += factor * sum(a, b, power);
      if (b >= rows_.num_constraints && a == b) matrix(a, b) += 1.0;
    }
    // A positive factor; without it the determinant of many rows leaves the range of a double.
    const double largest = matrix.row(a).cwiseAbs2().maxCoeff();
    if (largest > 0.0) matrix.row(a) *= 1.0 / std::sqrt(largest);
  }
  return determinant_of(matrix);
}

Complex SecularFunction::determinant_at(Complex s) {
  invert_modes(
      {omega_.data(), damping_.data(), padded_}, s.real(), s.imag(),
      {value_re_.data(), value_im_.data(), slope_re_.data(), slope_im_.data(), norm_.data()});
  return determinant(value_re_.data(), value_im_.data(), s);
}

SecularFunction::Line& SecularFunction::line_at(double height) {
  const auto found = lines_.find(height);
  if (found != lines_.end()) return found->second;
  // A table of 60 samples of some hundred modes takes 0.2 MB.
  constexpr std::size_t max_lines = 64;
  if (lines_.size() >= max_lines) lines_.clear();

  Line line;
  const double end = 1e3 * extent_;
  const auto on_side = [&](double x) { return Complex(x, height + std::abs(x)); };
  // Far from all poles det A is a power of s.
  constexpr int num_rises = 4;
  for (int i = 0; i < num_rises; ++i)
    line.places.emplace_back(end, i * on_side(end).imag() / num_rises);
  double x = end;
  while (x > -end) {
    const Complex place = on_side(x);
    line.places.push_back(place);
    double distance = place.imag();
    for (std::size_t i = 0; i < order_.size(); ++i) {
      for (const Complex pole : poles(static_cast<Eigen::Index>(i)))
        distance = std::min(distance, std::abs(pole - place));
    }
    // The floor keeps the number of samples finite.
    constexpr double closest = 1e-9;
    line.meets_pole = line.meets_pole || distance < closest * place.imag();
    const double step = std::max(0.5 * distance / std::numbers::sqrt2, closest * extent_);
    // The corner is one of the samples.
    x = x > 0.0 ? std::max(x - step, 0.0) : x - step;
  }
  for (int i = num_rises; i >= 0; --i)
    line.places.emplace_back(-end, i * on_side(end).imag() / num_rises);
  line.inverses = AlignedArray(2 * padded_ * line.places.size());
  for (std::size_t p = 0; p < line.places.size(); ++p) {
    double* const re = line.inverses.data() + 2 * padded_ * p;
    invert_modes({omega_.data(), damping_.data(), padded_}, line.places[p].real(),
                 line.places[p].imag(),
                 {re, re + padded_, slope_re_.data(), slope_im_.data(), norm_.data()});
  }
  line.values.resize(line.places.size());
  return lines_.emplace(height, std::move(line)).first->second;
}

std::optional<int> SecularFunction::count_zeros_below(double height) {
  Line& line = line_at(height);
  if (line.meets_pole) return std::nullopt;
  for (std::size_t p = 0; p < line.places.size(); ++p) {
    const double* const re = line.inverses.data() + 2 * padded_ * p;
    line.values[p] = determinant(re, re + padded_, line.places[p]);
  }
  constexpr double largest_turn = 1.0;
  constexpr int max_halvings = 30;
  double total = 0.0;
  std::vector<std::pair<Complex, Complex>> waiting;  // places and values yet to be reached
  for (std::size_t p = 0; p + 1 < line.places.size(); ++p) {
    Complex place = line.places[p];
    Complex value = line.values[p];
    waiting.assign(1, {line.places[p + 1], line.values[p + 1]});
    while (!waiting.empty()) {
      const auto [next_place, next_value] = waiting.back();
      const double angle = turn(value, next_value);
      if (!std::isfinite(angle)) return std::nullopt;
      if (std::abs(angle) > largest_turn) {
        if (waiting.size() > max_halvings) return std::nullopt;
        const Complex middle = 0.5 * (place + next_place);
        waiting.emplace_back(middle, determinant_at(middle));
        continue;
      }
      total += angle;
      place = next_place;
      value = next_value;
      waiting.pop_back();
    }
  }
  const auto num_modes_below =
      std::lower_bound(heights_.begin(), heights_.end(), height) - heights_.begin();
  const double zeros = total / std::numbers::pi + 2.0 * static_cast<double>(num_modes_below);
  // Both ends are real: only rounding keeps the turn from being a multiple of π.
  if (std::abs(zeros - std::round(zeros)) > 0.1) return std::nullopt;
  return static_cast<int>(std::lround(zeros));
}

}  // namespace stridor
