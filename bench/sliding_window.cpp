#include "bench/sliding_window.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "solvers/transient/simulation.hpp"

namespace stridor::bench {
namespace {

constexpr double approach_step = 1e-6;  ///< s

/// Takes the rate of the gap out of the velocities.
void close_gap_rate(System& system) {
  const ContactPoint& contact = system.contacts[0];
  const MasterSurface& surface = system.surfaces[0];
  SystemBody& slave = system.bodies[static_cast<std::size_t>(contact.slave_body)];
  SystemBody& master = system.bodies[static_cast<std::size_t>(surface.body)];
  const auto segment = static_cast<std::size_t>(contact.first_segment);
  const PointRows rows[] = {contact.slave_rows, surface.rows[segment], surface.rows[segment + 1]};
  const auto pick = [&](int point) {
    const Eigen::MatrixXd& all = (point == 0 ? slave : master).reduced.rows;
    Eigen::Matrix<double, 2, Eigen::Dynamic> two(2, all.cols());
    two << all.row(rows[point].x), all.row(rows[point].y);
    return two;
  };
  const auto c = pick(0);
  const auto first = pick(1);
  const auto second = pick(2);
  const SlidingFrame frame =
      sliding_frame(contact, surface, contact.first_segment, c * slave.initial_displacement,
                    first * master.initial_displacement, second * master.initial_displacement);
  const auto on_master = ((1.0 - frame.xi) * first + frame.xi * second).eval();
  Eigen::Vector2d rate = c * slave.initial_velocity - on_master * master.initial_velocity;
  rate.x() += system.drives[0].velocity.value(0.0);
  const Eigen::Vector2d force = frame.normal - contact.friction.dynamic_coefficient * frame.tangent;
  const Eigen::VectorXd slave_answer = slave.reduced.mass.llt().solve(c.transpose() * force).eval();
  const Eigen::VectorXd master_answer =
      master.reduced.mass.llt().solve(on_master.transpose() * force).eval();
  const double answer = frame.normal.dot(c * slave_answer + on_master * master_answer);
  const double impulse = -frame.normal.dot(rate) / answer;
  slave.initial_velocity += impulse * slave_answer;
  master.initial_velocity -= impulse * master_answer;
}

}  // namespace

SlidingFrame sliding_frame(const ContactPoint& contact, const MasterSurface& surface, int segment,
                           const Eigen::Vector2d& slave, const Eigen::Vector2d& first,
                           const Eigen::Vector2d& second) {
  const Segment ends = surface.undeformed_segment(segment);
  // As seen from the first node: far from the origin the gap would drown in rounding.
  const Eigen::Vector2d span = ends.second - ends.first + (second - first);
  const Eigen::Vector2d arm = contact.slave_position - ends.first + (slave - first);
  const double length = span.norm();
  SlidingFrame frame;
  frame.tangent = span / length;
  frame.normal = {-frame.tangent.y(), frame.tangent.x()};
  frame.xi = frame.tangent.dot(arm) / length;
  frame.gap = frame.normal.dot(arm);
  return frame;
}

SlidingWindow make_sliding_window(const Model& model, ObservedRow observed, double from, double to,
                                  double interval) {
  const System& system = model.system;
  if (system.contacts.size() != 1 || system.surfaces[0].kind != SurfaceKind::polyline ||
      system.contacts[0].assumption != ContactAssumption::subs_b) {
    throw std::runtime_error("make_sliding_window: takes one contact, Subs-b, on a polyline");
  }
  TimeParameters time;
  time.integrator = Integrator::exact;
  time.step = approach_step;
  const auto last = static_cast<std::int64_t>(std::llround(from / time.step));
  Simulation simulation(system, time);
  const auto displacements_at = [&](std::int64_t step) {
    if (simulation.step_until(step) != StepOutcome::done)
      throw std::runtime_error("make_sliding_window: " + simulation.failure());
    std::vector<Eigen::VectorXd> all;
    for (std::size_t b = 0; b < system.bodies.size(); ++b)
      all.push_back(simulation.reduced_motion(static_cast<int>(b)).displacement);
    return all;
  };
  const auto before = displacements_at(last - 1);
  const auto now = displacements_at(last);
  const double position = simulation.contact_place(0).position;
  const auto after = displacements_at(last + 1);

  SlidingWindow window{system, observed, interval,
                       static_cast<std::int64_t>(std::llround((to - from) / interval))};
  Drive& drive = window.system.drives[0];
  ContactPoint& contact = window.system.contacts[0];
  contact.slave_position.x() += drive.displacement(from);
  contact.friction_rise = TimeCurve(contact.friction_rise.value(from));
  const std::vector<double>& arcs = window.system.surfaces[0].arc_length;
  contact.first_segment =
      static_cast<int>(std::upper_bound(arcs.begin(), arcs.end(), position) - arcs.begin()) - 1;
  drive.velocity = TimeCurve(drive.velocity.value(from));
  drive.load = TimeCurve(drive.load.value(from));
  for (std::size_t b = 0; b < window.system.bodies.size(); ++b) {
    SystemBody& body = window.system.bodies[b];
    const RayleighDamping damping{
        body.reduced.damping.alpha_at(from), body.reduced.damping.beta, {}, 0.0, 0.0};
    body.reduced.damping = damping;
    body.modal.damping = damping;
    body.initial_displacement = now[b];
    body.initial_velocity = (after[b] - before[b]) / (2.0 * time.step);
  }
  close_gap_rate(window.system);
  return window;
}

ModalStart modal_start(const SystemBody& body) {
  // ΦᵀMΦ = I, so ΦᵀM takes reduced coordinates to modal ones.
  const Eigen::MatrixXd to_modal = body.modal.shapes.transpose() * body.reduced.mass;
  if (body.initial_displacement.size() == 0) {
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(body.modal.size());
    return {zero, zero};
  }
  return {to_modal * body.initial_displacement, to_modal * body.initial_velocity};
}

}  // namespace stridor::bench
