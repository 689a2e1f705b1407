// Motions with stick, slip, lift-off and impact whose closed form is known, and the order in which
// the scheme approaches them.
//
// Each test runs several steps (and meshes) and asks for an order from both sides: an error that
// falls too fast is as wrong as one that does not fall.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "coupling/laws/static_dynamic_friction.hpp"
#include "coupling/laws/stribeck_friction.hpp"
#include "tests/support/small_systems.hpp"

namespace stridor {
namespace {

using namespace test;

using std::numbers::pi;

/// log2 of the ratios of an error to that at half the step.
std::vector<double> orders(const std::vector<double>& errors) {
  std::vector<double> result;
  for (std::size_t k = 0; k + 1 < errors.size(); ++k)
    result.push_back(std::log2(errors[k] / errors[k + 1]));
  return result;
}

void expect_orders(const std::vector<double>& errors, double low, double high) {
  for (const double order : orders(errors)) {
    EXPECT_GT(order, low) << ::testing::PrintToString(errors);
    EXPECT_LT(order, high) << ::testing::PrintToString(errors);
  }
}

/// Runs to `end` and hands over every step, the start included.
void run(Simulation& simulation, double end, const std::function<void()>& look) {
  look();
  while (simulation.time() < end) {
    ASSERT_EQ(simulation.step(), StepOutcome::done) << simulation.failure();
    look();
  }
}

// Mass on a frictional support (code_aster SDND100): m = 1 kg, k = 10⁴ N/m, normal force 10 N,
// μ = 0.1, released at 0.85 mm. Friction shifts the centre of every half swing by μ N/k = 0.1 mm.

MassOnGround frictional_support() {
  MassOnGround scene;
  scene.stiffness = 1e4;
  scene.load = 10.0;
  scene.friction = constant_friction(0.1);
  scene.displacement = 0.85e-3;
  return scene;
}

double frictional_support_motion(double time) {
  constexpr double omega = 100.0;
  constexpr double centre = 0.1e-3;
  const int swing = static_cast<int>(std::floor(time * omega / pi));
  if (swing >= 4) return 0.05e-3;
  const double side = swing % 2 == 0 ? 1.0 : -1.0;
  const double turn = 0.85e-3 - 2.0 * centre * swing;
  return side * (centre + (turn - centre) * std::cos(omega * time - swing * pi));
}

TEST(ClosedForms, MassOnAFrictionalSupportAtFirstOrder) {
  std::vector<double> errors;
  for (const double step : {1e-4, 5e-5, 2.5e-5, 1.25e-5}) {
    Simulation simulation(frictional_support().system(), time_of(step));
    double error = 0.0;
    run(simulation, 0.2, [&] {
      const double x = simulation.displacement(0, MassOnGround::x_row);
      error = std::max(error, std::abs(x - frictional_support_motion(simulation.time())));
    });
    errors.push_back(error);
  }
  // The start, u_{−1} = u_0, is that of a swing half a step earlier: v_max h/2 = 0.075 m/s h/2.
  expect_orders(errors, 0.95, 1.05);
  EXPECT_NEAR(errors.back(), 0.075 * 0.5 * 1.25e-5, 1e-8);
}

TEST(ClosedForms, MassOnAFrictionalSupportTurnsAndRestsWhereItShould) {
  constexpr double step = 1e-5;
  Simulation simulation(frictional_support().system(), time_of(step));
  double turns[4] = {0.85e-3, -1.0, -1.0, -1.0};  // outwards of every swing
  double rest = 0.0;
  run(simulation, 0.2, [&] {
    const double x = simulation.displacement(0, MassOnGround::x_row);
    const auto nearest = std::lround(simulation.time() * 100.0 / pi);
    if (nearest < 4) turns[nearest] = std::max(turns[nearest], nearest % 2 == 0 ? x : -x);
    if (simulation.contact_state(0) != ContactState::stick) rest = simulation.time();
  });
  // Extremes err by (ω h)² and by what one step at the reversal moves: 1e-6 of a millimetre.
  EXPECT_NEAR(turns[1], 0.65e-3, 2e-9);
  EXPECT_NEAR(turns[2], 0.45e-3, 2e-9);
  EXPECT_NEAR(turns[3], 0.25e-3, 2e-9);
  EXPECT_NEAR(rest, 0.12566371, 2.0 * step);
  EXPECT_NEAR(simulation.displacement(0, MassOnGround::x_row), 0.05e-3, 2e-9);
  EXPECT_EQ(simulation.contact_state(0), ContactState::stick);
  EXPECT_NEAR(simulation.friction_force(0), -0.5, 2e-5);
}

// Belt: m = 1 kg, k = 100 N/m, N = 10 N, μ_s = 0.4, μ_d = 0.3, v = 0.1 m/s. From rest the mass
// slips until it has the belt's velocity, sticks until 0.04 m, then slips three quarters of a swing
// about 0.03 m.

MassOnGround belt() {
  MassOnGround scene;
  scene.belt_velocity = 0.1;
  scene.friction = static_dynamic_friction(0.4, 0.3);
  return scene;
}

double belt_motion(double time) {
  constexpr double omega = 10.0;
  constexpr double speed = 0.1;
  const double caught = std::asin(1.0 / 3.0) / omega;
  if (time < caught) return 0.03 * (1.0 - std::cos(omega * time));
  const double caught_at = 0.03 * (1.0 - std::cos(omega * caught));
  const double first_break = caught + (0.04 - caught_at) / speed;
  if (time < first_break) return caught_at + speed * (time - caught);
  constexpr double slip = 1.5 * pi / omega;
  constexpr double stick = 0.2;
  const double phase = std::fmod(time - first_break, slip + stick);
  if (phase < slip) return 0.03 + 0.01 * (std::cos(omega * phase) + std::sin(omega * phase));
  return 0.02 + speed * (phase - slip);
}

TEST(ClosedForms, BeltStickSlipAtFirstOrder) {
  // A change between stick and slip falls somewhere into a step, so the error of a single step is
  // irregular. The root of the mean square over the steps of an octave decreases regularly.
  std::vector<double> errors;
  for (const double h : {1e-3, 5e-4, 2.5e-4, 1.25e-4}) {
    constexpr int num_steps = 16;
    double sum = 0.0;
    for (int k = 0; k < num_steps; ++k) {
      double error = 0.0;
      Simulation simulation(belt().system(),
                            time_of(h * std::exp2(-static_cast<double>(k) / num_steps)));
      run(simulation, 1.8, [&] {
        const double x = simulation.displacement(0, MassOnGround::x_row);
        error = std::max(error, std::abs(x - belt_motion(simulation.time())));
      });
      sum += error * error;
    }
    errors.push_back(std::sqrt(sum / num_steps));
  }
  expect_orders(errors, 0.8, 1.2);
  EXPECT_LT(errors.back(), 5e-5);
}

TEST(ClosedForms, BeltStickSlipHasItsExtremesAndDurations) {
  constexpr double step = 2e-5;
  Simulation simulation(belt().system(), time_of(step));
  std::vector<double> caught;
  std::vector<double> broken;
  double lowest = 1.0;
  double highest = -1.0;
  bool sticks = false;
  run(simulation, 3.0, [&] {
    const double x = simulation.displacement(0, MassOnGround::x_row);
    if (broken.size() > 0) {
      lowest = std::min(lowest, x);
      highest = std::max(highest, x);
    }
    const bool now = simulation.contact_state(0) == ContactState::stick;
    if (now && !sticks) caught.push_back(simulation.time());
    if (!now && sticks) broken.push_back(simulation.time());
    sticks = now;
  });
  ASSERT_GE(broken.size(), 4u);
  // The amplitude of the swing is fixed by where it breaks away, which a step overshoots by v h.
  EXPECT_NEAR(lowest, 0.0158578644, 0.1 * step);
  EXPECT_NEAR(highest, 0.0441421356, 0.1 * step);
  for (std::size_t k = 1; k + 1 < broken.size(); ++k) {
    EXPECT_NEAR(broken[k] - caught[k], 0.2, 3.0 * step);
    EXPECT_NEAR(caught[k + 1] - broken[k], 0.471238898, 3.0 * step);
  }
}

// Elastic bar on rigid ground: E = 900 Pa, ρ = 1 kg/m³, L = 10 m, so that c = 30 m/s (Doyen, Ern
// and Piperno 2011). Step and mesh are refined together.

/// The discrete energy that the scheme keeps exactly in free motion:
/// ½ vᵀ M v + ½ u_nᵀ K u_{n−1} + g 1ᵀ M (u_n + u_{n−1})/2 with v = (u_n − u_{n−1})/h.
///
/// A contact force changes it by λ_n (gap_{n+1} − gap_{n−1})/2 = −λ_n gap_{n−1}/2, which is never
/// positive because the gap at the end of a step with force is closed.
class BarEnergy {
 public:
  BarEnergy(const FallingBar& bar, const Simulation& simulation)
      : body_(bar.system().bodies[0]), gravity_(bar.gravity), simulation_(simulation) {}

