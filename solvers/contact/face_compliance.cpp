#include "solvers/contact/face_compliance.hpp"

#include <algorithm>

#include "core/clones.hpp"
#include "solvers/algebra/ports.hpp"

namespace stridor {
namespace {

using Row = FaceDirections::Row;

STRIDOR_INLINE Ports4 four(const Row& row) {
  Ports4 all;
  __builtin_memcpy(&all, row.data(), sizeof all);
  return all;
}

/// W p of one contact at some ports of its body.
/// @param W     column after column, from the first of these ports on
/// @param moved three columns, likewise
template <class Ports>
STRIDOR_INLINE void move_some(std::size_t num_ports, const double* W, const FaceSide& by,
                              const FaceDirections& from, double* moved) {
  Ports sum[3]{};
  for (std::size_t j = 0; j < by.count; ++j) {
    Ports column;
    __builtin_memcpy(&column, W + by.ports[j] * num_ports, sizeof column);
    const Row& push = from.push[by.first + j];
    for (std::size_t c = 0; c < 3; ++c) sum[c] += push[c] * column;
  }
  for (std::size_t c = 0; c < 3; ++c)
    __builtin_memcpy(moved + c * num_ports, &sum[c], sizeof sum[c]);
}

/// W p of one contact at all ports of its body: three columns, one after the other.
STRIDOR_CLONES
void move_ports(std::size_t num_ports, const double* W, const FaceSide& by,
                const FaceDirections& from, double* moved) {
  constexpr std::size_t lanes = sizeof(Ports8) / sizeof(double);
  std::size_t i = 0;
  for (; i + lanes <= num_ports; i += lanes) move_some<Ports8>(num_ports, W + i, by, from, moved + i);
  if (i == num_ports) return;
  if (num_ports >= lanes) {
    // Some of the ports once more.
    i = num_ports - lanes;
    return move_some<Ports8>(num_ports, W + i, by, from, moved + i);
  }
  for (; i < num_ports; ++i) move_some<Ports1>(num_ports, W + i, by, from, moved + i);
}

/// sᵀ of a contact at its ports times three columns of these.
STRIDOR_INLINE void see(std::size_t num_ports, const double* moved, const FaceSide& on,
                        const FaceDirections& to, Ports4 (&columns)[3]) {
  for (std::size_t i = 0; i < on.count; ++i) {
    const Ports4 sense = four(to.sense[on.first + i]);
    const double* const at = moved + on.ports[i];
    columns[0] += sense * at[0];
    columns[1] += sense * at[num_ports];
    columns[2] += sense * at[2 * num_ports];
  }
}

/// Adds three columns of the contacts on a body.
/// @param moved    of move_ports()
/// @param is_ahead with W of t_{n+1}: of the gaps and slips that are sought there, else of the others
/// @param delassus three rows of every contact, `outer` from column to column
STRIDOR_CLONES
void add_columns(std::span<const FaceCompliances::Contact> contacts,
                 std::span<const FaceSide> sides, std::size_t num_ports, const double* moved,
                 bool is_ahead, double* delassus, std::size_t outer) {
  for (const FaceSide& on : sides) {
    const FaceCompliances::Contact& to = contacts[on.contact];
    const bool takes_gap = to.seeks_gap_ahead == is_ahead;
    const bool takes_slip = to.seeks_slip_ahead == is_ahead;
    if (!takes_gap && !takes_slip) continue;
    Ports4 columns[3]{};
    see(num_ports, moved, on, to.directions, columns);
    for (std::size_t c = 0; c < 3; ++c) {
      double* const rows = delassus + 3 * on.contact + c * outer;
      if (takes_gap) rows[0] += columns[c][0];
      if (!takes_slip) continue;
      rows[1] += columns[c][1];
      rows[2] += columns[c][2];
    }
  }
}

}  // namespace

void FaceCompliances::add(const Propagator& slave, const Propagator& master,
                          std::span<const int> slave_ports, std::span<const int> master_ports) {
  const std::size_t contact = contacts_.size();
  contacts_.emplace_back();
  const auto side_of = [&](std::size_t first, std::span<const int> ports) {
    FaceSide side{contact, first, ports.size(), {}};
    std::copy(ports.begin(), ports.end(), side.ports.begin());
    return side;
  };
  masters_.emplace_back();
  if (!master_ports.empty()) masters_.back() = add_side(master, side_of(0, master_ports));
  add_side(slave, side_of(master_ports.size(), slave_ports));
}

FaceCompliances::Place FaceCompliances::add_side(const Propagator& body, const FaceSide& side) {
  auto found = std::find_if(bodies_.begin(), bodies_.end(),
                            [&](const Body& one) { return one.propagator == &body; });
  if (found == bodies_.end()) found = bodies_.insert(found, Body{&body, {}, 0});
  found->sides.push_back(side);
  return {static_cast<std::size_t>(found - bodies_.begin()), found->sides.size() - 1};
}

void FaceCompliances::direct(std::size_t contact, const FaceDirections& directions,
                             std::span<const int> master_ports) {
  Contact& of = contacts_[contact];
  bool is_new = of.seeks_gap_ahead || of.seeks_slip_ahead;
  of.seeks_gap_ahead = of.seeks_slip_ahead = false;
  of.directions.count = directions.count;
  for (std::size_t i = 0; i < directions.count; ++i) {
    is_new |= of.directions.sense[i] != directions.sense[i] ||
              of.directions.push[i] != directions.push[i];
    of.directions.sense[i] = directions.sense[i];
    of.directions.push[i] = directions.push[i];
  }
  if (!master_ports.empty()) {
    FaceSide& side = bodies_[masters_[contact].body].sides[masters_[contact].side];
    for (std::size_t i = 0; i < master_ports.size(); ++i) {
      const auto port = static_cast<std::size_t>(master_ports[i]);
      is_new |= side.ports[i] != port;
      side.ports[i] = port;
    }
  }
  has_changed_ |= is_new;
}

void FaceCompliances::seek(std::size_t contact, bool gap_ahead, bool slip_ahead) {
  Contact& of = contacts_[contact];
  of.seeks_gap_ahead = gap_ahead;
  of.seeks_slip_ahead = slip_ahead;
  has_changed_ = true;
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
  const auto outer = static_cast<std::size_t>(delassus.outerStride());
  for (const Body& body : bodies_) {
    const auto num_ports = static_cast<std::size_t>(body.propagator->num_ports());
    moved_.resize(3 * num_ports);
    const auto seeks = [&](bool ahead) {
      return std::any_of(body.sides.begin(), body.sides.end(), [&](const FaceSide& side) {
        const Contact& contact = contacts_[side.contact];
        return contact.seeks_gap_ahead == ahead || contact.seeks_slip_ahead == ahead;
      });
    };
    for (const bool is_ahead : {false, true}) {
      if (!seeks(is_ahead)) continue;
      const double* const W =
          is_ahead ? body.propagator->ahead_compliances() : body.propagator->compliances();
      for (const FaceSide& by : body.sides) {
        move_ports(num_ports, W, by, contacts_[by.contact].directions, moved_.data());
        add_columns(contacts_, body.sides, num_ports, moved_.data(), is_ahead,
                    delassus.data() + 3 * by.contact * outer, outer);
      }
    }
  }
  return true;
}

}  // namespace stridor
