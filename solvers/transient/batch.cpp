#include "solvers/transient/batch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "solvers/algebra/aligned_array.hpp"
#include "solvers/algebra/ports.hpp"
#include "solvers/integrators/modal_recurrence.hpp"
#include "solvers/transient/lane_kernel.hpp"
#include "solvers/transient/simulation_implementation.hpp"

namespace stridor {

using Run = Simulation::Implementation;

/// Copies the state of bodies and contacts of a simulation into a batch, and back.
struct LaneAccess {
  static ModalRecurrence* modal(Run& run, int body) {
    return dynamic_cast<ModalRecurrence*>(run.bodies[static_cast<std::size_t>(body)].get());
  }
  static std::size_t num_modes(const ModalRecurrence& body) { return body.size_; }
  static bool has_residual(const ModalRecurrence& body) { return body.has_residual(); }
  /// Copies between an entry's lane and a number of the simulation.
  template <bool is_out>
  struct Copy {
    std::size_t lane;
    std::size_t width;
    STRIDOR_INLINE void operator()(double* entries, std::size_t i, double& number) const {
      double& of_lane = entries[i * width + lane];
      if constexpr (is_out) {
        number = of_lane;
      } else {
        of_lane = number;
      }
    }
    STRIDOR_INLINE void operator()(double* entries, std::vector<double>& numbers) const {
      double* const data = numbers.data();
      const std::size_t count = numbers.size();
      for (std::size_t i = 0; i < count; ++i) (*this)(entries, i, data[i]);
    }
    /// A field of all modes.
    STRIDOR_INLINE void operator()(const BodyLanes& lanes, ModalField field,
                                   ModalRecurrence& body) const {
      double* const entries = lanes.fields[static_cast<std::size_t>(field)];
      double* block = body.blocks_.data() + modal_index(0, field);
      for (std::size_t first = 0; first < lanes.num_modes; first += modal_block) {
        const std::size_t count = std::min(modal_block, lanes.num_modes - first);
        for (std::size_t j = 0; j < count; ++j) (*this)(entries, first + j, block[j]);
        block += num_modal_fields * modal_block;
      }
    }
  };
  using Into = Copy<false>;
  using OutOf = Copy<true>;

  /// Variables that a step changes and displacements depend on.
  template <bool is_out>
  static void copy_place(const Copy<is_out>& copy, const BodyLanes& lanes, ModalRecurrence& body,
                         std::vector<double>& forces) {
    copy(lanes, ModalField::position, body);
    copy(lanes.current, body.current_);
    copy(lanes.forces, forces);
    if (!body.has_feedthrough()) return;
    // After a step everything has responded to the last forces.
    if constexpr (is_out) copy(lanes.forces, body.acting_.forces);
    if (body.has_residual()) copy(lanes.lagging, body.lagging_.forces);
  }
  /// Other variables that a step changes.
  template <bool is_out>
  static void copy_rest(const Copy<is_out>& copy, const BodyLanes& lanes, ModalRecurrence& body) {
    copy(lanes, ModalField::increment, body);
    copy(lanes.predicted, body.predicted_);
    copy(lanes.increment, body.increment_);
    if (!body.has_feedthrough()) return;
    copy(lanes.expected, body.expected_);
    copy(lanes.answer, body.answer_);
  }

  /// Constants of a step.
  static void copy_constants(const Into& copy, const BodyLanes& lanes, ModalRecurrence& body) {
    for (const ModalField field :
         {ModalField::keep, ModalField::pull, ModalField::gain, ModalField::load})
      copy(lanes, field, body);
    for (std::size_t m = 0; m < body.size_; ++m) {
      for (std::size_t s = 0; s < lanes.num_ports; ++s) {
        double entry = body.port_rows_[s][m];
        copy(lanes.rows, m * lanes.num_ports + s, entry);
      }
    }
    copy(lanes.compliance, body.compliance_);
    if (!body.has_residual()) return;
    copy(lanes.lag, body.port_lag_);
    copy(lanes.load, body.port_load_);
    copy(lanes.share, 0, body.share_);
  }

