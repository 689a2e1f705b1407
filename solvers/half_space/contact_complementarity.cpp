#include "solvers/half_space/contact_complementarity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace stridor {
namespace {

/// Reduction of the residual before the set of contact cells is checked again.
constexpr double early_stop = 0.1;
/// Residual, over the largest target, from which there is no way back.
constexpr double hopeless = 100.0;

/// Several sums, so that the order is fixed and the loop is still a vector loop.
double dot(std::span<const double> a, std::span<const double> b) {
  double sum[8] = {};
  std::size_t i = 0;
  for (; i + 8 <= a.size(); i += 8)
    for (std::size_t k = 0; k < 8; ++k) sum[k] += a[i + k] * b[i + k];
  for (; i < a.size(); ++i) sum[0] += a[i] * b[i];
  return ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7]));
}

double norm(std::span<const double> a) {
  return std::sqrt(dot(a, a));
}

void add_scaled(std::span<double> to, double factor, std::span<const double> what) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += factor * what[i];
}

/// The least-squares problem of GMRES, kept triangular by rotations.
class GrowingLeastSquares {
 public:
  explicit GrowingLeastSquares(double right_hand_side) : right_{right_hand_side} {}

  /// Appends a column of k + 2 entries when there are k.
  void append(std::vector<double> column) {
    const std::size_t k = columns_.size();
    for (std::size_t i = 0; i < k; ++i) {
      const double upper = cosines_[i] * column[i] + sines_[i] * column[i + 1];
      column[i + 1] = cosines_[i] * column[i + 1] - sines_[i] * column[i];
      column[i] = upper;
    }
    const double length = std::hypot(column[k], column[k + 1]);
    cosines_.push_back(length > 0.0 ? column[k] / length : 1.0);
    sines_.push_back(length > 0.0 ? column[k + 1] / length : 0.0);
    column[k] = length;
    columns_.push_back(std::move(column));
    right_.push_back(-sines_[k] * right_[k]);
    right_[k] *= cosines_[k];
  }
  std::size_t size() const { return columns_.size(); }
  double residual() const { return std::abs(right_.back()); }

  std::vector<double> solution() const {
    std::vector<double> y(size());
    for (std::size_t k = size(); k-- > 0;) {
      double sum = right_[k];
      for (std::size_t i = k + 1; i < size(); ++i) sum -= columns_[i][k] * y[i];
      y[k] = columns_[k][k] > 0.0 ? sum / columns_[k][k] : 0.0;
    }
    return y;
  }

 private:
  std::vector<std::vector<double>> columns_;
  std::vector<double> right_;
  std::vector<double> cosines_;
  std::vector<double> sines_;
};

}  // namespace

ContactComplementarity::ContactComplementarity(HalfSpaceConvolution& half_space)
    : half_space_(half_space),
      in_contact_(half_space.num_values()),
      displacement_(half_space.num_values()),
      residual_(half_space.num_values()) {}

void ContactComplementarity::restrict_to_contact(std::span<double> field) const {
  for (std::size_t i = 0; i < field.size(); ++i) field[i] = in_contact_[i] ? field[i] : 0.0;
}

void ContactComplementarity::update_residual(std::span<const double> target) {
  for (std::size_t i = 0; i < residual_.size(); ++i)
    residual_[i] = in_contact_[i] ? target[i] - displacement_[i] : 0.0;
}

void ContactComplementarity::approach(std::span<double> pressure, double wanted_norm,
                                      const ComplementarityLimits& limits) {
  const double start = norm(residual_);
  if (start <= wanted_norm) return;
  const auto at = [this](std::vector<Field>& fields, std::size_t k) -> Field& {
    if (k == fields.size()) fields.emplace_back(half_space_.num_values());
    return fields[k];
  };
  GrowingLeastSquares system(start);
  Field& first = at(basis_, 0);
  for (std::size_t i = 0; i < first.size(); ++i) first[i] = residual_[i] / start;
  while (system.residual() > wanted_norm && system.size() < limits.max_directions) {
    const std::size_t k = system.size();
    Field& next = at(basis_, k + 1);
    Field& direction = at(directions_, k);
    Field& image = at(images_, k);
    half_space_.apply_inverse(basis_[k], direction);
    restrict_to_contact(direction);
    half_space_.apply(direction, image);
    products_ += 2;
    next = image;
    restrict_to_contact(next);
    const double length = norm(next);
    std::vector<double> column(k + 2);
    for (std::size_t i = 0; i <= k; ++i) {
      column[i] = dot(next, basis_[i]);
      add_scaled(next, -column[i], basis_[i]);
    }
    column[k + 1] = norm(next);
    const bool is_exhausted = column[k + 1] <= 1e-15 * length;
    if (!is_exhausted)
      for (double& value : next) value /= column[k + 1];
    system.append(std::move(column));
    if (is_exhausted) break;
  }
  const std::vector<double> amounts = system.solution();
  for (std::size_t k = 0; k < amounts.size(); ++k) {
    add_scaled(pressure, amounts[k], directions_[k]);
    add_scaled(displacement_, amounts[k], images_[k]);
  }
}

