#include "solvers/contact/space_point.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace stridor {

SpacePoint::SpacePoint(const ContactPoint& point, const FacetSurface* surface, NodePorts* nodes,
                       const DrivenMotion& driven, Propagator& slave, Propagator& master,
                       int slave_port)
    : FacePoint(point, slave, master, slave_port,
                surface == nullptr ? 0 : NodePorts::ports_per_node * surface->max_nodes()),
      surface_(surface),
      nodes_(nodes),
      driven_(driven),
      place_{point.space->first_facet, 0.4, 0.4} {
  if (surface_ != nullptr) number_ = nodes_->join(*surface_);
  watch_facet();
  const TangentPorts rest = TangentPorts::Zero(num_master_ports() + 3);
  search(driven_.displacement(0.0), [&] { return rest; });
}

void SpacePoint::watch_facet() {
  if (surface_ == nullptr) return;
  const std::array<int, 4> ports = nodes_->put(number_, place_.facet);
  const int count = surface_->facets[static_cast<std::size_t>(place_.facet)].count;
  for (int k = 0; k < num_master_ports(); ++k) {
    // Those of a node that the facet lacks have no weight.
    const int node = k / NodePorts::ports_per_node;
    master_ports_[static_cast<std::size_t>(k)] =
        ports[node < count ? static_cast<std::size_t>(node) : 0] + k % NodePorts::ports_per_node;
  }
}

template <class Displacements>
bool SpacePoint::search(double displaced, const Displacements& displacements) {
  bool is_on = true;
  TangentPorts ports = displacements();
  if (surface_ != nullptr) {
    FacetSearch search;
    FacetSearch::Step step = FacetSearch::Step::moved;
    while (step == FacetSearch::Step::moved) {
      const SpaceInstant instant =
          space_instant(*point().space, surface_, place_.facet, displaced, ports);
      const Eigen::Vector2d found =
          closest_on(instant.deformed, instant.slave, {place_.xi, place_.eta});
      place_.xi = found.x();
      place_.eta = found.y();
      step = search.look(*surface_, place_);
      if (step != FacetSearch::Step::moved) break;
      watch_facet();
      ports = displacements();
    }
    is_on = step == FacetSearch::Step::stay;
  }
  direct(displaced, ports);
  return is_on;
}

bool SpacePoint::find(double sought) {
  return search(driven_.displacement(sought), [&] { return expected(); });
}

void SpacePoint::direct(double displaced, const TangentPorts& ports) {
  directed_at_ = ports;
  displaced_ = displaced;
  const SpaceInstant instant =
      space_instant(*point().space, surface_, place_.facet, displaced, ports);
  geometry_ = space_geometry(instant, {place_.xi, place_.eta});
  const auto& [normal, tangents] = geometry_.frame;
  const Eigen::Index num_ports = ports.size();
  normal_ = space_row(normal, geometry_.weights, instant.num_nodes(), num_ports);
  along_ = space_row(tangents[0], geometry_.weights, instant.num_nodes(), num_ports);
  across_ = space_row(tangents[1], geometry_.weights, instant.num_nodes(), num_ports);
}

Eigen::Vector3d SpacePoint::from_origin(const Eigen::Vector3d& local) const {
  return local + (surface_ == nullptr ? point().space->origin : surface_->origin(place_.facet));
}

Eigen::Vector2d SpacePoint::tangential(const Eigen::Vector3d& vector) const {
  const auto& tangents = geometry_.frame.tangents;
  return {tangents[0].dot(vector), tangents[1].dot(vector)};
}

std::optional<Eigen::Vector2d> SpacePoint::stand(const System& system, const FaceInstant& at) {
  const auto motion_of = [&](Eigen::VectorXd SystemBody::*motion) {
    TangentPorts y = TangentPorts::Zero(num_master_ports() + 3);
    const auto put = [&](Eigen::Index port, int index, int row) {
      const SystemBody& body = system.bodies[static_cast<std::size_t>(index)];
      if (row >= 0 && (body.*motion).size() > 0)
        y[port] = body.reduced.rows.row(row).dot(body.*motion);
    };
    const std::vector<int> rows = system.master_rows(point(), place_.facet);
    for (std::size_t k = 0; k < rows.size(); ++k)
      put(static_cast<Eigen::Index>(k), point().space->body, rows[k]);
    for (int i = 0; i < 3; ++i)
      put(num_master_ports() + i, point().slave_body, point().slave_rows.row(i));
    return y;
  };
  const bool is_on = search(driven_.displacement(at.now),
                            [&] { return motion_of(&SystemBody::initial_displacement); });
  if (!is_on) return std::nullopt;
  const TangentPorts rate = motion_of(&SystemBody::initial_velocity);
  const Eigen::Vector2d moving(along_.dot(rate), across_.dot(rate));
  const Eigen::Vector3d by_drives = driven_.velocity(at.now) * Eigen::Vector3d::UnitX();
  const Eigen::Vector2d by_motion = -moving - tangential(by_drives);
  const Eigen::Vector2d velocity = by_motion + tangential(geometry_.carried);
  reached_ = from_origin(geometry_.material);
  carried_ = geometry_.carried;
  if (at.has_feedthrough) {
    const Eigen::Vector2d moved =
        at.step * (driven_.is_frozen() ? moving : Eigen::Vector2d(-by_motion));
    reached_ -= moved.x() * geometry_.frame.tangents[0] + moved.y() * geometry_.frame.tangents[1];
  }
  return velocity;
}

