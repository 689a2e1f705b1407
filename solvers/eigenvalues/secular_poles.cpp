#include "solvers/eigenvalues/secular_poles.hpp"

#include <cmath>
#include <limits>
#include <utility>

namespace stridor {
namespace {

std::size_t padded_to_blocks(Eigen::Index size) {
  return (static_cast<std::size_t>(size) + secular_block - 1) / secular_block * secular_block;
}

}  // namespace

bool SecularPoles::BodyTerms::operator==(const BodyTerms& other) const {
  const auto is_same = [](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return a.rows() == b.rows() && a.cols() == b.cols() && a == b;
  };
  return is_same(ports, other.ports) && is_same(stiffness, other.stiffness) &&
         is_same(damping, other.damping);
}

SecularPoles::BodyTerms SecularPoles::body_terms(const Pencil& pencil) {
  const Eigen::Index size = pencil.num_body_ports;
  if (size == 0) return {};
  const auto between = [&](const Eigen::MatrixXd& terms) -> Eigen::MatrixXd {
    if (terms.size() == 0) return {};
    return terms.bottomRightCorner(size, size);
  };
  return {pencil.ports.bottomRows(size), between(pencil.port_stiffness),
          between(pencil.port_damping)};
}

bool SecularPoles::assign(const Pencil& pencil) {
  const bool has_same_modes = pencil.num_modes() == num_modes_ && pencil.omega == given_omega_ &&
                              pencil.damping == given_damping_ &&
                              body_terms(pencil) == given_terms_;
  if (has_same_modes) return false;
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
    const std::complex<double> first = coupled_.poles(2 * j);
    const std::complex<double> second = coupled_.poles(2 * j + 1);
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
  sort(omega, damping);
  return true;
}

void SecularPoles::sort(const Eigen::VectorXd& omega, const Eigen::VectorXd& damping) {
  padded_ = padded_to_blocks(num_modes_);
  omega_ = AlignedArray(padded_);
  damping_ = AlignedArray(padded_);
  std::fill_n(omega_.data(), padded_, padding_omega);
  extent_ = 0.0;
  smallest_ = std::numeric_limits<double>::infinity();
  heights_.clear();
  for (std::size_t i = 0; i < order_.size(); ++i) {
    omega_[i] = omega(order_[i]);
    damping_[i] = damping(order_[i]);
    heights_.push_back(std::max(0.0, height_of(of(i).front())));
    extent_ = std::max({extent_, omega_[i], std::abs(damping_[i])});
    for (const std::complex<double> pole : of(i))
      if (pole != 0.0) smallest_ = std::min(smallest_, std::abs(pole));
  }
  if (extent_ == 0.0) extent_ = 1.0;
  smallest_ = std::min(smallest_, extent_);
  sorted_heights_ = heights_;
  std::sort(sorted_heights_.begin(), sorted_heights_.end());
  find_clusters();
}

void SecularPoles::find_clusters() {
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
}

std::array<std::complex<double>, 2> SecularPoles::of(std::size_t i) const {
  const double half = 0.5 * damping_[i];
  const double square = (omega_[i] - half) * (omega_[i] + half);
  if (square >= 0.0) {
    const double height = std::sqrt(square);
    return {std::complex<double>(-half, height), std::complex<double>(-half, -height)};
  }
  // The one farther from zero first, the other from the product of both: no difference of equals.
  const double far = -half - std::copysign(std::sqrt(-square), half);
  const double near = far == 0.0 ? 0.0 : omega_[i] * omega_[i] / far;
  return {std::complex<double>(std::max(far, near), 0.0),
          std::complex<double>(std::min(far, near), 0.0)};
}

double SecularPoles::distance_from(std::complex<double> s) const {
  double distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < order_.size(); ++i) {
    for (const std::complex<double> pole : of(i)) distance = std::min(distance, std::abs(pole - s));
  }
  return distance;
}

int SecularPoles::nearest(std::complex<double> s) const {
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

}  // namespace stridor
