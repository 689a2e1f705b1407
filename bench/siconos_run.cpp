#include "bench/siconos_run.hpp"

#include <cmath>
#include <stdexcept>

#include "bench/processor_clock.hpp"
#include "bench/siconos_march.hpp"

namespace stridor::bench {
namespace {

SiconosBody body_of(const System& system, int index) {
  const SystemBody& body = system.bodies[static_cast<std::size_t>(index)];
  const ReducedBody& reduced = body.reduced;
  SiconosBody given;
  given.mass = reduced.mass;
  given.stiffness = reduced.stiffness;
  given.damping = reduced.damping.alpha * reduced.mass + reduced.damping.beta * reduced.stiffness;
  given.displacement = body.initial_displacement;
  given.velocity = body.initial_velocity;
  given.load = Eigen::VectorXd::Zero(reduced.size());
  if (!body.loads.empty())
    given.load = system.drives[0].load.value(0.0) * reduced.rows.row(body.loads.front().row);
  return given;
}

/// The slave over its present segment.
class SlidingContact : public MovingContact {
 public:
  SlidingContact(const System& system, const Eigen::MatrixXd& slave_rows,
                 const Eigen::MatrixXd& master_rows)
      : contact_(system.contacts[0]),
        surface_(system.surfaces[0]),
        all_rows_(master_rows),
        slave_(pick(slave_rows, contact_.slave_rows)),
        drive_velocity_(system.drives[0].velocity.value(0.0)) {
    enter(contact_.first_segment);
  }

  void find(double time, const Vector& slave, const Vector& master, Place& place) override {
    Eigen::Vector2d tip = slave_ * slave;
    tip.x() += drive_velocity_ * time;
    const auto frame_here = [&] {
      return sliding_frame(contact_, surface_, segment_, tip, first_ * master, second_ * master);
    };
    SlidingFrame frame = frame_here();
    while (frame.xi > 1.0) {
      enter(segment_ + 1);
      frame = frame_here();
    }
    Eigen::Matrix2d axes;
    axes << frame.normal.transpose(), frame.tangent.transpose();
    place.gap = frame.gap;
    place.rates = drive_velocity_ * axes.col(0);
    place.rows.resize(2, slave_.cols() + first_.cols());
    place.rows.leftCols(slave_.cols()).noalias() = axes * slave_;
    place.rows.rightCols(first_.cols()).noalias() = (frame.xi - 1.0) * axes * first_;
    place.rows.rightCols(first_.cols()).noalias() -= frame.xi * axes * second_;
  }

 private:
  static Eigen::Matrix2Xd pick(const Eigen::MatrixXd& all, const PointRows& point) {
    Eigen::Matrix2Xd rows(2, all.cols());
    rows << all.row(point.x), all.row(point.y);
    return rows;
  }

  void enter(int segment) {
    if (segment >= surface_.num_segments())
      throw std::runtime_error("run_siconos: the slave has left its master");
    segment_ = segment;
    first_ = pick(all_rows_, surface_.rows[static_cast<std::size_t>(segment)]);
    second_ = pick(all_rows_, surface_.rows[static_cast<std::size_t>(segment) + 1]);
  }

  const ContactPoint& contact_;
  const MasterSurface& surface_;
  const Eigen::MatrixXd& all_rows_;
  Eigen::Matrix2Xd slave_, first_, second_;
  double drive_velocity_;
  int segment_ = 0;
};

}  // namespace

WindowRun run_siconos(const SlidingWindow& window, double step) {
  const System& system = window.system;
  const ContactPoint& point = system.contacts[0];
  const int master = system.surfaces[0].body;
  const auto rows = [&](int body) -> const Eigen::MatrixXd& {
    return system.bodies[static_cast<std::size_t>(body)].reduced.rows;
  };
  SlidingContact contact(system, rows(point.slave_body), rows(master));
  const auto per_sample = static_cast<std::int64_t>(std::llround(window.interval / step));
  SiconosParameters parameters;
  parameters.step = step;
  parameters.num_steps = window.num_samples * per_sample + 1;
  parameters.friction = point.friction.dynamic_coefficient * point.friction_rise.value(0.0);

  WindowRun run;
  run.samples.interval = window.interval;
  run.samples.forces.resize(1);
  const Eigen::VectorXd observed = rows(window.observed.body).row(window.observed.row);
  StretchClock clock(window.num_samples);
  double before = 0.0;
  const SiconosLook look = [&](std::int64_t k, const MovingContact::Vector& on_slave,
                               const MovingContact::Vector& on_master, double impulse) {
    const std::int64_t sample = k / per_sample;
    if (k % per_sample == 0 && sample <= window.num_samples) {
      run.samples.displacement.push_back(
          observed.dot(window.observed.body == master ? on_master : on_slave));
      clock.pass(sample);
    }
    // The sample at t_{k-1} has the impulses of the steps to and from it.
    if (k > 0 && (k - 1) % per_sample == 0)
      run.samples.forces[0].push_back((k == 1 ? impulse : 0.5 * (before + impulse)) / step);
    before = impulse;
  };
  run.setup = march_siconos(body_of(system, point.slave_body), body_of(system, master), contact,
                            parameters, look);
  run.stepping = clock.least();
  run.steps = window.num_samples * per_sample;
  return run;
}

}  // namespace stridor::bench
