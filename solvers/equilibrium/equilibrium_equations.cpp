#include "solvers/equilibrium/equilibrium_equations.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/errors.hpp"
#include "solvers/algebra/block_products.hpp"

namespace stridor {
namespace {

void note_result(ContactEquilibrium& result, const ContactLinearisation& local, double force) {
  result.projection = local.projection;
  result.gap = local.gap;
  result.force = force;
  result.friction = local.friction;
  result.direction = local.direction;
  result.friction_force = local.direction * local.friction * force * local.sliding_direction.x();
  result.friction_across = local.friction * force * local.sliding_direction.y();
  result.slip_velocity = local.slip_velocity;
  result.velocity = local.velocity;
}

/// The law of a contact that closes, or gives way as a spring.
LawState spring_state(const ContactPoint& point, double force) {
  LawState law;
  law.compliance = point.compliance();
  law.indentation = law.compliance * force;
  return law;
}

}  // namespace

EquilibriumEquations::EquilibriumEquations(const System& system, EquilibriumState& state,
                                           std::optional<Target> target)
    : system_(system), state_(state), target_(target), ports_(system, state) {
  Eigen::Index first_port = 0;
  for (const ContactPoint& point : system.contacts) {
    contacts.push_back(sought_contact(system, state, point));
    contacts.back().first_port = first_port;
    contacts.back().num_ports = system.num_contact_ports(point);
    first_port += contacts.back().num_ports;
  }
  if (target_)
    contacts[static_cast<std::size_t>(target_->contact)].result.segment = target_->segment;
}

Eigen::VectorXd EquilibriumEquations::first_unknowns() const {
  Eigen::VectorXd unknowns =
      Eigen::VectorXd::Zero(first_rigid() + ports_.num_rigid + (target_ ? 1 : 0));
  if (target_) unknowns(unknowns.size() - 1) = state_.drive_displacement;
  return unknowns;
}

/// Whether the next step of Newton's method takes a derivative that is factored already.
bool EquilibriumEquations::reuses_factor(Eigen::Index size) const {
  constexpr Eigen::Index many = 100;  // below, a factor costs nothing
  return ports_.is_modal && size >= many && factor_.has_value();
}

EquilibriumEquations::Values EquilibriumEquations::evaluate(const Eigen::VectorXd& unknowns) {
  return evaluate(unknowns, !reuses_factor(unknowns.size()));
}

EquilibriumEquations::Values EquilibriumEquations::evaluate(const Eigen::VectorXd& unknowns,
                                                            bool with_derivative) {
  const Eigen::Index size = unknowns.size();
  if (target_) state_.drive_displacement = unknowns(size - 1);
  Values equations{Eigen::VectorXd::Zero(size), Eigen::VectorXd::Zero(size), {}, 0.0};
  if (with_derivative) equations.derivative.setZero(size, size);
  auto& [values, scale, derivative, residual, by_ports] = equations;
  const Eigen::Index num_unknown = ports_.num_unknown;
  const Eigen::Index num_rigid = ports_.num_rigid;
  values.segment(first_rigid(), num_rigid) = -ports_.rigid_load;
  scale.segment(first_rigid(), num_rigid) = ports_.rigid_load.cwiseAbs();
  double length = 0.0;
  const Eigen::VectorXd rigid = unknowns.segment(first_rigid(), num_rigid);
  const Eigen::VectorXd at_ports = ports_.at_ports(unknowns.head(num_unknown), rigid);
  if (num_contacts() > 0) {
    values.head(num_unknown) = unknowns.head(num_unknown) - ports_.loaded;
    if (with_derivative) derivative.topLeftCorner(num_unknown, num_unknown).setIdentity();
    if (!ports_.is_modal) {
      values.head(num_unknown) -= ports_.rigid_rows * rigid;
      if (with_derivative)
        derivative.block(0, first_rigid(), num_unknown, num_rigid) = -ports_.rigid_rows;
    }
    length = at_ports.cwiseAbs().maxCoeff();
  }
  for (Eigen::Index i = 0; i < num_contacts(); ++i)
    length = std::max(length, add_contact(equations, i, unknowns, at_ports));
  scale.head(first_rigid()).setConstant(length);
  if (ports_.is_modal && num_contacts() > 0) {
    // An amplitude that moves a port by that length, or that by the load alone, where contacts hold
    // against it.
    scale.head(num_unknown)
        .setConstant(std::max(length / ports_.elastic_rows.cwiseAbs().maxCoeff(),
                              ports_.loaded.cwiseAbs().maxCoeff()));
  }
  if (target_) scale(size - 1) = length;
  for (Eigen::Index k = 0; k < size; ++k) {
    const double value = std::abs(values(k));
    // Zero by zero where nothing loads the equation: it is satisfied.
    if (value > 0.0) residual = std::max(residual, value / scale(k));
  }
  if (!values.allFinite()) residual = std::numeric_limits<double>::infinity();
  return equations;
}

void EquilibriumEquations::add_by_ports(Values& equations, Eigen::Index row,
                                        const SoughtContact& contact,
                                        const Eigen::RowVectorXd& by_ports) const {
  const Eigen::Index first = contact.first_port;
  const Eigen::Index width = contact.num_ports;
  auto derivative = equations.derivative.row(row);
  if (!ports_.is_modal) {
    derivative.segment(first, width) += by_ports;
    return;
  }
  derivative.head(ports_.num_unknown) += by_ports * ports_.elastic_rows.middleRows(first, width);
  if (ports_.num_rigid > 0) {
    derivative.segment(first_rigid(), ports_.num_rigid) +=
        by_ports * ports_.rigid_rows.middleRows(first, width);
  }
}

double EquilibriumEquations::add_contact(Values& equations, Eigen::Index index,
                                         const Eigen::VectorXd& unknowns,
                                         const Eigen::VectorXd& at_ports) {
  const Eigen::Index num_unknown = ports_.num_unknown;
  const Eigen::Index row = num_unknown + index;
  const Eigen::Index last = unknowns.size() - 1;
  SoughtContact& contact = contacts[static_cast<std::size_t>(index)];
  const Eigen::Index first = contact.first_port;
  const Eigen::Index width = contact.num_ports;
  place(contact, state_, at_ports.segment(first, width));
  const ContactPositions& positions = contact.result.positions;
  const double force = unknowns(row);
  const bool has_law = contact.point->substrate.has_value();
  const LawState law = has_law ? law_state(contact, force, state_.friction_factor)
                               : spring_state(*contact.point, force);
  const ContactLinearisation local =
      contact.has_two_tangents() ? linearised_face(system_, state_, contact)
      : has_law ? linearise_contact(positions, constant_friction(law.friction), 1.0)
                : linearise_contact(positions, contact.point->friction, state_.friction_factor);
  note_result(contact.result, local, force);

  auto& [values, scale, derivative, residual, by_ports] = equations;
  const auto flexibility = ports_.flexibility.middleCols(first, width);
  values.head(num_unknown) += flexibility * (force * local.force_row);
  const Eigen::Index num_rigid = ports_.num_rigid;
  const auto rigid = ports_.rigid_rows.middleRows(first, width).transpose();
  values.segment(first_rigid(), num_rigid) += rigid * (force * local.force_row);
  scale.segment(first_rigid(), num_rigid) +=
      rigid.cwiseAbs() * (force * local.force_row).cwiseAbs();
  if (derivative.size() > 0) {
    const PortMatrix by_position = force * local.force_by_position;
    const PortVector by_drive = contact.path_share * by_position.col(0);
    // ∂(λ b_E)/∂λ: the friction of a force law is not proportional to λ.
    const PortVector by_force =
        local.force_row + local.direction * law.friction_slope * local.tangent_row;
    derivative.col(row).head(num_unknown) = flexibility * by_force;
    if (target_) derivative.col(last).head(num_unknown) += flexibility * by_drive;
    derivative.col(row).segment(first_rigid(), num_rigid) = rigid * by_force;
    if (target_) derivative.col(last).segment(first_rigid(), num_rigid) += rigid * by_drive;
    if (ports_.is_modal) {
      by_ports.push_back(by_position);
    } else {
      derivative.block(0, first, num_unknown, width) += flexibility * by_position;
      derivative.block(first_rigid(), first, num_rigid, width) = rigid * by_position;
    }
  }

  add_conditions(equations, index, local, law, force);
  if (contact.has_two_tangents())
    return std::max({contact.point->overlap, std::abs(law.indentation),
                     ports_.loaded_ports.segment(first, width).cwiseAbs().maxCoeff(),
                     length_of(contact)});
  const double segment_length = positions.master.chord().norm();
  const Eigen::Vector2d& T1 =
      positions.master.nodes[static_cast<std::size_t>(positions.master.stencil.before)];
  return std::max(segment_length, (positions.slave - T1).norm());
}

void EquilibriumEquations::add_conditions(Values& equations, Eigen::Index index,
                                          const ContactLinearisation& local, const LawState& law,
                                          double force) {
  auto& [values, scale, derivative, residual, by_ports] = equations;
  const SoughtContact& contact = contacts[static_cast<std::size_t>(index)];
  const Eigen::Index row = ports_.num_unknown + index;
  const Eigen::Index last = values.size() - 1;
  const bool with_derivative = derivative.size() > 0;
  const bool is_closed = contact.result.is_closed;
  values(row) = is_closed ? local.gap + law.indentation : force;
  if (with_derivative) derivative(row, row) = is_closed ? law.compliance : 1.0;
  if (with_derivative && is_closed) {
    add_by_ports(equations, row, contact, -local.gap_row.transpose());
    if (target_) derivative(row, last) = -local.gap_row[0] * contact.path_share;
  }
  if (!contact.has_two_tangents() && is_target(contact)) {
    const double segment_length = contact.result.positions.master.chord().norm();
    values(last) = segment_length * (local.projection.xi - target_->xi);
    if (!with_derivative) return;
    add_by_ports(equations, last, contact, segment_length * local.shift_row.transpose());
    derivative(last, last) = segment_length * local.shift_row[0] * contact.path_share;
  }
}

void EquilibriumEquations::add_forces_by_modes(const std::vector<PortMatrix>& by_ports,
                                               Eigen::MatrixXd& matrix) const {
  const Eigen::Index n = ports_.num_unknown;
  const Eigen::Index r = ports_.num_rigid;
  BlockProducts products(n + r, n + r);
  for (std::size_t i = 0; i < by_ports.size(); ++i) {
    if (by_ports[i].isZero(0.0)) continue;
    const Eigen::Index first = contacts[i].first_port;
    const Eigen::Index width = contacts[i].num_ports;
    const auto rigid = ports_.rigid_rows.middleRows(first, width);
    Eigen::MatrixXd before(n + r, width);
    before.topRows(n) = ports_.flexibility.middleCols(first, width);
    before.bottomRows(r) = rigid.transpose();
    Eigen::MatrixXd after(width, n + r);
    after.leftCols(n) = ports_.elastic_rows.middleRows(first, width);
    after.rightCols(r) = rigid;
    products.add(before, by_ports[i], after);
  }
  if (products.is_zero()) return;
  const Eigen::MatrixXd sum = products.sum();
  matrix.topLeftCorner(n, n) += sum.topLeftCorner(n, n);
  matrix.block(0, first_rigid(), n, r) += sum.topRightCorner(n, r);
  matrix.block(first_rigid(), 0, r, n) += sum.bottomLeftCorner(r, n);
  matrix.block(first_rigid(), first_rigid(), r, r) += sum.bottomRightCorner(r, r);
}

EquilibriumEquations::Factor EquilibriumEquations::factorise(const Values& equations) const {
  const Eigen::Index size = equations.values.size();
  Eigen::MatrixXd matrix = equations.derivative;
  if (ports_.is_modal) add_forces_by_modes(equations.by_ports, matrix);
  Eigen::VectorXd row_scale = Eigen::VectorXd::Ones(size);
  Eigen::VectorXd column_scale = Eigen::VectorXd::Ones(size);
  const auto inverse_root = [](double largest) {
    return largest > 0.0 ? 1.0 / std::sqrt(largest) : 1.0;
  };
  constexpr int num_balancings = 4;
  for (int k = 0; k < num_balancings; ++k) {
    const Eigen::VectorXd rows = matrix.cwiseAbs().rowwise().maxCoeff().unaryExpr(inverse_root);
    const Eigen::VectorXd columns =
        matrix.cwiseAbs().colwise().maxCoeff().transpose().unaryExpr(inverse_root);
    matrix = rows.asDiagonal() * matrix * columns.asDiagonal();
    row_scale.array() *= rows.array();
    column_scale.array() *= columns.array();
  }
  Factor factor{std::move(row_scale), std::move(column_scale),
                Eigen::PartialPivLU<Eigen::MatrixXd>(matrix)};
  constexpr double singular_below = 1e-14;
  // The estimate of the condition is not made for pivots that vanish.
  const double smallest_pivot = factor.lu.matrixLU().diagonal().cwiseAbs().minCoeff();
  if (!(smallest_pivot > singular_below) || !(factor.lu.rcond() > singular_below))
    refuse_singular(matrix);
  return factor;
}

Eigen::VectorXd EquilibriumEquations::newton_step(const Values& equations,
                                                  const Eigen::VectorXd& unknowns) {
  if (equations.values.size() == 0) return {};
  was_step_approximate_ = reuses_factor(equations.values.size());
  if (!was_step_approximate_) {
    factor_ = equations.derivative.size() > 0 ? factorise(equations)
                                              : factorise(evaluate(unknowns, true));
  }
  return factor_->column_scale.cwiseProduct(
      factor_->lu.solve(factor_->row_scale.cwiseProduct(equations.values)).eval());
}

void EquilibriumEquations::refuse_singular(const Eigen::MatrixXd& matrix) const {
  if (!matrix.allFinite())
    throw NumericalError(Refusal::no_equilibrium, "equilibrium: the equations are not finite");
  // The direction of the smallest pivot, however small that is.
  Eigen::FullPivLU<Eigen::MatrixXd> factor(matrix);
  const double smallest = std::abs(factor.matrixLU().diagonal().tail<1>().value());
  factor.setThreshold(smallest > 0.0 ? 2.0 * smallest / factor.maxPivot() : 0.0);
  const Eigen::VectorXd free = factor.kernel().col(0).cwiseAbs();
  const Eigen::VectorXd rigid = free.segment(first_rigid(), ports_.num_rigid);
  constexpr double negligible = 1e-3;
  if (ports_.num_rigid > 0 && rigid.maxCoeff() > negligible * free.maxCoeff()) {
    Eigen::Index mode = 0;
    rigid.maxCoeff(&mode);
    throw NumericalError(
        Refusal::no_equilibrium,
        fmt::format("equilibrium: the body '{}' is free to move: neither its supports nor closed "
                    "contacts hold it, or friction jams them",
                    ports_.body_of(mode)));
  }
  Eigen::Index contact = 0;
  free.segment(ports_.num_unknown, num_contacts()).maxCoeff(&contact);
  throw NumericalError(
      Refusal::no_equilibrium,
      fmt::format("equilibrium: the force of {} is undetermined: friction jams it, or other "
                  "contacts hold the same motion",
                  contacts[static_cast<std::size_t>(contact)].point->name));
}

std::vector<Eigen::VectorXd> EquilibriumEquations::displacements(
    const Eigen::VectorXd& unknowns) const {
  Eigen::VectorXd forces = Eigen::VectorXd::Zero(ports_.num_ports);
  for (const SoughtContact& contact : contacts) {
    const ContactEquilibrium& result = contact.result;
    auto ports = forces.segment(contact.first_port, contact.num_ports);
    if (contact.has_two_tangents()) {
      ports = -result.force * linearised_face(system_, state_, contact).force_row;
      continue;
    }
    const ContactRows rows = make_rows(result.projection, result.friction, result.direction);
    const ContactRow& pushed = rows.equilibrium;
    ports.head<2>() << pushed.slave[0], pushed.slave[1];
    for (Eigen::Index k = 2; k < contact.num_ports; ++k)
      ports(k) = pushed.master[static_cast<std::size_t>(k) - 2];
    ports *= -result.force;
  }
  const Eigen::VectorXd rigid = unknowns.segment(first_rigid(), ports_.num_rigid);
  std::vector<Eigen::VectorXd> found;
  found.reserve(system_.bodies.size());
  for (std::size_t b = 0; b < system_.bodies.size(); ++b)
    found.push_back(ports_.modes(b, forces, rigid));
  return found;
}

}  // namespace stridor
