#include "solvers/transient/lane_storage.hpp"

namespace stridor {

LaneStorage::LaneStorage(const LaneShape& shape) : width_(num_kernel_lanes()) {
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

std::size_t LaneStorage::assign(double* data) {
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
  for (double** entries : {&contact.origin, &contact.end, &contact.tangent, &contact.found_tangent})
    take(*entries, 2);
  for (double** entries :
       {&contact.length, &contact.friction, &contact.xi, &contact.force, &contact.friction_force,
        &contact.slip_velocity, &contact.force_min, &contact.force_max, &contact.friction_min,
        &contact.friction_max, &contact.driven_displacement, &contact.driven_rate,
        &contact.driven_from, &contact.sliding_velocity, &lanes_.step, &lanes_.index,
        &lanes_.is_used, &flagged_})
    take(*entries, 1);
  take(lanes_.trace, max_traced);
  return used;
}

}  // namespace stridor
