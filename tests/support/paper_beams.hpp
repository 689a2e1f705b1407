// The two beams of Brunetti, D'Ambrogio, Fregolent (Machines 2022, 10, 384), sections 3.1 to 3.4,
// as the scenes beam_on_beam.yaml and beam_on_beam_leading.yaml describe them.
#pragma once

#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "substructures/bodies/beam.hpp"

namespace stridor::test {

inline constexpr double trailing_angle = std::numbers::pi / 6.0;       ///< 30°
inline constexpr double leading_angle = 5.0 * std::numbers::pi / 6.0;  ///< 150°

/// Beam 1: oblique, aluminium, tip free, other end guided.
/// @param angle of the axis from the tip to the guided end against +x, rad
inline BeamParameters paper_oblique(double angle = trailing_angle) {
  BeamParameters beam;
  beam.length = 0.075;
  beam.thickness = 0.0015;
  beam.width = 0.010;
  beam.angle = angle;
  beam.material = {71e9, 0.33, 2770.0};
  beam.mesh = {37, 1};
  beam.damping = {0.2, 4e-8, 40.0, 0.2, 0.05};
  beam.supports = {Support::free, Support::guided};
  beam.reduction = {20};
  return beam;
}

/// Beam 1 by a small oblique mesh with more than one element through the thickness.
inline BeamParameters small_beam(Support start = Support::free, Support end = Support::free,
                                 double angle = 0.4) {
  BeamParameters beam = paper_oblique(angle);
  beam.mesh = {5, 2};
  beam.supports = {start, end};
  return beam;
}

/// Beam 2: horizontal, polycarbonate, clamped at x = 0; its top edge is the master surface.
inline BeamParameters paper_cantilever() {
  BeamParameters beam;
  beam.length = 0.100;
  beam.thickness = 0.002;
  beam.width = 0.020;
  beam.angle = 0.0;
  beam.material = {2.38e9, 0.40, 1200.0};
  beam.mesh = {50, 1};
  beam.damping = {40.0, 4e-8, std::nullopt, 0.0, 0.0};
  beam.supports = {Support::clamped, Support::free};
  beam.interface = {0.001};
  beam.reduction = {20};
  return beam;
}

/// x and y DoF of a named point.
inline std::vector<int> point_dofs(const BodyMatrices& body, const std::string& point) {
  const auto& dofs = body.node_dofs[static_cast<std::size_t>(body.points.at(point))];
  return {dofs[0], dofs[1]};
}

/// Interface of beam 1: tip x, tip y, and the DoF that carries the load where there is one.
inline std::vector<int> slave_interface(const BodyMatrices& body) {
  std::vector<int> dofs = point_dofs(body, "tip");
  if (body.follows_drive()) dofs.push_back(body.load_dof);
  return dofs;
}

/// Interface of beam 2: x and y of every free node of its top edge, along the surface.
inline std::vector<int> master_interface(const BodyMatrices& body) {
  std::vector<int> dofs;
  for (const int node : body.surfaces.at("top")) {
    for (const int dof : body.node_dofs[static_cast<std::size_t>(node)])
      if (dof != BodyMatrices::held) dofs.push_back(dof);
  }
  return dofs;
}

}  // namespace stridor::test
