// A sphere on a viscoelastic substrate: time per point of a stability map, and the time of a limit
// cycle against SUNDIALS ARKODE with the same right-hand side and the same events.
#include <arkode/arkode_erkstep.h>
#include <fmt/format.h>
#include <nvector/nvector_serial.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <stdexcept>
#include <vector>

#include "solvers/transient/substrate_motion.hpp"
#include "tests/support/paper_sphere.hpp"

namespace stridor {
namespace {

using test::paper_sphere;

/// Of the processor, so that what else runs on the machine does not count.
struct Clock {
  static double now() {
    return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
  }
};

double seconds_since(double start) {
  return Clock::now() - start;
}

/// Equilibrium, linearisation and leading eigenvalue over speeds and shear strengths, seconds per
/// point.
double map_point_seconds(SphereContactLaw law) {
  constexpr int side = 300;
  test::PaperSphere model = paper_sphere();
  model.contact_law = law;
  double last = 1e-2;
  double sum = 0.0;
  const auto start = Clock::now();
  for (int i = 0; i < side; ++i) {
    model.shear_strength = std::pow(10.0, -4.0 + 3.0 * i / side);
    for (int j = 0; j < side; ++j) {
      model.speed = std::pow(10.0, -6.0 + 8.0 * j / side);
      const SubstrateOscillator oscillator = make_sphere(model);
      const double unit = oscillator.contact.indentation_unit;
      const SubstrateEquilibrium rest = find_equilibrium(oscillator, last * unit);
      last = rest.displacement.y() / unit;
      sum += leading_eigenvalue(small_motion(oscillator, rest)).real();
    }
  }
  const double elapsed = seconds_since(start);
  if (!std::isfinite(sum)) throw std::runtime_error("a growth rate is not finite");
  return elapsed / (side * side);
}

void check(int flag, const char* what) {
  if (flag < 0) throw std::runtime_error(fmt::format("{} failed: {}", what, flag));
}

/// The same equations for ARKODE, with the mode that they are in.
struct ArkodeSphere {
  const SubstrateOscillator* oscillator;
  SubstrateMode mode = SubstrateMode::slip_back;
  long evaluations = 0;

  double required(const double* s) const {
    const auto& c = oscillator->damping;
    const auto& k = oscillator->stiffness;
    return c(0, 0) * s[2] + k(0, 0) * s[0] + k(0, 1) * s[1];
  }
  void settle(double* s) {
    s[2] = oscillator->substrate_speed;
    const double r = required(s);
    if (std::abs(r) <= oscillator->contact.static_strength(s[1]).value) {
      mode = SubstrateMode::stick;
    } else {
      mode = r > 0.0 ? SubstrateMode::slip_back : SubstrateMode::slip_forward;
    }
  }
};

int right_hand_side(realtype, N_Vector y, N_Vector y_dot, void* user) {
  auto& sphere = *static_cast<ArkodeSphere*>(user);
  ++sphere.evaluations;
  const double* s = N_VGetArrayPointer(y);
  double* slope = N_VGetArrayPointer(y_dot);
  const SubstrateOscillator& o = *sphere.oscillator;
  double normal = 0.0;
  double tangential = 0.0;
  if (sphere.mode == SubstrateMode::stick) {
    normal = o.contact.at(s[1], 0.0, 1.0).normal.value;
  } else if (sphere.mode != SubstrateMode::free) {
    const double direction = sphere.mode == SubstrateMode::slip_forward ? 1.0 : -1.0;
    const SubstrateForces forces = o.contact.at(s[1], s[2] - o.substrate_speed, direction);
    normal = forces.normal.value;
    tangential = forces.tangential.value;
  }
  slope[0] = s[2];
  slope[1] = s[3];
  slope[2] = sphere.mode == SubstrateMode::stick ? 0.0 : tangential - sphere.required(s);
  slope[3] = o.load.y() - normal - o.damping(1, 1) * s[3] - o.stiffness(1, 0) * s[0] -
             o.stiffness(1, 1) * s[1];
  return 0;
}

/// Slip, what strength is left, and the indentation.
int root_functions(realtype, N_Vector y, realtype* roots, void* user) {
  const auto& sphere = *static_cast<ArkodeSphere*>(user);
  const double* s = N_VGetArrayPointer(y);
  const bool sticks = sphere.mode == SubstrateMode::stick;
  const bool flies = sphere.mode == SubstrateMode::free;
  roots[0] = sticks || flies ? 1.0 : s[2] - sphere.oscillator->substrate_speed;
  roots[1] =
      sticks ? sphere.oscillator->contact.static_strength(s[1]).value - std::abs(sphere.required(s))
             : 1.0;
  roots[2] = s[1];
  return 0;
}

struct Timing {
  double seconds = 0.0;
  long evaluations = 0;
  std::array<double, 4> end{};
};

Timing run_arkode(const SubstrateOscillator& oscillator, const std::array<double, 4>& start,
                  double end, double tolerance, ARKODE_ERKTableID table) {
  const auto begin = Clock::now();
  ArkodeSphere sphere{&oscillator};
  SUNContext context = nullptr;
  check(SUNContext_Create(nullptr, &context), "SUNContext_Create");
  N_Vector y = N_VNew_Serial(4, context);
  double* s = N_VGetArrayPointer(y);
  std::copy(start.begin(), start.end(), s);
  void* memory = ERKStepCreate(right_hand_side, 0.0, y, context);
  check(ERKStepSetTableNum(memory, table), "table");
  check(ERKStepSStolerances(memory, tolerance, 0.02 * tolerance), "tolerances");
  check(ERKStepSetUserData(memory, &sphere), "user data");
  check(ERKStepSetMaxNumSteps(memory, 10'000'000), "steps");
  check(ERKStepRootInit(memory, 3, root_functions), "roots");
  check(ERKStepSetNoInactiveRootWarn(memory), "warnings");
  check(ERKStepSetStopTime(memory, end), "stop time");
  double t = 0.0;
  while (t < end) {
    const int flag = ERKStepEvolve(memory, end, y, &t, ARK_NORMAL);
    check(flag, "ERKStepEvolve");
    if (flag != ARK_ROOT_RETURN) continue;
    int found[3];
    check(ERKStepGetRootInfo(memory, found), "root info");
    if (found[2] < 0) {
      sphere.mode = SubstrateMode::free;
    } else if (found[2] > 0) {
      sphere.mode = s[2] > oscillator.substrate_speed ? SubstrateMode::slip_forward
                                                      : SubstrateMode::slip_back;
    } else if (found[0] != 0) {
      sphere.settle(s);
    } else if (found[1] != 0) {
      sphere.mode =
          sphere.required(s) > 0.0 ? SubstrateMode::slip_back : SubstrateMode::slip_forward;
    }
    check(ERKStepReset(memory, t, y), "ERKStepReset");
    check(ERKStepSetStopTime(memory, end), "stop time");
  }
  Timing timing;
  std::copy(s, s + 4, timing.end.begin());
  timing.evaluations = sphere.evaluations;
  ERKStepFree(&memory);
  N_VDestroy(y);
  SUNContext_Free(&context);
  timing.seconds = seconds_since(begin);
  return timing;
}

Timing run_events(const SubstrateOscillator& oscillator, const std::array<double, 4>& start,
                  double end, double tolerance) {
  const auto begin = Clock::now();
  SubstrateMotion motion(oscillator, tolerance);
  motion.start({start[0], start[1]}, {start[2], start[3]});
  if (motion.advance(end, false) != SubstrateMotion::Stop::end)
    throw std::runtime_error("the motion failed");
  Timing timing;
  timing.seconds = seconds_since(begin);
  timing.evaluations = motion.statistics().evaluations;
  std::copy_n(motion.state().begin(), 4, timing.end.begin());
  return timing;
}

double difference(const std::array<double, 4>& a, const std::array<double, 4>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1]);
}

