#include "solvers/transient/lane_group.hpp"

#include <algorithm>
#include <stdexcept>

namespace stridor {
namespace {

/// Steps from `index` on in which load, drive, friction and damping do not change: the number of
/// the first one that does, `index` itself where they change in the step from there.
std::int64_t quiet_until(const Simulation::Implementation& run, std::int64_t index) {
  const double now = run.clock.time(index);
  if (now < run.loads_constant_from || now < run.lines.front().constant_from) return index;
  std::int64_t last = std::numeric_limits<std::int64_t>::max();
  for (const RayleighDamping& damping : run.damping) {
    if (now >= damping.constant_from()) continue;
    auto until = static_cast<std::int64_t>(damping.hold / run.clock.step) + 1;
    while (until > index && run.clock.time(until) > damping.hold) --until;
    last = std::min(last, std::max(until, index));
  }
  return last;
}

}  // namespace

std::optional<LaneShape> lane_shape_of(Simulation::Implementation& run) {
  if (run.lines.size() != 1 || run.bodies.size() != 2 || run.ledger) return std::nullopt;
  const RunningLine& contact = run.lines.front();
  const ContactPoint& point = contact.point();
  const MasterSurface& surface = contact.sliding.surface();
  if (!run.slides_only || point.substrate || point.penalty || point.friction.sliding ||
      surface.stencil_size() != 2 || !surface.roughness.is_smooth() ||
      point.slave_body == surface.body) {
    return std::nullopt;
  }
  const ModalRecurrence* const slave = LaneAccess::modal(run, point.slave_body);
  const ModalRecurrence* const master = LaneAccess::modal(run, surface.body);
  if (slave == nullptr || master == nullptr) return std::nullopt;
  return LaneShape{run.clock.has_feedthrough,        point.assumption,
                   LaneAccess::num_modes(*slave),    LaneAccess::num_modes(*master),
                   LaneAccess::has_residual(*slave), LaneAccess::has_residual(*master)};
}

LaneMember::LaneMember(Simulation& given) : simulation(&given), run(&given.implementation()) {
  const int slave_body = contact().point().slave_body;
  const int master_body = contact().sliding.surface().body;
  slave = LaneAccess::modal(*run, slave_body);
  master = LaneAccess::modal(*run, master_body);
  slave_forces = &run->forces[static_cast<std::size_t>(slave_body)];
  master_forces = &run->forces[static_cast<std::size_t>(master_body)];
}

void LaneGroup::watch(std::size_t lane, DisplacementSink& sink, DisplacementSink::Row row) {
  LaneMember& member = members_[lane];
  if (sink.next_step() <= member.index())
    throw std::invalid_argument("Batch: a sample is due before the next step");
  release(lane);
  const bool is_slave = row.body == member.contact().point().slave_body;
  (is_slave ? member.slave_row : member.master_row) = row.row;
  (is_slave ? storage_.lanes().slave : storage_.lanes().master).is_watched = true;
  member.sink = &sink;
  member.row = row;
  member.next_sample = sink.next_step();
}

void LaneGroup::step_until(std::int64_t target) {
  for (std::size_t lane = 0; lane < members_.size(); ++lane) {
    if (members_[lane].is_resident)
      LaneAccess::copy_statistics(into(lane), storage_.lanes(), members_[lane].contact());
  }
  while (const std::optional<std::int64_t> num_steps = use_lanes(target)) {
    for (std::size_t lane = 0; lane < members_.size(); ++lane) {
      if (storage_.lanes().is_used[lane] == 0.0) {
        release(lane);
      } else if (!members_[lane].is_resident) {
        take_in(lane);
      }
    }
    step(*num_steps);
  }
  for (std::size_t lane = 0; lane < members_.size(); ++lane) {
    LaneMember& member = members_[lane];
    if (member.is_resident) copy_place(out_of(lane), member);
    if (member.outcome == StepOutcome::done && member.index() >= member.run->next_health_check) {
      put_back(lane);
      member.outcome = member.run->check_health();
    }
  }
}

std::optional<std::int64_t> LaneGroup::use_lanes(std::int64_t target) {
  std::optional<std::int64_t> num_steps;
  for (std::size_t lane = 0; lane < members_.size(); ++lane) {
    double& is_used = storage_.lanes().is_used[lane];
    is_used = 0.0;
    LaneMember& member = members_[lane];
    step_until_quiet(lane, target);
    if (!member.is_running(target)) continue;
    const std::int64_t until = std::min(target, quiet_until(*member.run, member.index()));
    num_steps = std::min(num_steps.value_or(std::numeric_limits<std::int64_t>::max()),
                         until - member.index());
    is_used = 1.0;
  }
  return num_steps;
}

void LaneGroup::step_until_quiet(std::size_t lane, std::int64_t target) {
  LaneMember& member = members_[lane];
  while (member.is_running(target)) {
    const bool is_settled = quiet_until(*member.run, member.index()) > member.index() &&
                            member.contact().state == ContactState::slip;
    if (is_settled) return;
    release(lane);
    member.outcome = member.simulation->step();
    member.sample_where_due();
  }
}

template <class Copy>
void LaneGroup::copy_place(const Copy& copy, LaneMember& member) {
  const Lanes& lanes = storage_.lanes();
  LaneAccess::copy_place(copy, lanes.slave, *member.slave, *member.slave_forces);
  LaneAccess::copy_place(copy, lanes.master, *member.master, *member.master_forces);
  LaneAccess::copy_state(copy, lanes, *member.run);
}
template <class Copy>
void LaneGroup::copy_rest(const Copy& copy, LaneMember& member) {
  LaneAccess::copy_rest(copy, storage_.lanes().slave, *member.slave);
  LaneAccess::copy_rest(copy, storage_.lanes().master, *member.master);
}

void LaneGroup::take_in(std::size_t lane) {
  LaneMember& member = members_[lane];
  const Lanes& lanes = storage_.lanes();
  const LaneAccess::Into copy = into(lane);
  LaneAccess::copy_constants(copy, lanes.slave, *member.slave);
  LaneAccess::copy_constants(copy, lanes.master, *member.master);
  LaneAccess::copy_constants(copy, lanes, *member.run);
  if (lanes.slave.is_watched)
    LaneAccess::copy_watched(copy, lanes.slave, *member.slave, member.slave_row);
  if (lanes.master.is_watched)
    LaneAccess::copy_watched(copy, lanes.master, *member.master, member.master_row);
  copy_place(copy, member);
  copy_rest(copy, member);
  lanes.index[lane] = static_cast<double>(member.index());
  member.is_resident = true;
}

void LaneGroup::put_back(std::size_t lane) {
  LaneMember& member = members_[lane];
  if (!member.is_resident) return;
  copy_place(out_of(lane), member);
  copy_rest(out_of(lane), member);
  LaneAccess::set_rows(*member.run);
}

void LaneGroup::step(std::int64_t num_steps) {
  const Lanes& lanes = storage_.lanes();
  if (lanes.slave.is_watched || lanes.master.is_watched)
    num_steps = std::min(num_steps, static_cast<std::int64_t>(LaneStorage::max_traced));
  const std::int64_t done = step_lanes(lanes, num_steps, storage_.flagged());
  for (std::size_t lane = 0; lane < members_.size(); ++lane) {
    if (lanes.is_used[lane] == 0.0) continue;
    LaneMember& member = members_[lane];
    const bool is_flagged = storage_.flagged()[lane] != 0.0;
    const std::int64_t whole = is_flagged ? done - 1 : done;
    hand_out(lane, whole);
    member.run->clock.index += done;
    member.contact().statistics.steps += whole;
    if (!is_flagged) continue;
    release(lane);
    member.outcome = member.run->finish_step();
    member.sample_where_due();
  }
}

void LaneGroup::hand_out(std::size_t lane, std::int64_t num_steps) {
  LaneMember& member = members_[lane];
  const std::int64_t first = member.index() + 1;
  while (member.next_sample < first + num_steps)
    member.sample(storage_.traced(lane, static_cast<std::size_t>(member.next_sample - first)));
}

}  // namespace stridor
