#include "solvers/face_contact_motion.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "solvers/rigid_contact_motion.hpp"
#include "solvers/spring_contact_motion.hpp"

namespace stridor {

FaceContactRows::FaceContactRows(const LinearSystem& bodies,
                                 const std::vector<FaceContact>& contacts,
                                 const FaceContactLaw& law, const FaceSlidingState& state) {
  const Eigen::Index n = bodies.size();
  const auto num_contacts = static_cast<Eigen::Index>(contacts.size());
  displacement = velocity = Eigen::MatrixXd::Zero(3 * num_contacts, n);
  drive = preload = Eigen::VectorXd::Zero(3 * num_contacts);
  inputs = Eigen::MatrixXd::Zero(n, 3 * num_contacts);
  for (Eigen::Index i = 0; i < num_contacts; ++i) {
    const FaceContact& contact = contacts[static_cast<std::size_t>(i)];
    const FaceContactPoint& point = state.contacts[static_cast<std::size_t>(i)];
    const Eigen::Index k = 3 * i;
    displacement.row(k) = point.normal;
    velocity.row(k + 1) = -contact.friction();
    drive(k) = point.gap;
    drive.segment<2>(k + 1) = point.velocity;
    inputs.col(k) = point.normal;
    inputs.col(k + 1) = point.along;
    if (law.friction_turns) {
      velocity.row(k + 2) = -contact.across();
      displacement.row(k + 2) = -law.speed * contact.radius * contact.turning();
      inputs.col(k + 2) = contact.across();
    }
    if (!point.is_closed) continue;
    preload(k) = point.force;
    preload.segment<2>(k + 1) = point.force * law.friction * point.direction;
  }
  constexpr Eigen::Index each = FaceContact::num_bending;
  const Eigen::Index num_bending = law.forces_bend ? each * num_contacts : 0;
  bending_inputs.resize(n, num_bending);
  normal_bending.resize(num_bending, n);
  friction_bending.resize(num_bending, n);
  for (Eigen::Index i = 0; each * i < num_bending; ++i) {
    const FaceContact& contact = contacts[static_cast<std::size_t>(i)];
    bending_inputs.middleCols(each * i, each) = contact.bending_forces();
    normal_bending.middleRows(each * i, each) = contact.normal_bending();
    friction_bending.middleRows(each * i, each) = contact.friction_bending();
  }
}

Eigen::VectorXd FaceContactRows::gap_bending(const Eigen::VectorXd& x) const {
  constexpr Eigen::Index each = FaceContact::num_bending;
  Eigen::VectorXd bent = Eigen::VectorXd::Zero(num_contacts());
  if (!bends()) return bent;
  const Eigen::VectorXd turned = normal_bending * x;
  const Eigen::VectorXd moved = bending_inputs.transpose() * x;
  for (Eigen::Index i = 0; i < bent.size(); ++i)
    bent(i) = 0.5 * turned.segment<each>(each * i).dot(moved.segment<each>(each * i));
  return bent;
}

Eigen::VectorXd FaceContactRows::bending(const Eigen::VectorXd& f, const Eigen::VectorXd& x) const {
  constexpr Eigen::Index each = FaceContact::num_bending;
  if (!bends()) return {};
  const Eigen::VectorXd normal = normal_bending * x;
  Eigen::VectorXd bent = friction_bending * x;
  for (Eigen::Index i = 0; i < num_contacts(); ++i) {
    bent.segment<each>(each * i) =
        f(3 * i) * normal.segment<each>(each * i) + f(3 * i + 1) * bent.segment<each>(each * i);
  }
  return bent;
}

FaceContactState face_contact_state(const FaceContactLaw& law, const FaceContact& contact,
                                    const Eigen::Vector3d& seen, const Eigen::Vector3d& forces) {
  constexpr double still = 1e-9;  // of the velocity of sliding
  FaceContactState state;
  state.gap = seen(0);
  state.force = forces(0);
  state.friction_force = forces(1);
  state.across_force = forces(2);
  state.slip_velocity = seen.tail<2>().norm();
  const bool sticks =
      law.friction > 0.0 && state.slip_velocity <= still * law.speed * contact.radius;
  state.state = !(state.force > 0.0) ? ContactState::open
                : sticks             ? ContactState::stick
                                     : ContactState::slip;
  return state;
}

double least_sine_ratio(double x) {
  constexpr double lowest_at = 4.493409457909064;
  const double to = std::min(x, lowest_at);
  return to > 0.0 ? std::sin(to) / to : 1.0;
}

Eigen::MatrixXd normal_answer(const LinearSystem& system, const FaceSlidingState& state,
                              const std::function<double(double)>& answer) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(
      split(system.position).symmetric, system.mass);
  const Eigen::VectorXd answers = modes.eigenvalues().cwiseMax(0.0).cwiseSqrt().unaryExpr(answer);
  std::vector<Eigen::VectorXd> rows;
  for (const FaceContactPoint& point : state.contacts)
    if (point.is_closed) rows.push_back(modes.eigenvectors().transpose() * point.normal);
  const auto size = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd sum(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < size; ++j) {
      sum(i, j) = rows[static_cast<std::size_t>(i)].dot(
          answers.cwiseProduct(rows[static_cast<std::size_t>(j)]));
    }
  }
  return sum;
}

bool is_positive_definite(const Eigen::MatrixXd& matrix) {
  if (matrix.rows() == 0) return true;
  return Eigen::LLT<Eigen::MatrixXd>(split(matrix).symmetric).info() == Eigen::Success;
}

std::unique_ptr<FaceContactMotion> make_face_contact_motion(
    const LinearSystem& bodies, const std::vector<FaceContact>& contacts, const FaceContactLaw& law,
    const FaceSlidingState& state, double step) {
  if (law.penalty) return std::make_unique<SpringContactMotion>(bodies, contacts, law, state, step);
  return std::make_unique<RigidContactMotion>(bodies, contacts, law, state, step);
}

}  // namespace stridor
