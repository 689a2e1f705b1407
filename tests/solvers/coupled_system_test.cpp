// Bodies with gyroscopic, circulatory and non-proportional damping terms in sliding contact:
// against the same bodies without, and growth against eigenvalues.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <vector>

#include "core/errors.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/eigenvalues/eigenvector.hpp"
#include "solvers/eigenvalues/secular_eigenvalues.hpp"
#include "solvers/equilibrium/equilibrium.hpp"
#include "solvers/equilibrium/linearise.hpp"
#include "solvers/integrators/coupled_propagator.hpp"
#include "solvers/transient/frozen_step.hpp"
#include "solvers/transient/simulation.hpp"
#include "substructures/bodies/beam.hpp"
#include "tests/support/paper_model.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

/// The main scene with few modes and damping that is switched off nowhere, moving or held.
Model sliding_model(SlidingMode sliding) {
  ModelParameters parameters = test::paper_model();
  for (auto& [name, body] : parameters.substructures) {
    auto& beam = body.get<BeamParameters>();
    beam.reduction.fixed_interface_modes = 4;
    beam.damping.alpha_start.reset();
    beam.damping.hold = beam.damping.fade = 0.0;
  }
  auto& cantilever = parameters.substructures["cantilever"].get<BeamParameters>();
  cantilever.mesh.along = 10;
  cantilever.interface.spacing = 0.02;
  auto& oblique = parameters.substructures["oblique"].get<BeamParameters>();
  oblique.mesh.along = 8;
  parameters.contact->sliding = sliding;
  parameters.contact->start = 0.05;
  parameters.contact->armed_from = 1e9;
  parameters.drive->ramp = 0.0;
  return make_model(parameters, {});
}

/// The same with its proportional damping as terms beside the modes.
System with_damping_coupled(System system) {
  for (SystemBody& body : system.bodies) {
    const RayleighDamping& damping = body.reduced.damping;
    body.reduced.coupled = {
        damping.alpha * body.reduced.mass + damping.beta * body.reduced.stiffness,
        Eigen::MatrixXd::Zero(body.reduced.size(), body.reduced.size())};
    body.reduced.damping = {};
    body.modal.damping = {};
    body.modal.coupled = body.reduced.coupled.in(body.modal.shapes);
  }
  return system;
}

/// A step that the fastest mode of all bodies allows.
TimeParameters resolving_time(const System& system) {
  double fastest = 0.0;
  for (const SystemBody& body : system.bodies)
    if (body.modal.size() > 0) fastest = std::max(fastest, body.modal.omega.maxCoeff());
  TimeParameters time;
  time.integrator = Integrator::exact;
  time.step = 1.5 / fastest;
  time.end = 1.0;
  return time;
}

TEST(CoupledSystem, MovesAsTheModesDoWhereNothingIsCoupled) {
  const Model model = sliding_model(SlidingMode::moving);
  const TimeParameters time = resolving_time(model.system);
  Simulation modes(model.system, time);
  Simulation coupled(with_damping_coupled(model.system), time);
  double largest = 0.0;
  double difference = 0.0;
  for (int n = 0; n < 20000; ++n) {
    ASSERT_EQ(modes.step(), StepOutcome::done);
    ASSERT_EQ(coupled.step(), StepOutcome::done);
    const int row = model.system.contacts[0].slave_rows.y;
    const double expected = modes.displacement(model.system.contacts[0].slave_body, row);
    largest = std::max(largest, std::abs(expected));
    difference = std::max(
        difference,
        std::abs(coupled.displacement(model.system.contacts[0].slave_body, row) - expected));
  }
  EXPECT_GT(largest, 1e-7);
  EXPECT_LT(difference, 1e-8 * largest);
}

/// Values next to each other in frequency and growth, relative to the largest.
void expect_same_spectrum(std::vector<Complex> a, std::vector<Complex> b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  double scale = 0.0;
  for (const Complex& value : a) scale = std::max(scale, std::abs(value));
  for (const Complex& value : a) {
    const auto nearest = std::min_element(b.begin(), b.end(), [&](const auto& x, const auto& y) {
      return std::abs(x - value) < std::abs(y - value);
    });
    EXPECT_LT(std::abs(*nearest - value), tolerance * scale) << value;
    b.erase(nearest);
  }
}

