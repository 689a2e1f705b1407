// Two bodies of a few random degrees of freedom, one sliding on the other.
#pragma once

#include <Eigen/Eigenvalues>
#include <random>
#include <utility>

#include "tests/support/small_systems.hpp"

namespace stridor::test {

/// A body of 2 to 6 degrees of freedom with springs of 1 to 300 and Rayleigh damping of up
/// to a tenth of the critical one; `num_points` points that all of them move.
inline SystemBody random_body(std::string name, std::mt19937& engine, int num_points,
                              bool is_damped) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const auto n = static_cast<Eigen::Index>(2 + engine() % 5);
  const auto matrix = [&](Eigen::Index rows, Eigen::Index columns) {
    return Eigen::MatrixXd(
        Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(engine); }));
  };
  const Eigen::MatrixXd shape = matrix(n, n);
  const Eigen::MatrixXd mass = shape * shape.transpose() + 0.2 * Eigen::MatrixXd::Identity(n, n);
  const Eigen::VectorXd springs =
      Eigen::VectorXd::NullaryExpr(n, [&] { return std::pow(300.0, uniform(engine)); });
  const Eigen::MatrixXd turn = matrix(n, n);
  SystemBody body =
      driven_body(std::move(name), mass, turn * springs.asDiagonal() * turn.transpose(),
                  matrix(2 * num_points, n), 0);
  if (is_damped) {
    const double highest = body.modal.omega.maxCoeff();
    body.reduced.damping.alpha = 0.2 * uniform(engine) * body.modal.omega.minCoeff();
    body.reduced.damping.beta = 0.2 * uniform(engine) / highest;
    body.modal = make_modal(body.reduced);
  }
  return body;
}

/// Points on the straight line y = 0 through the four nodes of the other body, each at one of them
/// or in the middle between two. They slide forward for ever where they are, by Subs-a: with rows
/// that nothing changes.
inline System random_sliding_bodies(unsigned seed, double friction, bool is_damped,
                                    int num_points = 1) {
  std::mt19937 engine(seed);
  System system;
  system.bodies.push_back(random_body("slave", engine, num_points, is_damped));
  system.bodies.push_back(random_body("master", engine, 4, is_damped));
  system.bodies[1].drive = -1;
  system.bodies[1].loads.clear();
  MasterSurface surface;
  surface.name = "master.top";
  surface.body = 1;
  for (int node = 0; node < 4; ++node) {
    surface.rows.push_back({2 * node, 2 * node + 1});
    surface.positions.emplace_back(node, 0.0);
    surface.arc_length.push_back(node);
  }
  system.surfaces.push_back(surface);
  for (int point = 0; point < num_points; ++point) {
    ContactPoint contact;
    contact.name = "contact";
    contact.slave_rows = {2 * point, 2 * point + 1};
    contact.slave_position = {0.5 * static_cast<double>(1 + engine() % 5), 0.0};
    contact.first_segment = static_cast<int>(contact.slave_position.x());
    contact.assumption = ContactAssumption::subs_a;
    contact.friction = constant_friction(friction);
    contact.armed_from = 1e9;
    system.contacts.push_back(contact);
  }
  system.drives[0].velocity = TimeCurve(1e9);
  system.drives[0].load = TimeCurve(0.0);
  system.drives[0].is_frozen = true;
  return system;
}

/// What is added to the modes of bodies, as shares of their frequencies.
struct RandomCoupling {
  double gyroscopic = 0.0;   ///< of the largest ω, 1/s
  double damper = 0.0;       ///< likewise, of one damper that all modes move
  double circulatory = 0.0;  ///< of the least ω², 1/s²
};

/// Terms between the modes of every body.
inline System with_coupling(System system, unsigned seed, const RandomCoupling& coupling) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  for (SystemBody& body : system.bodies) {
    const Eigen::Index n = body.modal.size();
    const auto skew = [&] {
      const Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return normal(engine); });
      return Eigen::MatrixXd(0.5 * (a - a.transpose()));
    };
    const Eigen::VectorXd moved = Eigen::VectorXd::NullaryExpr(n, [&] { return normal(engine); });
    const double fastest = body.modal.omega.maxCoeff();
    const double slowest = body.modal.omega.minCoeff();
    const Eigen::MatrixXd to_modal = body.modal.shapes.transpose() * body.reduced.mass;
    const Eigen::MatrixXd velocity =
        coupling.gyroscopic * fastest * skew() +
        coupling.damper * fastest / moved.squaredNorm() * moved * moved.transpose();
    const Eigen::MatrixXd position = coupling.circulatory * slowest * slowest * skew();
    body.reduced.coupled = {to_modal.transpose() * velocity * to_modal,
                            to_modal.transpose() * position * to_modal};
    body.modal.coupled = {velocity, position};
  }
  return system;
}

/// Largest |s| of the bodies by themselves, with their coupled terms and without damping and
/// circulatory ones, 1/s.
inline double fastest_motion(const System& system) {
  double fastest = 0.0;
  for (const SystemBody& body : system.bodies) {
    const Eigen::Index n = body.modal.size();
    const Eigen::MatrixXd K = body.modal.omega.array().square().matrix().asDiagonal();
    const Eigen::MatrixXd& V = body.modal.coupled.velocity;
    Eigen::MatrixXd damped = V;
    damped.diagonal().array() +=
        body.modal.damping.alpha + body.modal.damping.beta * K.diagonal().array();
    for (const auto& [velocity, position] :
         {std::pair<Eigen::MatrixXd, Eigen::MatrixXd>(0.5 * (V - V.transpose()), K),
          {damped, K + body.modal.coupled.position}}) {
      Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(2 * n, 2 * n);
      companion.topRightCorner(n, n).setIdentity();
      companion.bottomLeftCorner(n, n) = -position;
      companion.bottomRightCorner(n, n) = -velocity;
      fastest = std::max(fastest, companion.eigenvalues().cwiseAbs().maxCoeff());
    }
  }
  return fastest;
}

}  // namespace stridor::test
