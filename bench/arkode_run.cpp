#include "bench/arkode_run.hpp"

#include <arkode/arkode_erkstep.h>
#include <fmt/format.h>
#include <nvector/nvector_serial.h>

#include <cmath>
#include <stdexcept>
#include <utility>

#include "bench/processor_clock.hpp"
#include "bench/sliding_window.hpp"

namespace stridor::bench {
namespace {

/// Kinks and reversals of a run that is no chatter.
constexpr int most_events = 10'000;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

void check(int flag, const char* what) {
  if (flag < 0) throw std::runtime_error(fmt::format("{} failed: {}", what, flag));
}

/// The coupled system as seen by an integrator of ordinary differential equations.
class SlidingPair {
 public:
  SlidingPair(const System& system, double drift_rate) : system_(system), drift_rate_(drift_rate) {
    if (system.contacts.size() != 1 || system.surfaces.size() != 1 ||
        system.surfaces[0].kind != SurfaceKind::polyline ||
        system.contacts[0].assumption != ContactAssumption::subs_b) {
      throw std::runtime_error("run_arkode: takes one contact, Subs-b, on a polyline");
    }
    for (const SystemBody& body : system.bodies) {
      first_.push_back(size_);
      size_ += body.modal.size();
      rows_.push_back(body.modal.rows);
      squares_.emplace_back(body.modal.omega.array().square());
      loads_.emplace_back(body.loads.empty()
                              ? Eigen::VectorXd(Eigen::VectorXd::Zero(body.modal.size()))
                              : Eigen::VectorXd(body.modal.rows.row(body.loads.front().row)));
    }
    segment_ = contact().first_segment;
    enter_segment();
  }

  Eigen::Index size() const { return size_; }
  double& direction() { return direction_; }

  struct Contact {
    double gap_area, rate, force;  ///< G, Ġ, λ
  };

  /// Modal accelerations and what the contact does.
  Contact accelerations(double t, const Eigen::Ref<const Eigen::VectorXd>& q,
                        const Eigen::Ref<const Eigen::VectorXd>& v,
                        Eigen::Ref<Eigen::VectorXd> a) const {
    const double load = system_.drives[0].load.value(t);
    const double drive_acceleration = system_.drives[0].acceleration(t);
    for (std::size_t b = 0; b < system_.bodies.size(); ++b) {
      const SystemBody& body = system_.bodies[b];
      const auto n = body.modal.size();
      const double alpha = body.modal.damping.alpha_at(t);
      const double beta = body.modal.damping.beta;
      const auto velocity = v.segment(first_[b], n).array();
      a.segment(first_[b], n) =
          -alpha * velocity - squares_[b] * (q.segment(first_[b], n).array() + beta * velocity);
      if (!body.follows_drive()) continue;
      a.segment(first_[b], n) += load * loads_[b] - drive_acceleration * body.modal.base_inertia;
    }
    const Frame frame = frame_at(t, q);
    const Points velocity = points(v, system_.drives[0].velocity.value(t));
    const Points free = points(a, drive_acceleration);
    Contact contact;
    const Eigen::Vector2d s_dot = velocity.second - velocity.first;
    const Eigen::Vector2d a_dot = velocity.slave - velocity.first;
    contact.gap_area = cross(frame.s, frame.a);
    contact.rate = cross(s_dot, frame.a) + cross(frame.s, a_dot);
    const Eigen::Vector2d f = force_direction(t, frame);
    const double free_second = cross(free.second - free.first, frame.a) +
                               2.0 * cross(s_dot, a_dot) + cross(frame.s, free.slave - free.first) +
                               2.0 * drift_rate_ * contact.rate +
                               drift_rate_ * drift_rate_ * contact.gap_area;
    contact.force = -free_second / answer(frame, f);
    add_force(frame, contact.force * f, a);
    return contact;
  }

