// A spinning disc between two pads meshed with finite elements: large, sparse, not symmetric.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "substructures/bodies/annular_plate.hpp"
#include "substructures/bodies/beam.hpp"
#include "substructures/bodies/matrix_body.hpp"

namespace stridor::test {

/// Disc and pads of plane stress in the plane of circumference and axis, pressed on by springs at
/// their backs, in contact with penalty and friction at every node of their faces.
struct ElasticPads {
  int along = 36;
  int through = 9;
  int nodal_diameters = 20;
  int radial_modes = 3;
  double friction = 0.5;
  double speed = 10.0;
  double beta = 1e-8;

  SparseSystem system() const {
    AnnularPlateParameters plate_parameters;
    plate_parameters.inner_radius = 0.08;
    plate_parameters.outer_radius = 0.16;
    plate_parameters.thickness = 0.012;
    plate_parameters.material = {2.1e11, 0.3, 7850.0};
    plate_parameters.nodal_diameters = nodal_diameters;
    plate_parameters.radial_modes = radial_modes;
    const AnnularPlate plate(plate_parameters);

    BeamParameters pad;
    pad.length = 0.06;
    pad.thickness = 0.015;
    pad.width = 0.04;
    pad.material = {1e10, 0.3, 2500.0};
    pad.mesh = {along, through};
    const BodyMatrices mesh = make_beam(pad);

    const int n = static_cast<int>(plate.size());
    const int size = n + 2 * static_cast<int>(mesh.num_dofs());
    std::vector<Eigen::Triplet<double>> M, P, Q;
    const Eigen::MatrixXd spin = plate.spin();
    const Eigen::VectorXd stiffness = plate.omega().cwiseAbs2();
    const Eigen::MatrixXd transport = speed * speed * spin.transpose() * spin;
    for (int i = 0; i < n; ++i) {
      M.emplace_back(i, i, 1.0);
      P.emplace_back(i, i, beta * stiffness(i));
      Q.emplace_back(i, i, stiffness(i));
      for (int j = 0; j < n; ++j) {
        if (spin(i, j) == 0.0 && transport(i, j) == 0.0) continue;
        P.emplace_back(i, j, 2.0 * speed * spin(i, j));
        Q.emplace_back(i, j, -transport(i, j) + speed * beta * stiffness(i) * spin(i, j));
      }
    }
    for (const int side : {1, -1})
      add_pad(plate, mesh, side, side > 0 ? n : n + static_cast<int>(mesh.num_dofs()), M, P, Q);
    SparseSystem system;
    for (auto [matrix, entries] : {std::pair{&system.mass, &M}, std::pair{&system.velocity, &P},
                                   std::pair{&system.position, &Q}}) {
      matrix->resize(size, size);
      matrix->setFromTriplets(entries->begin(), entries->end());
    }
    return system;
  }

 private:
  using Entries = std::vector<Eigen::Triplet<double>>;

  void add_pad(const AnnularPlate& plate, const BodyMatrices& mesh, int side, int first, Entries& M,
               Entries& P, Entries& Q) const {
    constexpr double radius = 0.13, half_thickness = 0.006, contact_stiffness = 1e10;
    const auto add = [&](Entries& entries, const SparseMatrix& matrix, double factor) {
      for (Eigen::Index j = 0; j < matrix.outerSize(); ++j)
        for (SparseMatrix::InnerIterator it(matrix, j); it; ++it)
          entries.emplace_back(first + static_cast<int>(it.row()),
                               first + static_cast<int>(it.col()), factor * it.value());
    };
    add(M, mesh.mass, 1.0);
    add(P, mesh.stiffness, beta);
    add(Q, mesh.stiffness, 1.0);
    const std::vector<int>& back = mesh.surfaces.at("top");
    for (const int node : back) {
      const auto& dofs = mesh.node_dofs[static_cast<std::size_t>(node)];
      const double share = 1.0 / static_cast<double>(back.size());
      Q.emplace_back(first + dofs[0], first + dofs[0], 4e7 * share);
      Q.emplace_back(first + dofs[1], first + dofs[1], 1e8 * share);
      // The piston's spring leans, as the coupling of rigid pads does.
      Q.emplace_back(first + dofs[0], first + dofs[1], 2e7 * share);
      Q.emplace_back(first + dofs[1], first + dofs[0], 2e7 * share);
    }
    const std::vector<int>& face = mesh.surfaces.at("bottom");
    const double penalty = contact_stiffness / static_cast<double>(face.size());
    for (const int node : face) {
      const double x = mesh.nodes(node, 0) - 0.03;
      const PlateRows rows = plate.rows(radius, x / radius);
      const auto& dofs = mesh.node_dofs[static_cast<std::size_t>(node)];
      // Pad on the other face: its mesh is the mirror image, its y points to −z. Gap: s (p_z − w).
      std::vector<std::pair<int, double>> gap, force;
      for (int i = 0; i < static_cast<int>(plate.size()); ++i) {
        gap.emplace_back(i, -side * rows.w(i));
        force.emplace_back(
            i, -side * rows.w(i) + friction * side * half_thickness / radius * rows.w_phi(i));
      }
      gap.emplace_back(first + dofs[1], 1.0);
      force.emplace_back(first + dofs[1], 1.0);
      force.emplace_back(first + dofs[0], friction);
      for (const auto& [i, f] : force)
        for (const auto& [j, g] : gap) Q.emplace_back(i, j, penalty * f * g);
    }
  }
};

}  // namespace stridor::test
