// Motion of a body on a sliding substrate, from event to event.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "core/state.hpp"
#include "solvers/integrators/runge_kutta.hpp"
#include "solvers/transient/substrate_oscillator.hpp"

namespace stridor {

/// State of contact of the body with the substrate.
enum class SubstrateMode {
  slip_back,     ///< slower than the substrate
  slip_forward,  ///< faster than the substrate
  stick,         ///< moves with it
  free,          ///< separated
};

/// Marches the equations of SubstrateOscillator with an adaptive Runge-Kutta method of order 8
/// whose steps end at every change of mode (docs/theory.md, 9.3): the right-hand side is smooth
/// within a step, and a change is placed to rounding by steps of other lengths from the same state.
///
/// Sticking is set-valued: the friction is whatever keeps the slip at zero, up to the static
/// strength.
class SubstrateMotion {
 public:
  /// x, y, ẋ, ẏ, and ∫ x dt, ∫ x² dt since start() or restart_statistics().
  using State = std::array<double, 6>;

  /// @param oscillator must live longer
  /// @param tolerance  allowed error of a step relative to the size of the motion
  /// @throws std::invalid_argument if there is no sliding equilibrium, which gives that size, or
  ///         the tolerance is not positive
  SubstrateMotion(const SubstrateOscillator& oscillator, double tolerance);

  /// At t = 0. Whether a body without slip sticks follows from the forces.
  void start(const Eigen::Vector2d& displacement, const Eigen::Vector2d& velocity);

  enum class Stop {
    end,     ///< the time that was asked for
    turn,    ///< ẋ falls through zero: the body is at its largest x
    failed,  ///< see failure()
  };
  /// Marches to a time or, where asked, to the next turn.
  Stop advance(double end, bool stops_at_turns);

  /// Cause and remedy of the failure; empty unless `advance` has failed.
  const std::string& failure() const { return failure_; }

  double time() const { return time_; }
  const State& state() const { return state_; }
  SubstrateMode mode() const { return mode_; }
  /// ẍ, ÿ; where the mode changes, after the change.
  Eigen::Vector2d acceleration() const { return {slope_[2], slope_[3]}; }
  /// Forces of the contact now; sticking, the tangential one is what keeps the slip at zero.
  SubstrateForces forces() const;

  /// Events since start() or restart_statistics().
  struct Statistics {
    double from = 0.0;
    double stick_time = 0.0;
    double free_time = 0.0;
    double smallest_x = 0.0;
    double largest_x = 0.0;
    double largest_y = 0.0;
    std::int64_t steps = 0;
    std::int64_t evaluations = 0;  ///< of the right-hand side
    std::int64_t events = 0;
  };
  const Statistics& statistics() const { return statistics_; }
  void restart_statistics();

  /// Everything with which a later `load` into a motion of the same oscillator resumes
  /// bit-identically to an uninterrupted run.
  void save(stridor::State& state, const std::string& prefix) const;
  /// @throws std::invalid_argument if the state is of another kind
  void load(const stridor::State& state, const std::string& prefix);

 private:
  using Step = RungeKuttaStep<6, 4>;
  enum : std::size_t { X, Y, VX, VY, SUM, SQUARES };  ///< of State

  /// Event that ends a step.
  enum class Event { slip_ends, strength_reached, lift_off, touch_down, turn };
  static constexpr std::size_t num_events = 5;
  struct Value {
    double value = 0.0;
    double rate = 0.0;
  };

  void evaluate(const State& state, State& slope);
  Value event_value(Event event, const State& state, const State& slope) const;
  bool is_possible(Event event) const;
  double required_friction(const State& state) const;
  void enter_contact();
  void settle_at_rest_of_slip();
  void apply(Event event);
  void renew();
  /// What the events possible say of a step that is accurate enough.
  struct Scan {
    double first;    ///< length to the first event in it; infinite where there is none
    Event event{};   ///< that one
    double shorter;  ///< length of a step that shows what this one may hide; its own where nothing
  };
  Scan scan_events(double length, bool stops_at_turns);
  bool take_step(double end, bool stops_at_turns, Event& event, bool& has_event);
  bool check_motion();
  double locate(Event event, double length, const Value& at_start, const Value& at_end);
  void accept(double length);

  const SubstrateOscillator* oscillator_;
  double tolerance_;
  std::array<double, 4> size_{};
  double time_ = 0.0;
  double step_ = 0.0;
  State state_{};
  State slope_{};
  SubstrateMode mode_ = SubstrateMode::slip_back;
  std::array<bool, num_events> armed_{};  ///< was positive since its mode began
  Step trial_;
  State end_slope_{};
  Statistics statistics_;
  std::string failure_;
};

}  // namespace stridor
