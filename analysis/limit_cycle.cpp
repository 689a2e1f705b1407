#include "analysis/limit_cycle.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace stridor {
namespace {

/// The motion has died down, or does so, where it moves less than this part of the equilibrium and
/// that is stable: this close to it the motion is linear.
constexpr double died_down = 1e-6;
/// Longest time to wait for a turn: several times the time in which the substrate winds up the
/// spring to the static strength, within bounds.
double longest_loop(const SubstrateOscillator& oscillator) {
  const SubstrateEquilibrium rest =
      find_equilibrium(oscillator, 1e-2 * oscillator.contact.indentation_unit);
  const double strength = oscillator.contact.static_strength(rest.displacement.y()).value;
  const double winding = strength / (oscillator.stiffness(0, 0) * oscillator.substrate_speed);
  return std::clamp(10.0 * winding, 200.0, 5e3);
}

using CyclePoint = Eigen::Vector3d;

CyclePoint point_of(const SubstrateMotion& motion) {
  return {motion.state()[0], motion.state()[1], motion.state()[3]};
}

void start_at(SubstrateMotion& motion, const CyclePoint& z) {
  motion.start({z[0], z[1]}, {0.0, z[2]});
}

/// P(z) after some turns, and the time that takes; nothing where the motion never gets there.
struct Return {
  CyclePoint point;
  double period = 0.0;
};
std::optional<Return> return_map(SubstrateMotion& motion, const CyclePoint& z,
                                 const LimitCycle& cycle, double longest) {
  start_at(motion, z);
  for (int i = 0; i < cycle.loops; ++i) {
    if (motion.advance(motion.time() + longest, true) != SubstrateMotion::Stop::turn)
      return std::nullopt;
  }
  return Return{point_of(motion), motion.time()};
}

bool is_stable(const SubstrateOscillator& oscillator, const SubstrateEquilibrium& rest) {
  return leading_eigenvalue(small_motion(oscillator, rest)).real() < 0.0;
}

/// Reads the statistics from the motion.
void measure(const SubstrateMotion& motion, LimitCycle& cycle) {
  const SubstrateMotion::Statistics& seen = motion.statistics();
  const double duration = motion.time() - seen.from;
  cycle.x_min = seen.smallest_x;
  cycle.x_max = seen.largest_x;
  cycle.y_max = seen.largest_y;
  if (duration > 0.0) {
    cycle.x_mean = motion.state()[4] / duration;
    const double square = motion.state()[5] / duration - cycle.x_mean * cycle.x_mean;
    cycle.x_rms = std::sqrt(std::max(0.0, square));
    cycle.stick_fraction = seen.stick_time / duration;
    cycle.free_fraction = seen.free_time / duration;
  }
  cycle.last_displacement = {motion.state()[0], motion.state()[1]};
  cycle.last_velocity = {motion.state()[2], motion.state()[3]};
}

/// Result for a motion that has failed.
LimitCycle failed(const SubstrateMotion& motion) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  LimitCycle cycle;
  cycle.x_min = cycle.x_max = cycle.x_mean = cycle.x_rms = cycle.y_max = nan;
  cycle.stick_fraction = cycle.free_fraction = nan;
  cycle.failure = motion.failure();
  cycle.failure_time = motion.time();
  return cycle;
}

/// Whether each of the later turns is nearer to x than the one before it, or each farther off. Of
/// an irregular motion that is next to impossible.
bool is_settling(const std::vector<CyclePoint>& turns, double x) {
  const std::size_t first = turns.size() / 2;  // faster motions die down before
  const auto all = static_cast<int>(turns.size() - first) - 1;
  int shrinking = 0;
  int growing = 0;
  for (std::size_t i = first + 1; i < turns.size(); ++i) {
    const double before = std::abs(turns[i - 1].x() - x);
    const double after = std::abs(turns[i].x() - x);
    shrinking += after < before;
    growing += after > before;
  }
  return all > 2 && (shrinking == all || growing == all);
}

/// Newton's method for P(z) = z. @return whether it came to a fixed point
bool solve(SubstrateMotion& motion, const CyclePoint& scale, double longest, LimitCycle& cycle,
           CyclePoint z) {
  // Of any size, of which the decompositions are compiled once.
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(3, 3);
  constexpr int most_steps = 12;
  double last_residual = 1e300;
  for (int step = 0; step < most_steps; ++step) {
    const auto found = return_map(motion, z, cycle, longest);
    if (!found) return false;
    const CyclePoint miss = (found->point - z).cwiseQuotient(scale);
    const double residual = miss.norm();
    const bool is_done = residual < 1e-11 || (residual < 1e-8 && residual > 0.3 * last_residual);
    if (step == 0 || (!is_done && residual > 1e-6)) {
      constexpr double change = 3e-5;
      for (int k = 0; k < 3; ++k) {
        CyclePoint ahead = z;
        CyclePoint behind = z;
        ahead[k] += change * scale[k];
        behind[k] -= change * scale[k];
        const auto after = return_map(motion, ahead, cycle, longest);
        const auto before = return_map(motion, behind, cycle, longest);
        if (!after || !before) return false;
        jacobian.col(k) = (after->point - before->point).cwiseQuotient(scale) / (2.0 * change);
      }
    }
    cycle.residual = residual;
    cycle.newton_steps = step;
    if (is_done) {
      cycle.point = {z[0], z[1], z[2]};
      cycle.period = found->period;
      const Eigen::EigenSolver<Eigen::MatrixXd> solver(jacobian, false);
      const Eigen::VectorXcd& all = solver.eigenvalues();
      cycle.multipliers.assign(all.data(), all.data() + 3);
      std::sort(cycle.multipliers.begin(), cycle.multipliers.end(),
                [](auto a, auto b) { return std::abs(a) > std::abs(b); });
      return true;
    }
    last_residual = residual;
    const Eigen::FullPivLU<Eigen::MatrixXd> factor(
        Eigen::MatrixXd(jacobian - Eigen::MatrixXd::Identity(3, 3)));
    const Eigen::VectorXd correction = factor.solve(Eigen::VectorXd(miss));
    z -= correction.cwiseProduct(scale);
  }
  return false;
}

