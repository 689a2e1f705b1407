#include "solvers/face_contact_solver.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace stridor {
namespace {

constexpr Eigen::Index per_contact = 3;  // normal, along, across

/// What friction is compared with: velocities that it takes away, per force.
double resistance(const FaceContactAnswer& answer, Eigen::Index k) {
  return std::max({0.0, -answer.compliance(k + 1, k + 1), -answer.compliance(k + 2, k + 2)});
}

}  // namespace

FaceContactSolver::FaceContactSolver(const FaceContactLaw& law, double least)
    : friction_(law.friction), softness_(law.penalty ? 1.0 / *law.penalty : 0.0), least_(least) {}

bool FaceContactSolver::solve(const FaceContactAnswer& answer, Eigen::VectorXd& forces) const {
  return sweep(answer, forces) || search(answer, forces);
}

bool FaceContactSolver::sweep(const FaceContactAnswer& answer, Eigen::VectorXd& f) const {
  constexpr int max_sweeps = 40;
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
    double largest = least_;
    double change = 0.0;
    for (Eigen::Index k = 0; k < f.size(); k += per_contact) {
      const Eigen::Vector3d last = f.segment<3>(k);
      const double W = answer.compliance(k, k);
      const double gap = answer.free(k) + answer.compliance.row(k).dot(f) - W * f(k);
      f(k) = std::max(0.0, -gap / (softness_ + W));
      const double limit = friction_ * f(k);
      const Eigen::Vector2d velocity =
          answer.free.segment<2>(k + 1) + answer.compliance.middleRows<2>(k + 1) * f;
      // Without slip friction is what stops it, unless that is more than there can be.
      const double soft = resistance(answer, k);
      const Eigen::Vector2d trial = soft * f.segment<2>(k + 1) + velocity;
      if (trial.norm() > soft * limit) {
        f.segment<2>(k + 1) = limit * trial.normalized();
      } else if (soft > 0.0) {
        f.segment<2>(k + 1) = trial / soft;
      }
      change = std::max(change, (f.segment<3>(k) - last).cwiseAbs().maxCoeff());
      largest = std::max(largest, f(k));
    }
    if (change <= tolerance * largest) return true;
  }
  return false;
}

/// How far forces are from the laws, and its slope where that is wanted.
Eigen::VectorXd FaceContactSolver::deviation(const FaceContactAnswer& answer,
                                             const Eigen::VectorXd& f,
                                             Eigen::MatrixXd* slope) const {
  const Eigen::VectorXd seen = answer.free + answer.compliance * f;
  Eigen::VectorXd apart = f;
  if (slope != nullptr) slope->setIdentity(f.size(), f.size());
  for (Eigen::Index k = 0; k < f.size(); k += per_contact) {
    const double stiffness = 1.0 / (softness_ + answer.compliance(k, k));
    const double overlap = stiffness * (seen(k) + softness_ * f(k));
    if (f(k) > overlap) {
      apart(k) = overlap;
      if (slope != nullptr) {
        slope->row(k) = stiffness * answer.compliance.row(k);
        (*slope)(k, k) += stiffness * softness_;
      }
    }
    const double soft = resistance(answer, k);
    const double limit = friction_ * std::max(0.0, f(k));
    const Eigen::Vector2d velocity = seen.segment<2>(k + 1);
    const auto rows = answer.compliance.middleRows<2>(k + 1);
    const Eigen::Vector2d trial = soft * f.segment<2>(k + 1) + velocity;
    const double size = trial.norm();
    if (size > soft * limit) {
      const Eigen::Vector2d direction = trial / size;
      apart.segment<2>(k + 1) -= limit * direction;
      if (slope == nullptr) continue;
      const Eigen::Matrix2d turning =
          limit / size * (Eigen::Matrix2d::Identity() - direction * direction.transpose());
      slope->middleRows<2>(k + 1) -= turning * rows;
      slope->block<2, 2>(k + 1, k + 1) -= soft * turning;
      if (f(k) > 0.0) slope->block<2, 1>(k + 1, k) -= friction_ * direction;
    } else if (soft > 0.0) {
      apart.segment<2>(k + 1) = -velocity / soft;
      if (slope == nullptr) continue;
      slope->middleRows<2>(k + 1) = -rows / soft;
      // A direction that friction has not is left where it is.
      for (const Eigen::Index row : {k + 1, k + 2})
        if (answer.compliance(row, row) == 0.0) (*slope)(row, row) = 1.0;
    }
  }
  return apart;
}

/// Newton's method with steps that are halved until the deviation falls.
bool FaceContactSolver::search(const FaceContactAnswer& answer, Eigen::VectorXd& forces) const {
  constexpr int max_iterations = 60;
  constexpr int max_halvings = 12;
  Eigen::MatrixXd slope;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const Eigen::VectorXd apart = deviation(answer, forces, &slope);
    const double largest = std::max(least_, forces.cwiseAbs().maxCoeff());
    if (!std::isfinite(largest)) return false;
    if (apart.cwiseAbs().maxCoeff() <= tolerance * largest) return true;
    const Eigen::VectorXd change = slope.partialPivLu().solve(-apart);
    if (change.cwiseAbs().maxCoeff() <= tolerance * largest) {
      forces += change;
      return true;
    }
    double share = 1.0;
    for (int halving = 0; halving < max_halvings; ++halving, share *= 0.5)
      if (deviation(answer, forces + share * change, nullptr).norm() < apart.norm()) break;
    forces += share * change;
  }
  return false;
}

}  // namespace stridor
