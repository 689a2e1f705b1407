// Matrices and interface of every kind of body before its reduction.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "substructures/matrices/damping.hpp"
#include "substructures/matrices/facet.hpp"
#include "substructures/matrices/sparse_matrix.hpp"

namespace stridor {

/// A DoF with the weight that it has in a displacement.
struct DofWeight {
  int dof = 0;
  double weight = 0.0;
};

/// A displacement Σ w u as a sum over DoFs; with its weights in N, the generalised force of a load.
/// Empty for a displacement that is held.
using DofSum = std::vector<DofWeight>;

/// A face of a plate that spins about the axis of the body's frame, on which other bodies slide.
struct BodyFace {
  int side = 1;                 ///< s: +1 on the face of larger y of the plate's frame, −1 below
  double half_thickness = 0.0;  ///< h/2, m
  double spin = 0.0;            ///< Ω towards growing angles, rad/s
  double inner_radius = 0.0;    ///< m
  double outer_radius = 0.0;    ///< m
  /// Sums over DoFs that give w, w_r, w_φ, w_rφ and w_φφ at a radius, m, and an angle, rad.
  std::function<std::array<DofSum, 5>(double radius, double angle)> rows;
};

/// A spring as pictures show it, in the body's frame.
struct BodySpring {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();      ///< one end, m
  std::optional<Eigen::Vector3d> other;              ///< the other end, m; else it is on the ground
  Eigen::Vector3d along = Eigen::Vector3d::UnitX();  ///< of one to the ground, of length 1
};

/// Terms of the spin of a body of revolution about its axis, seen from space (docs/theory.md, 10.9).
struct SpinTerms {
  double speed = 0.0;  ///< Ω about the direction of the axis, rad/s
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< e, of length 1, in the body's frame
  Eigen::Vector3d point = Eigen::Vector3d::Zero();       ///< p, of the axis, m
  /// G, the derivative ∂_φ of displacements along circles, and K_σ − S for Ω = 1 rad/s, each N x N.
  /// Empty: the body does without them, and all that spins is what slides past its contacts.
  SparseMatrix gyroscopic, around, position;
  SparseMatrix viscous;       ///< damping of its materials beside RayleighDamping, N x N; or empty
  bool turns_damping = true;  ///< whether what it loses follows the material
};

/// Full model of one component: M ü + C u̇ + K u = f over its free DoFs.
///
/// Displacements are measured from the undeformed place, which follows the drive where the body has
/// a guided support. Nodes carry displacements along x, y and z; as a rule each is a DoF or is held
/// (`held`), and none moves along z.
struct BodyMatrices {
  static constexpr int held = -1;

  SparseMatrix mass;       ///< M, N x N, symmetric positive definite, kg
  SparseMatrix stiffness;  ///< K, N x N, symmetric positive semi-definite, N/m
  RayleighDamping damping;
  /// Terms beside these (CoupledTerms), N x N; both empty where there are none.
  SparseMatrix velocity, circulatory;
  /// Structural damping: the imaginary part Σ η K of the complex stiffness, N x N, N/m; or empty.
  SparseMatrix loss_stiffness;
  std::optional<SpinTerms> spin;  ///< of a body of revolution that spins

  Eigen::MatrixX3d nodes;  ///< undeformed positions in the body's frame, m
  std::vector<std::array<int, 2>> node_dofs;       ///< (x, y) DoF of every node, or `held`
  std::vector<int> across;  ///< z DoF of every node, or `held`; empty where no node moves along z
  std::vector<int> kept;    ///< DoFs that a reduction keeps whatever touches the body
  /// Displacements of nodes that move with others: along x, y and z, in the place of their DoFs.
  std::map<int, std::array<DofSum, 3>> dependent;
  std::map<std::string, int> points;               ///< named nodes
  /// Named outlines: nodes in the order in which the body lies on their right-hand side, so that
  /// the direction turned by +90° points out of the body.
  std::map<std::string, std::vector<int>> surfaces;
  std::map<std::string, std::vector<Facet>> facets;  ///< named surfaces in space
  std::map<std::string, BodyFace> faces;   ///< named faces of a plate
  std::vector<std::vector<int>> outlines;  ///< nodes in order that are drawn besides the surfaces
  std::vector<BodySpring> springs;         ///< those in `stiffness`
  /// Whether modes are its DoFs already, of which a reduction would make none better.
  bool is_modal = false;
  /// Lowest ω among modes that are not among its DoFs, rad/s; infinite where none is left out.
  double lowest_omitted = std::numeric_limits<double>::infinity();
  /// Loads by name, "<surface>.<x|y|z>": a force of 1 N spread evenly over a surface;
  /// "<spring>.<x|y|z>": what the spring exerts when its ground end moves by 1 m. As sums over DoFs,
  /// which also are the displacements that these loads do work on.
  std::map<std::string, DofSum> loads;

  /// DoF that carries the drive's load, or `held` where no support is guided.
  int load_dof = held;
  /// M r over the free DoFs with r the unit translation in x of all nodes, held ones included; kg.
  /// Empty where no support is guided.
  Eigen::VectorXd base_inertia;

  Eigen::Index num_dofs() const { return mass.rows(); }
  /// Displacement of a node along x (0), y (1) or z (2).
  DofSum displacement(int node, std::size_t direction) const;
  /// Whether a node moves in a direction at all.
  bool moves(int node, std::size_t direction) const {
    return !displacement(node, direction).empty();
  }
  /// One of `loads`, or a force of 1 N on a named point, "<point>.<x|y|z>".
  /// @return nothing where there is no such load
  std::optional<DofSum> load(const std::string& name) const;
  bool follows_drive() const { return load_dof != held; }
};

}  // namespace stridor
