// A body given by its matrices.
#pragma once

#include <Eigen/SparseCore>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/schema.hpp"
#include "substructures/bodies/beam.hpp"
#include "substructures/bodies/body_files.hpp"
#include "substructures/bodies/mesh_body.hpp"
#include "substructures/elements/labelled_matrix.hpp"
#include "substructures/matrices/sparse_system.hpp"

namespace stridor {

/// One matrix in a scene: the name of a file, or its rows as texts of numbers ("1 0 -2.5"). Nothing
/// where it is zero.
using MatrixText = std::vector<std::string>;

/// Which matrix of a body a term adds to.
enum class MatrixRole {
  damping,      ///< of q̇
  gyroscopic,   ///< of q̇, skew-symmetric
  stiffness,    ///< of q
  circulatory,  ///< of q, skew-symmetric
  velocity,     ///< of q̇, of any kind
  position,     ///< of q, of any kind
  structural,   ///< of q, symmetric: the imaginary part of a complex stiffness
};

/// Whether a matrix is multiplied with velocities, else with displacements.
bool is_of_velocity(MatrixRole role);

/// A matrix with a factor, which is added to those of the body.
struct MatrixTermParameters {
  MatrixRole role = MatrixRole::damping;
  MatrixText matrix;
  double factor = 1.0;
  static const Schema& schema();
};

/// M q̈ + (D + G + Σ f_i D_i) q̇ + (K + N + Σ f_j K_j + i Σ f_k L_k) q = 0   (HS (28);
/// docs/theory.md, 10.3)
struct MatrixBodyParameters {
  MatrixText mass;                          ///< M, symmetric positive semidefinite
  MatrixText damping;                       ///< D
  MatrixText gyroscopic;                    ///< G, skew-symmetric
  MatrixText stiffness;                     ///< K
  MatrixText circulatory;                   ///< N, skew-symmetric
  std::vector<MatrixTermParameters> terms;  ///< f_i D_i, f_j K_j and f_k L_k
  static const Schema& schema();
};

/// The matrices of a body as its scene names them, all n x n, in the units of their files.
struct NamedMatrices {
  SparseMatrix mass, damping, gyroscopic, stiffness, circulatory;
  std::vector<SparseMatrix> terms;    ///< as many as the body has, without their factors
  std::vector<NodeUnknown> unknowns;  ///< of the rows; empty where only their numbers are known
  Mesh mesh;  ///< the nodes and, where a mesh is given, its elements, sets and surfaces
  std::vector<MatrixFileFacts> files{};  ///< of matrices
};

/// Nodes and units of the matrices of a body.
struct MatrixNodesParameters {
  static constexpr const char* all_of_mesh = "all_of_mesh";

  std::string unknowns;  ///< a file, all_of_mesh, or nothing where the matrices say it or do not
  std::string mesh;      ///< a file; may be absent
  std::string nodes;     ///< a table of places; may be absent
  std::string length_unit = "m", force_unit = "N", time_unit = "s";  ///< of matrices and places
  static const Schema& schema();
  bool operator==(const MatrixNodesParameters&) const = default;
};

/// Reads the matrices and what is known of their nodes.
/// @throws ConfigError with the key below that of the body, or the place in a file; FileError
NamedMatrices read_matrices(const MatrixBodyParameters& body, const MatrixNodesParameters& nodes,
                            const BodyFiles& files);

/// The files among them.
std::vector<NamedFile> matrix_files(MatrixBodyParameters& body, MatrixNodesParameters& nodes);

/// Whether two bodies name the same files and have the same rows; factors may differ.
bool have_same_matrices(const MatrixBodyParameters& one, const MatrixBodyParameters& other);

/// All of them summed up, the terms with their factors, in SI units.
/// @throws ConfigError for units that are none
SparseSystem sum(const NamedMatrices& matrices, const MatrixBodyParameters& body,
                 const MatrixNodesParameters& nodes);

/// A point of a body given by matrices. Unknowns are counted from 1; 0: it is held there.
struct MatrixPointParameters {
  std::vector<double> at;  ///< place, m: x and y in the frame of the body; as MeshPointParameters
                           ///< where nodes are known
  std::int64_t x = 0;      ///< unknown that is its displacement in x
  std::int64_t y = 0;      ///< in y
  std::optional<std::int64_t> node{};  ///< where nodes are known: as MeshPointParameters
  std::string mean_of{};               ///< likewise
  static const Schema& schema();
};

/// A surface of such a body: an outline, on the right-hand side of which it lies, or a part of its
/// mesh.
struct MatrixSurfaceParameters {
  std::vector<std::string> points;  ///< at least two, in order; empty: a part of the mesh
  std::optional<MeshPlaneParameters> plane{};  ///< as MeshSurfaceParameters, as are those below
  std::optional<MeshCylinderParameters> cylinder{};
  std::optional<MeshBoxParameters> box{};
  std::optional<double> tolerance{};
  static const Schema& schema();
};

/// Guide by which such a body follows the drive.
struct MatrixGuideParameters {
  std::int64_t load = 0;            ///< unknown on which the drive's load acts, from 1
  std::vector<double> translation;  ///< of every unknown as the body moves by one metre in +x
  std::vector<std::string> on{};    ///< in the place of both: as MeshGuideParameters
  static const Schema& schema();
};

/// A body given by its matrices, with points and surfaces at which others may touch it.
struct TouchedMatrixBodyParameters : BodyParametersOf<TouchedMatrixBodyParameters> {
  static constexpr const char* type_name = "matrices";

  MatrixBodyParameters body;
  std::map<std::string, MatrixPointParameters> points;
  std::map<std::string, MatrixSurfaceParameters> surfaces;
  std::optional<MatrixGuideParameters> guided;
  std::optional<ReductionParameters> reduction;   ///< absent: every unknown is kept
  std::shared_ptr<const NamedMatrices> matrices;  ///< the matrices that `body` names, read
  MatrixNodesParameters nodes;
  double angle = 0.0;  ///< rad, as MeshBodyParameters; so are those below
  std::map<std::string, MeshSupportParameters> supports;
  std::map<std::string, SurfaceSpringParameters> springs;
  InterfaceParameters interface;
  static const Schema& schema();

  /// Whether it is known which rows are which nodes, so that it has the keys of a mesh.
  bool has_nodes() const { return matrices && !matrices->unknowns.empty(); }

  std::vector<NamedFile> files() override { return matrix_files(body, nodes); }
  void read(const BodyFiles& files) override;
  bool take_contents(const BodyParameters& other) override;
  BodyMatrices make() const override;
  std::optional<int> num_modes() const override;
  std::optional<double> interface_spacing() const override { return interface.spacing; }
  std::optional<int> interface_modes() const override { return interface.modes; }
  bool is_filled() const override;
  std::vector<DrawnElement> elements() const override;
  double num_slave_nodes(const std::string& name) const override;
  ReductionSize reduction_size(double interface_nodes) const override;
  SizeKey size_key() const override;
  std::optional<ImportFacts> import_facts() const override;
};

/// The body. Its stiffness is the symmetric part of the matrix of q. The matrix of q̇ is its
/// damping where that is proportional (proportional_damping()); otherwise it is an additional term,
/// like the skew part of the stiffness (CoupledTerms).
/// Where nodes are known, supports, surfaces and points are made as those of a mesh.
/// @throws ConfigError (key paths below the body) if an unknown or a point is not there, or sizes
///         do not fit
/// @throws std::invalid_argument if the matrices have not been read
BodyMatrices make_matrix_body(const TouchedMatrixBodyParameters& parameters);

}  // namespace stridor
