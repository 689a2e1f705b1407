// Equations of a static equilibrium in the ports of its contacts.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <optional>
#include <vector>

#include "coupling/system/system.hpp"
#include "solvers/equilibrium/equilibrium.hpp"
#include "solvers/equilibrium/sought_contact.hpp"
#include "solvers/equilibrium/static_ports.hpp"

namespace stridor {

/// Place on its master that a contact is to have.
struct Target {
  int contact = 0;
  int segment = 0;
  double xi = 0.0;
};

/// The equations
///
///   z − z_load − S_r a + R B_Eᵀλ = 0,   gap = 0 (or λ = 0),   S_rᵀ B_Eᵀλ − load_r = 0
///
/// for the displacements z of the ports, λ and the rigid amplitudes a, in this order; with a
/// target, ξ of its contact for the displacement of the drive at the end. Where the ports are more
/// than the elastic modes, p − p_load + R B_Eᵀλ = 0 for the displacements p of these (StaticPorts).
class EquilibriumEquations {
 public:
  struct Values {
    Eigen::VectorXd values;
    Eigen::VectorXd scale;       ///< what each of them is made of
    /// With respect to the unknowns; where those are displacements of modes, without `by_ports`.
    /// Empty where it is not needed.
    Eigen::MatrixXd derivative;
    double residual = 0.0;  ///< largest value by scale
    /// How the force of each contact changes with the displacements of its ports, where the unknown
    /// ones are those of modes.
    std::vector<PortMatrix> by_ports{};
  };

  /// @param system must outlive it
  /// @param state  must outlive it; with a target its drive displacement is written
  /// @throws NumericalError as sought_contact()
  EquilibriumEquations(const System& system, EquilibriumState& state, std::optional<Target> target);
  EquilibriumEquations(const EquilibriumEquations&) = delete;
  EquilibriumEquations& operator=(const EquilibriumEquations&) = delete;
  ~EquilibriumEquations() = default;

  /// All zero, but for the displacement of the drive with a target.
  Eigen::VectorXd first_unknowns() const;

  /// To be called whenever a contact is on another segment.
  void gather() { ports_.gather(contacts); }

  /// Also notes in `contacts` what they are like there. Without the derivative where newton_step()
  /// takes one that is factored already.
  Values evaluate(const Eigen::VectorXd& unknowns);

  /// Newton step. Where the unknowns are displacements of many modes, by the derivative that was
  /// factored last, until forget_factor().
  /// @param equations at `unknowns`
  /// @throws NumericalError if the equations are singular, naming what is free
  Eigen::VectorXd newton_step(const Values& equations, const Eigen::VectorXd& unknowns);
  /// Whether the last step was by the derivative of other unknowns.
  bool was_step_approximate() const { return was_step_approximate_; }
  void forget_factor() { factor_.reset(); }

  /// Displacements of the modes of all bodies.
  std::vector<Eigen::VectorXd> displacements(const Eigen::VectorXd& unknowns) const;

  bool is_target(const SoughtContact& contact) const {
    return target_ && &contact == &contacts[static_cast<std::size_t>(target_->contact)];
  }
  /// Place of a contact force among the unknowns.
  Eigen::Index force_index(const SoughtContact& contact) const {
    return ports_.num_unknown + (&contact - contacts.data());
  }

  std::vector<SoughtContact> contacts;

 private:
  bool reuses_factor(Eigen::Index size) const;
  Values evaluate(const Eigen::VectorXd& unknowns, bool with_derivative);
  Eigen::Index num_contacts() const { return static_cast<Eigen::Index>(contacts.size()); }
  /// A derivative, rows and columns brought to the same size first: they mix m, N and m kg^½.
  struct Factor {
    Eigen::VectorXd row_scale, column_scale;
    Eigen::PartialPivLU<Eigen::MatrixXd> lu;
  };
  Factor factorise(const Values& equations) const;
  /// Adds what contact forces that change with displacements of modes contribute to the derivative.
  void add_forces_by_modes(const std::vector<PortMatrix>& by_ports, Eigen::MatrixXd& matrix) const;
  Eigen::Index first_rigid() const { return ports_.num_unknown + num_contacts(); }
  /// Adds what a contact contributes and notes its state. @returns the largest length in it, m
  double add_contact(Values& equations, Eigen::Index index, const Eigen::VectorXd& unknowns,
                     const Eigen::VectorXd& at_ports);
  /// Adds to one equation what changes with the displacements of the ports of a contact.
  void add_by_ports(Values& equations, Eigen::Index row, const SoughtContact& contact,
                    const Eigen::RowVectorXd& by_ports) const;
  /// The conditions that a contact obeys: that of its gap or force, and that it is on its target.
  void add_conditions(Values& equations, Eigen::Index index, const ContactLinearisation& local,
                      const LawState& law, double force);
  [[noreturn]] void refuse_singular(const Eigen::MatrixXd& matrix) const;

  const System& system_;
  EquilibriumState& state_;
  std::optional<Target> target_;
  StaticPorts ports_;
  std::optional<Factor> factor_;
  bool was_step_approximate_ = false;
};

}  // namespace stridor
