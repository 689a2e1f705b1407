#include "tests/support/sliding_state.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace stridor {
namespace {

class SlidingStateSolver {
 public:
  SlidingStateSolver(const LinearSystem& bodies, const std::vector<FaceContact>& contacts,
                     const FaceContactLaw& law, const Eigen::VectorXd& loads)
      : bodies_(bodies),
        contacts_(contacts),
        law_(law),
        rigid_law_(law),
        loads_(loads),
        closed_(contacts.size(), true),
        forces_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(contacts.size()))),
        q_(Eigen::VectorXd::Zero(bodies.size())) {
    rigid_law_.penalty.reset();
  }

  SlidingStateSolution solve() {
    SlidingStateSolution solution;
    while (solution.iterations < max_iterations && !solution.has_converged) {
      ++solution.iterations;
      const bool has_moved = take_newton_step();
      if (!q_.allFinite() || !forces_.allFinite()) break;
      const bool has_switched = switch_contacts(solution.iterations > patience);
      solution.residual = residual();
      solution.has_converged = !has_moved && !has_switched && solution.residual < 1e-9;
    }
    solution.state = state();
    return solution;
  }

 private:
  static constexpr int max_iterations = 200;
  static constexpr int patience = 30;  ///< iterations before contacts switch one at a time

  double softness() const { return law_.penalty ? 1.0 / *law_.penalty : 0.0; }

  FaceSlidingState state() const {
    FaceSlidingState state;
    state.displacement = q_;
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      state.contacts.push_back(
          face_contact_point(contacts_[i], law_, q_, closed_[i] ? forces_(index(i)) : 0.0));
      state.contacts.back().is_closed = closed_[i];
    }
    return state;
  }

  /// @return whether displacements changed by so much that the next step is not within rounding
  bool take_newton_step() {
    const FaceSlidingState now = state();
    // With rows for the closed contacts, whatever the law.
    const LinearSystem tangent = linearise(bodies_, contacts_, rigid_law_, now);
    const Eigen::Index n = q_.size();
    const Eigen::Index k = tangent.gaps.rows();
    Eigen::MatrixXd matrix(n + k, n + k);
    matrix << tangent.position, -tangent.forces.transpose(), tangent.gaps,
        softness() * Eigen::MatrixXd::Identity(k, k);
    Eigen::VectorXd right(n + k);
    right.head(n) = loads_ - bodies_.position * q_;
    Eigen::Index row = n;
    for (const FaceContactPoint& point : now.contacts) {
      if (!point.is_closed) continue;
      right.head(n) += point.force * tangent.forces.row(row - n).transpose();
      right(row) = -(point.gap + softness() * point.force);
      ++row;
    }
    const Eigen::VectorXd step = Eigen::PartialPivLU<Eigen::MatrixXd>(matrix).solve(right);
    const double size = q_.norm();
    q_ += step.head(n);
    row = n;
    for (std::size_t i = 0; i < contacts_.size(); ++i)
      if (closed_[i]) forces_(index(i)) += step(row++);
    return step.head(n).norm() > 1e-8 * std::max(size, q_.norm());
  }

  /// Opens contacts that pull and closes those that overlap; only the worst of them if `one`.
  bool switch_contacts(bool one) {
    // Gaps against forces: what springs as stiff as the bodies at the contacts would need.
    const double stiffness = law_.penalty ? *law_.penalty : bodies_.position.diagonal().maxCoeff();
    std::vector<std::pair<double, std::size_t>> wrong;
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      const double pull = closed_[i]
                              ? -forces_(index(i))
                              : -stiffness * face_contact_point(contacts_[i], law_, q_, 0.0).gap;
      if (pull > 1e-12 * forces_.cwiseAbs().maxCoeff()) wrong.emplace_back(pull, i);
    }
    if (one && !wrong.empty()) wrong = {*std::max_element(wrong.begin(), wrong.end())};
    for (const auto& [pull, i] : wrong) {
      closed_[i] = !closed_[i];
      forces_(index(i)) = 0.0;
    }
    return !wrong.empty();
  }

  double residual() const {
    const FaceSlidingState now = state();
    const Eigen::VectorXd elastic = bodies_.position * q_;
    Eigen::VectorXd unbalanced = loads_ - elastic;
    double largest = std::max(loads_.cwiseAbs().maxCoeff(),
                              (bodies_.position.cwiseAbs() * q_.cwiseAbs()).maxCoeff());
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      if (!closed_[i]) continue;
      unbalanced += now.contacts[i].force * unit_force(contacts_[i], law_, now.contacts[i]);
      largest = std::max(largest, now.contacts[i].force);
    }
    return largest > 0.0 ? unbalanced.cwiseAbs().maxCoeff() / largest : 0.0;
  }

  static Eigen::Index index(std::size_t i) { return static_cast<Eigen::Index>(i); }

  const LinearSystem& bodies_;
  const std::vector<FaceContact>& contacts_;
  const FaceContactLaw& law_;
  FaceContactLaw rigid_law_;
  const Eigen::VectorXd& loads_;
  std::vector<bool> closed_;
  Eigen::VectorXd forces_, q_;
};

}  // namespace

SlidingStateSolution solve_sliding_state(const LinearSystem& bodies,
                                         const std::vector<FaceContact>& contacts,
                                         const FaceContactLaw& law, const Eigen::VectorXd& loads) {
  return SlidingStateSolver(bodies, contacts, law, loads).solve();
}

}  // namespace stridor
