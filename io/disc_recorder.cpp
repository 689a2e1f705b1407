#include "io/disc_recorder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/suggestion.hpp"

namespace stridor {
namespace {

constexpr std::array<const char*, 3> motion_names{"displacement", "velocity", "acceleration"};
constexpr std::array<const char*, 3> motion_units{"m", "m/s", "m/s^2"};

struct DiscQuantity {
  const char* name;
  const char* units;
  double FaceContactState::*member;  ///< null: the state
};
constexpr std::array<DiscQuantity, 5> contact_quantities{
    {{"force", "N", &FaceContactState::force},
     {"friction_force", "N", &FaceContactState::friction_force},
     {"gap", "m", &FaceContactState::gap},
     {"slip_velocity", "m/s", &FaceContactState::slip_velocity},
     {"state", "1", nullptr}}};

/// A displacement at a contact.
struct RecordedPlace {
  const char* body;
  const char* direction;
  FacePort port;
};
constexpr std::array<RecordedPlace, 4> places{{{"pad", "r", FacePort::pad_r},
                                               {"pad", "phi", FacePort::pad_phi},
                                               {"pad", "z", FacePort::pad_z},
                                               {"disc", "z", FacePort::plate_w}}};

/// Calls what is given for every motion (contact, place, number of derivatives, name) and for every
/// quantity (contact, quantity, name).
template <class OnMotion, class OnQuantity>
void for_every_channel(std::size_t per_pad, OnMotion&& on_motion, OnQuantity&& on_quantity) {
  for (std::size_t i = 0; i < 2 * per_pad; ++i) {
    const std::string contact = disc_contact_name(i, per_pad);
    for (const RecordedPlace& place : places) {
      for (std::size_t d = 0; d < motion_names.size(); ++d) {
        on_motion(
            i, place, d,
            fmt::format("{}.{}.{}.{}", place.body, contact, place.direction, motion_names[d]));
      }
    }
    for (const DiscQuantity& quantity : contact_quantities)
      on_quantity(i, quantity, fmt::format("{}.{}", contact, quantity.name));
  }
}

}  // namespace

std::string disc_contact_name(std::size_t contact, std::size_t per_pad) {
  const std::string pad = contact < per_pad ? "upper" : "lower";
  return per_pad == 1 ? pad : fmt::format("{}_{}", pad, contact % per_pad);
}

std::vector<std::string> disc_channels(std::size_t per_pad) {
  std::vector<std::string> names;
  for_every_channel(
      per_pad,
      [&](std::size_t, const RecordedPlace&, std::size_t, const std::string& name) {
        names.push_back(name);
      },
      [&](std::size_t, const DiscQuantity&, const std::string& name) { names.push_back(name); });
  return names;
}

std::vector<Problem> channel_problems(const std::vector<std::string>& channels,
                                      std::size_t per_pad) {
  const std::vector<std::string> known = disc_channels(per_pad);
  std::vector<Problem> problems;
  std::set<std::string> seen;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    std::string wrong;
    if (!seen.insert(channels[i]).second) {
      wrong = "is listed twice";
    } else if (std::find(known.begin(), known.end(), channels[i]) == known.end()) {
      wrong = fmt::format("there is none of this name{} (they begin with {} and end with {})",
                          did_you_mean(channels[i], known), known.front(), known.back());
    }
    if (wrong.empty()) continue;
    problems.push_back({fmt::format("record.channels.{}", i),
                        fmt::format("channel '{}': {}", channels[i], wrong),
                        {},
                        0,
                        0});
  }
  return problems;
}