  /// ξ and the slip velocity.
  std::pair<double, double> place_and_slip(double t, const Eigen::Ref<const Eigen::VectorXd>& q,
                                           const Eigen::Ref<const Eigen::VectorXd>& v) const {
    const Frame frame = frame_at(t, q);
    return {frame.xi, slip_of(frame, points(v, system_.drives[0].velocity.value(t)))};
  }

  /// The contact has reached an end of its segment: goes over to the next one, with an impulse.
  void pass_kink(double t, const Eigen::Ref<const Eigen::VectorXd>& q,
                 Eigen::Ref<Eigen::VectorXd> v, int heading) {
    segment_ += heading;
    if (segment_ < 0 || segment_ >= surface().num_segments())
      throw std::runtime_error("run_arkode: the slave has left its master");
    enter_segment();
    const Frame frame = frame_at(t, q);
    const Points velocity = points(v, system_.drives[0].velocity.value(t));
    const double rate = cross(velocity.second - velocity.first, frame.a) +
                        cross(frame.s, velocity.slave - velocity.first);
    const Eigen::Vector2d f = force_direction(t, frame);
    add_force(frame, -rate / answer(frame, f) * f, v);
  }

 private:
  struct Points {
    Eigen::Vector2d slave, first, second;
  };
  struct Frame {
    Eigen::Vector2d s, a, tangent, normal;
    double xi;
  };

  const ContactPoint& contact() const { return system_.contacts[0]; }
  const MasterSurface& surface() const { return system_.surfaces[0]; }

  static double slip_of(const Frame& frame, const Points& velocity) {
    return frame.tangent.dot(velocity.slave - (1.0 - frame.xi) * velocity.first -
                             frame.xi * velocity.second);
  }

  /// Copies the rows of the slave and of both master nodes.
  void enter_segment() {
    const auto slave = static_cast<std::size_t>(contact().slave_body);
    const auto master = static_cast<std::size_t>(surface().body);
    slave_rows_.resize(2, rows_[slave].cols());
    slave_rows_ << rows_[slave].row(contact().slave_rows.x),
        rows_[slave].row(contact().slave_rows.y);
    master_rows_.resize(4, rows_[master].cols());
    for (int k = 0; k < 2; ++k) {
      const PointRows& node = surface().rows[static_cast<std::size_t>(segment_ + k)];
      master_rows_.row(2 * k) = rows_[master].row(node.x);
      master_rows_.row(2 * k + 1) = rows_[master].row(node.y);
    }
    slave_gram_ = slave_rows_ * slave_rows_.transpose();
    master_gram_ = master_rows_ * master_rows_.transpose();
  }

  /// Displacements, velocities or accelerations of the three points.
  Points points(const Eigen::Ref<const Eigen::VectorXd>& x, double drive) const {
    const auto slave = static_cast<std::size_t>(contact().slave_body);
    const auto master = static_cast<std::size_t>(surface().body);
    Points result;
    result.slave = slave_rows_ * x.segment(first_[slave], slave_rows_.cols());
    const Eigen::Vector4d nodes = master_rows_ * x.segment(first_[master], master_rows_.cols());
    result.first = nodes.head<2>();
    result.second = nodes.tail<2>();
    if (system_.bodies[slave].follows_drive()) result.slave.x() += drive;
    if (system_.bodies[master].follows_drive()) {
      result.first.x() += drive;
      result.second.x() += drive;
    }
    return result;
  }

  Frame frame_at(double t, const Eigen::Ref<const Eigen::VectorXd>& q) const {
    const Points u = points(q, system_.drives[0].displacement(t));
    const Eigen::Vector2d& first = surface().positions[static_cast<std::size_t>(segment_)];
    const Eigen::Vector2d& second = surface().positions[static_cast<std::size_t>(segment_) + 1];
    Frame frame;
    frame.s = second - first + (u.second - u.first);
    frame.a = contact().slave_position - first + (u.slave - u.first);
    const double length = frame.s.norm();
    frame.tangent = frame.s / length;
    frame.normal = {-frame.tangent.y(), frame.tangent.x()};
    frame.xi = frame.tangent.dot(frame.a) / length;
    return frame;
  }

