#include "solvers/contact/face_compliance.hpp"

#include <algorithm>
#include <span>

#include "core/clones.hpp"
#include "solvers/algebra/ports.hpp"

namespace stridor {
namespace {

using Row = std::array<double, 4>;

/// Compliances of a body, column after column.
struct BodyAnswers {
  const double* at_once;
  const double* ahead;
  std::size_t stride;
};

STRIDOR_INLINE Ports4 four(const Row& row) {
  Ports4 all;
  __builtin_memcpy(&all, row.data(), sizeof all);
  return all;
}

/// Adds sᵀ W p of two contacts to three columns, of which each has the rows of the one.
/// @param W    at their first ports
/// @param size number of ports of each, or the same known to the compiler
template <class SizeTo, class SizeFrom>
STRIDOR_INLINE void add_seen(SizeTo num_to, SizeFrom num_from, const double* W, std::size_t stride,
                             const Row* sense, const Row* push, Ports4 (&columns)[3]) {
  for (std::size_t i = 0; i < num_to; ++i) {
    Ports4 moved = W[i] * four(push[0]);
    for (std::size_t j = 1; j < num_from; ++j) moved += W[j * stride + i] * four(push[j]);
    const Ports4 seen = four(sense[i]);
    columns[0] += seen * moved[0];
    columns[1] += seen * moved[1];
    columns[2] += seen * moved[2];
  }
}

template <class SizeTo, class SizeFrom>
STRIDOR_INLINE void add_pair(SizeTo num_to, SizeFrom num_from, const FaceDirections& to,
                             const FaceSide& on, const FaceDirections& from, const FaceSide& by,
                             const BodyAnswers& body, double* block, std::size_t outer) {
  const std::size_t place = by.port * body.stride + on.port;
  const Row* const push = from.push.data() + by.first;
  Ports4 columns[3]{};
  if (to.seeks_at_once)
    add_seen(num_to, num_from, body.at_once + place, body.stride, to.at_once.data() + on.first,
             push, columns);
  if (to.seeks_ahead)
    add_seen(num_to, num_from, body.ahead + place, body.stride, to.ahead.data() + on.first, push,
             columns);
  for (std::size_t c = 0; c < 3; ++c) {
    double* const rows = block + c * outer;
    rows[0] += columns[c][0];
    rows[1] += columns[c][1];
    rows[2] += columns[c][2];
  }
}

/// All pairs of contacts on a body.
/// @param delassus three rows and columns of every contact, `outer` from column to column
STRIDOR_CLONES
void add_pairs(std::span<const FaceDirections> contacts, std::span<const FaceSide> sides,
               const BodyAnswers& body, double* delassus, std::size_t outer) {
  constexpr std::size_t master = num_face_rows;
  constexpr std::size_t slave = num_face_ports - num_face_rows;
  for (const FaceSide& by : sides) {
    for (const FaceSide& on : sides) {
      const FaceDirections& to = contacts[on.contact];
      const FaceDirections& from = contacts[by.contact];
      double* const block = delassus + 3 * by.contact * outer + 3 * on.contact;
      if (on.count == master && by.count == master) {
        add_pair(FixedSize<master>{}, FixedSize<master>{}, to, on, from, by, body, block, outer);
      } else if (on.count == slave && by.count == slave) {
        add_pair(FixedSize<slave>{}, FixedSize<slave>{}, to, on, from, by, body, block, outer);
      } else {
        add_pair(on.count, by.count, to, on, from, by, body, block, outer);
      }
    }
  }
}

}  // namespace

void FaceCompliances::add(const Propagator& slave, const Propagator& master, int slave_port,
                          int master_port, int num_slave_ports, int num_master_ports) {
  const std::size_t contact = directions_.size();
  directions_.emplace_back();
  sense_.emplace_back(Directions::Zero(num_master_ports + 3, 3));
  const auto num_rows = static_cast<std::size_t>(num_master_ports);
  if (num_rows > 0)
    add_side(master, {contact, 0, static_cast<std::size_t>(master_port), num_rows});
  add_side(slave, {contact, num_rows, static_cast<std::size_t>(slave_port),
                   static_cast<std::size_t>(num_slave_ports)});
}

void FaceCompliances::add_side(const Propagator& body, const FaceSide& side) {
  auto found = std::find_if(bodies_.begin(), bodies_.end(),
                            [&](const Body& one) { return one.propagator == &body; });
  if (found == bodies_.end()) found = bodies_.insert(found, Body{&body, {}, 0});
  found->sides.push_back(side);
}

void FaceCompliances::direct(std::size_t contact, const Directions& sense,
                             const Directions& push) {
  sense_[contact] = sense;
  FaceDirections& of = directions_[contact];
  const FaceDirections before = of;
  for (Eigen::Index i = 0; i < sense.rows(); ++i) {
    const auto port = static_cast<std::size_t>(i);
    of.at_once[port] = {sense(i, 0), sense(i, 1), sense(i, 2), 0.0};
    of.push[port] = {push(i, 0), push(i, 1), push(i, 2), 0.0};
  }
  of.seeks_at_once = true;
  of.seeks_ahead = false;
  has_changed_ = has_changed_ || before.seeks_ahead || before.at_once != of.at_once ||
                 before.push != of.push;
}

void FaceCompliances::seek(std::size_t contact, bool gap_ahead, bool slip_ahead) {
  FaceDirections& of = directions_[contact];
  const Directions& sense = sense_[contact];
  for (Eigen::Index i = 0; i < sense.rows(); ++i) {
    const auto port = static_cast<std::size_t>(i);
    const Row all = {sense(i, 0), sense(i, 1), sense(i, 2), 0.0};
    for (std::size_t r = 0; r < 3; ++r) {
      const bool is_ahead = r == 0 ? gap_ahead : slip_ahead;
      of.at_once[port][r] = is_ahead ? 0.0 : all[r];
      of.ahead[port][r] = is_ahead ? all[r] : 0.0;
    }
  }
  has_changed_ = true;
  of.seeks_at_once = !(gap_ahead && slip_ahead);
  of.seeks_ahead = gap_ahead || slip_ahead;
}

bool FaceCompliances::fill(Eigen::Ref<Eigen::MatrixXd> delassus) {
  for (Body& body : bodies_) {
    const std::uint64_t version = body.propagator->compliance_version();
    has_changed_ = has_changed_ || version != body.version;
    body.version = version;
  }
  if (!has_changed_) return false;
  has_changed_ = false;
  delassus.setZero();
  for (const Body& body : bodies_) {
    const BodyAnswers answers{body.propagator->compliances(), body.propagator->ahead_compliances(),
                              static_cast<std::size_t>(body.propagator->num_ports())};
    add_pairs(directions_, body.sides, answers, delassus.data(),
              static_cast<std::size_t>(delassus.outerStride()));
  }
  return true;
}

}  // namespace stridor