/// The next turns of a motion; fewer where it comes to rest, nothing where it fails.
/// @param longest time that a turn takes
std::optional<std::vector<CyclePoint>> next_turns(SubstrateMotion& motion, std::size_t count,
                                                  double longest) {
  std::vector<CyclePoint> turns;
  while (turns.size() < count) {
    const SubstrateMotion::Stop stop = motion.advance(motion.time() + longest, true);
    if (stop == SubstrateMotion::Stop::failed) return std::nullopt;
    if (stop == SubstrateMotion::Stop::end) break;
    turns.push_back(point_of(motion));
  }
  return turns;
}

}  // namespace

std::string cycle_status_text(CycleStatus status) {
  switch (status) {
    case CycleStatus::periodic:
      return "periodic";
    case CycleStatus::at_rest:
      return "at_rest";
    case CycleStatus::irregular:
      return "irregular";
    case CycleStatus::diverged:
      return "diverged";
    case CycleStatus::sticking:
      return "sticking";
    case CycleStatus::settling:
      return "settling";
  }
  return "";
}

LimitCycle find_limit_cycle(const SubstrateOscillator& oscillator,
                            const Eigen::Vector2d& displacement, const Eigen::Vector2d& velocity,
                            const CycleOptions& options) {
  LimitCycle cycle;
  SubstrateMotion motion(oscillator, options.tolerance);
  motion.start(displacement, velocity);
  if (motion.advance(options.settle, false) != SubstrateMotion::Stop::end) return failed(motion);

  // The last turns of the settled motion.
  const double longest = longest_loop(oscillator);
  motion.restart_statistics();
  const double from = motion.time();
  const auto num_turns = static_cast<std::size_t>(2 * options.most_loops + 1);
  const std::optional<std::vector<CyclePoint>> made = next_turns(motion, num_turns, longest);
  if (!made) return failed(motion);
  const std::vector<CyclePoint>& turns = *made;
  measure(motion, cycle);
  const double width = cycle.x_max - cycle.x_min;
  const double indentation = 1e-2 * oscillator.contact.indentation_unit;
  const SubstrateEquilibrium rest = find_equilibrium(oscillator, indentation);
  const double size = std::abs(rest.displacement.x()) + rest.displacement.y();
  const bool is_still = turns.size() < num_turns || width < died_down * size;
  if (is_still && motion.mode() == SubstrateMode::stick) {
    cycle.status = CycleStatus::sticking;
    return cycle;
  }
  if (is_still && is_stable(oscillator, rest)) {
    cycle.status = CycleStatus::at_rest;
    return cycle;
  }
  const CyclePoint scale{width, std::max(cycle.y_max, 1e-6 * width), width};
  for (int loops = 1; loops <= options.most_loops && !is_still; ++loops) {
    const CyclePoint& last = turns.back();
    const auto back = turns.size() - 1 - static_cast<std::size_t>(loops);
    if ((turns[back] - last).cwiseQuotient(scale).norm() > 1e-3) continue;
    LimitCycle found = cycle;
    found.loops = loops;
    if (!solve(motion, scale, longest, found, last)) continue;
    // A motion settles to a stable cycle: an unstable one beside it has fewer loops.
    if (std::abs(found.multipliers.front()) > 1.0) continue;
    start_at(motion, {found.point.x, found.point.y, found.point.vertical_velocity});
    for (int i = 0; i < loops; ++i) (void)motion.advance(motion.time() + longest, true);
    measure(motion, found);
    // The equilibrium is a fixed point too, to which a slowly decaying motion leads.
    if (found.x_max - found.x_min < 1e-2 * width) continue;
    found.status = CycleStatus::periodic;
    return found;
  }
  // Statistics of irregular motion need more time than a few turns.
  motion.start(cycle.last_displacement, cycle.last_velocity);
  const double enough = std::max(0.1 * options.settle, from > 0.0 ? 100.0 : 200.0);
  if (motion.advance(enough, false) != SubstrateMotion::Stop::end) return failed(motion);
  measure(motion, cycle);
  cycle.status =
      is_settling(turns, rest.displacement.x()) ? CycleStatus::settling : CycleStatus::irregular;
  return cycle;
}

}  // namespace stridor
