// Two bodies with one moving contact, marched by Siconos 4.4. In C++17, hence no header of stridor
// here: Boost 1.74, whose uBLAS Siconos' headers need, does not compile as C++20.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>

namespace stridor::bench {

/// M q̈ + C q̇ + K q = f + forces of the contact.
struct SiconosBody {
  Eigen::MatrixXd mass, damping, stiffness;
  Eigen::VectorXd load;
  Eigen::VectorXd displacement, velocity;  ///< at t = 0
};

/// Position and action of a contact, as functions of time and coordinates of both bodies.
class MovingContact {
 public:
  using Vector = Eigen::Map<const Eigen::VectorXd>;
  struct Place {
    double gap = 0.0;       ///< m
    Eigen::Vector2d rates;  ///< ∂/∂t of gap and slip, m/s
    Eigen::Matrix2Xd rows;  ///< ∂/∂q of gap and slip, slave before master
  };
  virtual ~MovingContact() = default;
  virtual void find(double time, const Vector& slave, const Vector& master, Place& place) = 0;
};

struct SiconosParameters {
  double step = 0.0;  ///< h, s
  std::int64_t num_steps = 0;
  double friction = 0.0;            ///< μ
  double solver_tolerance = 1e-12;  ///< of the friction contact problem
  double activation = 1e-6;         ///< a contact is taken as closed up to this gap, m
};

/// Coordinates of both bodies and normal impulse of the step that has led to them, Ns.
using SiconosLook = std::function<void(std::int64_t step, const MovingContact::Vector& slave,
                                       const MovingContact::Vector& master, double impulse)>;

/// Siconos' TimeStepping with MoreauJeanOSI, θ = 1/2, one LagrangianLinearTIDS per body, a
/// LagrangianRheonomousR for the contact at the place expected for the end of the step (one Newton
/// iteration per step, SICONOS_TS_LINEAR), NewtonImpactFrictionNSL with e = 0 and the
/// two-dimensional FrictionContact problem by SICONOS_FRICTION_2D_NSGS.
///
/// @param look called at the start and after every step
/// @return processor time before the first step, s
double march_siconos(const SiconosBody& slave, const SiconosBody& master, MovingContact& contact,
                     const SiconosParameters& parameters, const SiconosLook& look);

}  // namespace stridor::bench
