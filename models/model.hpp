// From the keys of a scene to the coupled system.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "coupling/system/contact_parameters.hpp"
#include "coupling/system/system.hpp"
#include "models/initial_parameters.hpp"
#include "substructures/bodies/body_parameters.hpp"
#include "substructures/matrices/sparse_system.hpp"

namespace stridor {

/// The part of a scene that describes the mechanics.
struct ModelParameters {
  Substructures substructures;
  std::optional<ContactParameters> contact;           ///< one pair, named "contact"
  std::map<std::string, ContactParameters> contacts;  ///< several pairs by name
  std::optional<DriveParameters> drive;               ///< the only one
  std::map<std::string, DriveParameters> drives;      ///< several by name
  InitialParameters initial;
  static const Schema& schema();

  /// All pairs by name, under whichever key they are.
  std::map<std::string, ContactParameters> pairs() const;
  /// All drives in the order of System::drives; one at rest without load where there is none.
  std::vector<SceneDrive> scene_drives() const;
};

/// A point of a body whose motion is wanted: "<body>.<point>".
struct PointName {
  std::string body;
  std::string point;
  auto operator<=>(const PointName&) const = default;
};

/// Number of unknowns up to which a body is kept whole in dense matrices, which cost its third
/// power.
inline constexpr Eigen::Index largest_dense_size = 1000;

/// The system and where in it the wanted points are.
struct Model {
  struct Point {
    int body = 0;
    PointRows rows;
  };
  /// Position of a body and the DoFs that its reduction kept.
  struct Placement {
    Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< of its frame, m
    std::vector<int> interface;                       ///< DoFs, as of make_craig_bampton()
    bool is_mirrored = false;  ///< y of its frame points downwards, from the lower face of a plate
  };
  System system;
  std::map<PointName, Point> points;
  std::vector<Placement> placements;                            ///< of the bodies of the system
  Substructures substructures;  ///< of which it was made
  /// All bodies side by side where nothing touches them and those of which every unknown is kept
  /// have more than `largest_dense_size`; then `system` is empty. It has eigenvalues, no runs.
  std::optional<SparseSystem> sparse;
};

/// @throws ConfigError with a key path if a model is sparse, and cannot be run for that
void require_modes(const Model& model);

/// Builds, places and reduces the bodies, connects them and sets them moving. The initial state is
/// left at rest where `initial.state` is another than that; see initial_state.hpp of io and
/// find_equilibrium().
///
/// Contacts and drives may be absent. A body that nothing touches, and of which nothing says that it
/// be reduced, keeps every unknown, may be free to move, and have negative stiffness.
///
/// The first body that is only ever a master keeps its frame as the global one; a slave body is
/// placed so that its first slave point lies on the master at `start`.
///
/// @param observed points whose displacement must be recoverable besides the contact points; each
/// is
///                 paired with the key path that asks for it, for messages
/// @throws ConfigError (key paths below "substructures", "contact", "contacts") if a name is
/// unknown,
///         a slave starts off its master, a body is left free to move rigidly within its interface,
///         a reduction asks for more modes than there are, or matrices do not make a body
Model make_model(const ModelParameters& parameters,
                 const std::vector<std::pair<PointName, std::string>>& observed);

class BodyCache;

/// The same with bodies and reductions from a cache where it has them.
Model make_model(const ModelParameters& parameters,
                 const std::vector<std::pair<PointName, std::string>>& observed, BodyCache& cache);

}  // namespace stridor