  double value() const {
    const Propagator::Motion modal = simulation_.motion(0);
    const Eigen::VectorXd u = body_.modal.shapes * modal.displacement;
    const Eigen::VectorXd v = body_.modal.shapes * modal.velocity;
    const Eigen::VectorXd before = u - simulation_.step_size() * v;
    return 0.5 * v.dot(body_.reduced.mass * v) + 0.5 * u.dot(body_.reduced.stiffness * before) +
           gravity_ * body_.reduced.rows.row(FallingBar::gravity_row).dot(0.5 * (u + before));
  }

 private:
  SystemBody body_;
  double gravity_;
  const Simulation& simulation_;
};

struct BarRun {
  double error = 0.0;  ///< root of the mean square over the run at the three watched points, m
  double energy_start = 0.0;
  double energy_gain = 0.0;  ///< largest of a step, J
  double energy_end = 0.0;
  double impulse = 0.0;        ///< N s
  double mean_pressure = 0.0;  ///< between `pressure_from` and `pressure_to`, Pa
  double first_contact = -1.0;
  double last_contact = -1.0;
};

/// @param motion displacement at X and t in closed form
BarRun run_bar(const FallingBar& bar, double step, double end, double pressure_from,
               double pressure_to, const std::function<double(double, double)>& motion) {
  Simulation simulation(bar.system(), time_of(step));
  const BarEnergy energy(bar, simulation);
  BarRun result;
  double before = result.energy_start = energy.value();
  double sum = 0.0;
  int num_pressures = 0;
  run(simulation, end, [&] {
    const double t = simulation.time();
    const std::pair<int, double> watched[] = {{FallingBar::lower_row, 0.0},
                                              {FallingBar::middle_row, 0.5 * bar.length},
                                              {FallingBar::upper_row, bar.length}};
    for (const auto& [row, place] : watched)
      sum += std::pow(simulation.displacement(0, row) - motion(place, t), 2);
    const double force = simulation.contact_force(0);
    result.impulse += step * force;
    if (force > 0.0) {
      if (result.first_contact < 0.0) result.first_contact = t;
      result.last_contact = t;
    }
    if (t >= pressure_from && t < pressure_to) {
      result.mean_pressure += force;
      ++num_pressures;
    }
    result.energy_end = energy.value();
    result.energy_gain = std::max(result.energy_gain, result.energy_end - before);
    before = result.energy_end;
  });
  result.error = std::sqrt(sum * step / (3.0 * end));
  result.mean_pressure /= std::max(num_pressures, 1);
  return result;
}

/// The bar hits the wall with 10 m/s: the stop runs up and, as release, down again, so the pressure
/// is ρ c v_0 = 300 Pa for 2 L/c and the bar leaves as it came.
double wall_motion(double place, double time) {
  constexpr double v0 = 10.0;
  constexpr double c = 30.0;
  constexpr double duration = 2.0 * 10.0 / c;
  if (time >= duration) return v0 * (time - duration);
  return v0 * (-std::min(time, place / c) + std::max(0.0, time - (20.0 - place) / c));
}

FallingBar bar_at_wall(int num_elements) {
  FallingBar bar;
  bar.height = 0.0;
  bar.gravity = 0.0;
  bar.velocity = -10.0;
  bar.num_elements = num_elements;
  return bar;
}

TEST(ClosedForms, BarThatHitsAWallAtFirstOrderWhileItTouches) {
  std::vector<double> errors;
  for (const int n : {20, 40, 80, 160}) {
    const FallingBar bar = bar_at_wall(n);
    const double step = 0.5 * bar.step_limit();
    const BarRun result = run_bar(bar, step, 2.0 / 3.0, 0.1, 0.6, wall_motion);
    errors.push_back(result.error);
    // Behind the front the oscillation of the mesh decays; the mean is right much earlier.
    EXPECT_NEAR(result.mean_pressure, 300.0, 300.0 * 10.0 / std::pow(n, 2)) << n;
  }
  expect_orders(errors, 0.85, 1.15);
}

TEST(ClosedForms, BarThatHitsAWallLeavesWithWhatItsLowestMassDidNotLose) {
  for (const int n : {40, 80, 160}) {
    const FallingBar bar = bar_at_wall(n);
    const double step = 0.5 * bar.step_limit();
    const BarRun result = run_bar(bar, step, 1.0, 0.1, 0.6, wall_motion);
    EXPECT_EQ(result.first_contact, 0.0);
    // A front of n elements is blurred over some n^(1/3) of them.
    EXPECT_NEAR(result.last_contact, 2.0 / 3.0, std::cbrt(n) * bar.step_limit());
    // Twice the momentum of 10 kg at 10 m/s, less what the blurred front keeps.
    EXPECT_NEAR(result.impulse, 200.0, 200.0 * std::pow(n, -2.0 / 3.0) * 0.2);
    // The impact stops half an element at once, for good: ½ (ρ Δx/2) v_0². Nothing else is lost,
    // and nothing is ever gained but the rounding of u K u, eps E (10 m)²/Δx per step.
    EXPECT_NEAR(result.energy_start, 500.0, 1e-9);
    EXPECT_NEAR(result.energy_start - result.energy_end, 25.0 * bar.element_length(), 1e-6);
    EXPECT_LT(result.energy_gain, 1e-9);
  }
}

/// Dropped from 5 m with g = 10 m/s²: impact after 1 s with 10 m/s. While it touches, ρ c v_0 and
/// the weight that the stopped part takes up press with 300 Pa (1 + t); after 2 L/c it leaves with
/// 10 m/s and the compression −2 (g/c²)(L X − X²/2), swings freely three times, and comes back as
/// it left, so that all of the motion is mirrored at t = 8/3 s. Displacements count from the place
/// on the ground.
double bounce_motion(double place, double time) {
  constexpr double v0 = 10.0;
  constexpr double c = 30.0;
  constexpr double g = 10.0;
  constexpr double length = 10.0;
  if (time > 8.0 / 3.0) time = 16.0 / 3.0 - time;
  if (time < 1.0) return 5.0 - 0.5 * g * time * time;
  const auto fall = [&](double t) { return t > 0.0 ? 0.5 * g * t * t : 0.0; };
  if (time < 5.0 / 3.0) {
    const double t = time - 1.0;
    const double up = place / c;
    const double down = (2.0 * length - place) / c;
    return v0 * (std::max(0.0, t - down) - std::min(t, up)) - fall(t) + fall(t - up) +
           fall(t - down);
  }
  const double t = time - 5.0 / 3.0;
  const auto compression = [&](double x) {
    x = std::fmod(std::abs(x), 2.0 * length);
    if (x > length) x = 2.0 * length - x;
    return -2.0 * g / (c * c) * (length * x - 0.5 * x * x);
  };
  return v0 * t - fall(t) + 0.5 * (compression(place - c * t) + compression(place + c * t));
}

/// run_bar() with displacements counted from the ground.
BarRun run_bounce(int num_elements, double end) {
  FallingBar bar;
  bar.num_elements = num_elements;
  return run_bar(bar, 0.9 * bar.step_limit(), end, 1.1, 1.6, [&](double place, double time) {
    return bounce_motion(place, time) - bar.height;
  });
}

TEST(ClosedForms, DroppedBarAtFirstOrder) {
  std::vector<double> errors;
  for (const int n : {20, 40, 80, 160}) {
    const BarRun result = run_bounce(n, 8.0 / 3.0);
    errors.push_back(result.error);
    const double slack = 2.0 * 10.0 / 30.0 / n;  // two elements of wave travel
    EXPECT_NEAR(result.first_contact, 1.0, slack) << n;
    EXPECT_NEAR(result.last_contact, 5.0 / 3.0, slack) << n;
    // 300 Pa (1 + t) between 0.1 and 0.6 s: 405 Pa.
    EXPECT_NEAR(result.mean_pressure, 405.0, 405.0 * 0.2 / n) << n;
    // Twice the momentum and the weight of 10 kg for 2/3 s.
    EXPECT_NEAR(result.impulse, 200.0 + 100.0 * 2.0 / 3.0, 266.7 * 0.1 / n) << n;
  }
  expect_orders(errors, 0.85, 1.15);
}

TEST(ClosedForms, DroppedBarBouncesTwiceWithoutGainingEnergy) {
  // It starts with none, counted from its height, and each impact takes about half an element's
  // kinetic energy; the elastic energy at the second is not that of the closed form to the element.
  std::vector<double> losses;
  for (const int n : {20, 40, 80, 160}) {
    const BarRun result = run_bounce(n, 16.0 / 3.0);
    EXPECT_LT(result.energy_gain, 1e-8) << n;  // as above, with n² K u² (5 m)²
    losses.push_back(result.energy_start - result.energy_end);
    EXPECT_GT(losses.back(), 0.0);
    EXPECT_LT(losses.back(), 2.0 * 25.0 * 10.0 / n);
  }
  expect_orders(losses, 0.7, 1.3);
}

// A force that crosses a simply supported beam with v = 0.1 v_cr.

/// Midspan deflection at t = L/(2v) over P L³/(48 E I): the terms sin(i ω_1 t/α) of the series
/// vanish for α = 0.1.
double midspan_closed_form(int num_modes) {
  double sum = 0.0;
  for (int i = 1; i <= num_modes; i += 2) sum += 1.0 / (i * i * (i * i - 0.01));
  return 96.0 / std::pow(pi, 4) * sum;
}

double midspan(const MovingForce& scene, int num_steps) {
  const double step = scene.length / (2.0 * scene.speed()) / num_steps;
  Simulation simulation(scene.system(), time_of(step));
  EXPECT_EQ(simulation.step_until(num_steps), StepOutcome::done) << simulation.failure();
  EXPECT_NEAR(simulation.contact_force(0), scene.force, 1e-6 * scene.force);
  return -simulation.displacement(1, scene.middle_row()) * 48.0 * scene.bending_stiffness /
         (scene.force * std::pow(scene.length, 3));
}

TEST(ClosedForms, MovingForceOnASimplySupportedBeamAtFirstOrder) {
  EXPECT_NEAR(midspan_closed_form(999), 1.0099691, 1e-7);
  MovingForce scene;
  scene.num_modes = 20;
  scene.num_segments = 1000;
  std::vector<double> errors;
  for (const int num_steps : {4000, 8000, 16000})
    errors.push_back(std::abs(midspan(scene, num_steps) - midspan_closed_form(20)));
  // Forces are shared between the nodes as of the end of the step: the load is v h ahead.
  expect_orders(errors, 0.9, 1.1);
}

TEST(ClosedForms, MovingForceReachesTheDeflectionOfTheSeries) {
  // 40 modes miss 3e-6 of the series, 800 segments 2e-6 of the load's place; extrapolated to h = 0.
  MovingForce scene;
  scene.num_modes = 40;
  scene.num_segments = 800;
  const double coarse = midspan(scene, 16000);
  const double fine = midspan(scene, 32000);
  EXPECT_NEAR(2.0 * fine - coarse, 1.0099691, 1e-5);
}

// A friction law that falls with the speed makes steady sliding unstable: about the equilibrium
// x_0 = μ(v) N/k, m ẍ + (c + N μ'(v)) ẋ + k x = 0.

/// Growth rate of a perturbation of 10⁻⁷ m, from displacements a quarter of a period apart over ten
/// periods: x_{n+m} + x_{n−m} γ² is proportional to x_n where γ = e^{σ m h}.
double growth_rate(const MassOnGround& given, double step) {
  MassOnGround scene = given;
  const double equilibrium =
      scene.load * sliding_friction(scene.friction, scene.belt_velocity) / scene.stiffness;
  scene.displacement = equilibrium + 1e-7;
  Simulation simulation(scene.system(), time_of(step));
  const double period = 2.0 * pi / std::sqrt(scene.stiffness / scene.mass);
  std::vector<double> x;
  run(simulation, 10.0 * period,
      [&] { x.push_back(simulation.displacement(0, MassOnGround::x_row) - equilibrium); });
  const auto m = static_cast<std::size_t>(period / 4.0 / step);
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (std::size_t n = m; n + m < x.size(); ++n) {
    const Eigen::Vector2d row(x[n], -x[n - m]);
    normal += row * row.transpose();
    right += row * x[n + m];
  }
  const double square = normal.ldlt().solve(right)(1);
  return std::log(square) / (2.0 * static_cast<double>(m) * step);
}

TEST(ClosedForms, FallingFrictionGrowsAtTheRateOfItsSlope) {
  struct Case {
    double static_coefficient;
    double dynamic_coefficient;
    double alpha;
  };
  // Falling stronger than the damping, weaker, and rising: N μ'(v) = ∓ 10 · 0.2/0.2 · e^{-0.5}.
  for (const auto& [mu_s, mu_d, alpha] :
       {Case{0.5, 0.3, 2.0}, Case{0.5, 0.3, 10.0}, Case{0.3, 0.5, 0.0}, Case{0.3, 0.3, 3.0}}) {
    MassOnGround scene;
    scene.stiffness = 1e4;
    scene.belt_velocity = 0.1;
    scene.alpha = alpha;
    scene.friction = stribeck_friction(mu_s, mu_d, 0.2);
    const double slope = sliding_friction_slope(scene.friction, 0.1);
    const double expected = (-alpha * scene.mass - scene.load * slope) / (2.0 * scene.mass);
    for (const ContactAssumption assumption :
         {ContactAssumption::film, ContactAssumption::subs_b}) {
      scene.assumption = assumption;
      std::vector<double> errors;
      for (const double step : {1e-4, 5e-5, 2.5e-5}) {
        const double rate = growth_rate(scene, step);
        errors.push_back(std::abs(rate - expected));
        // Backward differences in both: 1 − h c is the square of the factor per step, so the rate
        // is ln(1 − 2 σ' h)/(2 h) with σ' = −σ. The remainder is the curvature of the law over a
        // perturbation of 10⁻⁵ m/s.
        EXPECT_NEAR(rate, std::log1p(2.0 * expected * step) / (2.0 * step),
                    1e-6 * std::abs(expected))
            << mu_s << ' ' << alpha;
      }
      expect_orders(errors, 0.8, 1.2);
    }
    // The damping alone would never let it grow.
    EXPECT_EQ(expected > 0.0, mu_s == 0.5 && alpha == 2.0);
  }
}

}  // namespace
}  // namespace stridor