double SpacePoint::predicted_gap() const {
  return geometry_.gap + normal_.dot(predicted() - directed_at_) - point().overlap;
}

double SpacePoint::gap_ahead(const FaceInstant& at) const {
  const double moved = driven_.displacement(at.now + at.step) - displaced_;
  return geometry_.gap + normal_.dot(ahead() - directed_at_) +
         moved * geometry_.frame.normal.x() - point().overlap;
}

double SpacePoint::present_gap(double now) const {
  const double moved = driven_.displacement(now) - displaced_;
  return geometry_.gap + normal_.dot(current() - directed_at_) +
         moved * geometry_.frame.normal.x() - point().overlap;
}

double SpacePoint::position() const {
  return (from_origin(geometry_.material) - (surface_ == nullptr ? point().space->origin
                                                                 : surface_->positions.front()))
      .dot(point().space->reference);
}

/// From the material place reached to that under the slave at the displacements of the directions.
Eigen::Vector2d SpacePoint::slip_since_reached() const {
  const Eigen::Vector3d passed = from_origin(geometry_.material) - reached_;
  return -tangential(geometry_.stretch * passed);
}

/// From the displacements of the directions on.
Eigen::Vector2d SpacePoint::slip_to(const TangentPorts& ports, double displaced) const {
  const TangentPorts moved = ports - directed_at_;
  const Eigen::Vector3d by_drives = (displaced - displaced_) * Eigen::Vector3d::UnitX();
  return Eigen::Vector2d(-along_.dot(moved), -across_.dot(moved)) - tangential(by_drives);
}

Eigen::Vector2d SpacePoint::frozen_slip(double from, double step) const {
  if (!driven_.is_frozen()) return Eigen::Vector2d::Zero();
  const double drawn_by = 0.5 * step * (driven_.velocity(from) + driven_.velocity(from + step));
  return -tangential(drawn_by * Eigen::Vector3d::UnitX());
}

Eigen::Vector2d SpacePoint::predicted_slip(const FaceInstant& at) const {
  return slip_since_reached() + slip_to(predicted(), displaced_) +
         frozen_slip(at.sought - at.step, at.step) + carried_slip(at.step);
}

Eigen::Vector2d SpacePoint::expected_slip(const FaceInstant& at) const {
  return slip_since_reached() + frozen_slip(at.sought - at.step, at.step) + carried_slip(at.step);
}

Eigen::Vector2d SpacePoint::slip_ahead(const FaceInstant& at) const {
  return slip_to(ahead(), driven_.displacement(at.now + at.step)) + frozen_slip(at.now, at.step) +
         at.step * tangential(geometry_.carried);
}

Eigen::Vector2d SpacePoint::follow(const FaceInstant& at) {
  const Eigen::Vector2d since = slip_since_reached();
  const Eigen::Vector2d on = slip_to(current(), driven_.displacement(at.now));
  const auto& tangents = geometry_.frame.tangents;
  const Eigen::Vector3d passed = on.x() * tangents[0] + on.y() * tangents[1];
  reached_ = from_origin(geometry_.material) - geometry_.unstretch * passed;
  const Eigen::Vector2d carried = carried_slip(at.step);
  carried_ = geometry_.carried;
  return since + on + frozen_slip(at.now - at.step, at.step) + carried;
}

Eigen::Vector2d SpacePoint::drawn_velocity(double time) const {
  return tangential(geometry_.carried - driven_.velocity(time) * Eigen::Vector3d::UnitX());
}

Eigen::Vector2d SpacePoint::drawn(double from, double step) const {
  return carried_slip(step) - tangential(step * driven_.velocity(from) * Eigen::Vector3d::UnitX());
}

double SpacePoint::lifted(double from, double step) const {
  return driven_.is_frozen() ? 0.0 : step * driven_.velocity(from) * geometry_.frame.normal.x();
}

FaceDirections SpacePoint::directions(double /*step*/) const {
  FaceDirections made;
  made.count = static_cast<std::size_t>(normal_.size());
  for (std::size_t i = 0; i < made.count; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    made.sense[i] = made.push[i] = {normal_[k], along_[k], across_[k], 0.0};
  }
  return made;
}

std::vector<double> SpacePoint::numbers() const {
  std::vector<double> numbers{static_cast<double>(place_.facet), place_.xi, place_.eta, displaced_};
  numbers.insert(numbers.end(), reached_.begin(), reached_.end());
  numbers.insert(numbers.end(), directed_at_.begin(), directed_at_.end());
  if (is_carried()) numbers.insert(numbers.end(), carried_.begin(), carried_.end());
  return numbers;
}

void SpacePoint::restore(std::span<const double> numbers) {
  place_ = {static_cast<int>(numbers[0]), numbers[1], numbers[2]};
  std::copy_n(numbers.begin() + 4, 3, reached_.begin());
  TangentPorts directed(num_master_ports() + 3);
  std::copy_n(numbers.begin() + 7, directed.size(), directed.begin());
  if (is_carried()) std::copy_n(numbers.begin() + 7 + directed.size(), 3, carried_.begin());
  watch_facet();
  direct(numbers[3], directed);
}

std::string SpacePoint::where() const {
  const Eigen::Vector3d at = from_origin(geometry_.material);
  return fmt::format("at ({:.6g}, {:.6g}, {:.6g}) m of {}", at.x(), at.y(), at.z(),
                     point().space->name);
}

}  // namespace stridor