  /// Terms of the displacement of a row; zeros without a row.
  static void copy_watched(const Into& copy, const BodyLanes& lanes, ModalRecurrence& body,
                           std::optional<int> row) {
    const auto set = [&](double* entries, std::size_t i, double number) {
      copy(entries, i, number);
    };
    for (std::size_t m = 0; m < lanes.num_modes; ++m)
      set(lanes.watched_row, m, row ? body.row_data(*row)[m] : 0.0);
    // Without direct feedthrough, forces are in the modes already.
    const Propagator::Influence* const influence =
        row && body.has_feedthrough() ? &body.influence_on(*row) : nullptr;
    const bool has_lagging = influence != nullptr && body.has_residual();
    for (std::size_t s = 0; s < lanes.num_ports; ++s) {
      set(lanes.watched_forces, s, influence != nullptr ? influence->modes[s] : 0.0);
      set(lanes.watched_lagging, s, has_lagging ? influence->residual[s] : 0.0);
    }
    set(lanes.watched_load, 0, has_lagging ? body.load_residual(*row) : 0.0);
  }

  static void copy_constants(const Into& copy, const Lanes& lanes, Run& run) {
    const ContactLanes& to = lanes.contact;
    RunningLine& contact = run.lines.front();
    const SlidingPoint& point = contact.sliding;
    const auto set = [&](double* entries, std::size_t i, double number) {
      copy(entries, i, number);
    };
    const Eigen::Vector2d end = point.undeformed_.nodes[1] - point.undeformed_.nodes[0];
    for (Eigen::Index k = 0; k < 2; ++k) {
      const auto i = static_cast<std::size_t>(k);
      set(to.origin, i, point.slave_origin_(k));
      set(to.end, i, end(k));
      set(to.tangent, i, end(k) / end.norm());
    }
    set(to.length, 0, end.norm());
    set(to.friction, 0, contact.rise * contact.point().friction.dynamic_coefficient);
    set(to.driven_displacement, 0, contact.driven.end_displacement());
    set(to.driven_rate, 0, contact.driven.end_rate());
    set(to.driven_from, 0, contact.driven.constant_from());
    set(to.sliding_velocity, 0, contact.driven.end_velocity());
    set(lanes.step, 0, run.clock.step);
  }

