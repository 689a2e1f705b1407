// Equilibria of the beams of the main scene, and of a block in place of the oblique one.
#pragma once

#include "solvers/equilibrium/equilibrium.hpp"
#include "substructures/bodies/beam.hpp"
#include "tests/support/paper_model.hpp"

namespace stridor::test {

/// A vertical force on a guided beam is balanced through its rigid mode alone. That is an
/// eigenvector computed next to frequencies up to ω_max, which mixes elastic modes from ω_1 on into
/// it by about 100 eps (ω_max/ω_1)², 1e-8 here.
inline constexpr double rigid_mode_error = 1e-8;

/// Displacement of a point of a body.
inline Eigen::Vector2d moved(const System& system, const Equilibrium& equilibrium, int body,
                             const PointRows& rows) {
  const auto b = static_cast<std::size_t>(body);
  const Eigen::MatrixXd& matrix = system.bodies[b].modal.rows;
  return {matrix.row(rows.x).dot(equilibrium.displacement[b]),
          matrix.row(rows.y).dot(equilibrium.displacement[b])};
}

/// A flat block pressed on the cantilever: its bottom edge carries the slave points, its raised end
/// is guided.
inline ModelParameters block_on_cantilever(ContactAssumption assumption) {
  ModelParameters model = paper_model();
  BeamParameters block = paper_oblique(0.0);
  block.length = 0.010;
  block.thickness = 0.004;
  block.mesh = {2, 1};
  block.reduction = {4};
  model.substructures["oblique"] = block;
  model.contact->slave = {"oblique.bottom"};
  model.contact->assumption = assumption;
  model.contact->start = 0.0505;
  return model;
}

}  // namespace stridor::test
