#include "substructures/bodies/whole_body.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "substructures/matrices/massless_motions.hpp"

namespace stridor {
namespace {

/// Takes negative stiffness into the coupled terms.
void move_negative_stiffness(ReducedBody& body) {
  const Eigen::Index n = body.size();
  if (Eigen::LLT<Eigen::MatrixXd>(body.stiffness).info() == Eigen::Success) return;
  const SemidefinitePairs pairs =
      semidefinite_eigenpairs(body.stiffness, body.mass, "stiffness of a body");
  constexpr double rounding = 1e-12;
  const double least = -rounding * pairs.values.cwiseAbs().maxCoeff();
  const auto num_negative = (pairs.values.array() < least).count();  // values ascend
  if (num_negative == 0) return;
  const Eigen::MatrixXd momenta = body.mass * pairs.vectors.leftCols(num_negative);
  const Eigen::MatrixXd negative =
      momenta * pairs.values.head(num_negative).asDiagonal() * momenta.transpose();
  constexpr double eps = std::numeric_limits<double>::epsilon();
  body.interface_rounding = 16.0 * std::sqrt(static_cast<double>(n)) * eps *
                            body.stiffness.diagonal().cwiseAbs().maxCoeff();
  body.stiffness -= negative;
  if (body.coupled.is_empty())
    body.coupled = {Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n)};
  body.coupled.position += negative;
}

using Entries = std::vector<Eigen::Triplet<double>>;

void append(Entries& entries, const SparseMatrix& matrix, Eigen::Index first) {
  for (Eigen::Index column = 0; column < matrix.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry(matrix, column); entry; ++entry)
      entries.emplace_back(static_cast<int>(first + entry.row()), static_cast<int>(first + column),
                           entry.value());
  }
}

SparseMatrix sparse(const Eigen::MatrixXd& matrix) {
  return matrix.sparseView();
}

/// spin_terms() of a body of which every unknown is kept.
void add_spin(const BodyMatrices& body, SparseSystem& system) {
  const SpinTerms& spin = *body.spin;
  const double speed = spin.speed;
  system.velocity += 2.0 * speed * spin.gyroscopic;
  system.position += speed * speed * spin.position;
  if (!spin.turns_damping) return;
  system.position += speed * body.damping.alpha * spin.gyroscopic;
  SparseMatrix loss = body.damping.beta * body.stiffness;
  if (spin.viscous.size() > 0) loss += spin.viscous;
  const SparseMatrix turned = loss * spin.around;
  const SparseMatrix mirrored = turned.transpose();
  system.position += 0.5 * speed * (turned - mirrored);
}

}  // namespace

ReducedBody make_whole(const BodyMatrices& body, std::span<const int> watched) {
  const Eigen::Index n = body.num_dofs();
  ReducedBody whole;
  whole.mass = body.mass;
  whole.stiffness = body.stiffness;
  whole.damping = body.damping;
  whole.base_inertia = body.base_inertia;
  whole.num_interface = n;
  if (body.velocity.size() > 0) whole.coupled = {body.velocity, body.circulatory};
  whole.loss_stiffness = body.loss_stiffness;
  if (body.spin && body.spin->gyroscopic.size() > 0)
    whole.spin = reduce_spin(body, Eigen::MatrixXd::Identity(n, n));
  whole.rows = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(watched.size()), n);
  for (std::size_t r = 0; r < watched.size(); ++r) {
    if (watched[r] == BodyMatrices::held) continue;
    if (watched[r] < 0 || watched[r] >= n)
      throw std::invalid_argument("make_whole: a watched DoF is out of range");
    whole.rows(static_cast<Eigen::Index>(r), watched[r]) = 1.0;
  }
  move_negative_stiffness(whole);
  return whole;
}

SparseSystem make_sparse(const BodyMatrices& body) {
  SparseSystem system;
  system.mass = body.mass;
  system.position = body.stiffness;
  if (body.velocity.size() > 0) {
    system.velocity = body.velocity;
    system.position += body.circulatory;
  } else {
    system.velocity.resize(body.mass.rows(), body.mass.cols());
  }
  if (body.damping.alpha > 0.0 || body.damping.beta > 0.0)
    system.velocity += body.damping.alpha * body.mass + body.damping.beta * body.stiffness;
  if (body.spin && body.spin->gyroscopic.size() > 0) add_spin(body, system);
  return system;
}

SparseSystem make_sparse(const ModalBody& body) {
  const Eigen::Index n = body.size();
  Eigen::MatrixXd velocity = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd position = velocity;
  if (!body.coupled.is_empty()) {
    velocity = body.coupled.velocity;
    position = body.coupled.position;
  }
  velocity.diagonal().array() +=
      body.damping.alpha + body.damping.beta * body.omega.array().square();
  position.diagonal().array() += body.omega.array().square();
  return {sparse(Eigen::MatrixXd::Identity(n, n)), sparse(velocity), sparse(position)};
}

SparseSystem block_diagonal(std::vector<SparseSystem> blocks) {
  if (blocks.size() == 1) return std::move(blocks.front());
  SparseSystem whole;
  for (SparseMatrix SparseSystem::*member :
       {&SparseSystem::mass, &SparseSystem::velocity, &SparseSystem::position}) {
    Entries entries;
    Eigen::Index first = 0;
    for (const SparseSystem& block : blocks) {
      append(entries, block.*member, first);
      first += block.size();
    }
    (whole.*member).resize(first, first);
    (whole.*member).setFromTriplets(entries.begin(), entries.end());
  }
  return whole;
}

}  // namespace stridor
