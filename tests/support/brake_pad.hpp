// Brake pads that springs hold against a disc: rigid, or elastic and reduced by Craig-Bampton.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "substructures/bodies/beam.hpp"

namespace stridor {

/// Springs that hold a pad: along r, φ and z, and between φ and z.
struct PadStiffness {
  double radial = 0.0;           ///< N/m, > 0
  double circumferential = 0.0;  ///< N/m, > 0
  double normal = 0.0;           ///< N/m, > 0
  double coupling = 0.0;         ///< N/m, between φ and z on the face of larger z, mirrored below
};

/// A pad of plane stress in the plane of circumference and axis; along the radius it is rigid.
struct ElasticPadParameters {
  double length = 0.0;     ///< along the circumference, m, > 0
  double thickness = 0.0;  ///< along the axis, m, > 0
  double width = 0.0;      ///< along the radius, m, > 0
  MaterialParameters material;
  MeshParameters mesh;  ///< along: the length
  ReductionParameters reduction;
};

/// Rows of the displacement of a point of a pad.
struct PadPoint {
  Eigen::VectorXd radial;
  Eigen::VectorXd circumferential;
  Eigen::VectorXd normal;  ///< away from the disc
};

/// M q̈ + K q = f of one pad on its springs, the same on either face: directions are those of its
/// centre, the normal one away from the disc. The first coordinate is the motion along the radius.
struct PadBody {
  Eigen::MatrixXd mass;          ///< n x n
  Eigen::MatrixXd stiffness;     ///< n x n, the springs included
  std::vector<PadPoint> points;  ///< of contact
  Eigen::VectorXd pushed;        ///< generalised force of 1 N on the back, towards the disc
  Eigen::VectorXd advanced;      ///< that of springs whose far ends come 1 m closer to the disc, N
  /// Of the highest fixed-interface mode that is kept, rad/s; infinite where none is truncated.
  double highest_kept = std::numeric_limits<double>::infinity();

  Eigen::Index size() const { return mass.rows(); }
};

/// Coordinates: displacements along r, φ and the normal. All points move alike.
/// @param mass kg, > 0
PadBody make_rigid_pad(double mass, const PadStiffness& springs, std::size_t num_points);

/// Contact points of an elastic pad where the scene names none: every node of its face.
std::vector<double> face_nodes(const ElasticPadParameters& pad);

/// Degrees of freedom of the mesh that do not belong to nodes at contact points: as many
/// fixed-interface modes there are.
/// @param offsets as of make_elastic_pad()
int num_interior_dofs(const ElasticPadParameters& pad, const std::vector<double>& offsets);

/// A mesh of Q8 elements whose back rests on the springs, spread evenly over it, and whose face has
/// the contact points; reduced to the nodes there and the lowest fixed-interface modes
/// (docs/theory.md, 10.7).
///
/// @param offsets contact points along the circumference, from the centre, m; between nodes the
/// face
///                has the shape of its elements
/// @throws std::invalid_argument if a point lies beyond the face, or more modes are wanted than
/// there
///         are; NumericalError as make_craig_bampton()
PadBody make_elastic_pad(const ElasticPadParameters& pad, const PadStiffness& springs,
                         const std::vector<double>& offsets);

}  // namespace stridor
