#include "solvers/integrators/added_feedthrough.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "coupling/system/undeformed_contact.hpp"
#include "solvers/integrators/contact_path.hpp"
#include "solvers/integrators/coupled_step.hpp"
#include "solvers/integrators/modal_recurrence.hpp"

namespace stridor {
namespace {

/// Stable are ratios of the next answer to that at once up to 4. Friction, damping and what changes
/// along the path want some room.
constexpr double limit = 3.6;

/// What forces on modes or on a point do: at once, in the next step, and at once by added.
template <class Matrix>
struct Answers {
  Matrix feedthrough;
  Matrix next;
  Matrix added;       ///< per δ, to `feedthrough`
  Matrix added_next;  ///< likewise, taken from `next`
};

/// Of all modes of a body. Diagonals as columns where nothing is coupled.
struct BodyAnswers : Answers<Eigen::MatrixXd> {
  /// δ up to which the answers are linear in it: no mode answers at once by all of its flexibility.
  double most = std::numeric_limits<double>::infinity();
};

BodyAnswers answers_of_modes(const ModalBody& body, const TimeParameters& time, double alpha) {
  const Eigen::Index n = body.size();
  BodyAnswers found;
  for (Eigen::MatrixXd* one :
       {&found.feedthrough, &found.next, &found.added, &found.added_next})
    one->resize(n, 1);
  const Eigen::VectorXd damping = body.mode_damping(alpha);
  for (Eigen::Index i = 0; i < n; ++i) {
    const StepCoefficients c =
        step_coefficients(time.integrator, body.omega(i), damping(i), time.step, 0.0);
    // Of an oscillation that changes sign with every step, e/((1 + r₁)(1 + r₂)) per force; a
    // quarter of e for a free mass without damping.
    const double alternating = 4.0 / (2.0 + 2.0 * c.keep - c.pull);
    found.feedthrough(i) = c.feedthrough;
    found.next(i) = alternating * c.gain;
    found.added(i) = c.answer();
    found.added_next(i) = alternating * c.pull * c.answer();
    if (c.pull > 0.0) found.most = std::min(found.most, c.gain / (c.pull * c.answer()));
  }
  return found;
}

BodyAnswers answers_of_coupled(const SystemBody& body, const TimeParameters& time, double alpha) {
  // All of it is linear in δ up to the largest.
  constexpr double some = CoupledStep::largest_added;
  const auto symmetric = [](const Eigen::MatrixXd& a) -> Eigen::MatrixXd {
    return 0.5 * (a + a.transpose());
  };
  const CoupledStep without = make_coupled_step(body.modal, time.step, 0.0, alpha, body.name);
  const CoupledStep with = make_coupled_step(body.modal, time.step, some, alpha, body.name);
  BodyAnswers found;
  found.feedthrough = symmetric(without.feedthrough);
  found.next = 4.0 * symmetric(without.alternating());
  found.added = (symmetric(with.feedthrough) - found.feedthrough) / some;
  found.added_next = (found.next - 4.0 * symmetric(with.alternating())) / some;
  found.most = some;
  return found;
}

BodyAnswers answers_of(const SystemBody& body, const TimeParameters& time, double alpha) {
  return body.modal.coupled.is_empty() ? answers_of_modes(body.modal, time, alpha)
                                       : answers_of_coupled(body, time, alpha);
}

/// Least δ with which q (P + δ S) − (W − δ V) is positive semidefinite, of symmetric matrices.
template <class Matrix>
double least_added(const Answers<Matrix>& at) {
  const Matrix lacking = at.next - limit * at.feedthrough;
  Matrix gained = limit * at.added + at.added_next;
  if (!(gained.trace() > 0.0)) return 0.0;
  // A point that cannot move in one direction gains nothing there, and lacks nothing.
  gained.diagonal().array() += 1e-12 * gained.trace();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> pair(
      0.5 * (lacking + lacking.transpose()), 0.5 * (gained + gained.transpose()),
      Eigen::EigenvaluesOnly);
  return std::max(0.0, pair.eigenvalues().maxCoeff());
}

/// Least δ with which a body by itself is stable under the forces of any contacts.
double added_of_body(const BodyAnswers& body) {
  if (body.feedthrough.cols() > 1) return std::min(least_added(body), body.most);
  double added = 0.0;
  for (Eigen::Index i = 0; i < body.feedthrough.rows(); ++i) {
    const double gained = limit * body.added(i) + body.added_next(i);
    const double lacking = body.next(i) - limit * body.feedthrough(i);
    if (gained > 0.0) added = std::max(added, lacking / gained);
  }
  return added;
}

/// Of a point of a body, x and y.
using PointAnswers = Answers<Eigen::Matrix2d>;

PointAnswers answers_at(const ModalBody& body, const BodyAnswers& modes, const WeightedRows& point,
                        double step) {
  const Eigen::MatrixXd entries = rows_of(body.rows, point);
  const auto seen = [&](const Eigen::MatrixXd& of_modes) -> Eigen::Matrix2d {
    if (of_modes.cols() == 1)
      return entries * of_modes.col(0).asDiagonal() * entries.transpose();
    return entries * of_modes * entries.transpose();
  };
  PointAnswers sum{seen(modes.feedthrough), seen(modes.next), seen(modes.added),
                   seen(modes.added_next)};
  const Eigen::MatrixXd& residual = body.residual.flexibility;
  if (residual.size() > 0) {
    // Of a force that changes its sign with every step, w/(2 − w).
    const double share = step / (step + 2.0 * body.residual.beta);
    sum.feedthrough += share * rows_of(rows_of(residual, point).transpose(), point);
  }
  return sum;
}

PointAnswers operator+(const PointAnswers& a, const PointAnswers& b) {
  return {a.feedthrough + b.feedthrough, a.next + b.next, a.added + b.added,
          a.added_next + b.added_next};
}

/// Least δ along the path of the only contact; infinite where some mode cannot take as much.
double added_on_path(const System& system, const std::vector<BodyAnswers>& answers,
                       const TimeParameters& time) {
  const ContactPoint& contact = system.contacts.front();
  const auto slave = static_cast<std::size_t>(contact.slave_body);
  const auto master = static_cast<std::size_t>(system.surface_of(contact).body);
  const PointAnswers of_slave = answers_at(system.bodies[slave].modal, answers[slave],
                                           {{contact.slave_rows}, {1.0}}, time.step);
  double added = 0.0;
  for (const WeightedRows& place : path_of(system, contact, time.end)) {
    added = std::max(added, least_added(of_slave + answers_at(system.bodies[master].modal,
                                                                    answers[master], place,
                                                                    time.step)));
  }
  return added <= std::min(answers[slave].most, answers[master].most)
             ? added
             : std::numeric_limits<double>::infinity();
}

/// What a body answers along the normals of contacts on faces.
Answers<Eigen::MatrixXd> answers_along_normals(const System& system, std::size_t body,
                                               const BodyAnswers& modes, double step) {
  const ModalBody& modal = system.bodies[body].modal;
  const auto num_contacts = static_cast<Eigen::Index>(system.contacts.size());
  Eigen::MatrixXd shares = Eigen::MatrixXd::Zero(num_contacts, modal.rows.rows());
  for (Eigen::Index c = 0; c < num_contacts; ++c) {
    const ContactPoint& contact = system.contacts[static_cast<std::size_t>(c)];
    const std::optional<UndeformedContact> at = undeformed_contact(system, contact, 0.0);
    if (!at) continue;
    const TangentPorts& normal = at->kinematics.normal;
    const auto add = [&](int on, int row, double share) {
      if (static_cast<std::size_t>(on) == body && row >= 0) shares(c, row) += share;
    };
    Eigen::Index port = 0;
    for (const int row : system.master_rows(contact, at->facet))
      add(system.master_of(contact), row, normal[port++]);
    for (int i = 0; i < 3; ++i)
      add(contact.slave_body, contact.slave_rows.row(i), normal[normal.size() - 3 + i]);
  }
  const Eigen::MatrixXd entries = shares * modal.rows;
  const auto seen = [&](const Eigen::MatrixXd& of_modes) -> Eigen::MatrixXd {
    if (of_modes.cols() == 1)
      return entries * of_modes.col(0).asDiagonal() * entries.transpose();
    return entries * of_modes * entries.transpose();
  };
  Answers<Eigen::MatrixXd> found{seen(modes.feedthrough), seen(modes.next), seen(modes.added),
                                 seen(modes.added_next)};
  const Eigen::MatrixXd& residual = modal.residual.flexibility;
  if (residual.size() > 0) {
    // Of a force that changes its sign with every step, w/(2 − w).
    found.feedthrough += step / (step + 2.0 * modal.residual.beta) *
                         (shares * residual * shares.transpose());
  }
  return found;
}

/// Least δ of contacts that are all springs on faces, of which those that stick are sought at
/// t_{n+1}; infinite where some mode cannot take as much.
double added_on_springs(const System& system, const std::vector<BodyAnswers>& answers,
                        double step) {
  const auto num_contacts = static_cast<Eigen::Index>(system.contacts.size());
  Answers<Eigen::MatrixXd> all;
  for (Eigen::MatrixXd* one : {&all.feedthrough, &all.next, &all.added, &all.added_next})
    one->setZero(num_contacts, num_contacts);
  double most = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < answers.size(); ++b) {
    const Answers<Eigen::MatrixXd> one = answers_along_normals(system, b, answers[b], step);
    all.feedthrough += one.feedthrough;
    all.next += one.next;
    all.added += one.added;
    all.added_next += one.added_next;
    most = std::min(most, answers[b].most);
  }
  for (Eigen::Index c = 0; c < num_contacts; ++c)
    all.feedthrough(c, c) += system.contacts[static_cast<std::size_t>(c)].compliance();
  const double added = least_added(all);
  return added <= most ? added : std::numeric_limits<double>::infinity();
}

/// With the damping of one instant.
double added_at(const System& system, const TimeParameters& time, double instant) {
  std::vector<BodyAnswers> answers;
  double enough = 0.0;
  for (const SystemBody& body : system.bodies) {
    answers.push_back(answers_of(body, time, body.modal.damping.alpha_at(instant)));
    enough = std::max(enough, added_of_body(answers.back()));
  }
  if (has_springs_on_faces(system, time))
    return std::min(enough, added_on_springs(system, answers, time.step));
  if (system.contacts.size() != 1 || system.has_faces()) return enough;
  return std::min(enough, added_on_path(system, answers, time));
}

}  // namespace

bool has_springs_on_faces(const System& system, const TimeParameters& time) {
  return time.integrator == Integrator::exact && !system.contacts.empty() &&
         std::all_of(system.contacts.begin(), system.contacts.end(),
                     [](const ContactPoint& contact) {
                       return contact.has_two_tangents() && contact.compliance() > 0.0;
                     });
}

std::optional<double> added_feedthrough(const System& system, const TimeParameters& time) {
  if (time.integrator == Integrator::central_difference && !time.retain) return std::nullopt;
  // A force law acts by where the body is at the beginning of a step.
  if (std::any_of(system.contacts.begin(), system.contacts.end(),
                  [](const ContactPoint& contact) { return contact.substrate.has_value(); })) {
    return std::nullopt;
  }
  if (system.contacts.empty()) return 0.0;
  const double at_end = added_at(system, time, std::numeric_limits<double>::infinity());
  const bool is_faded =
      std::any_of(system.bodies.begin(), system.bodies.end(), [](const SystemBody& body) {
        return body.modal.damping.alpha_at(0.0) != body.modal.damping.alpha;
      });
  return is_faded ? std::max(at_end, added_at(system, time, 0.0)) : at_end;
}

}  // namespace stridor
