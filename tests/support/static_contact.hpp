// Unilateral contact at rest, from the dense static equations: another way than marching there.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <vector>

#include "coupling/system/system.hpp"

namespace stridor::test {

struct StaticContact {
  Eigen::VectorXd force;  ///< λ_n per contact, N
  Eigen::VectorXd gap;    ///< per contact, m
  bool is_solution = false;

  int num_closed() const { return static_cast<int>((force.array() > 0.0).count()); }
};

/// Solves the linear complementarity problem of contacts that all slide forwards,
///
///   K q + B_Eᵀ λ = f,  0 ≤ λ ⟂ gap = −B_C (X + q) ≥ 0,
///
/// with the rows of the undeformed geometry: the equations of the closed contacts are solved and
/// the set of these corrected until it no longer changes (projected Newton).
///
/// @param load of the drive, N
inline StaticContact static_contact(const System& system, double load) {
  const auto num_contacts = static_cast<Eigen::Index>(system.contacts.size());
  std::vector<Eigen::Index> offset{0};
  for (const SystemBody& body : system.bodies)
    offset.push_back(offset.back() + body.reduced.size());
  const Eigen::Index n = offset.back();

  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd forces = Eigen::VectorXd::Zero(n);
  for (std::size_t b = 0; b < system.bodies.size(); ++b) {
    const SystemBody& body = system.bodies[b];
    const Eigen::Index size = body.reduced.size();
    stiffness.block(offset[b], offset[b], size, size) = body.reduced.stiffness;
    if (body.follows_drive())
      forces.segment(offset[b], size) = load * body.reduced.rows.row(body.loads.front().row).transpose();
  }

  Eigen::MatrixXd compatibility = Eigen::MatrixXd::Zero(num_contacts, n);
  Eigen::MatrixXd equilibrium = Eigen::MatrixXd::Zero(num_contacts, n);
  Eigen::VectorXd undeformed_gap(num_contacts);
  for (Eigen::Index i = 0; i < num_contacts; ++i) {
    const ContactPoint& contact = system.contacts[static_cast<std::size_t>(i)];
    const MasterSurface& surface = system.surfaces[static_cast<std::size_t>(contact.surface)];
    const auto s = static_cast<std::size_t>(contact.first_segment);
    const Segment segment = surface.undeformed_segment(contact.first_segment);
    const Projection projection = project(segment, contact.slave_position);
    const ContactRows rows = make_rows(projection, sliding_friction(contact.friction, 1.0), 1.0);
    const auto add = [&](Eigen::MatrixXd& matrix, int body, int row, double weight) {
      const auto b = static_cast<std::size_t>(body);
      const auto& entries = system.bodies[b].reduced.rows.row(row);
      matrix.row(i).segment(offset[b], entries.size()) += weight * entries;
    };
    const auto fill = [&](Eigen::MatrixXd& matrix, const ContactRow& row) {
      add(matrix, contact.slave_body, contact.slave_rows.x, row.slave[0]);
      add(matrix, contact.slave_body, contact.slave_rows.y, row.slave[1]);
      for (std::size_t end = 0; end < 2; ++end) {
        add(matrix, surface.body, surface.rows[s + end].x, row.master[2 * end]);
        add(matrix, surface.body, surface.rows[s + end].y, row.master[2 * end + 1]);
      }
    };
    fill(compatibility, rows.compatibility);
    fill(equilibrium, rows.equilibrium);
    undeformed_gap(i) = projection.normal.dot(contact.slave_position - segment.first);
  }

  StaticContact result;
  std::vector<Eigen::Index> closed;
  for (Eigen::Index i = 0; i < num_contacts; ++i) closed.push_back(i);
  for (int round = 0; round < 100; ++round) {
    const auto m = static_cast<Eigen::Index>(closed.size());
    Eigen::MatrixXd saddle = Eigen::MatrixXd::Zero(n + m, n + m);
    Eigen::VectorXd right(n + m);
    saddle.topLeftCorner(n, n) = stiffness;
    right.head(n) = forces;
    for (Eigen::Index k = 0; k < m; ++k) {
      const Eigen::Index i = closed[static_cast<std::size_t>(k)];
      saddle.row(n + k).head(n) = compatibility.row(i);
      saddle.col(n + k).head(n) = equilibrium.row(i).transpose();
      right(n + k) = undeformed_gap(i);
    }
    const Eigen::VectorXd solution = saddle.fullPivLu().solve(right);
    result.force = Eigen::VectorXd::Zero(num_contacts);
    for (Eigen::Index k = 0; k < m; ++k)
      result.force(closed[static_cast<std::size_t>(k)]) = solution(n + k);
    result.gap = undeformed_gap - compatibility * solution.head(n);

    std::vector<Eigen::Index> next;
    const double touching = 1e-12 * result.gap.cwiseAbs().maxCoeff();
    for (Eigen::Index i = 0; i < num_contacts; ++i) {
      const bool is_closed = std::find(closed.begin(), closed.end(), i) != closed.end();
      if (is_closed ? result.force(i) > 0.0 : result.gap(i) < -touching) next.push_back(i);
    }
    result.is_solution = next == closed;
    if (result.is_solution) break;
    closed = next;
  }
  return result;
}

}  // namespace stridor::test
