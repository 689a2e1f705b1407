// What meshes and matrices from other programs turned out to be, for comparison with what was meant.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "substructures/elements/mesh.hpp"
#include "substructures/elements/labelled_matrix.hpp"

namespace stridor {

struct MatrixBodyParameters;
struct MatrixNodesParameters;
struct NamedMatrices;

/// A surface of a mesh as a whole.
struct SurfaceFacts {
  std::size_t num_sides = 0;
  double area = 0.0;                                 ///< m²; of a planar mesh length x thickness
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< mean, out of the body; 0 where closed
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< m
};

/// A mesh, in metres.
struct MeshFacts {
  std::size_t num_nodes = 0;
  std::map<ElementShape, std::size_t> elements;
  int dimension = 3;
  double volume = 0.0;                               ///< m³
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of the volume, m
  Eigen::Vector3d lowest = Eigen::Vector3d::Zero(), highest = Eigen::Vector3d::Zero();  ///< m
  std::map<std::string, std::size_t> node_sets, element_sets;
  std::map<std::string, SurfaceFacts> surfaces;
};
/// @param mesh      in metres, with elements
/// @param thickness of a planar one, m
/// @throws std::invalid_argument as mass_properties()
MeshFacts mesh_facts(const Mesh& mesh, double thickness);

enum class Definiteness { positive, semidefinite, indefinite };

/// Mass as it resists a motion of all that moves along one direction.
struct DirectionMass {
  double mass = 0.0;                                 ///< rᵀ M r, kg
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< m; not finite where there is no mass
};

/// Matrices, in SI units.
struct MatrixFacts {
  Eigen::Index num_unknowns = 0;
  std::vector<MatrixFileFacts> files;
  double mass_asymmetry = 0.0, stiffness_asymmetry = 0.0;  ///< ‖A − Aᵀ‖/‖A‖ of what is used
  Definiteness mass = Definiteness::positive;
  Definiteness stiffness = Definiteness::positive;
  double smallest_pivot = 0.0;  ///< of M scaled to a unit diagonal; 0 where it has none
  /// Of the lowest modes, rigid ones included: 0 for a rigid motion. Negative: ω² is, −√−ω²/2π.
  std::vector<double> frequencies;  ///< Hz
  std::string trouble;              ///< why there are none
  int num_rigid = 0;                ///< of them
  // Where nodes are known:
  std::size_t num_nodes = 0;                  ///< with a place
  std::size_t num_without = 0;                ///< of these, that no unknown moves
  std::vector<std::int64_t> missing;          ///< nodes of unknowns without a place
  std::optional<int> num_rigid_expected;      ///< motions that displace nothing that is held
  std::vector<DirectionMass> masses;          ///< along x, y and z
};
/// @param num_frequencies how many modes are sought; 0: none
/// @throws ConfigError for units that are none
MatrixFacts matrix_facts(const NamedMatrices& matrices, const MatrixBodyParameters& body,
                         const MatrixNodesParameters& nodes, int num_frequencies);

/// What a body has from files.
struct ImportFacts {
  std::optional<MeshFacts> mesh;
  std::optional<MatrixFacts> matrices;
};

}  // namespace stridor
