#include "bench/siconos_march.hpp"

#include <SolverOptions.h>
#include <SiconosKernel.hpp>

#include "bench/processor_clock.hpp"

namespace stridor::bench {
namespace {

SP::SiconosVector to_siconos(const Eigen::VectorXd& values) {
  SP::SiconosVector vector(new SiconosVector(static_cast<unsigned>(values.size())));
  Eigen::Map<Eigen::VectorXd>(vector->getArray(), values.size()) = values;
  return vector;
}

SP::SimpleMatrix to_siconos(const Eigen::MatrixXd& values) {
  const auto n = static_cast<unsigned>(values.rows());
  SP::SimpleMatrix matrix(new SimpleMatrix(n, n));
  Eigen::Map<Eigen::MatrixXd>(matrix->getArray(), values.rows(), values.cols()) = values;
  return matrix;
}

MovingContact::Vector view(const SiconosVector& vector) {
  return {vector.getArray(), static_cast<Eigen::Index>(vector.size())};
}

class MovingRelation : public LagrangianRheonomousR {
 public:
  MovingRelation(MovingContact& contact, unsigned size) : contact_(contact) {
    _hDot.reset(new SiconosVector(2));
    _jachq.reset(new SimpleMatrix(2, size));
  }

  void initialize(Interaction&) override {}

  void computeh(double time, const BlockVector& q, BlockVector&, SiconosVector& y) override {
    find(time, q);
    y.setValue(0, place_.gap);
    y.setValue(1, 0.0);
  }

  void computehDot(double time, const BlockVector& q, BlockVector&) override {
    find(time, q);
    _hDot->setValue(0, place_.rates[0]);
    _hDot->setValue(1, place_.rates[1]);
  }

  void computeJachq(double time, const BlockVector& q, BlockVector&) override {
    find(time, q);
    Eigen::Map<Eigen::Matrix2Xd>(_jachq->getArray(), 2, place_.rows.cols()) = place_.rows;
  }

 private:
  void find(double time, const BlockVector& q) {
    contact_.find(time, view(*q.vector(0)), view(*q.vector(1)), place_);
  }

  MovingContact& contact_;
  MovingContact::Place place_;
};

}  // namespace

double march_siconos(const SiconosBody& slave, const SiconosBody& master, MovingContact& contact,
                     const SiconosParameters& parameters, const SiconosLook& look) {
  const double start = processor_seconds();
  SP::NonSmoothDynamicalSystem model(new NonSmoothDynamicalSystem(
      0.0, parameters.step * static_cast<double>(parameters.num_steps + 1)));
  const auto insert = [&](const SiconosBody& body) {
    std::shared_ptr<LagrangianLinearTIDS> system(new LagrangianLinearTIDS(
        to_siconos(body.displacement), to_siconos(body.velocity), to_siconos(body.mass),
        to_siconos(body.stiffness), to_siconos(body.damping)));
    system->setFExtPtr(to_siconos(body.load));
    model->insertDynamicalSystem(system);
    return system;
  };
  const auto first = insert(slave);
  const auto second = insert(master);
  SP::NonSmoothLaw law(new NewtonImpactFrictionNSL(0.0, 0.0, parameters.friction, 2));
  SP::Relation relation(
      new MovingRelation(contact, static_cast<unsigned>(slave.load.size() + master.load.size())));
  SP::Interaction interaction(new Interaction(law, relation));
  model->link(interaction, first, second);

  SP::TimeDiscretisation times(new TimeDiscretisation(0.0, parameters.step));
  std::shared_ptr<MoreauJeanOSI> integrator(new MoreauJeanOSI(0.5));
  integrator->setConstraintActivationThreshold(parameters.activation);
  std::shared_ptr<FrictionContact> problem(new FrictionContact(2, SICONOS_FRICTION_2D_NSGS));
  problem->numericsSolverOptions()->dparam[SICONOS_DPARAM_TOL] = parameters.solver_tolerance;
  std::shared_ptr<TimeStepping> stepping(new TimeStepping(model, times, integrator, problem));
  stepping->setNewtonOptions(SICONOS_TS_LINEAR);
  stepping->initialize();

  const double setup = processor_seconds() - start;
  look(0, view(*first->q()), view(*second->q()), 0.0);
  for (std::int64_t k = 1; k <= parameters.num_steps; ++k) {
    stepping->computeOneStep();
    stepping->nextStep();
    look(k, view(*first->q()), view(*second->q()), (*interaction->lambda(1))(0));
  }
  return setup;
}

}  // namespace stridor::bench
