#include "analysis/periodic_motion.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "analysis/period_map.hpp"
#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "solvers/transient/simulation.hpp"

namespace stridor {
namespace {

/// A motion that is smaller than this part of the static displacement has died down.
constexpr double at_rest = 1e-6;
/// Turns that are looked at, and settling times that they may take together.
constexpr int num_turns = 25;
constexpr double longest_look = 2.0;

/// Drive, damping and friction as they are once they no longer change.
System settled(System system) {
  const double late = std::numeric_limits<double>::max();
  for (Drive& drive : system.drives) {
    for (TimeCurve* curve : {&drive.velocity, &drive.load, &drive.shift})
      *curve = TimeCurve(curve->value(late));
  }
  for (ContactPoint& contact : system.contacts) {
    contact.friction_rise = TimeCurve(contact.friction_rise.value(late));
    contact.armed_from = 0.0;
  }
  const auto settle = [](RayleighDamping& damping) { damping.alpha_start.reset(); };
  for (SystemBody& body : system.bodies) {
    settle(body.reduced.damping);
    settle(body.modal.damping);
  }
  return system;
}

/// From this time on nothing that is prescribed changes.
double settled_from(const System& system) {
  double from = system.drives_constant_from();
  for (const ContactPoint& contact : system.contacts)
    from = std::max(from, contact.friction_rise.constant_from());
  for (const SystemBody& body : system.bodies)
    from = std::max(from, body.modal.damping.constant_from());
  return from;
}

int row_of(const ContactPoint& contact, bool is_x) {
  return is_x ? contact.slave_rows.x : contact.slave_rows.y;
}

/// Reads turns, and integrals between them, from one displacement of a simulation.
class TurnReader {
 public:
  TurnReader(const Simulation& simulation, const System& system, ObservedMotion observed)
      : simulation_(&simulation),
        contact_(observed.contact),
        body_(system.contacts[static_cast<std::size_t>(observed.contact)].slave_body),
        row_(row_of(system.contacts[static_cast<std::size_t>(observed.contact)], observed.is_x)),
        meter_(simulation.time(), std::numeric_limits<double>::infinity()) {}

  /// To be called after every step. @return whether a turn lies before the present step
  bool note() {
    const double h = simulation_->step_size();
    const double x = simulation_->displacement(body_, row_);
    const ContactState state = simulation_->contact_state(contact_);
    meter_.note_position(simulation_->time(), x, 0.0);
    const bool has_turned = num_seen_ >= 2 && before_ < last_ && last_ >= x;
    if (has_turned) {
      // The parabola through the three displacements.
      const double curvature = before_ - 2.0 * last_ + x;
      const double ahead = curvature < 0.0 ? 0.5 * (before_ - x) / curvature : 0.0;
      CycleMeter::Turn turn = sums_;
      turn.time = simulation_->time() - h + ahead * h;
      turn.x = last_ - 0.25 * (before_ - x) * ahead;
      turn.sum += ahead * h * last_;
      turn.squares += ahead * h * last_ * last_;
      meter_.note_turn(turn);
      ++num_turns_;
    }
    sums_.sum += h * x;
    sums_.squares += h * x * x;
    if (state == ContactState::stick) sums_.stick += h;
    if (state == ContactState::open) sums_.free += h;
    before_ = last_;
    last_ = x;
    ++num_seen_;
    return has_turned;
  }

  int turns() const { return num_turns_; }
  CycleMeter::Reading reading() const { return meter_.reading(); }

