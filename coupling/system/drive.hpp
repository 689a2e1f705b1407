// Motions and loads that are prescribed from outside.
#pragma once

#include <algorithm>
#include <optional>
#include <string>

#include "core/time_curve.hpp"

namespace stridor {

/// Prescribed motion of bodies, and size of loads, over time.
struct Drive {
  TimeCurve velocity;      ///< of the bodies that follow it in +x, m/s
  TimeCurve load;          ///< of every BodyLoad by force that it has, N
  bool is_frozen = false;  ///< the bodies stay where they are, friction acts as if they moved
  double displaced = 0.0;  ///< of these bodies in +x at t = 0, m
  TimeCurve shift{};       ///< of the ground ends of springs in +y: of every BodyLoad by shift, m
  std::string key = "drive";  ///< key path of its section

  /// Displacement of the bodies that follow the drive in +x, m.
  double displacement(double time) const {
    return displaced + (is_frozen ? 0.0 : velocity.integral(time));
  }
  double acceleration(double time) const { return is_frozen ? 0.0 : velocity.slope(time); }
  /// From this time on nothing of it changes but the displacement.
  double constant_from() const {
    return std::max({velocity.constant_from(), load.constant_from(), shift.constant_from()});
  }
};

/// A load of a drive on a body: the transpose of a row of ReducedBody::rows times what the drive says.
struct BodyLoad {
  enum class By {
    force,  ///< Drive::load, N; the row is the displacement that it does work on
    shift,  ///< Drive::shift, m; the row holds what the spring exerts, N/m
  };
  int row = 0;
  int drive = 0;  ///< index into System::drives
  By by = By::force;

  /// Size at a time, N or m.
  /// @param from System::drives
  template <class Drives>
  double size(const Drives& from, double time) const {
    const Drive& of = from[static_cast<std::size_t>(drive)];
    return by == By::force ? of.load.value(time) : of.shift.value(time);
  }
};

/// Motion in +x of the slave of a contact against its master, by the drives that they follow.
class DrivenMotion {
 public:
  /// Neither is driven, or both are by the same.
  DrivenMotion() = default;
  /// @param slave, master null where the body follows no drive; copied
  DrivenMotion(const Drive* slave, const Drive* master) {
    if (slave == master) return;
    if (slave != nullptr) slave_ = *slave;
    if (master != nullptr) master_ = *master;
    for (const std::optional<Drive>* one : {&slave_, &master_}) {
      if (!*one) continue;
      constant_from_ = std::max(constant_from_, (*one)->velocity.constant_from());
      is_frozen_ = is_frozen_ || (*one)->is_frozen;
    }
    end_velocity_ = changing_velocity(constant_from_);
    end_displacement_ = changing_displacement(constant_from_);
    rate_ = is_frozen_ ? 0.0 : end_velocity_;
  }

  /// m.
  double displacement(double time) const {
    if (time < constant_from_) return changing_displacement(time);
    return end_displacement_ + rate_ * (time - constant_from_);
  }
  /// m/s; frozen or not.
  double velocity(double time) const {
    return time < constant_from_ ? changing_velocity(time) : end_velocity_;
  }
  bool is_frozen() const { return is_frozen_; }
  /// From this time on the velocity no longer changes.
  double constant_from() const { return constant_from_; }
  double end_displacement() const { return end_displacement_; }  ///< at constant_from()
  double end_velocity() const { return end_velocity_; }          ///< from then on
  double end_rate() const { return rate_; }  ///< that of the displacement, 0 where it is frozen

 private:
  double changing_displacement(double time) const {
    return (slave_ ? slave_->displacement(time) : 0.0) -
           (master_ ? master_->displacement(time) : 0.0);
  }
  double changing_velocity(double time) const {
    return (slave_ ? slave_->velocity.value(time) : 0.0) -
           (master_ ? master_->velocity.value(time) : 0.0);
  }

  double constant_from_ = 0.0;
  double end_displacement_ = 0.0;
  double rate_ = 0.0;
  double end_velocity_ = 0.0;
  bool is_frozen_ = false;
  std::optional<Drive> slave_;
  std::optional<Drive> master_;
};

}  // namespace stridor
