#include "substructures/reduction/reduced_spin.hpp"

namespace stridor {
namespace {

Eigen::MatrixXd skew_part(const Eigen::MatrixXd& matrix) {
  return 0.5 * (matrix - matrix.transpose());
}

}  // namespace

ReducedSpin reduce_spin(const BodyMatrices& body, const Eigen::MatrixXd& T) {
  const SpinTerms& spin = *body.spin;
  ReducedSpin reduced;
  reduced.gyroscopic = skew_part(T.transpose() * (spin.gyroscopic * T));
  reduced.position = T.transpose() * (spin.position * T);
  if (!spin.turns_damping) return reduced;
  const Eigen::MatrixXd turned = spin.around * T;
  reduced.elastic = skew_part(T.transpose() * (body.stiffness * turned));
  if (spin.viscous.size() > 0)
    reduced.viscous = skew_part(T.transpose() * (spin.viscous * turned));
  return reduced;
}

CoupledTerms spin_terms(const ReducedSpin& spin, double speed, const RayleighDamping& damping) {
  CoupledTerms terms;
  terms.velocity = 2.0 * speed * spin.gyroscopic;
  terms.position = speed * speed * spin.position;
  if (spin.elastic.size() > 0)
    terms.position += speed * (damping.alpha * spin.gyroscopic + damping.beta * spin.elastic);
  if (spin.viscous.size() > 0) terms.position += speed * spin.viscous;
  return terms;
}

void add_terms(const CoupledTerms& more, CoupledTerms& terms) {
  if (terms.is_empty()) {
    terms = more;
    return;
  }
  terms.velocity += more.velocity;
  terms.position += more.position;
}

}  // namespace stridor