  /// On the slave per unit of λ.
  Eigen::Vector2d force_direction(double t, const Frame& frame) const {
    const double mu = contact().friction_rise.value(t) * contact().friction.dynamic_coefficient;
    return frame.normal - direction_ * mu * frame.tangent;
  }

  /// G̈ per unit of λ.
  double answer(const Frame& frame, const Eigen::Vector2d& f) const {
    const Eigen::Vector2d slave = slave_gram_ * f;
    Eigen::Vector4d on_master;
    on_master << -(1.0 - frame.xi) * f, -frame.xi * f;
    const Eigen::Vector4d master = master_gram_ * on_master;
    const Eigen::Vector2d first = master.head<2>();
    const Eigen::Vector2d second = master.tail<2>();
    return cross(second - first, frame.a) + cross(frame.s, slave - first);
  }

  void add_force(const Frame& frame, const Eigen::Vector2d& force,
                 Eigen::Ref<Eigen::VectorXd> a) const {
    const auto slave = static_cast<std::size_t>(contact().slave_body);
    const auto master = static_cast<std::size_t>(surface().body);
    a.segment(first_[slave], slave_rows_.cols()).noalias() += slave_rows_.transpose() * force;
    Eigen::Vector4d on_master;
    on_master << -(1.0 - frame.xi) * force, -frame.xi * force;
    a.segment(first_[master], master_rows_.cols()).noalias() +=
        master_rows_.transpose() * on_master;
  }

