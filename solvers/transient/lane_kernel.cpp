#include "solvers/transient/lane_kernel.hpp"

#include <cmath>

#include "core/processor.hpp"
#include "solvers/algebra/ports.hpp"

namespace stridor {
namespace {

using Lanes2 = double __attribute__((vector_size(16)));
using Lanes4 = double __attribute__((vector_size(32)));
using Lanes8 = double __attribute__((vector_size(64)));

/// Entry i of an array of entries.
template <class V>
STRIDOR_INLINE V& at(double* entries, std::size_t i) {
  return reinterpret_cast<V*>(entries)[i];
}

template <class V>
constexpr std::size_t width = sizeof(V) / sizeof(double);

template <class V>
STRIDOR_INLINE V root_of(const V& square) {
  V root;
  for (std::size_t i = 0; i < width<V>; ++i) root[i] = std::sqrt(square[i]);
  return root;
}

template <class V>
STRIDOR_INLINE bool has_any(const V& mask) {
  bool any = false;
  for (std::size_t i = 0; i < width<V>; ++i) any |= mask[i] != 0.0;
  return any;
}

/// ModalRecurrence::advance_body() and the rest of Propagator::advance().
template <class V, std::size_t num_ports, bool has_feedthrough>
STRIDOR_INLINE void advance_body(const BodyLanes& body) {
  V force[num_ports];
  for (std::size_t s = 0; s < num_ports; ++s) force[s] = at<V>(body.forces, s);
  if constexpr (!has_feedthrough) {
    for (std::size_t s = 0; s < num_ports; ++s) {
      V corrected = at<V>(body.predicted, s);
      for (std::size_t t = 0; t < num_ports; ++t)
        corrected += at<V>(body.compliance, t * num_ports + s) * force[t];
      at<V>(body.increment, s) = corrected - at<V>(body.current, s);
      at<V>(body.current, s) = corrected;
    }
  }
  double* const positions = body.fields[static_cast<std::size_t>(ModalField::position)];
  double* const increments = body.fields[static_cast<std::size_t>(ModalField::increment)];
  double* const keeps = body.fields[static_cast<std::size_t>(ModalField::keep)];
  double* const pulls = body.fields[static_cast<std::size_t>(ModalField::pull)];
  double* const gains = body.fields[static_cast<std::size_t>(ModalField::gain)];
  double* const loads = body.fields[static_cast<std::size_t>(ModalField::load)];
  V seen[num_ports] = {};
  for (std::size_t m = 0; m < body.num_modes; ++m) {
    V row[num_ports];
#pragma GCC unroll 4
    for (std::size_t s = 0; s < num_ports; ++s) row[s] = at<V>(body.rows, m * num_ports + s);
    V modal_force = row[0] * force[0];
#pragma GCC unroll 4
    for (std::size_t s = 1; s < num_ports; ++s) modal_force += row[s] * force[s];
    const V increment = at<V>(increments, m) + at<V>(gains, m) * modal_force;
    const V position = at<V>(positions, m) + increment;
    const V next = at<V>(keeps, m) * increment - (at<V>(pulls, m) * position - at<V>(loads, m));
    at<V>(positions, m) = position;
    at<V>(increments, m) = next;
    const V ahead = has_feedthrough ? position : position + next;
#pragma GCC unroll 4
    for (std::size_t s = 0; s < num_ports; ++s) seen[s] += row[s] * ahead;
  }
  for (std::size_t s = 0; s < num_ports; ++s) {
    V predicted = seen[s];
    if constexpr (has_feedthrough) {
      if (body.has_residual) {
        predicted += at<V>(body.load, s);
        for (std::size_t t = 0; t < num_ports; ++t)
          predicted += at<V>(body.lag, t * num_ports + s) * at<V>(body.lagging, t);
      }
      at<V>(body.expected, s) = predicted + at<V>(body.answer, s);
    }
    at<V>(body.predicted, s) = predicted;
  }
}

/// Propagator::settle(), where `is_taken`.
template <class V, std::size_t num_ports, class Mask>
STRIDOR_INLINE void settle_body(const BodyLanes& body, const V* increment, const V* answer,
                                const V* force, const Mask& is_taken) {
  for (std::size_t s = 0; s < num_ports; ++s) {
    V& current = at<V>(body.current, s);
    current = is_taken ? current + increment[s] : current;
    V& of_port = at<V>(body.increment, s);
    of_port = is_taken ? increment[s] : of_port;
    V& answered = at<V>(body.answer, s);
    answered = is_taken ? answer[s] : answered;
    if (!body.has_residual) continue;
    V& lagging = at<V>(body.lagging, s);
    lagging = is_taken ? lagging + at<V>(body.share, 0) * (force[s] - lagging) : lagging;
  }
}

/// Where the slave is on its segment: the projection, with the tangent and the normal there.
template <class V>
struct LaneProjection {
  V xi, tx, ty, nx, ny;
  V gap;     ///< with the displacements predicted
  V w0, w1;  ///< −w of the two nodes of the master
};

/// SlidingPoint::find() and predicted_gap().
template <class V, bool has_feedthrough>
STRIDOR_INLINE LaneProjection<V> project_contact(const Lanes& lanes) {
  const ContactLanes& c = lanes.contact;
  const BodyLanes& slave = lanes.slave;
  const BodyLanes& master = lanes.master;
  const V one = V{} + 1.0;
  const V h = at<V>(lanes.step, 0);
  const V sought = (has_feedthrough ? at<V>(lanes.index, 0) : at<V>(lanes.index, 0) + 1.0) * h;
  const V driven = at<V>(c.driven_displacement, 0) +
                   at<V>(c.driven_rate, 0) * (sought - at<V>(c.driven_from, 0));

  double* const slave_seen = has_feedthrough ? slave.expected : slave.predicted;
  double* const master_seen = has_feedthrough ? master.expected : master.predicted;
  const V origin_x = at<V>(c.origin, 0) + driven;
  const V origin_y = at<V>(c.origin, 1);
  const V end_x = at<V>(c.end, 0);
  const V end_y = at<V>(c.end, 1);
  const V from_x = origin_x + at<V>(slave_seen, 0) - at<V>(master_seen, 0);
  const V from_y = origin_y + at<V>(slave_seen, 1) - at<V>(master_seen, 1);
  const V along_x = end_x + at<V>(master_seen, 2) - at<V>(master_seen, 0);
  const V along_y = end_y + at<V>(master_seen, 3) - at<V>(master_seen, 1);
  LaneProjection<V> on;
  on.tx = at<V>(c.tangent, 0);
  on.ty = at<V>(c.tangent, 1);
  if (lanes.assumption == ContactAssumption::subs_b) {
    const V inverse_length = one / root_of<V>(along_x * along_x + along_y * along_y);
    on.tx = along_x * inverse_length;
    on.ty = along_y * inverse_length;
    on.xi = (on.tx * from_x + on.ty * from_y) * inverse_length;
  } else if (lanes.assumption == ContactAssumption::subs_c) {
    on.xi = (on.tx * from_x + on.ty * from_y) / (on.tx * along_x + on.ty * along_y);
  } else {
    on.xi = (on.tx * origin_x + on.ty * origin_y) / at<V>(c.length, 0);
  }
  on.nx = -on.ty;
  on.ny = on.tx;
  // Entries n (or t) on the slave, −w n on the two nodes of the master.
  on.w0 = on.xi - one;
  on.w1 = -on.xi;
  on.gap = on.nx * (origin_x + on.w1 * end_x) + on.ny * (origin_y + on.w1 * end_y) +
           on.nx * (at<V>(slave.predicted, 0) + on.w0 * at<V>(master.predicted, 0) +
                    on.w1 * at<V>(master.predicted, 2)) +
           on.ny * (at<V>(slave.predicted, 1) + on.w0 * at<V>(master.predicted, 1) +
                    on.w1 * at<V>(master.predicted, 3));
  return on;
}

/// Forces of a contact on the ports and the response of these, per λ_n or for the whole of it.
template <class V>
struct LaneForces {
  V slave[2], master[4];
  V slave_answer[2], master_answer[4];
};

/// Of a unit λ_n with its friction.
template <class V>
STRIDOR_INLINE LaneForces<V> respond(const Lanes& lanes, const LaneProjection<V>& on,
                                     const V& friction) {
  const BodyLanes& slave = lanes.slave;
  const BodyLanes& master = lanes.master;
  const V pull_x = on.nx - friction * on.tx;
  const V pull_y = on.ny - friction * on.ty;
  LaneForces<V> unit{
      {pull_x, pull_y}, {on.w0 * pull_x, on.w0 * pull_y, on.w1 * pull_x, on.w1 * pull_y}, {}, {}};
  for (std::size_t s = 0; s < 2; ++s) {
    unit.slave_answer[s] =
        at<V>(slave.compliance, s) * pull_x + at<V>(slave.compliance, 2 + s) * pull_y;
  }
  for (std::size_t s = 0; s < 4; ++s) {
    unit.master_answer[s] = at<V>(master.compliance, s) * unit.master[0];
    for (std::size_t t = 1; t < 4; ++t)
      unit.master_answer[s] += at<V>(master.compliance, 4 * t + s) * unit.master[t];
  }
  return unit;
}

/// Enters place and forces of the contact, and counts these, where `is_taken`.
template <class V, class Mask>
STRIDOR_INLINE void take_forces(const Lanes& lanes, const LaneProjection<V>& on, const V& force,
                                const V& friction_force, const LaneForces<V>& forces,
                                const Mask& is_taken) {
  const ContactLanes& c = lanes.contact;
  const auto take = [&](double* entries, std::size_t i, const V& value) STRIDOR_INLINE_LAMBDA {
    V& entry = at<V>(entries, i);
    entry = is_taken ? value : entry;
  };
  take(c.xi, 0, on.xi);
  take(c.found_tangent, 0, on.tx);
  take(c.found_tangent, 1, on.ty);
  const auto extend = [&](double* lowest, double* highest, const V& value) STRIDOR_INLINE_LAMBDA {
    take(lowest, 0, value < at<V>(lowest, 0) ? value : at<V>(lowest, 0));
    take(highest, 0, value > at<V>(highest, 0) ? value : at<V>(highest, 0));
  };
  take(c.force, 0, force);
  take(c.friction_force, 0, friction_force);
  extend(c.force_min, c.force_max, force);
  extend(c.friction_min, c.friction_max, friction_force);
  for (std::size_t s = 0; s < 2; ++s) take(lanes.slave.forces, s, forces.slave[s]);
  for (std::size_t s = 0; s < 4; ++s) take(lanes.master.forces, s, forces.master[s]);
}

/// Simulation::Implementation::solve() of one contact that slides. 1 where it needs another
/// treatment.
template <class V, bool has_feedthrough>
STRIDOR_INLINE V solve_contact(const Lanes& lanes) {
  const ContactLanes& c = lanes.contact;
  const BodyLanes& slave = lanes.slave;
  const BodyLanes& master = lanes.master;
  const V zero = {};
  const V one = zero + 1.0;
  const LaneProjection<V> on = project_contact<V, has_feedthrough>(lanes);
  const V last_slip = at<V>(c.slip_velocity, 0);
  const V friction = last_slip < zero ? -at<V>(c.friction, 0) : at<V>(c.friction, 0);
  LaneForces<V> forces = respond<V>(lanes, on, friction);
  V* const slave_answer = forces.slave_answer;
  V* const master_answer = forces.master_answer;
  const V compliance = on.nx * slave_answer[0] + on.ny * slave_answer[1] +
                       on.w0 * (on.nx * master_answer[0] + on.ny * master_answer[1]) +
                       on.w1 * (on.nx * master_answer[2] + on.ny * master_answer[3]);
  const V force = -on.gap / compliance;

  constexpr double largest = 1e30;
  auto is_allowed = (on.xi >= zero) & (on.xi <= one) & (compliance > zero) & (force >= zero) &
                    (force < zero + largest);
  V slip = last_slip;
  const V driven_velocity = at<V>(c.sliding_velocity, 0) * on.tx;
  for (V& of_port : forces.slave) of_port = force * of_port;
  for (V& of_port : forces.master) of_port = force * of_port;
  V slave_increment[2];
  V master_increment[4];
  if constexpr (has_feedthrough) {
    for (std::size_t s = 0; s < 2; ++s) {
      slave_answer[s] *= force;
      slave_increment[s] = at<V>(slave.predicted, s) + slave_answer[s] - at<V>(slave.current, s);
    }
    for (std::size_t s = 0; s < 4; ++s) {
      master_answer[s] *= force;
      master_increment[s] =
          at<V>(master.predicted, s) + master_answer[s] - at<V>(master.current, s);
    }
    const V moved =
        on.tx * (slave_increment[0] + on.w0 * master_increment[0] + on.w1 * master_increment[2]) +
        on.ty * (slave_increment[1] + on.w0 * master_increment[1] + on.w1 * master_increment[3]);
    slip = moved / at<V>(lanes.step, 0) + driven_velocity;
    is_allowed &= slip * driven_velocity >= zero;
  }
  const auto is_taken = is_allowed & (at<V>(lanes.is_used, 0) > zero);
  take_forces<V>(lanes, on, force, friction * force, forces, is_taken);
  if constexpr (has_feedthrough) {
    settle_body<V, 2>(slave, slave_increment, slave_answer, forces.slave, is_taken);
    settle_body<V, 4>(master, master_increment, master_answer, forces.master, is_taken);
    V& of_lane = at<V>(c.slip_velocity, 0);
    of_lane = is_taken ? slip : of_lane;
  }
  return (is_taken | (at<V>(lanes.is_used, 0) == zero)) ? zero : one;
}

/// The slip velocity that a step of the published kind ends with; 1 where it is against the drive.
template <class V>
STRIDOR_INLINE V update_slip(const Lanes& lanes) {
  const ContactLanes& c = lanes.contact;
  const V zero = {};
  const V tx = at<V>(c.found_tangent, 0);
  const V ty = at<V>(c.found_tangent, 1);
  const V w1 = -at<V>(c.xi, 0);
  const V w0 = -1.0 - w1;
  double* const slave = lanes.slave.increment;
  double* const master = lanes.master.increment;
  const V moved = tx * (at<V>(slave, 0) + w0 * at<V>(master, 0) + w1 * at<V>(master, 2)) +
                  ty * (at<V>(slave, 1) + w0 * at<V>(master, 1) + w1 * at<V>(master, 3));
  const V driven = at<V>(c.sliding_velocity, 0) * tx;
  const V slip = moved / at<V>(lanes.step, 0) + driven;
  at<V>(c.slip_velocity, 0) = slip;
  return ((slip * driven < zero) & (at<V>(lanes.is_used, 0) > zero)) ? zero + 1.0 : zero;
}

/// Propagator::displacement() of the row that is watched.
template <class V, std::size_t num_ports, bool has_feedthrough>
STRIDOR_INLINE V watched_displacement(const BodyLanes& body) {
  V sum = {};
  if (!body.is_watched) return sum;
  double* const positions = body.fields[static_cast<std::size_t>(ModalField::position)];
  for (std::size_t m = 0; m < body.num_modes; ++m)
    sum += at<V>(body.watched_row, m) * at<V>(positions, m);
  if constexpr (has_feedthrough) {
    for (std::size_t s = 0; s < num_ports; ++s)
      sum += at<V>(body.watched_forces, s) * at<V>(body.forces, s);
    if (body.has_residual) {
      sum += at<V>(body.watched_load, 0);
      for (std::size_t s = 0; s < num_ports; ++s)
        sum += at<V>(body.watched_lagging, s) * at<V>(body.lagging, s);
    }
  }
  return sum;
}

/// Notes the rows that are watched after step number `done`.
template <class V, bool has_feedthrough>
STRIDOR_INLINE void watch(const Lanes& lanes, std::int64_t done) {
  if (!lanes.slave.is_watched && !lanes.master.is_watched) return;
  at<V>(lanes.trace, static_cast<std::size_t>(done - 1)) =
      watched_displacement<V, 2, has_feedthrough>(lanes.slave) +
      watched_displacement<V, 4, has_feedthrough>(lanes.master);
}

template <class V, bool has_feedthrough>
STRIDOR_INLINE std::int64_t step(const Lanes& lanes, std::int64_t max_steps, double* flagged) {
  V needs_more = {};
  std::int64_t done = 0;
  while (done < max_steps) {
    advance_body<V, 2, has_feedthrough>(lanes.slave);
    advance_body<V, 4, has_feedthrough>(lanes.master);
    at<V>(lanes.index, 0) += 1.0;
    ++done;
    if constexpr (!has_feedthrough) {
      const V reverses = update_slip<V>(lanes);
      // Such a lane has not got to its contact.
      if (has_any(reverses)) {
        const V used = at<V>(lanes.is_used, 0);
        at<V>(lanes.is_used, 0) = reverses > 0.0 ? V{} : used;
        needs_more = solve_contact<V, has_feedthrough>(lanes) + reverses;
        at<V>(lanes.is_used, 0) = used;
        watch<V, has_feedthrough>(lanes, done);
        break;
      }
    }
    needs_more = solve_contact<V, has_feedthrough>(lanes);
    watch<V, has_feedthrough>(lanes, done);
    if (has_any(needs_more)) break;
  }
  at<V>(flagged, 0) = needs_more;
  return done;
}

template <class V>
STRIDOR_INLINE std::int64_t step_all(const Lanes& lanes, std::int64_t max_steps, double* flagged) {
  return lanes.has_feedthrough ? step<V, true>(lanes, max_steps, flagged)
                         : step<V, false>(lanes, max_steps, flagged);
}

using Step = std::int64_t (*)(const Lanes&, std::int64_t, double*);

std::int64_t step_portable(const Lanes& lanes, std::int64_t max_steps, double* flagged) {
  return step_all<Lanes2>(lanes, max_steps, flagged);
}
#if defined(__x86_64__)
STRIDOR_V3 std::int64_t step_v3(const Lanes& lanes, std::int64_t max_steps, double* flagged) {
  return step_all<Lanes4>(lanes, max_steps, flagged);
}
STRIDOR_V4 std::int64_t step_v4(const Lanes& lanes, std::int64_t max_steps, double* flagged) {
  return step_all<Lanes8>(lanes, max_steps, flagged);
}
#endif

struct Kernel {
  Step step;
  std::size_t num_lanes;
};

Kernel kernel_of_this_processor() {
#if defined(__x86_64__)
  const KernelSet set = kernel_set();
  if (set == KernelSet::v4) return {step_v4, 8};
  if (set == KernelSet::v3) return {step_v3, 4};
#endif
  return {step_portable, 2};
}

const Kernel kernel = kernel_of_this_processor();

}  // namespace

std::size_t num_kernel_lanes() {
  return kernel.num_lanes;
}

std::int64_t step_lanes(const Lanes& lanes, std::int64_t max_steps, double* flagged) {
  return kernel.step(lanes, max_steps, flagged);
}

}  // namespace stridor
