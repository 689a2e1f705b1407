#include "analysis/explanation.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <numbers>

namespace stridor {
namespace {

using Complex = std::complex<double>;

/// Sᵀ(A S q) for a matrix on the ports that may be empty.
Eigen::VectorXcd through_ports(const Pencil& pencil, const Eigen::MatrixXd& matrix,
                               const Eigen::VectorXcd& q) {
  if (matrix.size() == 0) return Eigen::VectorXcd::Zero(q.size());
  return pencil.ports.transpose() * (matrix * (pencil.ports * q));
}

}  // namespace

ModeQuotients mode_quotients(const Pencil& pencil, Complex s, const Eigen::VectorXcd& right) {
  const Eigen::VectorXcd q = right.normalized();
  const Eigen::MatrixXd gap_rows = pencil.compatibility * pencil.ports;
  const Eigen::MatrixXd force_rows = pencil.equilibrium * pencil.ports;
  const Eigen::PartialPivLU<Eigen::MatrixXd> delassus(
      Eigen::MatrixXd(gap_rows * force_rows.transpose()));
  // q̄ᵀ P v
  const auto form = [&](const Eigen::VectorXcd& v) {
    const Eigen::VectorXcd gaps = gap_rows * v;
    Eigen::VectorXcd forces(gaps.size());
    forces.real() = delassus.solve(Eigen::VectorXd(gaps.real()));
    forces.imag() = delassus.solve(Eigen::VectorXd(gaps.imag()));
    return q.dot(v) - q.dot(force_rows.transpose() * forces);
  };
  const Eigen::VectorXcd damped = pencil.damping.cast<Complex>().cwiseProduct(q) +
                                  through_ports(pencil, pencil.port_damping, q);
  const Eigen::VectorXcd stiff =
      pencil.omega.array().square().matrix().cast<Complex>().cwiseProduct(q) +
      through_ports(pencil, pencil.port_stiffness, q);
  const Complex velocity = form(damped);
  const Complex position = form(stiff);
  ModeQuotients quotients;
  quotients.damping = velocity.real();
  quotients.gyroscopic = velocity.imag();
  quotients.stiffness = position.real();
  quotients.circulatory = position.imag();
  quotients.residual = std::abs(s * s + velocity * s + position) / std::norm(s);
  return quotients;
}

ModeQuotients mode_quotients(const SparseSystem& system, Complex s, const Eigen::VectorXcd& right) {
  const Complex velocity = right.dot(system.velocity * right);
  const Complex position = right.dot(system.position * right);
  return {velocity.real(), velocity.imag(), position.real(), position.imag(),
          std::abs(s * s + velocity * s + position) / std::norm(s)};
}

ModeEnergy mode_energy(const Pencil& pencil, Complex s, const Eigenvector& vector) {
  const double length = vector.right.norm();
  const Eigen::VectorXcd q = vector.right / length;
  const Eigen::VectorXcd velocity = s * q;
  Eigen::VectorXcd port_force = pencil.equilibrium.transpose() * (vector.force / length);
  const Eigen::VectorXcd y = pencil.ports * q;
  if (pencil.port_stiffness.size() > 0) port_force += pencil.port_stiffness * y;
  double stored = pencil.omega.cwiseProduct(q.cwiseAbs()).squaredNorm();
  if (pencil.normal_stiffness.size() > 0) {
    const Eigen::VectorXcd spring_force = pencil.normal_stiffness * y;
    port_force -= spring_force;
    stored += y.dot(spring_force).real();
  }
  if (pencil.port_damping.size() > 0) port_force += pencil.port_damping * (s * y);
  const auto growth_by = [&](Eigen::Index first, Eigen::Index count) {
    const Eigen::VectorXcd motion = pencil.ports.middleRows(first, count) * velocity;
    return -0.25 * motion.dot(port_force.segment(first, count)).real();
  };
  const Eigen::Index num_contact_ports = pencil.num_ports() - pencil.num_body_ports;
  const double energy = 0.25 * (std::norm(s) + stored);
  ModeEnergy result;
  result.from_contact = growth_by(0, num_contact_ports) / energy;
  result.by_coupled = growth_by(num_contact_ports, pencil.num_body_ports) / energy;
  result.by_damping = -0.25 * (pencil.damping.array() * velocity.array().abs2()).sum() / energy;
  result.residual =
      std::abs(result.from_contact + result.by_damping + result.by_coupled - s.real()) /
      std::abs(s);
  return result;
}

Pencil frictionless(const Pencil& pencil) {
  Pencil without = pencil;
  without.damping.setZero();
  without.equilibrium = without.compatibility;
  without.port_stiffness = pencil.normal_stiffness;
  without.port_damping.resize(0, 0);
  return without;
}

std::vector<Participation> participations(const Pencil& pencil,
                                          const std::vector<Eigenvalue>& eigenvalues,
                                          const Eigen::VectorXcd& right) {
  const Pencil without = frictionless(pencil);
  const ModalRows rows = modal_rows(without);
  std::vector<Participation> shares;
  for (const Eigenvalue& one : eigenvalues) {
    const Eigenvector mode = eigenvector(without, rows, one.s);
    shares.push_back({one.frequency(), modal_assurance(mode.right, right)});
  }
  std::sort(shares.begin(), shares.end(),
            [](const Participation& a, const Participation& b) { return a.share > b.share; });
  return shares;
}

std::vector<Participation> participations(const SparseSystem& system, const Eigen::VectorXd& omega,
                                          const Eigen::MatrixXd& modes,
                                          const Eigen::VectorXcd& right) {
  const Eigen::VectorXcd momentum = system.mass * right;
  const Eigen::VectorXd squares = (modes.transpose() * momentum).cwiseAbs2();
  std::vector<Participation> shares;
  for (Eigen::Index i = 0; i < omega.size(); ++i)
    shares.push_back({omega(i) / (2.0 * std::numbers::pi), squares(i)});
  std::sort(shares.begin(), shares.end(),
            [](const Participation& a, const Participation& b) { return a.share > b.share; });
  return shares;
}

}  // namespace stridor