DiscRecorder::DiscRecorder(const DiscModel& model, const std::vector<std::string>& channels,
                           double step, double interval)
    : interval_(interval),
      filter_(std::make_shared<const DecimationFilter>(
          step, static_cast<int>(std::lround(interval / step)))),
      intervals_(model.contacts.size(), filter_->ratio()),
      of_step_(model.contacts.size()) {
  const std::size_t per_pad = model.contacts.size() / 2;
  std::vector<Problem> problems = channel_problems(channels, per_pad);
  if (!problems.empty()) throw ConfigError(std::move(problems));
  const auto is_wanted = [&](const std::string& name) {
    return channels.empty() || std::find(channels.begin(), channels.end(), name) != channels.end();
  };
  // The derivatives of one displacement share its stream.
  std::size_t place_of_stream = 0;
  const auto on_motion = [&](std::size_t contact, const RecordedPlace& place,
                             std::size_t derivative, const std::string& name) {
    const std::string stream = name.substr(0, name.rfind('.'));
    if (!is_wanted(name)) return;
    if (streams_.empty() || streams_[place_of_stream].name != stream) {
      place_of_stream = streams_.size();
      streams_.push_back(
          {stream, place.port, static_cast<int>(contact), nullptr, Decimator(filter_)});
    }
    series_.push_back({"/channels/" + name,
                       motion_units[derivative],
                       SeriesKind::real,
                       {{"filter", filter_->description()}}});
    columns_.push_back({place_of_stream, static_cast<Derivative>(derivative), nullptr, 0});
  };
  const auto on_quantity = [&](std::size_t contact, const DiscQuantity& quantity,
                               const std::string& name) {
    if (!is_wanted(name)) return;
    streams_.push_back(
        {name, std::nullopt, static_cast<int>(contact), quantity.member, Decimator(filter_)});
    for (const ContactSeries& column :
         contact_columns(name.substr(0, name.rfind('.')), quantity.name, quantity.units,
                         filter_->description())) {
      series_.push_back(column.spec);
      columns_.push_back({streams_.size() - 1, std::nullopt, column.of_interval, contact});
      if (column.is_low_passed) columns_.back().derivative = Derivative::none;
    }
  };
  for_every_channel(per_pad, on_motion, on_quantity);
  row_.resize(columns_.size());
}

void DiscRecorder::sample(const FaceContactMotion& motion, RunFileWriter& writer,
                          std::int64_t last) {
  for (std::size_t i = 0; i < of_step_.size(); ++i) {
    const FaceContactState contact = motion.contact(static_cast<int>(i));
    of_step_[i] = {contact.force,
                   contact.force,
                   contact.friction_force,
                   contact.friction_force,
                   1,
                   contact.state == ContactState::stick ? 1 : 0,
                   contact.state == ContactState::open ? 1 : 0};
  }
  intervals_.add(of_step_);
  bool is_due = false;
  for (Stream& stream : streams_) is_due = stream.decimator.push(value(stream, motion));
  if (!is_due) return;
  const std::int64_t number = streams_.front().decimator.num_outputs() - 1;
  if (number <= last) {
    for (std::size_t i = 0; i < columns_.size(); ++i) row_[i] = value(columns_[i]);
    writer.append(static_cast<double>(number) * interval_, row_);
  }
  intervals_.drop_oldest();
}

double DiscRecorder::value(const Column& column) const {
  if (column.of_interval != nullptr) return column.of_interval(intervals_.oldest()[column.contact]);
  const Decimator& decimator = streams_[column.stream].decimator;
  return column.derivative ? decimator.value(*column.derivative) : decimator.sample();
}

void DiscRecorder::save(State& state, const std::string& prefix) const {
  for (std::size_t i = 0; i < streams_.size(); ++i)
    streams_[i].decimator.save(state, fmt::format("{}streams/{}/", prefix, i));
  intervals_.save(state, prefix);
}

void DiscRecorder::load(const State& state, const std::string& prefix) {
  for (std::size_t i = 0; i < streams_.size(); ++i)
    streams_[i].decimator.load(state, fmt::format("{}streams/{}/", prefix, i));
  intervals_.load(state, prefix);
}

double DiscRecorder::value(const Stream& stream, const FaceContactMotion& motion) {
  if (stream.port) return motion.moved(stream.contact, *stream.port);
  const FaceContactState contact = motion.contact(stream.contact);
  return stream.member != nullptr ? contact.*stream.member : static_cast<double>(contact.state);
}

}  // namespace stridor
