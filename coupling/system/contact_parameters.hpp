// Parameters of contacts and drives in a scene.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/schema.hpp"
#include "coupling/kinematics/roughness.hpp"
#include "coupling/laws/friction_parameters.hpp"
#include "coupling/laws/normal_parameters.hpp"
#include "coupling/system/system.hpp"

namespace stridor {

enum class SlidingMode {
  moving,  ///< the drive moves the slave along the master
  frozen,  ///< the position is held, friction acts as in sliding
};

/// Names of the masters that are no surface of a body: straight lines along +x without end.
inline constexpr const char* rigid_master = "rigid";
inline constexpr const char* half_space_master = "half_space";

/// Stands for all guided supports in the lists of a drive.
inline constexpr const char* guided_supports = "guided";

/// Where a slave is at the start: on a curve, or on the face of a plate.
struct StartParameters {
  std::optional<double> along;   ///< of the first slave point from the first node of the curve, m
  std::optional<double> radius;  ///< of the middle of the slave body, m
  std::optional<double> angle;   ///< of it, rad; default 0

  StartParameters() = default;
  StartParameters(double length)  // NOLINT(google-explicit-constructor): a length is one
      : along(length) {}
  static const Schema& schema();
};

/// One pair: slave points on a master surface.
struct ContactParameters {
  /// "<body>.<point>" or "<body>.<surface>" (every node of it); empty where only its law is wanted.
  std::vector<std::string> slave;
  /// "<body>.<surface>", "<body>.<face>", rigid_master or half_space_master.
  std::string master;
  std::optional<ContactAssumption> assumption;  ///< absent: film, of a normal law with an area
  OnViolation on_violation = OnViolation::stop;
  std::optional<double> armed_from;  ///< s; the drive's ramp where absent
  StartParameters start;  ///< of a curve; its first node where neither is given
  SlidingMode sliding = SlidingMode::moving;
  SurfaceKind surface = SurfaceKind::polyline;
  std::optional<RoughnessParameters> roughness;
  NormalParameters normal;
  std::optional<FrictionParameters> friction;  ///< may be absent with such a normal law
  static const Schema& schema();

  /// The assumption, or the one that goes with the normal law.
  ContactAssumption assumption_or_default() const {
    return assumption.value_or(normal.law->has_area() ? ContactAssumption::film
                                                      : ContactAssumption::subs_b);
  }
};

struct DriveParameters {
  TimeCurve velocity;  ///< of guided supports in +x, m/s; a constant rises over `ramp`
  TimeCurve load;      ///< on guided supports in +y, N; a constant rises over `ramp`
  double ramp = 0.0;   ///< s, >= 0
  /// What the velocity moves: guided_supports, "<body>", "<contact>.master"; empty: all guided supports.
  std::vector<std::string> moves{};
  /// What the load acts on: guided_supports, "<body>", "<body>.<point>", "<body>.<surface>"; empty: all
  /// guided supports.
  std::vector<std::string> load_on{};
  TimeCurve displacement{};  ///< of ground ends of springs in +y, m; a constant rises over `ramp`
  std::vector<std::string> displaces{};  ///< "<body>.<spring>"
  static const Schema& schema();
};

/// A drive of a scene with its name.
struct SceneDrive {
  std::string key;   ///< key path of its section, "drive" or "drives.NAME"
  std::string name;  ///< empty of the only one without a name
  DriveParameters parameters;
  bool is_only = true;  ///< there is no other

  std::string key_of(const std::string& below) const { return key + "." + below; }
  std::string key_of(const std::string& list, std::size_t entry) const {
    return key_of(list) + "." + std::to_string(entry);
  }
  /// Whether the velocity moves the guided supports of all bodies. Where nothing is said, it does where
  /// there is one, or no other drive.
  bool moves_guided() const;
  /// Whether the load acts on the guided supports of all bodies; likewise.
  bool loads_guided() const;
};

/// The force law of a contact whose normal law has an area, in SI units.
/// @param load that presses the bodies together, for FrictionLoad::applied, N
/// @throws std::invalid_argument if its table has not been read
SubstrateContact make_substrate_contact(const ContactParameters& contact, double load);

/// The drive as it acts: constants turned into ramps.
/// @param key of its section
Drive make_drive(const DriveParameters& parameters, SlidingMode sliding,
                 const std::string& key = "drive");

}  // namespace stridor
