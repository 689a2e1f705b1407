#include "io/run_file/event_recorder.hpp"

#include "io/run_file/contact_intervals.hpp"

namespace stridor {
namespace {

/// Displacement, velocity or acceleration of the point in contact, SI.
Eigen::Vector2d motion_in_contact(Derivative derivative, const SlidingOscillator& oscillator,
                                  const SubstrateMotion& motion) {
  const SubstrateMotion::State& s = motion.state();
  switch (derivative) {
    case Derivative::none:
      return oscillator.to_si({s[0], s[1]}, oscillator.length);
    case Derivative::first:
      return oscillator.to_si({s[2], s[3]}, oscillator.velocity_unit());
    case Derivative::second:
      break;
  }
  return oscillator.to_si(motion.acceleration(), oscillator.acceleration_unit());
}

}  // namespace

std::vector<SeriesSpec> EventRecorder::series(const Model& model,
                                              const std::vector<Channel>& channels) {
  std::vector<SeriesSpec> series;
  for (const Channel& channel : channels) {
    if (channel.point) {
      series.push_back(
          {"/channels/" + channel.name, channel.units(), SeriesKind::real, {{"filter", "none"}}});
      continue;
    }
    // Of the columns of a quantity the one of the row.
    const std::string& contact = model.system.contacts.front().name;
    series.push_back(
        contact_columns(contact, name_of(channel.quantity), channel.units(), "none").front().spec);
  }
  return series;
}

void EventRecorder::write(double time, const SubstrateMotion& motion, RowSink& rows) {
  row_.clear();
  for (const Channel& channel : channels_) row_.push_back(value(channel, time, motion));
  rows.append(time, row_);
}

double EventRecorder::value(const Channel& channel, double time,
                            const SubstrateMotion& motion) const {
  return channel.point ? value_at_point(channel, time, motion)
                       : value_of_contact(channel.quantity, time, motion);
}

double EventRecorder::value_at_point(const Channel& channel, double time,
                                     const SubstrateMotion& motion) const {
  const Model::Point& point = model_->points.at(*channel.point);
  const SystemBody& body = model_->system.bodies[static_cast<std::size_t>(point.body)];
  const Eigen::Vector2d reduced =
      oscillator_->mass.to_body * motion_in_contact(channel.derivative, *oscillator_, motion);
  const double relative =
      body.reduced.rows.row(point.rows.row(channel.direction)).dot(reduced);
  if (channel.direction != 0 || !body.follows_drive()) return relative;
  const Drive& drive = *model_->system.drive_of(point.body);
  if (channel.derivative == Derivative::none) return relative + drive.displacement(time);
  return channel.derivative == Derivative::first ? relative + drive.velocity.value(time) : relative;
}

double EventRecorder::value_of_contact(ContactQuantity quantity, double time,
                                       const SubstrateMotion& motion) const {
  const SlidingOscillator& o = *oscillator_;
  const SlidingMass& mass = o.mass;
  const SubstrateForces forces = motion.forces();
  const Eigen::Vector2d place = motion_in_contact(Derivative::none, o, motion);
  const double slip = motion.mode() == SubstrateMode::stick
                          ? 0.0
                          : motion_in_contact(Derivative::first, o, motion).x() - mass.speed;
  switch (quantity) {
    case ContactQuantity::force:
      return o.force * forces.normal.value;
    case ContactQuantity::friction_force:
      return -o.direction * o.force * forces.tangential.value;
    case ContactQuantity::friction_across:
    case ContactQuantity::slip_across:
      return 0.0;  // one mass in a plane
    case ContactQuantity::gap:
      return place.y();
    case ContactQuantity::slip_velocity:
      return slip;
    case ContactQuantity::position: {
      const System& system = model_->system;
      const ContactPoint& contact = system.contacts.front();
      const auto carried = [&](int body) {
        const Drive* const drive = system.drive_of(body);
        return drive == nullptr ? 0.0 : drive->displacement(time);
      };
      return contact.slave_position.x() + place.x() + carried(mass.body) -
             carried(system.surface_of(contact).body);
    }
    case ContactQuantity::area:
      return mass.contact.area(-place.y(), slip);
    case ContactQuantity::state:
      break;
  }
  switch (motion.mode()) {
    case SubstrateMode::free:
      return static_cast<double>(ContactState::open);
    case SubstrateMode::stick:
      return static_cast<double>(ContactState::stick);
    case SubstrateMode::slip_back:
    case SubstrateMode::slip_forward:
      break;
  }
  return static_cast<double>(ContactState::slip);
}

}  // namespace stridor
