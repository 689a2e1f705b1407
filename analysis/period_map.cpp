#include "analysis/period_map.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/errors.hpp"
#include "core/stop_token.hpp"

namespace stridor {

StepOutcome step_on(Simulation& simulation, std::int64_t target) {
  constexpr std::int64_t stretch = 100'000;
  while (simulation.step_index() < target) {
    throw_if_stopped();
    const StepOutcome outcome =
        simulation.step_until(std::min(target, simulation.step_index() + stretch));
    if (outcome != StepOutcome::done) return outcome;
  }
  return StepOutcome::done;
}

PeriodMap::PeriodMap(System& system, const TimeParameters& time, const Simulation& simulation,
                     std::int64_t num_steps)
    : system_(&system), time_(time), num_steps_(num_steps) {
  for (std::size_t b = 0; b < system.bodies.size(); ++b)
    sizes_.push_back(simulation.motion(static_cast<int>(b)).displacement.size());
  for (const Eigen::Index n : sizes_) num_unknowns_ += 2 * n;
}

std::optional<Eigen::VectorXd> PeriodMap::state_of(Simulation& simulation) const {
  const std::vector<Propagator::Motion> before = motions_of(simulation);
  if (simulation.step() != StepOutcome::done) return std::nullopt;
  const std::vector<Propagator::Motion> after = motions_of(simulation);
  Eigen::VectorXd z(num_unknowns_);
  Eigen::Index first = 0;
  for (std::size_t b = 0; b < sizes_.size(); ++b) {
    const Eigen::Index n = sizes_[b];
    z.segment(first, n) = before[b].displacement;
    // Both are backward differences: their mean is the velocity between them, to second order.
    z.segment(first + n, n) = 0.5 * (before[b].velocity + after[b].velocity);
    first += 2 * n;
  }
  return z;
}

void PeriodMap::set(const Eigen::VectorXd& z) {
  Eigen::Index first = 0;
  for (std::size_t b = 0; b < sizes_.size(); ++b) {
    SystemBody& body = system_->bodies[b];
    const Eigen::Index n = sizes_[b];
    const bool is_modal = time_.coordinates == Coordinates::modal;
    const auto reduced = [&](const Eigen::VectorXd& q) -> Eigen::VectorXd {
      if (!is_modal || n == 0) return q;
      return body.modal.shapes.leftCols(n) * q;
    };
    body.initial_displacement = reduced(z.segment(first, n));
    body.initial_velocity = reduced(z.segment(first + n, n));
    first += 2 * n;
  }
}

std::optional<Eigen::VectorXd> PeriodMap::operator()(const Eigen::VectorXd& z, double period) {
  throw_if_stopped();
  set(z);
  TimeParameters time = time_;
  time.step = period / static_cast<double>(num_steps_);
  try {
    Simulation simulation(*system_, time);
    if (simulation.step_until(num_steps_) != StepOutcome::done) return std::nullopt;
    return state_of(simulation);
  } catch (const NumericalError&) {
    return std::nullopt;
  } catch (const ConfigError&) {  // the step is above the limit of stability
    return std::nullopt;
  }
}

Eigen::RowVectorXd PeriodMap::velocity_row(int body, int row) const {
  Eigen::RowVectorXd of_z = Eigen::RowVectorXd::Zero(num_unknowns_);
  Eigen::Index first = 0;
  for (int b = 0; b < body; ++b) first += 2 * sizes_[static_cast<std::size_t>(b)];
  const SystemBody& of = system_->bodies[static_cast<std::size_t>(body)];
  const Eigen::Index n = sizes_[static_cast<std::size_t>(body)];
  const bool is_modal = time_.coordinates == Coordinates::modal;
  const Eigen::MatrixXd& rows = is_modal ? of.modal.rows : of.reduced.rows;
  of_z.segment(first + n, n) = rows.row(row).head(n);
  return of_z;
}

std::vector<Propagator::Motion> PeriodMap::motions_of(const Simulation& simulation) const {
  std::vector<Propagator::Motion> motions;
  for (std::size_t b = 0; b < sizes_.size(); ++b)
    motions.push_back(simulation.motion(static_cast<int>(b)));
  return motions;
}

Eigen::VectorXd PeriodMap::sizes_of_motion(Simulation& simulation) const {
  constexpr double inf = std::numeric_limits<double>::infinity();
  constexpr std::int64_t num_looks = 64;
  Eigen::VectorXd low = Eigen::VectorXd::Constant(num_unknowns_, inf);
  Eigen::VectorXd high = -low;
  const std::int64_t begin = simulation.step_index();
  for (std::int64_t i = 1; i <= num_looks; ++i) {
    const std::int64_t target = begin + num_steps_ * i / num_looks;
    if (target <= simulation.step_index()) continue;
    if (step_on(simulation, target - 1) != StepOutcome::done) break;
    const auto z = state_of(simulation);
    if (!z) break;
    low = low.cwiseMin(*z);
    high = high.cwiseMax(*z);
  }
  Eigen::VectorXd sizes = 0.5 * (high - low).cwiseMax(0.0);
  constexpr double least = 1e-6;
  Eigen::Index first = 0;
  for (const Eigen::Index n : sizes_) {
    for (const Eigen::Index part : {first, first + n}) {
      if (n == 0) continue;
      const double most = sizes.segment(part, n).maxCoeff();
      sizes.segment(part, n) = sizes.segment(part, n).cwiseMax(std::max(least * most, 1e-300));
    }
    first += 2 * n;
  }
  return sizes;
}

ScaledPeriodMap::ScaledPeriodMap(PeriodMap& map, const Eigen::RowVectorXd& velocity,
                                 const Eigen::VectorXd& scale, double step)
    : map_(&map), scale_(scale), step_(step) {
  velocity_ = velocity.cwiseProduct(scale.transpose());
  velocity_ /= velocity_.cwiseAbs().sum();
}

Eigen::VectorXd ScaledPeriodMap::scaled(const Eigen::VectorXd& z, double period) const {
  Eigen::VectorXd y(z.size() + 1);
  y << z.cwiseQuotient(scale_), period / step_;
  return y;
}

Eigen::VectorXd ScaledPeriodMap::state(const Eigen::VectorXd& y) const {
  return y.head(scale_.size()).cwiseProduct(scale_);
}

std::optional<Eigen::VectorXd> ScaledPeriodMap::operator()(const Eigen::VectorXd& y) const {
  std::optional<Eigen::VectorXd> next = (*map_)(state(y), period(y));
  if (next) *next = next->cwiseQuotient(scale_);
  return next;
}

std::optional<Eigen::VectorXd> ScaledPeriodMap::miss(const Eigen::VectorXd& y) const {
  const auto next = (*this)(y);
  if (!next) return std::nullopt;
  const Eigen::Index m = scale_.size();
  Eigen::VectorXd all(m + 1);
  all << *next - y.head(m), velocity_.dot(y.head(m));
  return all;
}

std::optional<Eigen::MatrixXd> ScaledPeriodMap::derivative(const Eigen::VectorXd& y) const {
  constexpr double change = 1e-5;
  constexpr double jump = 0.1;
  const Eigen::Index m = scale_.size();
  const auto here = (*this)(y);
  if (!here) return std::nullopt;
  Eigen::MatrixXd derivative(m, m + 1);
  for (Eigen::Index k = 0; k <= m; ++k) {
    Eigen::VectorXd moved = y;
    moved[k] = y[k] + change;
    const auto after = (*this)(moved);
    moved[k] = y[k] - change;
    const auto before = (*this)(moved);
    if (!after || !before) return std::nullopt;
    const Eigen::VectorXd ahead = (*after - *here) / change;
    const Eigen::VectorXd behind = (*here - *before) / change;
    if ((ahead - behind).norm() < jump * std::min(ahead.norm(), behind.norm()) + jump) {
      derivative.col(k) = 0.5 * (ahead + behind);
    } else {
      derivative.col(k) = ahead.norm() < behind.norm() ? ahead : behind;
    }
  }
  return derivative;
}

Eigen::VectorXd ScaledPeriodMap::correction(const Eigen::MatrixXd& derivative,
                                            const Eigen::VectorXd& miss) const {
  const Eigen::Index m = scale_.size();
  Eigen::MatrixXd bordered = Eigen::MatrixXd::Zero(m + 1, m + 1);
  bordered.topRows(m) = derivative;
  bordered.diagonal().head(m).array() -= 1.0;
  bordered.row(m).head(m) = velocity_;
  return -bordered.fullPivLu().solve(miss);
}

std::vector<std::complex<double>> multipliers_of(const Eigen::MatrixXd& derivative) {
  const Eigen::VectorXcd all = Eigen::EigenSolver<Eigen::MatrixXd>(derivative, false).eigenvalues();
  std::vector<std::complex<double>> multipliers(all.data(), all.data() + all.size());
  multipliers.erase(std::min_element(multipliers.begin(), multipliers.end(), [](auto a, auto b) {
    return std::abs(a - 1.0) < std::abs(b - 1.0);
  }));
  std::sort(multipliers.begin(), multipliers.end(),
            [](auto a, auto b) { return std::abs(a) > std::abs(b); });
  return multipliers;
}

}  // namespace stridor
