#include "bench/moreau_jean.hpp"

#include <array>
#include <cmath>
#include <stdexcept>

#include "bench/moreau_jean_kernel.hpp"
#include "bench/processor_clock.hpp"
#include "solvers/algebra/aligned_array.hpp"
#include "solvers/contact/contact_solver.hpp"

namespace stridor::bench {
namespace {

/// A body in modes with the displacements and velocities that its contact sees.
template <int num_ports>
class Body {
 public:
  using Ports = Eigen::Matrix<double, num_ports, 1>;

  Body(const SystemBody& body, double load, const MoreauJeanParameters& parameters)
      : all_rows_(body.modal.rows) {
    const double h = parameters.step;
    const double theta = parameters.theta;
    const Eigen::ArrayXd square = body.modal.omega.array().square();
    const Eigen::ArrayXd damping = body.modal.damping.alpha + body.modal.damping.beta * square;
    num_modes_ = square.size();
    for (AlignedArray* field :
         {&answer_, &kept_, &pulled_, &loaded_, &position_, &velocity_, &free_})
      *field = AlignedArray(padded_size());
    modes(answer_) = 1.0 / (1.0 + h * theta * damping + h * h * theta * theta * square);
    modes(kept_) = 1.0 - h * modes(answer_) * (damping + h * theta * square);
    modes(pulled_) = -h * modes(answer_) * square;
    if (!body.loads.empty()) {
      modes(loaded_) =
          h * load * modes(answer_) * body.modal.rows.row(body.loads.front().row).transpose().array();
    }
    const ModalStart start = modal_start(body);
    modes(position_) = start.position;
    modes(velocity_) = start.velocity;
    modes(free_) =
        modes(kept_) * modes(velocity_) + modes(pulled_) * modes(position_) + modes(loaded_);
    shares_[0] = h * theta;
    shares_[1] = h * (1.0 - theta);
  }

  void watch(const std::array<int, num_ports>& ports) {
    Eigen::Matrix<double, Eigen::Dynamic, num_ports> rows(num_modes_, num_ports);
    for (std::size_t j = 0; j < num_ports; ++j) {
      rows.col(static_cast<Eigen::Index>(j)) = all_rows_.row(ports[j]).transpose();
      rows_[j] = AlignedArray(padded_size());
      modes(rows_[j]) = rows.col(static_cast<Eigen::Index>(j));
    }
    compliance_ = rows.transpose() * modes(answer_).matrix().asDiagonal() * rows;
    displacement = rows.transpose() * modes(position_).matrix();
    velocity = rows.transpose() * modes(velocity_).matrix();
    free_velocity = rows.transpose() * modes(free_).matrix();
  }

  void advance(const Ports& impulses) {
    const Ports next = free_velocity + compliance_ * impulses;
    displacement += shares_[0] * next + shares_[1] * velocity;
    velocity = next;
    std::array<const double*, num_ports> rows;
    for (std::size_t j = 0; j < num_ports; ++j) rows[j] = rows_[j].data();
    const MoreauJeanModes fields{static_cast<int>(padded_size()),
                                 position_.data(),
                                 velocity_.data(),
                                 free_.data(),
                                 answer_.data(),
                                 kept_.data(),
                                 pulled_.data(),
                                 loaded_.data()};
    advance_moreau_jean<num_ports>(fields, rows.data(), impulses.data(), shares_[0], shares_[1],
                                   free_velocity.data());
  }

  double displacement_of(int row) const {
    return all_rows_.row(row).dot(Eigen::Map<const Eigen::VectorXd>(position_.data(), num_modes_));
  }
  const Eigen::Matrix<double, num_ports, num_ports>& compliance() const { return compliance_; }

  Ports displacement = Ports::Zero();   ///< at t_k, m
  Ports velocity = Ports::Zero();       ///< at t_k, m/s
  Ports free_velocity = Ports::Zero();  ///< at t_{k+1} without the contact, m/s

 private:
  /// Whole vectors of the widest instruction set.
  std::size_t padded_size() const { return (static_cast<std::size_t>(num_modes_) + 7) / 8 * 8; }
  Eigen::Map<Eigen::ArrayXd> modes(AlignedArray& field) const { return {field.data(), num_modes_}; }

  Eigen::MatrixXd all_rows_;
  Eigen::Index num_modes_ = 0;
  AlignedArray answer_, kept_, pulled_, loaded_;
  AlignedArray position_, velocity_, free_;
  std::array<AlignedArray, num_ports> rows_;
  Eigen::Matrix<double, num_ports, num_ports> compliance_;
  double shares_[2];
};

class MoreauJean {
 public:
  MoreauJean(const SlidingWindow& window, const MoreauJeanParameters& parameters)
      : system_(window.system),
        parameters_(parameters),
        slave_(system_.bodies[static_cast<std::size_t>(contact().slave_body)],
               system_.drives[0].load.value(0.0), parameters),
        master_(system_.bodies[static_cast<std::size_t>(surface().body)],
                system_.drives[0].load.value(0.0), parameters),
        drive_velocity_(system_.drives[0].velocity.value(0.0)),
        friction_(contact().friction.dynamic_coefficient * contact().friction_rise.value(0.0)),
        solver_(1) {
    slave_.watch({contact().slave_rows.x, contact().slave_rows.y});
    enter(contact().first_segment);
  }

