#include "io/run_file/recorder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace stridor {
namespace {

int steps_per_sample(double step, double interval) {
  return static_cast<int>(std::lround(interval / step));
}

std::shared_ptr<const DecimationFilter> make_filter(const System& system, double step,
                                                    double interval) {
  const int ratio = steps_per_sample(step, interval);
  const int stride = sampling_stride(system, step, ratio);
  return std::make_shared<const DecimationFilter>(step * stride, ratio / stride);
}

/// Contacts of the system that belong to a pair: its name, or its name with an index.
std::vector<int> contacts_of(const System& system, const std::string& pair) {
  std::vector<int> contacts;
  for (std::size_t i = 0; i < system.contacts.size(); ++i) {
    const std::string& name = system.contacts[i].name;
    if (name == pair || name.rfind(pair + "[", 0) == 0) contacts.push_back(static_cast<int>(i));
  }
  return contacts;
}

}  // namespace

int sampling_stride(const System& system, double step, int ratio) {
  constexpr double rings_below_damping_ratio = 0.05;
  constexpr int fewest_samples = 5;
  double highest = 0.0;  // rad/s
  for (const SystemBody& body : system.bodies) {
    const RayleighDamping& damping = body.modal.damping;
    for (const double omega : body.modal.omega) {
      const double damping_ratio =
          omega > 0.0 ? (damping.alpha + damping.beta * omega * omega) / (2.0 * omega) : 0.0;
      if (damping_ratio < rings_below_damping_ratio) highest = std::max(highest, omega);
    }
  }
  const double stop_band_from = 0.6 / (ratio * step);  // of the filter, Hz
  const double needed_rate = highest / (2.0 * std::numbers::pi) + stop_band_from;
  int stride = 1;
  for (int divisor = 1; divisor <= ratio / fewest_samples; ++divisor) {
    if (ratio % divisor == 0 && divisor * step * needed_rate <= 1.0) stride = divisor;
  }
  return stride;
}

double Recorder::Stream::value(const Simulation& simulation) const {
  if (point) {
    const double relative =
        simulation.displacement(point->body, point->rows.row(direction));
    return drive >= 0 ? relative + simulation.drive_displacement(drive) : relative;
  }
  if (energy != nullptr) {
    if (simulation.energy() == nullptr)
      throw std::invalid_argument("Recorder: the simulation keeps no account of its energy");
    return simulation.energy()->balance().*energy->value;
  }
  switch (quantity) {
    case ContactQuantity::force:
      return simulation.contact_force(contact);
    case ContactQuantity::slip_velocity:
      return simulation.slip_velocity(contact);
    case ContactQuantity::gap:
      return simulation.contact_place(contact).gap;
    case ContactQuantity::friction_force:
      return simulation.friction_force(contact);
    case ContactQuantity::state:
      return static_cast<double>(simulation.contact_state(contact));
    case ContactQuantity::area:
      return simulation.contact_area(contact);
    case ContactQuantity::friction_across:
      return simulation.friction_across(contact);
    case ContactQuantity::slip_across:
      return simulation.sliding_velocity(contact).y();
    case ContactQuantity::position:
      break;
  }
  return simulation.contact_place(contact).position;
}

Recorder::Recorder(const Model& model, std::vector<Channel> channels, double step, double interval,
                   RowSink& rows)
    : interval_(interval), max_samples_(std::numeric_limits<std::int64_t>::max()), rows_(&rows) {
  const auto filter = make_filter(model.system, step, interval);
  stride_ = steps_per_sample(step, interval) / filter->ratio();
  for (const Channel& channel : channels) {
    if (channel.point) {
      add_motion(model, channel, filter);
    } else if (channel.energy != nullptr) {
      columns_.push_back({streams_.size()});
      streams_.push_back(
          {std::nullopt, 0, -1, 0, channel.quantity, channel.energy, Decimator(filter)});
    } else {
      for (const int contact : contacts_of(model.system, channel.pair))
        add_contact(channel, contact, filter);
    }
  }
  row_.resize(columns_.size());
  if (std::any_of(columns_.begin(), columns_.end(),
                  [](const Column& column) { return column.of_interval != nullptr; })) {
    since_last_look_.resize(model.system.contacts.size());
    intervals_.emplace(since_last_look_.size(), filter->ratio());
  }
  if (streams_.empty()) next_step_ = std::numeric_limits<std::int64_t>::max();
}

void Recorder::add_motion(const Model& model, const Channel& channel,
                          const std::shared_ptr<const DecimationFilter>& filter) {
  const Model::Point& point = model.points.at(*channel.point);
  // Displacement, velocity and acceleration of one point share one stream of samples.
  std::size_t stream = 0;
  while (stream < streams_.size() &&
         !(streams_[stream].point && streams_[stream].point->body == point.body &&
           streams_[stream].point->rows.x == point.rows.x &&
           streams_[stream].point->rows.y == point.rows.y &&
           streams_[stream].direction == channel.direction)) {
    ++stream;
  }
  if (stream == streams_.size()) {
    const int drive = channel.direction == 0
                          ? model.system.bodies[static_cast<std::size_t>(point.body)].drive
                          : -1;
    streams_.push_back({point, channel.direction, drive, 0, ContactQuantity::force, nullptr,
                        Decimator(filter)});
  }
  columns_.push_back({stream, channel.derivative});
}

