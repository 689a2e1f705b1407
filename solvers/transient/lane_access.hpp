// Where the state of a simulation goes in the lanes of a batch.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <vector>

#include "solvers/algebra/ports.hpp"
#include "solvers/integrators/modal_recurrence.hpp"
#include "solvers/transient/lane_kernel.hpp"
#include "solvers/transient/simulation_implementation.hpp"

namespace stridor {

/// Copies the state of bodies and contacts of a simulation into a batch, and back.
struct LaneAccess {
  using Run = Simulation::Implementation;

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

}  // namespace stridor