std::vector<Complex> values_of(const std::vector<Eigenvalue>& eigenvalues) {
  std::vector<Complex> values;
  for (const Eigenvalue& one : eigenvalues) values.push_back(one.s);
  return values;
}

TEST(CoupledSystem, HasTheEigenvaluesAndStepsOfTheModesWhereNothingIsCoupled) {
  const Model model = sliding_model(SlidingMode::frozen);
  const System coupled = with_damping_coupled(model.system);
  const Equilibrium equilibrium = find_equilibrium(model.system, sliding_state(model.system, 0.0));
  const Equilibrium same = find_equilibrium(coupled, sliding_state(coupled, 0.0));
  ASSERT_EQ(same.status, EquilibriumStatus::converged);
  EXPECT_NEAR(same.contacts[0].force, equilibrium.contacts[0].force, 1e-12);
  const Pencil pencil = linearise(model.system, equilibrium);
  const Pencil other = linearise(coupled, same);
  EXPECT_GT(other.num_body_ports, 0);
  expect_same_spectrum(values_of(dense_eigenvalues(other)), values_of(dense_eigenvalues(pencil)),
                       1e-12);
  const TimeParameters time = resolving_time(model.system);
  expect_same_spectrum(FrozenStep(coupled, time).factors(other),
                       FrozenStep(model.system, time).factors(pencil), 1e-9);
}

/// Gyroscopic and circulatory terms on the cantilever, and a damper at its end.
System with_coupled_terms(System system) {
  for (SystemBody& body : system.bodies) {
    if (body.name != "cantilever") continue;
    const Eigen::Index n = body.reduced.size();
    const Eigen::MatrixXd& K = body.reduced.stiffness;
    const Eigen::MatrixXd& M = body.reduced.mass;
    Eigen::MatrixXd upper = Eigen::MatrixXd::Zero(n, n);
    upper.triangularView<Eigen::StrictlyUpper>() = M;
    body.reduced.coupled.velocity = 3000.0 * (upper - upper.transpose());
    body.reduced.coupled.velocity(n - 1, n - 1) += 50.0;
    upper.setZero();
    upper.triangularView<Eigen::StrictlyUpper>() = K;
    body.reduced.coupled.position = 1e-6 * (upper - upper.transpose());
    body.modal.coupled = body.reduced.coupled.in(body.modal.shapes);
  }
  return system;
}

TEST(CoupledSystem, EquilibriumBalancesTheCirculatoryForces) {
  const System system = with_coupled_terms(sliding_model(SlidingMode::frozen).system);
  const Equilibrium found = find_equilibrium(system, sliding_state(system, 0.0));
  ASSERT_EQ(found.status, EquilibriumStatus::converged);
  // The remainder of K u + N u is a force of the contact on its own rows alone.
  std::size_t b = 0;
  while (system.bodies[b].name != "cantilever") ++b;
  const ModalBody& modal = system.bodies[b].modal;
  const Eigen::VectorXd force =
      modal.omega.array().square().matrix().cwiseProduct(found.displacement[b]) +
      modal.coupled.position * found.displacement[b];
  const ContactEquilibrium& contact = found.contacts[0];
  const ContactRows rows = make_rows(contact.projection, contact.friction, contact.direction);
  const Stencil stencil = system.surfaces[0].stencil(contact.segment);
  Eigen::VectorXd pushed = Eigen::VectorXd::Zero(modal.size());
  for (int k = 0; k < stencil.count; ++k) {
    const PointRows& node = system.surfaces[0].rows[static_cast<std::size_t>(stencil.first + k)];
    const auto port = static_cast<std::size_t>(2 * k);
    pushed -= contact.force * (rows.equilibrium.master[port] * modal.rows.row(node.x) +
                               rows.equilibrium.master[port + 1] * modal.rows.row(node.y))
                                  .transpose();
  }
  EXPECT_LT((force - pushed).norm(), 1e-9 * pushed.norm());
  EXPECT_GT((modal.coupled.position * found.displacement[b]).norm(), 1e-4 * pushed.norm());
}

TEST(CoupledSystem, SecularAndDenseEigenvaluesAgree) {
  const System system = with_coupled_terms(sliding_model(SlidingMode::frozen).system);
  const Equilibrium equilibrium = find_equilibrium(system, sliding_state(system, 0.0));
  const Pencil pencil = linearise(system, equilibrium);
  std::vector<Complex> dense;
  for (const Complex& s : values_of(dense_eigenvalues(pencil)))
    if (s.imag() > 0.0) dense.push_back(s);
  std::vector<Complex> secular;
  for (const Complex& s : values_of(secular_eigenvalues(pencil, SpectrumWindow::below(1e7))))
    if (s.imag() > 0.0) secular.push_back(s);
  expect_same_spectrum(secular, dense, 1e-9);
}