void Recorder::add_contact(const Channel& channel, int contact,
                           const std::shared_ptr<const DecimationFilter>& filter) {
  // Names and filters are for series().
  for (const ContactSeries& column :
       contact_columns("", name_of(channel.quantity), channel.units(), "")) {
    Column added{streams_.size()};
    if (column.is_low_passed) added.derivative = Derivative::none;
    added.of_interval = column.of_interval;
    added.contact = static_cast<std::size_t>(contact);
    columns_.push_back(added);
  }
  streams_.push_back(
      {std::nullopt, false, false, contact, channel.quantity, nullptr, Decimator(filter)});
}

std::vector<SeriesSpec> Recorder::series(const Model& model, const std::vector<Channel>& channels,
                                         double step, double interval) {
  const std::string low_pass = make_filter(model.system, step, interval)->description();
  std::vector<SeriesSpec> series;
  for (const Channel& channel : channels) {
    const std::string filter = channel.is_filtered() ? low_pass : "none";
    SeriesSpec spec{
        "/channels/" + channel.name, channel.units(), SeriesKind::real, {{"filter", filter}}};
    if (channel.energy != nullptr) {
      spec.path = std::string("/energy/") + channel.energy->name;
      for (const char* name : {"definition", "long_name"})
        spec.attributes.emplace_back(name, std::string(channel.energy->definition));
      series.push_back(spec);
      continue;
    }
    if (channel.point) {
      series.push_back(spec);
      continue;
    }
    for (const int contact : contacts_of(model.system, channel.pair)) {
      const std::string& name = model.system.contacts[static_cast<std::size_t>(contact)].name;
      for (const ContactSeries& column :
           contact_columns(name, name_of(channel.quantity), channel.units(), low_pass))
        series.push_back(column.spec);
    }
  }
  return series;
}

void Recorder::sample(const Simulation& simulation) {
  next_step_ += stride_;
  if (intervals_) {
    for (std::size_t i = 0; i < since_last_look_.size(); ++i)
      since_last_look_[i] = simulation.interval_statistics(static_cast<int>(i));
    intervals_->add(since_last_look_);
  }
  bool is_due = false;
  for (Stream& stream : streams_) is_due = stream.decimator.push(stream.value(simulation));
  if (is_due) write_row();
}

std::optional<DisplacementSink::Row> Recorder::sole_row() const {
  if (streams_.size() != 1) return std::nullopt;
  const Stream& stream = streams_.front();
  if (!stream.point || stream.drive >= 0) return std::nullopt;
  const PointRows& rows = stream.point->rows;
  return Row{stream.point->body, rows.row(stream.direction)};
}

void Recorder::sample_displacement(double displacement) {
  next_step_ += stride_;
  if (streams_.front().decimator.push(displacement)) write_row();
}

/// The row that is due.
void Recorder::write_row() {
  const std::int64_t number = streams_.front().decimator.num_outputs() - 1;
  if (number < max_samples_) {
    for (std::size_t i = 0; i < columns_.size(); ++i) row_[i] = value(columns_[i]);
    rows_->append(static_cast<double>(number) * interval_, row_);
  }
  if (intervals_) intervals_->drop_oldest();
}

double Recorder::value(const Column& column) const {
  if (column.of_interval != nullptr)
    return column.of_interval(intervals_->oldest()[column.contact]);
  const Decimator& decimator = streams_[column.stream].decimator;
  return column.derivative ? decimator.value(*column.derivative) : decimator.sample();
}

std::int64_t Recorder::latency() const {
  return streams_.empty()
             ? 0
             : static_cast<std::int64_t>(streams_.front().decimator.latency()) * stride_;
}

void Recorder::save(State& state, const std::string& prefix) const {
  state.put(prefix + "next_step", static_cast<double>(next_step_));
  for (std::size_t i = 0; i < streams_.size(); ++i) {
    streams_[i].decimator.save(state, fmt::format("{}streams/{}/", prefix, i));
  }
  if (intervals_) intervals_->save(state, prefix);
}

void Recorder::load(const State& state, const std::string& prefix) {
  next_step_ = static_cast<std::int64_t>(state.get(prefix + "next_step"));
  for (std::size_t i = 0; i < streams_.size(); ++i) {
    streams_[i].decimator.load(state, fmt::format("{}streams/{}/", prefix, i));
  }
  if (intervals_) intervals_->load(state, prefix);
}

}  // namespace stridor
