#include "solvers/sliding_point.hpp"

#include "core/clones.hpp"
#include "solvers/slots.hpp"

namespace stridor {
namespace {

/// Part of a compliance that goes through one body: rows of one contact at `a` entries of it, of
/// another at `b`.
/// @param compliance W at the first of both, columns `stride` apart
template <int a, int b>
STRIDOR_INLINE void add_through(const double* compliance, std::size_t stride,
                                const double* normal_a, const double* tangent_a,
                                const double* normal_b, const double* tangent_b,
                                ContactCompliance& sum) {
  double by_normal[a] = {};
  double by_tangent[a] = {};
  for (int j = 0; j < b; ++j) {
    const double* const column = compliance + static_cast<std::size_t>(j) * stride;
    for (int i = 0; i < a; ++i) {
      by_normal[i] += column[i] * normal_b[j];
      by_tangent[i] += column[i] * tangent_b[j];
    }
  }
  sum.nn += dot<a>(normal_a, by_normal);
  sum.nt += dot<a>(normal_a, by_tangent);
  sum.tn += dot<a>(tangent_a, by_normal);
  sum.tt += dot<a>(tangent_a, by_tangent);
}

/// The same for any even numbers of entries.
STRIDOR_CLONES
void add_through(int a, int b, const double* compliance, std::size_t stride, const double* normal_a,
                 const double* tangent_a, const double* normal_b, const double* tangent_b,
                 ContactCompliance& sum) {
  if (a == 2 && b == 2) {
    add_through<2, 2>(compliance, stride, normal_a, tangent_a, normal_b, tangent_b, sum);
  } else if (a == 4 && b == 4) {
    add_through<4, 4>(compliance, stride, normal_a, tangent_a, normal_b, tangent_b, sum);
  } else {
    for (int j = 0; j < b; j += 2) {
      for (int i = 0; i < a; i += 2) {
        add_through<2, 2>(compliance + static_cast<std::size_t>(j) * stride + i, stride,
                          normal_a + i, tangent_a + i, normal_b + j, tangent_b + j, sum);
      }
    }
  }
}

}  // namespace

SlidingPoint::SlidingPoint(const ContactPoint& point, const MasterSurface& surface,
                           Propagator& slave, Propagator& master, int slave_slot, int master_slot,
                           double drive_share)
    : point_(point),
      surface_(&surface),
      slave_(&slave),
      master_(&master),
      slave_slot_(slave_slot),
      master_slot_(master_slot),
      drive_share_(drive_share),
      last_segment_(surface.num_segments() - 1) {
  slave_->watch(slave_slot, point.slave_rows.x);
  slave_->watch(slave_slot + 1, point.slave_rows.y);
  watch(point.first_segment);
}

void SlidingPoint::watch(int segment) {
  segment_ = segment;
  undeformed_ = surface_->undeformed_piece(segment);
  place_.master.stencil = undeformed_.stencil;
  slave_origin_ = point_.slave_position - surface_->positions[static_cast<std::size_t>(segment)];
  for (int k = 0; k < undeformed_.stencil.count; ++k) {
    const PointRows& rows = surface_->rows[static_cast<std::size_t>(undeformed_.stencil.first + k)];
    master_->watch(master_slot_ + 2 * k, rows.x);
    master_->watch(master_slot_ + 2 * k + 1, rows.y);
  }
}

SlidingPoint::Place SlidingPoint::place_of(const double* slave, const double* master,
                                           double drive_at) const {
  const double* const s = slave + slave_slot_;
  const double* const m = master + master_slot_;
  Place place;
  place.slave = {slave_origin_.x() + drive_share_ * drive_at + s[0], slave_origin_.y() + s[1]};
  place.master.stencil = undeformed_.stencil;
  for (int k = 0; k < undeformed_.stencil.count; ++k) {
    const Eigen::Vector2d& node = undeformed_.nodes[static_cast<std::size_t>(k)];
    place.master.nodes[static_cast<std::size_t>(k)] = {node.x() + m[2 * k],
                                                       node.y() + m[2 * k + 1]};
  }
  return place;
}

Projection SlidingPoint::project_place(const Place& place, double drive_at) const {
  const double guess = projection_.xi;
  switch (point_.assumption) {
    case ContactAssumption::subs_b:
    case ContactAssumption::film:
      return project(place.master, place.slave, guess);
    case ContactAssumption::subs_c:
      return project_along(place.master, place.slave, undeformed_, guess);
    case ContactAssumption::subs_a:
      break;
  }
  return project(undeformed_, slave_origin_ + Eigen::Vector2d(drive_share_ * drive_at, 0.0), guess);
}

bool SlidingPoint::find(double drive_at) {
  int heading = 0;
  while (true) {
    place_ = place_of(slave_->expected(), master_->expected(), drive_at);
    projection_ = project_place(place_, drive_at);
    const double xi = projection_.xi;
    const int wanted = xi > 1.0 ? 1 : xi < 0.0 ? -1 : 0;
    if (wanted == 0 || wanted == -heading) break;
    const int next = segment_ + wanted;
    if (next < 0 || next > last_segment_) {
      if (!surface_->is_endless) return false;
      break;
    }
    watch(next);
    projection_.xi -= wanted;
    heading = wanted;
  }
  set_rows();
  return true;
}

void SlidingPoint::stand(double drive_at) {
  place_ = place_of(slave_->current(), master_->current(), drive_at);
  projection_ = project_place(place_, drive_at);
  set_rows();
}

void SlidingPoint::set_rows() {
  const Eigen::Vector2d& n = projection_.normal;
  const Eigen::Vector2d& t = projection_.tangent;
  normal_.slave = {n.x(), n.y()};
  tangent_.slave = {t.x(), t.y()};
  for (std::size_t k = 0; k < static_cast<std::size_t>(undeformed_.stencil.count); ++k) {
    const double weight = projection_.weights[k];
    normal_.master[2 * k] = -weight * n.x();
    normal_.master[2 * k + 1] = -weight * n.y();
    tangent_.master[2 * k] = -weight * t.x();
    tangent_.master[2 * k + 1] = -weight * t.y();
  }
}

double SlidingPoint::undeformed_arm(const Eigen::Vector2d& direction, double drive_at) const {
  const Eigen::Vector2d on_master = undeformed_.combine(projection_.weights);
  return direction.x() * (slave_origin_.x() + drive_share_ * drive_at - on_master.x()) +
         direction.y() * (slave_origin_.y() - on_master.y());
}

double SlidingPoint::relative(const SlotRow& row, const double* slave, const double* master) const {
  return dot<2>(row.slave.data(), slave + slave_slot_) +
         dot(2 * undeformed_.stencil.count, row.master.data(), master + master_slot_);
}

double SlidingPoint::predicted_gap(double drive_at) const {
  return undeformed_arm(projection_.normal, drive_at) +
         relative(normal_, slave_->predicted(), master_->predicted());
}

double SlidingPoint::predicted_slip() const {
  return relative(tangent_, slave_->predicted(), master_->predicted()) -
         relative(tangent_, slave_->expected(), master_->expected());
}

double SlidingPoint::increment() const {
  return relative(tangent_, slave_->increments(), master_->increments());
}

double SlidingPoint::place() const {
  double along = position();
  if (point_.assumption == ContactAssumption::subs_a) {
    along += projection_.tangent.dot(place_.slave - place_.master.combine(projection_.weights));
  }
  return along;
}

double SlidingPoint::stretch() const {
  const auto slopes = weights_at(undeformed_.stencil, projection_.xi).slope;
  return projection_.tangent.dot(place_.master.combine(slopes)) /
         surface_->arc_slope(segment_, slopes);
}

double SlidingPoint::present_gap(double drive_at) const {
  const Place now = place_of(slave_->current(), master_->current(), drive_at);
  const Projection here = project(now.master, now.slave, projection_.xi);
  return here.normal.dot(now.slave - now.master.combine(here.weights)) -
         surface_->roughness_at(segment_, here.weights);
}

double SlidingPoint::present_position(double drive_at) const {
  const Place now = place_of(slave_->current(), master_->current(), drive_at);
  return surface_->arc_at(segment_, project(now.master, now.slave, projection_.xi).weights);
}

ContactCompliance SlidingPoint::compliance(const SlidingPoint& other) const {
  ContactCompliance sum;
  const auto add = [&](const Propagator& body, int slot_i, int count_i, const double* normal_i,
                       const double* tangent_i, int slot_j, int count_j, const double* normal_j,
                       const double* tangent_j) {
    const auto stride = static_cast<std::size_t>(body.num_slots());
    add_through(count_i, count_j,
                body.compliances() + static_cast<std::size_t>(slot_j) * stride + slot_i, stride,
                normal_i, tangent_i, normal_j, tangent_j, sum);
  };
  const int count = 2 * undeformed_.stencil.count;
  const int other_count = 2 * other.undeformed_.stencil.count;
  if (slave_ == other.slave_) {
    add(*slave_, slave_slot_, 2, normal_.slave.data(), tangent_.slave.data(), other.slave_slot_, 2,
        other.normal_.slave.data(), other.tangent_.slave.data());
  }
  if (master_ == other.master_) {
    add(*master_, master_slot_, count, normal_.master.data(), tangent_.master.data(),
        other.master_slot_, other_count, other.normal_.master.data(), other.tangent_.master.data());
  }
  if (slave_ == other.master_) {
    add(*slave_, slave_slot_, 2, normal_.slave.data(), tangent_.slave.data(), other.master_slot_,
        other_count, other.normal_.master.data(), other.tangent_.master.data());
  }
  if (master_ == other.slave_) {
    add(*master_, master_slot_, count, normal_.master.data(), tangent_.master.data(),
        other.slave_slot_, 2, other.normal_.slave.data(), other.tangent_.slave.data());
  }
  return sum;
}

void SlidingPoint::apply(double normal, double tangential, double* slave_forces,
                         double* master_forces) const {
  double* const slave = slave_forces + slave_slot_;
  double* const master = master_forces + master_slot_;
  for (std::size_t k = 0; k < 2; ++k)
    slave[k] = normal * normal_.slave[k] - tangential * tangent_.slave[k];
  for (std::size_t k = 0; k < 2 * static_cast<std::size_t>(undeformed_.stencil.count); ++k)
    master[k] = normal * normal_.master[k] - tangential * tangent_.master[k];
}

void SlidingPoint::restore(int segment, double xi, const Eigen::Vector2d& tangent) {
  segment_ = segment;
  undeformed_ = surface_->undeformed_piece(segment);
  slave_origin_ = point_.slave_position - surface_->positions[static_cast<std::size_t>(segment)];
  projection_ = {xi, tangent, turned_left(tangent), weights_at(undeformed_.stencil, xi).value};
  set_rows();
}

}  // namespace stridor
