#include "solvers/contact/sliding_point.hpp"

#include "core/clones.hpp"
#include "solvers/algebra/ports.hpp"

namespace stridor {
namespace {

/// Entries of a contact at the ports of one body.
struct Entries {
  int port;
  std::size_t count;
  const double* normal;
  const double* tangent;
};

/// Calls work(size of a, size of b), as constants where both are common.
template <class Work>
STRIDOR_INLINE void for_sizes(std::size_t a, std::size_t b, const Work& work) {
  if (a == 2 && b == 2) {
    work(FixedSize<2>(), FixedSize<2>());
  } else if (a == 4 && b == 4) {
    work(FixedSize<4>(), FixedSize<4>());
  } else {
    work(a, b);
  }
}

/// e_a W e_b through one body.
/// @param block W at the first of both, columns `stride` apart
template <class SizeA, class SizeB>
STRIDOR_INLINE double through(SizeA a, SizeB b, const double* block, std::size_t stride,
                              const double* entries_a, const double* entries_b) {
  double moved[2 * max_stencil] = {};
  for (std::size_t j = 0; j < b; ++j) {
    for (std::size_t i = 0; i < a; ++i) moved[i] += block[j * stride + i] * entries_b[j];
  }
  return dot(a, entries_a, moved);
}

STRIDOR_CLONES
void add_through(const double* block, std::size_t stride, const Entries& a, const Entries& b,
                 ContactCompliance& sum) {
  for_sizes(a.count, b.count, [&](auto size_a, auto size_b) STRIDOR_INLINE_LAMBDA {
    sum.nn += through(size_a, size_b, block, stride, a.normal, b.normal);
    sum.nt += through(size_a, size_b, block, stride, a.normal, b.tangent);
    sum.tn += through(size_a, size_b, block, stride, a.tangent, b.normal);
    sum.tt += through(size_a, size_b, block, stride, a.tangent, b.tangent);
  });
}

STRIDOR_CLONES
double sliding_through(const double* block, std::size_t stride, const Entries& a, const Entries& b,
                       double friction) {
  double sum = 0.0;
  for_sizes(a.count, b.count, [&](auto size_a, auto size_b) STRIDOR_INLINE_LAMBDA {
    double pull[2 * max_stencil];
    for (std::size_t j = 0; j < size_b; ++j) pull[j] = b.normal[j] - friction * b.tangent[j];
    sum = through(size_a, size_b, block, stride, a.normal, pull);
  });
  return sum;
}

/// e_a W e_b of a slave's two ports.
STRIDOR_INLINE double through_slave(const double* block, std::size_t stride, const double* a,
                                    const double* b) {
  return a[0] * (block[0] * b[0] + block[stride] * b[1]) +
         a[1] * (block[1] * b[0] + block[stride + 1] * b[1]);
}

/// n W (n − κ t) of a contact with itself, on a straight segment between two bodies.
/// @param slave, master blocks of W at the first ports of the contact
STRIDOR_CLONES
double sliding_through_both(const double* slave, std::size_t slave_stride, const double* master,
                            std::size_t master_stride, const PortRow& normal,
                            const PortRow& tangent, double friction) {
  double slave_pull[2];
  for (std::size_t j = 0; j < 2; ++j) slave_pull[j] = normal.slave[j] - friction * tangent.slave[j];
  double master_pull[4];
  for (std::size_t j = 0; j < 4; ++j)
    master_pull[j] = normal.master[j] - friction * tangent.master[j];
  return through_slave(slave, slave_stride, normal.slave.data(), slave_pull) +
         through(FixedSize<4>(), FixedSize<4>(), master, master_stride, normal.master.data(),
                 master_pull);
}

/// Calls work(k) for every node of a piece of surface, which has two at least: those of a straight
/// segment without a loop.
template <class Work>
STRIDOR_INLINE void for_nodes(const SurfacePiece& piece, const Work& work) {
  work(std::size_t{0});
  work(std::size_t{1});
  for (std::size_t k = 2; k < static_cast<std::size_t>(piece.stencil.count); ++k) work(k);
}

/// λ_n and λ_t as the force on one point.
STRIDOR_INLINE void set_force(double normal, const double* on_normal, double tangential,
                              const double* on_tangent, double* force) {
  force[0] = normal * on_normal[0] - tangential * on_tangent[0];
  force[1] = normal * on_normal[1] - tangential * on_tangent[1];
}

/// W from given ports of a body on, columns num_ports apart.
const double* block_of(const Propagator& body, const double* compliances, int port_a, int port_b) {
  return compliances +
         static_cast<std::size_t>(port_b) * static_cast<std::size_t>(body.num_ports()) + port_a;
}
const double* block_of(const Propagator& body, int port_a, int port_b) {
  return block_of(body, body.compliances(), port_a, port_b);
}

}  // namespace

SlidingPoint::SlidingPoint(const ContactPoint& point, const MasterSurface& surface,
                           Propagator& slave, Propagator& master, int slave_port, int master_port)
    : point_(point),
      surface_(&surface),
      slave_(&slave),
      master_(&master),
      slave_port_(slave_port),
      master_port_(master_port),
      last_segment_(surface.num_segments() - 1) {
  slave_->watch(slave_port, point.slave_rows.x);
  slave_->watch(slave_port + 1, point.slave_rows.y);
  watch(point.first_segment);
}

void SlidingPoint::enter(int segment) {
  segment_ = segment;
  undeformed_ = surface_->undeformed_piece(segment);
  place_.master.stencil = undeformed_.stencil;
  slave_origin_ = point_.slave_position - surface_->positions[static_cast<std::size_t>(segment)];
}

void SlidingPoint::watch(int segment) {
  enter(segment);
  for (int k = 0; k < undeformed_.stencil.count; ++k) {
    const PointRows& rows = surface_->rows[static_cast<std::size_t>(undeformed_.stencil.first + k)];
    master_->watch(master_port_ + 2 * k, rows.x);
    master_->watch(master_port_ + 2 * k + 1, rows.y);
  }
}

void SlidingPoint::set_place(const double* slave, const double* master, double driven,
                             Place& place) const {
  const double* const s = slave + slave_port_;
  const double* const m = master + master_port_;
  // The stencil is already that of the segment: of place_ since enter(), elsewhere by the caller.
  place.slave = {slave_origin_.x() + driven + s[0], slave_origin_.y() + s[1]};
  for_nodes(undeformed_, [&](std::size_t k) STRIDOR_INLINE_LAMBDA {
    const Eigen::Vector2d& node = undeformed_.nodes[k];
    place.master.nodes[k] = {node.x() + m[2 * k], node.y() + m[2 * k + 1]};
  });
}

Projection SlidingPoint::project_place(const Place& place, double driven) const {
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
  return project(undeformed_, slave_origin_ + Eigen::Vector2d(driven, 0.0), guess);
}

bool SlidingPoint::find(double driven) {
  int heading = 0;
  while (true) {
    set_place(slave_->expected(), master_->expected(), driven, place_);
    projection_ = project_place(place_, driven);
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

void SlidingPoint::stand(double driven) {
  set_place(slave_->current(), master_->current(), driven, place_);
  projection_ = project_place(place_, driven);
  set_rows();
}

void SlidingPoint::set_rows() {
  const Eigen::Vector2d& n = projection_.normal;
  const Eigen::Vector2d& t = projection_.tangent;
  normal_.slave = {n.x(), n.y()};
  tangent_.slave = {t.x(), t.y()};
  for_nodes(undeformed_, [&](std::size_t k) STRIDOR_INLINE_LAMBDA {
    const double weight = projection_.weights[k];
    normal_.master[2 * k] = -weight * n.x();
    normal_.master[2 * k + 1] = -weight * n.y();
    tangent_.master[2 * k] = -weight * t.x();
    tangent_.master[2 * k + 1] = -weight * t.y();
  });
}

double SlidingPoint::undeformed_arm(const Eigen::Vector2d& direction, double driven) const {
  const Eigen::Vector2d on_master = undeformed_.combine(projection_.weights);
  return direction.x() * (slave_origin_.x() + driven - on_master.x()) +
         direction.y() * (slave_origin_.y() - on_master.y());
}

double SlidingPoint::relative(const PortRow& row, const double* slave, const double* master) const {
  const double* const m = master + master_port_;
  const double of_slave = dot(FixedSize<2>(), row.slave.data(), slave + slave_port_);
  if (undeformed_.stencil.count == 2) return of_slave + dot(FixedSize<4>(), row.master.data(), m);
  return of_slave +
         dot(2 * static_cast<std::size_t>(undeformed_.stencil.count), row.master.data(), m);
}

double SlidingPoint::predicted_gap(double driven) const {
  return undeformed_arm(projection_.normal, driven) +
         relative(normal_, slave_->predicted(), master_->predicted());
}

double SlidingPoint::predicted_slip() const {
  return relative(tangent_, slave_->predicted(), master_->predicted()) -
         relative(tangent_, slave_->expected(), master_->expected());
}

double SlidingPoint::gap_ahead(double driven, double advance) const {
  return undeformed_arm(projection_.normal, driven + advance) +
         relative(normal_, slave_->ahead(), master_->ahead());
}

double SlidingPoint::slip_ahead(double advance) const {
  return along_tangent(advance) + relative(tangent_, slave_->ahead(), master_->ahead()) -
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

ContactPlace SlidingPoint::present_place(double driven) const {
  Place now{{}, {undeformed_.stencil, {}}};
  set_place(slave_->current(), master_->current(), driven, now);
  const Projection here = project(now.master, now.slave, projection_.xi);
  return {here.normal.dot(now.slave - now.master.combine(here.weights)) -
              surface_->roughness_at(segment_, here.weights),
          surface_->arc_at(segment_, here.weights)};
}

template <class Visit>
void SlidingPoint::for_shared_bodies(const SlidingPoint& other, const Visit& visit) const {
  const auto on_slave = [](const SlidingPoint& of) {
    return Entries{of.slave_port_, 2, of.normal_.slave.data(), of.tangent_.slave.data()};
  };
  const auto on_master = [](const SlidingPoint& of) {
    return Entries{of.master_port_, 2 * static_cast<std::size_t>(of.undeformed_.stencil.count),
                   of.normal_.master.data(), of.tangent_.master.data()};
  };
  if (slave_ == other.slave_) visit(*slave_, on_slave(*this), on_slave(other));
  if (master_ == other.master_) visit(*master_, on_master(*this), on_master(other));
  if (slave_ == other.master_) visit(*slave_, on_slave(*this), on_master(other));
  if (master_ == other.slave_) visit(*master_, on_master(*this), on_slave(other));
}

ContactCompliance SlidingPoint::compliance_by(const SlidingPoint& other,
                                              Compliances compliances) const {
  ContactCompliance sum;
  for_shared_bodies(other, [&](const Propagator& body, const Entries& a, const Entries& b) {
    add_through(block_of(body, (body.*compliances)(), a.port, b.port),
                static_cast<std::size_t>(body.num_ports()), a, b, sum);
  });
  return sum;
}

ContactCompliance SlidingPoint::compliance(const SlidingPoint& other) const {
  return compliance_by(other, &Propagator::compliances);
}

ContactCompliance SlidingPoint::compliance_ahead(const SlidingPoint& other) const {
  return compliance_by(other, &Propagator::ahead_compliances);
}

double SlidingPoint::sliding_compliance(const SlidingPoint& other, double friction) const {
  if (this == &other && slave_ != master_ && undeformed_.stencil.count == 2) {
    return sliding_through_both(
        block_of(*slave_, slave_port_, slave_port_), static_cast<std::size_t>(slave_->num_ports()),
        block_of(*master_, master_port_, master_port_),
        static_cast<std::size_t>(master_->num_ports()), normal_, tangent_, friction);
  }
  double sum = 0.0;
  for_shared_bodies(other, [&](const Propagator& body, const Entries& a, const Entries& b) {
    sum += sliding_through(block_of(body, a.port, b.port),
                           static_cast<std::size_t>(body.num_ports()), a, b, friction);
  });
  return sum;
}

void SlidingPoint::apply(double normal, double tangential, double* slave_forces,
                         double* master_forces) const {
  double* const slave = slave_forces + slave_port_;
  double* const master = master_forces + master_port_;
  set_force(normal, normal_.slave.data(), tangential, tangent_.slave.data(), slave);
  for_nodes(undeformed_, [&](std::size_t k) STRIDOR_INLINE_LAMBDA {
    set_force(normal, normal_.master.data() + 2 * k, tangential, tangent_.master.data() + 2 * k,
              master + 2 * k);
  });
}

std::array<PortBlock, 2> SlidingPoint::blocks() const {
  std::array<PortBlock, 2> blocks;
  const auto set = [](PortBlock& block, const Propagator& body, int port, int count,
                      const double* normal, const double* tangent) {
    block.body = &body;
    block.count = count;
    for (int k = 0; k < count; ++k) {
      block.ports[static_cast<std::size_t>(k)] = port + k;
      block.sense(k, 0) = normal[k];
      block.sense(k, 1) = -tangent[k];
    }
    block.push = block.sense;
  };
  set(blocks[0], *master_, master_port_, 2 * undeformed_.stencil.count, normal_.master.data(),
      tangent_.master.data());
  set(blocks[1], *slave_, slave_port_, 2, normal_.slave.data(), tangent_.slave.data());
  return blocks;
}

void SlidingPoint::restore(int segment, double xi, const Eigen::Vector2d& tangent) {
  enter(segment);
  projection_ = {xi, tangent, turned_left(tangent), weights_at(undeformed_.stencil, xi).value};
  set_rows();
}

}  // namespace stridor