/// Growth of a held system from one of its eigenvectors, from the amplitude of the slave point at
/// the frequency of the eigenvalue in two windows.
double growth_in_steps(const System& held, const Equilibrium& equilibrium, const Pencil& pencil,
                       const Eigenvalue& mode, const TimeParameters& time) {
  System system = held;
  apply_initial_motion(system, equilibrium);
  add_perturbation(system, eigenvector(pencil, mode.s).right, mode.s, 1e-9);
  Simulation simulation(system, time);
  const ContactPoint& point = system.contacts[0];
  const double period = 2.0 * M_PI / mode.s.imag();
  const auto window = static_cast<std::int64_t>(std::lround(40.0 * period / time.step));
  const auto amplitude = [&](std::int64_t from) {
    simulation.step_until(from);
    const double base = simulation.displacement(point.slave_body, point.slave_rows.y);
    Complex sum = 0.0;
    for (std::int64_t n = 0; n <= window; ++n) {
      simulation.step_until(from + n);
      const double t = static_cast<double>(from + n) * time.step;
      const double weight =
          std::pow(std::sin(M_PI * static_cast<double>(n) / static_cast<double>(window)), 4);
      sum += weight * std::exp(Complex(0.0, -mode.s.imag() * t)) *
             (simulation.displacement(point.slave_body, point.slave_rows.y) - base);
    }
    return std::abs(sum);
  };
  const auto far = static_cast<std::int64_t>(std::lround(0.02 / time.step));
  const double first = amplitude(1);
  const double second = amplitude(1 + far + window);
  return std::log(second / first) / (static_cast<double>(far + window) * time.step);
}

TEST(CoupledSystem, GrowsFromItsEigenvectorAsTheEigenvalueSays) {
  const System system = with_coupled_terms(sliding_model(SlidingMode::frozen).system);
  const Equilibrium equilibrium = find_equilibrium(system, sliding_state(system, 0.0));
  const Pencil pencil = linearise(system, equilibrium);
  Eigenvalue fastest;
  fastest.s = {-1e9, 0.0};
  for (const Eigenvalue& one : dense_eigenvalues(pencil))
    if (one.s.imag() > 0.0 && one.growth() > fastest.growth()) fastest = one;
  ASSERT_GT(fastest.growth(), 10.0) << "the coupled terms drive it";
  TimeParameters time = resolving_time(system);
  time.step *= 0.5;
  const double coarse =
      growth_in_steps(system, equilibrium, pencil, fastest, time) - fastest.growth();
  time.step *= 0.5;
  const double fine =
      growth_in_steps(system, equilibrium, pencil, fastest, time) - fastest.growth();
  EXPECT_LT(std::abs(fine), 1e-3 * fastest.growth()) << fastest.s;
  EXPECT_LT(std::abs(fine), 0.5 * std::abs(coarse) + 1e-5 * fastest.growth());
  // The map of one step knows no motion that grows faster.
  const std::vector<Complex> factors = FrozenStep(system, time).factors(pencil);
  EXPECT_NEAR(std::log(spectral_radius(factors)) / time.step, fastest.growth(),
              0.02 * fastest.growth());
}

TEST(CoupledSystem, IsMarchedExactlyOnly) {
  const System system = with_coupled_terms(sliding_model(SlidingMode::frozen).system);
  TimeParameters time = resolving_time(system);
  time.step *= 0.1;
  time.integrator = Integrator::central_difference;
  for (const auto& make : {+[](const System&s, const TimeParameters&t) { Simulation(s, t); },
                           +[](const System&s, const TimeParameters&t) { FrozenStep(s, t); }}) {
    try {
      make(system, time);
      FAIL() << "the scheme is of independent modes";
    } catch (const ConfigError& error) {
      EXPECT_EQ(error.problems().front().key, "time.integrator");
      EXPECT_THAT(error.what(), ::testing::HasSubstr("the modes of 'cantilever' are coupled"));
    }
  }
}

}  // namespace
}  // namespace stridor
