#include "solvers/face_contact_motion.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "solvers/rigid_contact_motion.hpp"
#include "solvers/spring_contact_motion.hpp"
#include "substructures/symmetric_eigenpairs.hpp"

namespace stridor {

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
  const SymmetricEigenpairs modes =
      generalised_eigenpairs(split(system.position).symmetric, system.mass, "contact motion");
  const Eigen::VectorXd answers = modes.values.cwiseMax(0.0).cwiseSqrt().unaryExpr(answer);
  std::vector<Eigen::VectorXd> rows;
  for (const FaceContactPoint& point : state.contacts)
    if (point.is_closed) rows.push_back(modes.vectors.transpose() * point.normal);
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