void ContactComplementarity::check(std::span<const double> target,
                                   const ComplementarityLimits& limits,
                                   std::span<const double> pressure) const {
  const std::size_t size = half_space_.num_values();
  if (target.size() != size || pressure.size() != size) {
    throw std::invalid_argument(fmt::format(
        "ContactComplementarity: {} targets and {} pressures for {} cells of half the window",
        target.size(), pressure.size(), size));
  }
  if (!(limits.tolerance > 0.0) || limits.max_rounds == 0 || limits.max_directions == 0)
    throw std::invalid_argument("ContactComplementarity: a limit is not > 0");
}

ContactComplementarity::Exchange ContactComplementarity::exchange_cells(
    std::span<const double> target, double sinking, std::span<double> pressure) {
  Exchange exchange;
  for (std::size_t i = 0; i < pressure.size(); ++i) {
    if (in_contact_[i]) {
      if (pressure[i] >= 0.0) continue;
      in_contact_[i] = 0;
      pressure[i] = 0.0;
      ++exchange.num_left;
    } else if (displacement_[i] < target[i] - sinking) {
      in_contact_[i] = 1;
      ++exchange.num_joined;
    }
  }
  return exchange;
}

ComplementarityOutcome ContactComplementarity::solve(std::span<const double> target,
                                                     const ComplementarityLimits& limits,
                                                     std::span<double> pressure) {
  check(target, limits, pressure);
  ComplementarityOutcome outcome;
  products_ = 0;
  const double largest = *std::max_element(target.begin(), target.end());
  if (!(largest > 0.0)) {
    std::fill(pressure.begin(), pressure.end(), 0.0);
    std::fill(displacement_.begin(), displacement_.end(), 0.0);
    outcome.converged = true;
    return outcome;
  }
  for (std::size_t i = 0; i < pressure.size(); ++i) {
    in_contact_[i] = pressure[i] > 0.0 && std::isfinite(target[i]);
    if (!in_contact_[i]) pressure[i] = 0.0;
  }
  const auto apply = [&] {
    half_space_.apply(pressure, displacement_);
    ++products_;
  };
  const auto residual_scale = [&] {
    const auto count = std::count(in_contact_.begin(), in_contact_.end(), 1);
    return largest * std::sqrt(std::max(1.0, static_cast<double>(count)));
  };
  // Cells that leave must not come back because of the remaining residual.
  const double sinking = 0.1 * limits.tolerance * largest;

  apply();
  bool is_exact = true;  // displacement_ is a product, not an update
  while (outcome.rounds < limits.max_rounds) {
    ++outcome.rounds;
    update_residual(target);
    double reached = norm(residual_);
    const double wanted = limits.tolerance * residual_scale();
    if (reached > wanted) {
      approach(pressure, std::max(0.9 * wanted, early_stop * reached), limits);
      is_exact = false;
      update_residual(target);
      reached = norm(residual_);
    }
    const auto [num_left, num_joined] = exchange_cells(target, sinking, pressure);
    outcome.residual = reached / residual_scale();
    if (!(outcome.residual < hopeless)) break;
    if (num_left == 0 && num_joined == 0 && reached <= wanted) {
      if (is_exact) {
        outcome.converged = true;
        break;
      }
      apply();
      is_exact = true;
    } else if (num_left > 0) {
      apply();
      is_exact = true;
    }
  }
  outcome.products = products_;
  return outcome;
}

}  // namespace stridor
