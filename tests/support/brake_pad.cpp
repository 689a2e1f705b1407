#include "tests/support/brake_pad.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>

#include "substructures/reduction/craig_bampton.hpp"

namespace stridor {
namespace {

BodyMatrices mesh_of(const ElasticPadParameters& pad) {
  BeamParameters beam;
  beam.length = pad.length;
  beam.thickness = pad.thickness;
  beam.width = pad.width;
  beam.material = pad.material;
  beam.mesh = pad.mesh;
  return make_beam(beam);
}

/// A node of the face and its weight in the motion of a place on it.
struct Share {
  int index = 0;  ///< from the smallest offset on
  double weight = 0.0;
};

/// Shares of the three nodes of the element's edge at a place of the face; of one where it is a
/// node.
std::vector<Share> shares_at(const ElasticPadParameters& pad, double offset) {
  constexpr double on_a_node = 1e-9;  // of the half of an element
  const double place = pad.mesh.along * (offset / pad.length + 0.5);
  if (!(place >= -on_a_node && place <= pad.mesh.along + on_a_node)) {
    throw std::invalid_argument(
        fmt::format("brake pad: a contact point {:g} m from the centre lies beyond a pad of {:g} m",
                    offset, pad.length));
  }
  const double nearest = std::round(2.0 * place);
  if (std::abs(2.0 * place - nearest) <= on_a_node) return {{static_cast<int>(nearest), 1.0}};
  const int element = std::clamp(static_cast<int>(std::floor(place)), 0, pad.mesh.along - 1);
  const double x = 2.0 * (place - element) - 1.0;
  return {{2 * element, 0.5 * x * (x - 1.0)},
          {2 * element + 1, 1.0 - x * x},
          {2 * element + 2, 0.5 * x * (x + 1.0)}};
}

std::set<int> touched_nodes(const ElasticPadParameters& pad, const std::vector<double>& offsets) {
  std::set<int> nodes;
  for (const double offset : offsets)
    for (const Share& share : shares_at(pad, offset)) nodes.insert(share.index);
  return nodes;
}

/// Nodes of an outline in the order of their offset.
std::vector<int> ordered(const BodyMatrices& mesh, const std::string& outline) {
  std::vector<int> nodes = mesh.surfaces.at(outline);
  std::sort(nodes.begin(), nodes.end(),
            [&](int a, int b) { return mesh.nodes(a, 0) < mesh.nodes(b, 0); });
  return nodes;
}

/// Part of an even load that each node of an outline carries: Simpson's weights.
std::vector<double> even_shares(int num_elements) {
  std::vector<double> shares(static_cast<std::size_t>(2 * num_elements + 1), 0.0);
  for (std::size_t element = 0; element < static_cast<std::size_t>(num_elements); ++element) {
    constexpr std::array simpson{1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0};
    for (std::size_t i = 0; i < 3; ++i) shares[2 * element + i] += simpson[i] / num_elements;
  }
  return shares;
}

/// The back of a mesh on its springs.
struct Backing {
  SparseMatrix stiffness;
  std::vector<double> shares;
  std::vector<std::array<int, 2>> dofs;  ///< of the nodes of the back
};

Backing backing_of(const BodyMatrices& mesh, const ElasticPadParameters& pad,
                   const PadStiffness& springs) {
  Backing backing;
  backing.shares = even_shares(pad.mesh.along);
  std::vector<Eigen::Triplet<double>> entries;
  for (const int node : ordered(mesh, "top")) {
    const auto& dofs = mesh.node_dofs[static_cast<std::size_t>(node)];
    const double share = backing.shares[backing.dofs.size()];
    entries.emplace_back(dofs[0], dofs[0], share * springs.circumferential);
    entries.emplace_back(dofs[1], dofs[1], share * springs.normal);
    entries.emplace_back(dofs[0], dofs[1], share * springs.coupling);
    entries.emplace_back(dofs[1], dofs[0], share * springs.coupling);
    backing.dofs.push_back(dofs);
  }
  backing.stiffness.resize(mesh.num_dofs(), mesh.num_dofs());
  backing.stiffness.setFromTriplets(entries.begin(), entries.end());
  return backing;
}

/// A matrix of the plane behind a number for the radius.
Eigen::MatrixXd with_radius(double radial, const Eigen::MatrixXd& plane) {
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(plane.rows() + 1, plane.cols() + 1);
  whole(0, 0) = radial;
  whole.bottomRightCorner(plane.rows(), plane.cols()) = plane;
  return whole;
}

Eigen::VectorXd with_radius(const Eigen::VectorXd& plane) {
  Eigen::VectorXd whole = Eigen::VectorXd::Zero(plane.size() + 1);
  whole.tail(plane.size()) = plane;
  return whole;
}

}  // namespace

PadBody make_rigid_pad(double mass, const PadStiffness& springs, std::size_t num_points) {
  PadBody pad;
  pad.mass = mass * Eigen::Matrix3d::Identity();
  pad.stiffness =
      Eigen::Vector3d(springs.radial, springs.circumferential, springs.normal).asDiagonal();
  pad.stiffness(1, 2) = pad.stiffness(2, 1) = springs.coupling;
  const PadPoint point{Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(),
                       Eigen::Vector3d::UnitZ()};
  pad.points.assign(num_points, point);
  pad.pushed = -point.normal;
  pad.advanced = -pad.stiffness * point.normal;
  return pad;
}

std::vector<double> face_nodes(const ElasticPadParameters& pad) {
  std::vector<double> offsets;
  const int last = 2 * pad.mesh.along;
  for (int i = 0; i <= last; ++i)
    offsets.push_back(pad.length * (static_cast<double>(i) / last - 0.5));
  return offsets;
}

int num_interior_dofs(const ElasticPadParameters& pad, const std::vector<double>& offsets) {
  const auto [along, through] = pad.mesh;
  const int num_nodes = (along + 1) * (2 * through + 1) + along * (through + 1);
  return 2 * (num_nodes - static_cast<int>(touched_nodes(pad, offsets).size()));
}

PadBody make_elastic_pad(const ElasticPadParameters& parameters, const PadStiffness& springs,
                         const std::vector<double>& offsets) {
  BodyMatrices mesh = mesh_of(parameters);
  const Backing backing = backing_of(mesh, parameters, springs);
  mesh.stiffness += backing.stiffness;

  // Coordinates: nodes at contact points, each with φ and normal, then modes. The back is watched.
  const std::vector<int> face = ordered(mesh, "bottom");
  const std::set<int> touched = touched_nodes(parameters, offsets);
  const std::vector<int> kept(touched.begin(), touched.end());
  std::vector<int> interface, watched;
  for (const int index : kept) {
    const auto& dofs =
        mesh.node_dofs[static_cast<std::size_t>(face[static_cast<std::size_t>(index)])];
    interface.insert(interface.end(), dofs.begin(), dofs.end());
  }
  for (const auto& dofs : backing.dofs) watched.insert(watched.end(), dofs.begin(), dofs.end());
  const int num_modes = parameters.reduction.fixed_interface_modes;
  const ReducedBody reduced = make_craig_bampton(mesh, interface, num_modes, watched);

  PadBody pad;
  const double mass =
      parameters.material.density * parameters.length * parameters.thickness * parameters.width;
  pad.mass = with_radius(mass, reduced.mass);
  pad.stiffness = with_radius(springs.radial, reduced.stiffness);
  Eigen::VectorXd circumferential = Eigen::VectorXd::Zero(reduced.size());
  Eigen::VectorXd normal = circumferential;  // of the back, on average
  for (std::size_t i = 0; i < backing.shares.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(2 * i);
    circumferential += backing.shares[i] * reduced.rows.row(row).transpose();
    normal += backing.shares[i] * reduced.rows.row(row + 1).transpose();
  }
  pad.pushed = with_radius(-normal);
  pad.advanced = with_radius(-springs.coupling * circumferential - springs.normal * normal);
  for (const double offset : offsets) {
    PadPoint point{Eigen::VectorXd::Unit(pad.size(), 0), Eigen::VectorXd::Zero(pad.size()),
                   Eigen::VectorXd::Zero(pad.size())};
    for (const Share& share : shares_at(parameters, offset)) {
      const auto position = std::lower_bound(kept.begin(), kept.end(), share.index) - kept.begin();
      point.circumferential(1 + 2 * position) = share.weight;
      point.normal(2 + 2 * position) = share.weight;
    }
    pad.points.push_back(std::move(point));
  }
  const bool is_whole = num_modes == num_interior_dofs(parameters, offsets);
  if (num_modes > 0 && !is_whole)
    pad.highest_kept = std::sqrt(reduced.stiffness(reduced.size() - 1, reduced.size() - 1));
  return pad;
}

}  // namespace stridor