  const System& system_;
  Eigen::Index size_ = 0;
  std::vector<Eigen::Index> first_;
  std::vector<Eigen::MatrixXd> rows_;
  std::vector<Eigen::ArrayXd> squares_;  ///< ω²
  std::vector<Eigen::VectorXd> loads_;   ///< per unit of the drive's load
  double drift_rate_;
  int segment_ = 0;
  double direction_ = 1.0;  ///< χ
  Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor> slave_rows_;
  Eigen::Matrix<double, 4, Eigen::Dynamic, Eigen::RowMajor> master_rows_;
  Eigen::Matrix2d slave_gram_;
  Eigen::Matrix4d master_gram_;
};

using Vector = Eigen::Map<Eigen::VectorXd>;

Vector part(N_Vector y, Eigen::Index from, Eigen::Index count) {
  return {N_VGetArrayPointer(y) + from, count};
}

int right_hand_side(realtype t, N_Vector y, N_Vector y_dot, void* user) {
  const auto& pair = *static_cast<SlidingPair*>(user);
  const auto n = pair.size();
  part(y_dot, 0, n) = part(y, n, n);
  Vector acceleration = part(y_dot, n, n);
  pair.accelerations(t, part(y, 0, n), part(y, n, n), acceleration);
  return 0;
}

/// ξ − 1, ξ and the slip velocity.
int root_functions(realtype t, N_Vector y, realtype* roots, void* user) {
  const auto& pair = *static_cast<SlidingPair*>(user);
  const auto n = pair.size();
  const auto [xi, slip] = pair.place_and_slip(t, part(y, 0, n), part(y, n, n));
  roots[0] = xi - 1.0;
  roots[1] = xi;
  roots[2] = slip;
  return 0;
}

}  // namespace

ArkodeResult run_arkode(const System& system, ObservedRow observed, double interval,
                        std::int64_t num_samples, const ArkodeParameters& parameters) {
  const double start = processor_seconds();
  SlidingPair pair(system, parameters.drift_rate);
  const auto n = pair.size();
  Eigen::Index first = 0;
  for (int b = 0; b < observed.body; ++b)
    first += system.bodies[static_cast<std::size_t>(b)].modal.size();
  const Eigen::VectorXd observed_row =
      system.bodies[static_cast<std::size_t>(observed.body)].modal.rows.row(observed.row);

  SUNContext context = nullptr;
  check(SUNContext_Create(nullptr, &context), "SUNContext_Create");
  N_Vector y = N_VNew_Serial(2 * n, context);
  Eigen::Index begin = 0;
  for (const SystemBody& body : system.bodies) {
    const ModalStart motion = modal_start(body);
    part(y, begin, body.modal.size()) = motion.position;
    part(y, n + begin, body.modal.size()) = motion.velocity;
    begin += body.modal.size();
  }
  check(N_VEnableFusedOps_Serial(y, SUNTRUE), "N_VEnableFusedOps");
  N_Vector tolerance = N_VNew_Serial(2 * n, context);
  part(tolerance, 0, n).setConstant(parameters.displacement_tolerance);
  part(tolerance, n, n).setConstant(parameters.velocity_tolerance);
  void* memory = ERKStepCreate(right_hand_side, 0.0, y, context);
  check(ERKStepSetTableNum(memory, parameters.table), "ERKStepSetTableNum");
  check(ERKStepSVtolerances(memory, parameters.relative_tolerance, tolerance), "tolerances");
  if (parameters.fixed_step > 0.0)
    check(ERKStepSetFixedStep(memory, parameters.fixed_step), "ERKStepSetFixedStep");
  check(ERKStepSetUserData(memory, &pair), "ERKStepSetUserData");
  check(ERKStepSetMaxNumSteps(memory, 1'000'000), "ERKStepSetMaxNumSteps");
  check(ERKStepRootInit(memory, 3, root_functions), "ERKStepRootInit");
  check(ERKStepSetNoInactiveRootWarn(memory), "ERKStepSetNoInactiveRootWarn");

  ArkodeResult result;
  result.samples.interval = interval;
  result.samples.forces.resize(1);
  Eigen::VectorXd scratch(n);
  double t = 0.0;
  int events = 0;
  StretchClock clock(num_samples);
  result.setup = processor_seconds() - start;
  for (std::int64_t k = 0; k <= num_samples; ++k) {
    const double target = static_cast<double>(k) * interval;
    while (t < target) {
      check(ERKStepSetStopTime(memory, target), "ERKStepSetStopTime");
      const int flag = ERKStepEvolve(memory, target, y, &t, ARK_NORMAL);
      check(flag, "ERKStepEvolve");
      if (flag != ARK_ROOT_RETURN) continue;
      if (++events > most_events)
        throw std::runtime_error("run_arkode: the contact chatters, the step is not stable");
      int found[3];
      check(ERKStepGetRootInfo(memory, found), "ERKStepGetRootInfo");
      Vector velocity = part(y, n, n);
      if (found[0] > 0 || found[1] < 0) {
        pair.pass_kink(t, part(y, 0, n), velocity, found[0] > 0 ? 1 : -1);
        ++result.kinks;
      }
      if (found[2] != 0) pair.direction() = found[2] > 0 ? 1.0 : -1.0;
      check(ERKStepReset(memory, t, y), "ERKStepReset");
    }
    const SlidingPair::Contact contact =
        pair.accelerations(t, part(y, 0, n), part(y, n, n), scratch);
    if (!(std::abs(contact.force) < 1e6))
      throw std::runtime_error("run_arkode: the motion has diverged, the step is not stable");
    result.samples.forces[0].push_back(contact.force);
    result.samples.displacement.push_back(observed_row.dot(part(y, first, observed_row.size())));
    result.worst_gap = std::max(result.worst_gap, std::abs(contact.gap_area) / 1e-3);
    clock.pass(k);
  }
  long steps = 0;
  long evaluations = 0;
  ERKStepGetNumSteps(memory, &steps);
  ERKStepGetNumRhsEvals(memory, &evaluations);
  result.steps = steps;
  result.evaluations = evaluations;
  ERKStepFree(&memory);
  N_VDestroy(y);
  N_VDestroy(tolerance);
  SUNContext_Free(&context);
  result.seconds = processor_seconds() - start;
  result.stepping = clock.least();
  return result;
}

}  // namespace stridor::bench