/// The least of three times.
template <class F>
Timing best_of(F&& run) {
  Timing best = run();
  for (int i = 0; i < 2; ++i) {
    const Timing again = run();
    if (again.seconds < best.seconds) best = again;
  }
  return best;
}

void report() {
  fmt::print("map, published fit:     {:.0f} ns per point\n",
             1e9 * map_point_seconds(SphereContactLaw::published_fit));
  fmt::print("map, boundary elements: {:.0f} ns per point\n",
             1e9 * map_point_seconds(SphereContactLaw::boundary_element));
  const SubstrateOscillator oscillator = make_sphere(paper_sphere());
  // On the limit cycle, so that errors do not grow.
  SubstrateMotion settling(oscillator, 1e-12);
  const SubstrateEquilibrium rest = find_equilibrium(oscillator);
  settling.start({rest.displacement.x(), 1.01 * rest.displacement.y()}, {0.0, 0.0});
  (void)settling.advance(500.0, true);
  while (settling.time() < 500.0) (void)settling.advance(1000.0, true);
  std::array<double, 4> start{};
  std::copy_n(settling.state().begin(), 4, start.begin());
  constexpr double end = 500.0;
  const Timing exact = run_events(oscillator, start, end, 1e-13);
  fmt::print("limit cycle, {} time units:\n{:<28}{:>10}{:>12}{:>14}{:>12}\n", end, "", "rtol", "ms",
             "evaluations", "error");
  const auto print = [&](const char* name, double tolerance, const Timing& timing) {
    fmt::print("{:<28}{:>10.0e}{:>12.3f}{:>14}{:>12.2e}\n", name, tolerance, 1e3 * timing.seconds,
               timing.evaluations, difference(timing.end, exact.end));
  };
  for (const double tolerance : {1e-6, 1e-9}) {
    print("event-driven, order 8", tolerance,
          best_of([&] { return run_events(oscillator, start, end, tolerance); }));
    print("ARKODE, default (order 4)", tolerance, best_of([&] {
            return run_arkode(oscillator, start, end, tolerance, ARKODE_ZONNEVELD_5_3_4);
          }));
    print("ARKODE, Dormand-Prince 5", tolerance, best_of([&] {
            return run_arkode(oscillator, start, end, tolerance, ARKODE_DORMAND_PRINCE_7_4_5);
          }));
    print("ARKODE, Verner 8", tolerance, best_of([&] {
            return run_arkode(oscillator, start, end, tolerance, ARKODE_VERNER_8_5_6);
          }));
  }
}

}  // namespace
}  // namespace stridor

int main() {
  try {
    stridor::report();
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