  template <bool is_out>
  static void copy_state(const Copy<is_out>& copy, const Lanes& lanes, Run& run) {
    const ContactLanes& to = lanes.contact;
    RunningLine& contact = run.lines.front();
    Projection& projection = contact.sliding.projection_;
    copy(to.xi, 0, projection.xi);
    copy(to.found_tangent, 0, projection.tangent.x());
    copy(to.found_tangent, 1, projection.tangent.y());
    copy(to.force, 0, contact.force);
    copy(to.friction_force, 0, contact.friction_force);
    copy(to.slip_velocity, 0, contact.slip_velocity);
    copy_statistics(copy, lanes, contact);
    if constexpr (!is_out) return;
    contact.state = ContactState::slip;
    projection.normal = turned_left(projection.tangent);
    projection.weights = {1.0 - projection.xi, projection.xi, 0.0, 0.0};
    // The guess that a step by itself starts from.
    run.lines.problems().front().normal = contact.force;
    run.lines.problems().front().tangential = contact.friction_force;
    run.lines.problems().front().state = contact.state;
  }
  static void set_rows(Run& run) { run.lines.front().sliding.set_rows(); }
  template <bool is_out>
  static void copy_statistics(const Copy<is_out>& copy, const Lanes& lanes, RunningLine& contact) {
    copy(lanes.contact.force_min, 0, contact.statistics.force_min);
    copy(lanes.contact.force_max, 0, contact.statistics.force_max);
    copy(lanes.contact.friction_min, 0, contact.statistics.friction_min);
    copy(lanes.contact.friction_max, 0, contact.statistics.friction_max);
  }
};

namespace {

/// Sizes common to simulations in the same lanes.
struct Shape {
  bool has_feedthrough;
  ContactAssumption assumption;
  std::size_t slave_modes;
  std::size_t master_modes;
  bool slave_residual;
  bool master_residual;
  auto operator<=>(const Shape&) const = default;
};

std::optional<Shape> shape_of(Run& run) {
  if (run.lines.size() != 1 || run.bodies.size() != 2 || run.ledger) return std::nullopt;
  const RunningLine& contact = run.lines.front();
  const ContactPoint& point = contact.point();
  const MasterSurface& surface = contact.sliding.surface();
  if (!run.slides_only || point.substrate || point.penalty ||
      point.friction.sliding || surface.stencil_size() != 2 ||
      !surface.roughness.is_smooth() || point.slave_body == surface.body) {
    return std::nullopt;
  }
  const ModalRecurrence* const slave = LaneAccess::modal(run, point.slave_body);
  const ModalRecurrence* const master = LaneAccess::modal(run, surface.body);
  if (slave == nullptr || master == nullptr) return std::nullopt;
  return Shape{run.clock.has_feedthrough,        point.assumption,
               LaneAccess::num_modes(*slave),    LaneAccess::num_modes(*master),
               LaneAccess::has_residual(*slave), LaneAccess::has_residual(*master)};
}

/// Steps from `index` on in which load, drive, friction and damping do not change: the number of
/// the first one that does, `index` itself where they change in the step from there.
std::int64_t quiet_until(const Run& run, std::int64_t index) {
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

/// Simulations of one shape, as many as a vector holds.
class LaneGroup {
 public:
  explicit LaneGroup(const Shape& shape) : width_(num_kernel_lanes()) {
    lanes_.has_feedthrough = shape.has_feedthrough;
    lanes_.assumption = shape.assumption;
    lanes_.slave = {
        .num_modes = shape.slave_modes, .num_ports = 2, .has_residual = shape.slave_residual};
    lanes_.master = {
        .num_modes = shape.master_modes, .num_ports = 4, .has_residual = shape.master_residual};
    // Once to count, once to hand out.
    assign(nullptr);
    numbers_ = AlignedArray(assign(nullptr));
    assign(numbers_.data());
  }

  bool is_full() const { return members_.size() == width_; }
  void add(Simulation& simulation) {
    Run& run = simulation.implementation();
    const RunningLine& contact = run.lines.front();
    const int slave = contact.point().slave_body;
    const int master = contact.sliding.surface().body;
    members_.push_back({&simulation, &run, LaneAccess::modal(run, slave),
                        LaneAccess::modal(run, master),
                        &run.forces[static_cast<std::size_t>(slave)],
                        &run.forces[static_cast<std::size_t>(master)]});
  }
  StepOutcome outcome(std::size_t lane) const { return members_[lane].outcome; }

  void watch(std::size_t lane, DisplacementSink& sink, DisplacementSink::Row row) {
    Member& member = members_[lane];
    if (sink.next_step() <= member.run->clock.index)
      throw std::invalid_argument("Batch: a sample is due before the next step");
    put_back(lane);
    member.is_resident = false;
    const RunningLine& contact = member.run->lines.front();
    const bool is_slave = row.body == contact.point().slave_body;
    (is_slave ? member.slave_row : member.master_row) = row.row;
    (is_slave ? lanes_.slave : lanes_.master).is_watched = true;
    member.sink = &sink;
    member.row = row;
    member.next_sample = sink.next_step();
  }

  void step_until(std::int64_t target) {
    for (std::size_t lane = 0; lane < members_.size(); ++lane) {
      if (members_[lane].is_resident)
        LaneAccess::copy_statistics(into(lane), lanes_, members_[lane].run->lines.front());
    }
    while (true) {
      std::int64_t num_steps = std::numeric_limits<std::int64_t>::max();
      for (std::size_t lane = 0; lane < members_.size(); ++lane) {
        lanes_.is_used[lane] = 0.0;
        Member& member = members_[lane];
        step_until_quiet(lane, target);
        if (!member.is_running(target)) continue;
        const std::int64_t until =
            std::min(target, quiet_until(*member.run, member.run->clock.index));
        num_steps = std::min(num_steps, until - member.run->clock.index);
        lanes_.is_used[lane] = 1.0;
      }
      if (num_steps == std::numeric_limits<std::int64_t>::max()) break;
      for (std::size_t lane = 0; lane < members_.size(); ++lane) {
        Member& member = members_[lane];
        if (lanes_.is_used[lane] == 0.0) {
          put_back(lane);
          member.is_resident = false;
        } else if (!member.is_resident) {
          take_in(lane);
        }
      }
      step(num_steps);
    }
    for (std::size_t lane = 0; lane < members_.size(); ++lane) {
      Member& member = members_[lane];
      if (member.is_resident) copy_place(out_of(lane), member);
      if (member.outcome == StepOutcome::done &&
          member.run->clock.index >= member.run->next_health_check) {
        put_back(lane);
        member.outcome = member.run->check_health();
      }
    }
  }

  void synchronise() {
    for (std::size_t lane = 0; lane < members_.size(); ++lane) put_back(lane);
  }

 private:
  struct Member {
    Simulation* simulation;
    Run* run;
    ModalRecurrence* slave;
    ModalRecurrence* master;
    std::vector<double>* slave_forces;
    std::vector<double>* master_forces;
    StepOutcome outcome = StepOutcome::done;
    bool is_resident = false;  ///< its state is in the lanes

    DisplacementSink* sink = nullptr;
    DisplacementSink::Row row{};
    std::optional<int> slave_row{};  ///< row that is watched
    std::optional<int> master_row{};
    std::int64_t next_sample = std::numeric_limits<std::int64_t>::max();

    void sample(double displacement) {
      sink->sample_displacement(displacement);
      next_sample = sink->next_step();
    }
    /// For simulations whose last step was done outside the lanes.
    void sample_where_due() {
      if (outcome == StepOutcome::done && run->clock.index == next_sample)
        sample(simulation->displacement(row.body, row.row));
    }

    bool is_running(std::int64_t target) const {
      return outcome == StepOutcome::done && run->clock.index < target;
    }
  };

  /// Gives every array its place from `data` on. @return numbers needed
  std::size_t assign(double* data) {
    std::size_t used = 0;
    const auto take = [&](double*& entries, std::size_t count) {
      entries = data == nullptr ? nullptr : data + used;
      used += count * width_;
      used = (used + 7) / 8 * 8;  // whole cache lines
    };
    for (BodyLanes* body : {&lanes_.slave, &lanes_.master}) {
      for (double*& field : body->fields) take(field, body->num_modes);
      take(body->rows, body->num_modes * body->num_ports);
      for (double** matrix : {&body->compliance, &body->lag})
        take(*matrix, body->num_ports * body->num_ports);
      take(body->share, 1);
      for (double** entries : {&body->load, &body->predicted, &body->expected, &body->current,
                               &body->increment, &body->answer, &body->lagging, &body->forces,
                               &body->watched_forces, &body->watched_lagging})
        take(*entries, body->num_ports);
      take(body->watched_row, body->num_modes);
      take(body->watched_load, 1);
    }
    ContactLanes& contact = lanes_.contact;
    for (double** entries :
         {&contact.origin, &contact.end, &contact.tangent, &contact.found_tangent})
      take(*entries, 2);
    for (double** entries :
         {&contact.length, &contact.friction, &contact.xi, &contact.force,
          &contact.friction_force, &contact.slip_velocity, &contact.force_min, &contact.force_max,
          &contact.friction_min, &contact.friction_max, &contact.driven_displacement,
          &contact.driven_rate, &contact.driven_from, &contact.sliding_velocity, &lanes_.step,
          &lanes_.index, &lanes_.is_used, &flagged_})
      take(*entries, 1);
    take(lanes_.trace, max_traced);
    return used;
  }

  LaneAccess::Into into(std::size_t lane) const { return {lane, width_}; }
  LaneAccess::OutOf out_of(std::size_t lane) const { return {lane, width_}; }

  /// By itself, as long as something changes that lanes take for constant.
  void step_until_quiet(std::size_t lane, std::int64_t target) {
    Member& member = members_[lane];
    while (member.is_running(target)) {
      const bool is_settled =
          quiet_until(*member.run, member.run->clock.index) > member.run->clock.index &&
          member.run->lines.front().state == ContactState::slip;
      if (is_settled) return;
      put_back(lane);
      member.is_resident = false;
      member.outcome = member.simulation->step();
      member.sample_where_due();
    }
  }

  template <class Copy>
  void copy_place(const Copy& copy, Member& member) {
    LaneAccess::copy_place(copy, lanes_.slave, *member.slave, *member.slave_forces);
    LaneAccess::copy_place(copy, lanes_.master, *member.master, *member.master_forces);
    LaneAccess::copy_state(copy, lanes_, *member.run);
  }
  template <class Copy>
  void copy_rest(const Copy& copy, Member& member) {
    LaneAccess::copy_rest(copy, lanes_.slave, *member.slave);
    LaneAccess::copy_rest(copy, lanes_.master, *member.master);
  }

  void take_in(std::size_t lane) {
    Member& member = members_[lane];
    const LaneAccess::Into copy = into(lane);
    LaneAccess::copy_constants(copy, lanes_.slave, *member.slave);
    LaneAccess::copy_constants(copy, lanes_.master, *member.master);
    LaneAccess::copy_constants(copy, lanes_, *member.run);
    if (lanes_.slave.is_watched)
      LaneAccess::copy_watched(copy, lanes_.slave, *member.slave, member.slave_row);
    if (lanes_.master.is_watched)
      LaneAccess::copy_watched(copy, lanes_.master, *member.master, member.master_row);
    copy_place(copy, member);
    copy_rest(copy, member);
    lanes_.index[lane] = static_cast<double>(member.run->clock.index);
    member.is_resident = true;
  }

  /// The whole state of a lane that holds one.
  void put_back(std::size_t lane) {
    Member& member = members_[lane];
    if (!member.is_resident) return;
    copy_place(out_of(lane), member);
    copy_rest(out_of(lane), member);
    LaneAccess::set_rows(*member.run);
  }

  /// All lanes in use; those that it takes more for than the kernel does end the last step by
  /// themselves.
  void step(std::int64_t num_steps) {
    if (lanes_.slave.is_watched || lanes_.master.is_watched)
      num_steps = std::min(num_steps, static_cast<std::int64_t>(max_traced));
    const std::int64_t done = step_lanes(lanes_, num_steps, flagged_);
    for (std::size_t lane = 0; lane < members_.size(); ++lane) {
      if (lanes_.is_used[lane] == 0.0) continue;
      Member& member = members_[lane];
      Run& run = *member.run;
      const bool is_flagged = flagged_[lane] != 0.0;
      hand_out(lane, is_flagged ? done - 1 : done);
      run.clock.index += done;
      run.lines.front().statistics.steps += is_flagged ? done - 1 : done;
      if (!is_flagged) continue;
      put_back(lane);
      member.is_resident = false;
      member.outcome = run.finish_step();
      member.sample_where_due();
    }
  }

  /// The samples that are due in the next steps, which the kernel has done.
  void hand_out(std::size_t lane, std::int64_t num_steps) {
    Member& member = members_[lane];
    const std::int64_t first = member.run->clock.index + 1;
    while (member.next_sample < first + num_steps) {
      const auto entry = static_cast<std::size_t>(member.next_sample - first);
      member.sample(lanes_.trace[entry * width_ + lane]);
    }
  }

  /// Steps that the kernel does in one call where rows are watched; their data stay in the cache.
  static constexpr std::size_t max_traced = 256;

  std::size_t width_;
  Lanes lanes_;
  AlignedArray numbers_;
  double* flagged_ = nullptr;
  std::vector<Member> members_;
};

}  // namespace

struct Batch::Implementation {
  struct Place {
    std::optional<std::size_t> group;
    std::size_t lane = 0;
    Simulation* alone = nullptr;
    StepOutcome outcome = StepOutcome::done;
  };
  std::vector<LaneGroup> groups;
  std::vector<Place> places;
};

Batch::Batch(std::vector<Simulation*> runs) : implementation_(std::make_unique<Implementation>()) {
  std::vector<std::pair<Shape, std::size_t>> open;  // groups with room
  std::vector<std::size_t> num_members;
  for (Simulation* simulation : runs) {
    Implementation::Place place;
    const std::optional<Shape> shape = shape_of(simulation->implementation());
    if (!shape) {
      place.alone = simulation;
      implementation_->places.push_back(place);
      continue;
    }
    auto found = std::find_if(open.begin(), open.end(),
                              [&](const auto& group) { return group.first == *shape; });
    if (found == open.end()) {
      open.emplace_back(*shape, implementation_->groups.size());
      implementation_->groups.emplace_back(*shape);
      num_members.push_back(0);
      found = std::prev(open.end());
    }
    place.group = found->second;
    place.lane = num_members[found->second]++;
    LaneGroup& group = implementation_->groups[found->second];
    group.add(*simulation);
    if (group.is_full()) open.erase(found);
    implementation_->places.push_back(place);
  }
}

Batch::~Batch() = default;
Batch::Batch(Batch&&) noexcept = default;
Batch& Batch::operator=(Batch&&) noexcept = default;

void Batch::watch(std::size_t run, DisplacementSink& sink) {
  const Implementation::Place& place = implementation_->places.at(run);
  const std::optional<DisplacementSink::Row> row = sink.sole_row();
  if (!place.group || !row)
    throw std::invalid_argument("Batch: only a sole row of what steps in lanes can be watched");
  implementation_->groups[*place.group].watch(place.lane, sink, *row);
}

void Batch::step_until(std::int64_t target) {
  for (LaneGroup& group : implementation_->groups) group.step_until(target);
  for (Implementation::Place& place : implementation_->places) {
    if (place.alone != nullptr && place.outcome == StepOutcome::done)
      place.outcome = place.alone->step_until(target);
  }
}

void Batch::synchronise() {
  for (LaneGroup& group : implementation_->groups) group.synchronise();
}

StepOutcome Batch::outcome(std::size_t run) const {
  const Implementation::Place& place = implementation_->places.at(run);
  return place.group ? implementation_->groups[*place.group].outcome(place.lane) : place.outcome;
}

bool Batch::steps_in_lanes(std::size_t run) const {
  return implementation_->places.at(run).group.has_value();
}

}  // namespace stridor
