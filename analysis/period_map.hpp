// The map of a system over one period, and its derivative.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstdint>
#include <optional>
#include <vector>

#include "coupling/system/system.hpp"
#include "solvers/transient/simulation.hpp"
#include "solvers/integrators/time_parameters.hpp"

namespace stridor {

/// Steps in stretches between which a stop is heard. @return the outcome of the last
/// @throws Interrupted where a stop was requested
StepOutcome step_on(Simulation& simulation, std::int64_t target);

/// P_T(z) of a system by N steps of T/N, with z = (q, q̇) of all bodies in the coordinates that they
/// are marched in, m and m/s over the normalisation of the modes.
class PeriodMap {
 public:
  /// @param system     of which nothing prescribed changes with time; its bodies get the motion of
  /// z
  /// @param simulation of it
  PeriodMap(System& system, const TimeParameters& time, const Simulation& simulation,
            std::int64_t num_steps);

  Eigen::Index num_unknowns() const { return num_unknowns_; }

  /// z at the present step of a simulation, which is then one step further on. Nothing where that
  /// fails.
  std::optional<Eigen::VectorXd> state_of(Simulation& simulation) const;
  /// Half of what each entry of z moves through over the next N steps of a simulation, at least
  /// 1e-6 of that of the displacements, or velocities, of its body.
  Eigen::VectorXd sizes_of_motion(Simulation& simulation) const;
  /// Puts the bodies of the system into a state.
  void set(const Eigen::VectorXd& z);
  /// P_T(z); nothing where a step fails. @throws Interrupted
  std::optional<Eigen::VectorXd> operator()(const Eigen::VectorXd& z, double period);
  /// Velocity of a row of a body as a row on z.
  Eigen::RowVectorXd velocity_row(int body, int row) const;

 private:
  std::vector<Propagator::Motion> motions_of(const Simulation& simulation) const;

  System* system_;
  TimeParameters time_;
  std::int64_t num_steps_;
  std::vector<Eigen::Index> sizes_;
  Eigen::Index num_unknowns_ = 0;
};

/// The same for y = (z, T), each over its size; T counts in steps, so that it is of the size of the
/// others.
class ScaledPeriodMap {
 public:
  /// @param velocity row on z that is zero at the turn
  /// @param scale    sizes of z
  /// @param step     size of T
  ScaledPeriodMap(PeriodMap& map, const Eigen::RowVectorXd& velocity, const Eigen::VectorXd& scale,
                  double step);

  Eigen::VectorXd scaled(const Eigen::VectorXd& z, double period) const;
  Eigen::VectorXd state(const Eigen::VectorXd& y) const;
  double period(const Eigen::VectorXd& y) const { return step_ * y[scale_.size()]; }

  /// (P_T(z) − z, v(z)); nothing where a step fails.
  std::optional<Eigen::VectorXd> miss(const Eigen::VectorXd& y) const;
  /// ∂P_T(z)/∂(z, T) by central differences; P jumps where a contact breaks loose a step earlier or
  /// later, and beside a jump the difference to the other side is taken.
  std::optional<Eigen::MatrixXd> derivative(const Eigen::VectorXd& y) const;
  /// −J⁻¹ miss with the derivative of (P_T(z) − z, v(z)).
  Eigen::VectorXd correction(const Eigen::MatrixXd& derivative, const Eigen::VectorXd& miss) const;

 private:
  std::optional<Eigen::VectorXd> operator()(const Eigen::VectorXd& y) const;

  PeriodMap* map_;
  Eigen::VectorXd scale_;
  double step_;
  Eigen::RowVectorXd velocity_;
};

/// Multipliers of ∂P/∂z, largest first, without that of a shift along the cycle.
std::vector<std::complex<double>> multipliers_of(const Eigen::MatrixXd& derivative);

}  // namespace stridor