 private:
  const Simulation* simulation_;
  int contact_;
  int body_;
  int row_;
  CycleMeter meter_;
  CycleMeter::Turn sums_;  ///< integrals up to the present step
  double before_ = 0.0, last_ = 0.0;
  std::int64_t num_seen_ = 0;
  int num_turns_ = 0;
};

/// The displacement of a slave that moves most over a stretch of steps, how far it moves, and the
/// largest displacement of any.
struct Largest {
  ObservedMotion observed;
  double width = 0.0;
  double size = 0.0;
  StepOutcome outcome = StepOutcome::done;
};

Largest largest_motion(Simulation& simulation, const System& system, std::int64_t num_steps) {
  const std::size_t num_rows = 2 * system.contacts.size();
  constexpr double inf = std::numeric_limits<double>::infinity();
  std::vector<double> low(num_rows, inf);
  std::vector<double> high(num_rows, -inf);
  Largest largest;
  for (std::int64_t i = 0; i < num_steps; ++i) {
    if (i % 100'000 == 0) throw_if_stopped();
    largest.outcome = simulation.step();
    if (largest.outcome != StepOutcome::done) return largest;
    for (std::size_t k = 0; k < num_rows; ++k) {
      const ContactPoint& contact = system.contacts[k / 2];
      const double u = simulation.displacement(contact.slave_body, row_of(contact, k % 2 == 0));
      low[k] = std::min(low[k], u);
      high[k] = std::max(high[k], u);
    }
  }
  for (std::size_t k = 0; k < num_rows; ++k) {
    largest.size = std::max({largest.size, std::abs(low[k]), std::abs(high[k])});
    if (high[k] - low[k] <= largest.width) continue;
    largest.width = high[k] - low[k];
    largest.observed = {static_cast<int>(k / 2), k % 2 == 0};
  }
  return largest;
}

/// Newton's method for P_T(z) = z with v(z) = 0 from z and the period found; `residual` is that of
/// the start where it does not converge. @return whether it came to a cycle
bool solve_period(const ScaledPeriodMap& map, Eigen::VectorXd& z, PeriodicMotion& found) {
  Eigen::VectorXd y = map.scaled(z, found.period);
  const double first_period = found.period;
  double last_residual = std::numeric_limits<double>::infinity();
  std::optional<Eigen::MatrixXd> derivative;
  constexpr int most_steps = 15;
  for (int step = 0; step < most_steps; ++step) {
    const auto miss = map.miss(y);
    if (!miss) return false;
    const double residual = miss->norm();
    if (step == 0) found.residual = residual;  // of the start, unless it converges
    // Small motions end in the rounding of large displacements.
    const bool is_done = residual < 1e-10 || (residual < 1e-5 && residual > 0.3 * last_residual);
    if (residual > 1e3) return false;
    // Close to the cycle its derivative no longer changes.
    if (step == 0 || (!is_done && residual > 1e-5)) derivative = map.derivative(y);
    if (!derivative) return false;
    if (is_done) {
      z = map.state(y);
      found.period = map.period(y);
      found.residual = residual;
      found.newton_steps = step;
      found.multipliers = multipliers_of(derivative->leftCols(z.size()));
      return true;
    }
    last_residual = residual;
    y += map.correction(*derivative, *miss);
    if (std::abs(map.period(y) - first_period) > 0.5 * first_period) return false;
  }
  return false;
}

/// Statistics over the cycle that was solved for.
void measure(PeriodicMotion& cycle, const TimeParameters& time) {
  CycleMeter::Reading& seen = cycle.seen;
  seen = {};
  seen.smallest = std::numeric_limits<double>::infinity();
  seen.largest = -seen.smallest;
  double sum = 0.0;
  double squares = 0.0;
  std::int64_t sticking = 0;
  std::int64_t open = 0;
  follow_cycle(cycle, time, [&](const Simulation& simulation) {
    const double x = observed_displacement(cycle, simulation);
    const ContactState state = simulation.contact_state(cycle.observed.contact);
    seen.smallest = std::min(seen.smallest, x);
    seen.largest = std::max(seen.largest, x);
    if (simulation.step_index() == 0) return;
    sum += x;
    squares += x * x;
    sticking += state == ContactState::stick;
    open += state == ContactState::open;
  });
  const auto count = static_cast<double>(cycle.num_steps);
  seen.period = cycle.period;
  seen.mean = sum / count;
  seen.rms = std::sqrt(std::max(0.0, squares / count - *seen.mean * *seen.mean));
  seen.stick_fraction = static_cast<double>(sticking) / count;
  seen.free_fraction = static_cast<double>(open) / count;
}

/// Looks at the motion for some turns: what moves most, and whether it repeats itself.
/// @return whether the simulation has gone on
bool observe(Simulation& simulation, const System& system, std::int64_t settling,
             PeriodicMotion& found) {
  // A tenth of the time that it was given to settle shows what moves most.
  const Largest largest =
      largest_motion(simulation, system, std::max<std::int64_t>(settling / 10, 100));
  if (largest.outcome != StepOutcome::done) return false;
  found.observed = largest.observed;
  TurnReader reader(simulation, system, found.observed);
  const bool is_still = largest.width < at_rest * largest.size;
  const auto most_steps =
      static_cast<std::int64_t>(longest_look * static_cast<double>(settling)) + 1000;
  for (std::int64_t i = 0; i < most_steps && reader.turns() < num_turns && !is_still; ++i) {
    if (i % 100'000 == 0) throw_if_stopped();
    if (simulation.step() != StepOutcome::done) return false;
    (void)reader.note();
  }
  found.seen = reader.reading();
  if (is_still || reader.turns() < 3) {
    const bool sticks = simulation.contact_state(found.observed.contact) == ContactState::stick;
    found.status = sticks     ? CycleStatus::sticking
                   : is_still ? CycleStatus::at_rest
                              : CycleStatus::settling;
    return true;
  }
  found.status = found.seen.period ? CycleStatus::periodic : CycleStatus::irregular;
  return true;
}

/// @return whether the simulation has come to a turn
bool go_to_turn(Simulation& simulation, const System& system, ObservedMotion observed) {
  TurnReader next(simulation, system, observed);
  do {
    throw_if_stopped();
    if (simulation.step() != StepOutcome::done) return false;
  } while (!next.note());
  return true;
}

/// Newton's method with `found.num_steps` steps, and where it ends at a jump of P with a few more:
/// a contact with a static coefficient breaks loose at the end of a step, and with another length
/// of it the cycle lies between two jumps. @return of what it came to, and of the first start where
/// it did not
std::optional<PeriodicMotion> solve_with_steps(const TimeParameters& time,
                                               const Simulation& simulation,
                                               const Eigen::VectorXd& start,
                                               const Eigen::VectorXd& scale,
                                               PeriodicMotion& found) {
  constexpr int most_tries = 4;
  constexpr double far = 0.1;
  const ContactPoint& contact =
      found.at_turn.contacts[static_cast<std::size_t>(found.observed.contact)];
  for (int attempt = 0; attempt < most_tries; ++attempt) {
    PeriodicMotion solved = found;
    solved.num_steps += attempt;
    PeriodMap map(solved.at_turn, time, simulation, solved.num_steps);
    const Eigen::RowVectorXd velocity =
        map.velocity_row(contact.slave_body, row_of(contact, found.observed.is_x));
    const ScaledPeriodMap scaled(map, velocity, scale,
                                 solved.period / static_cast<double>(solved.num_steps));
    Eigen::VectorXd z = start;
    if (solve_period(scaled, z, solved)) {
      map.set(z);
      solved.step = solved.period / static_cast<double>(solved.num_steps);
      return solved;
    }
    if (attempt == 0) found.residual = solved.residual;
    if (solved.residual > far) return std::nullopt;
  }
  return std::nullopt;
}

/// Solves for the cycle from a turn of a motion that seems to repeat itself, and puts `at_turn` on
/// it. @return whether the simulation has gone on
bool solve(Simulation& simulation, const TimeParameters& time, const PeriodicMotionOptions& options,
           PeriodicMotion& found) {
  found.period = *found.seen.period;
  found.num_steps = std::max<std::int64_t>(std::llround(found.period / time.step), 2);
  found.step = found.period / static_cast<double>(found.num_steps);
  PeriodMap map(found.at_turn, time, simulation, found.num_steps);
  const std::optional<Eigen::VectorXd> start = map.state_of(simulation);
  if (!start) return false;
  const Eigen::VectorXd scale = map.sizes_of_motion(simulation);
  map.set(*start);
  if (map.num_unknowns() > options.most_unknowns) {
    const auto next = map(*start, found.period);
    constexpr double inf = std::numeric_limits<double>::infinity();
    found.residual = next ? (*next - *start).cwiseQuotient(scale).norm() : inf;
  } else if (auto solved = solve_with_steps(time, simulation, *start, scale, found)) {
    measure(*solved, time);
    // A motion that dies down slowly seems to repeat itself, but the only cycle is at rest.
    const double before = found.seen.largest - found.seen.smallest;
    if (solved->seen.largest - solved->seen.smallest > 0.01 * before) {
      found = *std::move(solved);
    } else {
      found.status = CycleStatus::settling;
    }
    return true;
  }
  constexpr double close = 0.03;
  if (!(found.residual < close)) found.status = CycleStatus::irregular;
  return true;
}

}  // namespace

double observed_displacement(const PeriodicMotion& cycle, const Simulation& simulation) {
  const ContactPoint& contact =
      cycle.at_turn.contacts[static_cast<std::size_t>(cycle.observed.contact)];
  return simulation.displacement(contact.slave_body, row_of(contact, cycle.observed.is_x));
}

void follow_cycle(const PeriodicMotion& cycle, const TimeParameters& time,
                  const std::function<void(const Simulation&)>& visit) {
  TimeParameters own = time;
  own.step = cycle.step;
  Simulation simulation(cycle.at_turn, own);
  visit(simulation);
  for (std::int64_t i = 0; i < cycle.num_steps; ++i) {
    if (simulation.step() != StepOutcome::done)
      throw NumericalError(simulation.refusal(), simulation.failure());
    visit(simulation);
  }
}

std::optional<std::string> why_not_periodic(const System& system) {
  if (system.contacts.empty()) return "nothing touches its bodies, so nothing keeps them moving";
  for (const ContactPoint& contact : system.contacts) {
    if (contact.face) continue;
    const DrivenMotion driven = system.driven_motion(contact);
    const bool moves_on = !driven.is_frozen() && driven.end_velocity() != 0.0;
    const bool is_endless = contact.space ? system.facets_of(contact) == nullptr
                                          : system.surface_of(contact).is_endless;
    if (!moves_on || is_endless) continue;
    return fmt::format(
        "contact '{}' moves along {} and comes to its end; hold its place by `sliding: frozen`, in "
        "which friction acts as if it moved",
        contact.name, system.master_name(contact));
  }
  return std::nullopt;
}

PeriodicMotion find_periodic_motion(const System& system, const TimeParameters& time,
                                    const PeriodicMotionOptions& options) {
  PeriodicMotion found;
  Simulation simulation(system, time);
  const double settle = std::max(options.settle, settled_from(system));
  const auto settling = static_cast<std::int64_t>(std::ceil(settle / time.step));
  const auto failed = [&] {
    found.status = CycleStatus::diverged;
    found.failure = simulation.failure();
    found.refusal = simulation.refusal();
    return found;
  };
  if (step_on(simulation, settling) != StepOutcome::done) return failed();
  if (!observe(simulation, system, settling, found)) return failed();
  if (found.status != CycleStatus::periodic) return found;
  found.at_turn = settled(system);
  if (!go_to_turn(simulation, system, found.observed)) return failed();
  if (!solve(simulation, time, options, found)) return failed();
  return found;
}

}  // namespace stridor