  /// One step. @return the normal impulse by h, N
  double step() {
    const double h = parameters_.step;
    // The place of the contact at the end of the step.
    SlidingFrame frame = frame_after(h);
    while (frame.xi > 1.0) {
      enter(segment_ + 1);
      frame = frame_after(h);
    }
    const Eigen::Vector2d weights(1.0 - frame.xi, frame.xi);
    const auto of_master = [&](const Eigen::Vector4d& ports) -> Eigen::Vector2d {
      return weights[0] * ports.head<2>() + weights[1] * ports.tail<2>();
    };
    Eigen::Vector2d free = slave_.free_velocity - of_master(master_.free_velocity);
    free.x() += drive_velocity_;
    const Eigen::Matrix4d& w = master_.compliance();
    const Eigen::Matrix2d answer =
        slave_.compliance() + weights[0] * weights[0] * w.topLeftCorner<2, 2>() +
        weights[0] * weights[1] * (w.topRightCorner<2, 2>() + w.bottomLeftCorner<2, 2>()) +
        weights[1] * weights[1] * w.bottomRightCorner<2, 2>();
    Eigen::Vector2d impulse = Eigen::Vector2d::Zero();
    double normal = 0.0;
    if (frame.gap <= parameters_.activation) {
      const Eigen::Vector2d n = frame.normal;
      const Eigen::Vector2d t = frame.tangent;
      LocalProblem& local = local_[0];
      local.penetration = -n.dot(free);
      local.slip = t.dot(free);
      local.sliding_friction = friction_;
      local.sticking_friction = friction_;
      local.direction = local.slip < 0.0 ? -1.0 : 1.0;
      local.is_unilateral = true;
      Eigen::MatrixXd& delassus = solver_.delassus();
      delassus(0, 0) = n.dot(answer * n);
      delassus(0, 1) = -n.dot(answer * t);
      delassus(1, 0) = -t.dot(answer * n);
      delassus(1, 1) = t.dot(answer * t);
      if (solver_.solve(local_).status != ContactStatus::converged)
        throw std::runtime_error("run_moreau_jean: the contact has not settled");
      normal = local.normal;
      impulse = local.normal * n - local.tangential * t;
    }
    Eigen::Vector4d on_master;
    on_master << -weights[0] * impulse, -weights[1] * impulse;
    slave_.advance(impulse);
    master_.advance(on_master);
    ++index_;
    return normal / h;
  }

  double displacement(const ObservedRow& row) const {
    return row.body == contact().slave_body ? slave_.displacement_of(row.row)
                                            : master_.displacement_of(row.row);
  }

 private:
  const ContactPoint& contact() const { return system_.contacts[0]; }
  const MasterSurface& surface() const { return system_.surfaces[0]; }

  void enter(int segment) {
    if (segment >= surface().num_segments())
      throw std::runtime_error("run_moreau_jean: the slave has left its master");
    segment_ = segment;
    const PointRows& first = surface().rows[static_cast<std::size_t>(segment)];
    const PointRows& second = surface().rows[static_cast<std::size_t>(segment) + 1];
    master_.watch({first.x, first.y, second.x, second.y});
  }

  SlidingFrame frame_after(double h) const {
    Eigen::Vector2d slave = slave_.displacement + h * slave_.velocity;
    slave.x() += drive_velocity_ * h * static_cast<double>(index_ + 1);
    const Eigen::Vector4d nodes = master_.displacement + h * master_.velocity;
    return sliding_frame(contact(), surface(), segment_, slave, nodes.head<2>(), nodes.tail<2>());
  }

  const System& system_;
  MoreauJeanParameters parameters_;
  Body<2> slave_;
  Body<4> master_;
  double drive_velocity_;
  double friction_;
  ContactSolver solver_;
  std::array<LocalProblem, 1> local_;
  int segment_ = 0;
  std::int64_t index_ = 0;
};

}  // namespace

WindowRun run_moreau_jean(const SlidingWindow& window, const MoreauJeanParameters& parameters,
                          Sampling sampling) {
  const double start = processor_seconds();
  MoreauJean scheme(window, parameters);
  WindowRun run;
  run.samples.interval = window.interval;
  run.samples.forces.resize(1);
  const auto per_sample =
      static_cast<std::int64_t>(std::llround(window.interval / parameters.step));
  run.steps = window.num_samples * per_sample;
  const double begin = processor_seconds();
  run.setup = begin - start;
  if (sampling == Sampling::none) {
    for (std::int64_t k = 0; k < run.steps; ++k) scheme.step();
    run.stepping = processor_seconds() - begin;
    return run;
  }
  double before = 0.0;
  for (std::int64_t k = 0; k <= window.num_samples; ++k) {
    run.samples.displacement.push_back(scheme.displacement(window.observed));
    const double after = scheme.step();
    run.samples.forces[0].push_back(k == 0 ? after : 0.5 * (before + after));
    before = after;
    for (std::int64_t i = 1; i < per_sample; ++i) before = scheme.step();
  }
  run.stepping = processor_seconds() - begin;
  return run;
}

}  // namespace stridor::bench
