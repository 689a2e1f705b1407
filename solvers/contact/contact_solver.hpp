// The contact forces of one step: persistent sliding, or stick, slip and lift-off.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <optional>
#include <span>
#include <vector>

#include "coupling/laws/friction_law.hpp"
#include "coupling/laws/substrate_contact.hpp"
#include "solvers/contact/contact_jamming.hpp"
#include "solvers/contact/sweep_acceleration.hpp"

namespace stridor {

enum class ContactState {
  open,   ///< no force
  stick,  ///< closed, no slip in the step
  slip,   ///< closed, friction at its limit
};

/// One contact as the solver sees it in a step (docs/theory.md, 2.4).
///
/// Forces are λ_n, compression positive, and λ_t, against the slip when positive; both act over the
/// step and change penetration and slip by −W (λ_n, λ_t) with W the Delassus operator.
struct LocalProblem {
  double penetration = 0.0;        ///< −gap at the end of the step without contact forces, m
  double slip = 0.0;               ///< along the tangent over the step, likewise, m
  double sliding_friction = 0.0;   ///< μ while sliding
  double sticking_friction = 0.0;  ///< μ up to which it sticks in this step
  double direction = 1.0;          ///< χ of persistent sliding, ±1
  bool is_unilateral = false;      ///< false: persistent sliding, λ_n of either sign

  /// A regularised law of friction in the place of the two coefficients, not owned; null where
  /// there is none.
  const FrictionLaw* creep = nullptr;
  double friction_factor = 1.0;  ///< on that law

  /// A force law instead of a constraint, not owned; null where there is none. Of what is above it
  /// takes the slip.
  const SubstrateContact* substrate = nullptr;
  double indentation = 0.0;  ///< at the beginning of the step, m
  double last_slip = 0.0;    ///< velocity in the last step, m/s; for the two laws
  double step = 0.0;         ///< s, likewise

  // Answer; on entry the guess from which the iteration starts.
  double normal = 0.0;      ///< λ_n, N
  double tangential = 0.0;  ///< λ_t, N
  ContactState state = ContactState::open;
  double stiffness = 0.0;  ///< of the force law, by the indentation, N/m
};

/// The same of a contact with two tangents: λ = (λ_n, τ) with friction τ along both, against slip σ
/// when along it (docs/theory.md, 2.4). Slip is a vector; friction opposes it as such.
struct PlanarProblem {
  double penetration = 0.0;                        ///< as LocalProblem, m
  Eigen::Vector2d slip = Eigen::Vector2d::Zero();  ///< likewise, m
  double sliding_friction = 0.0;                   ///< μ while sliding
  double sticking_friction = 0.0;                  ///< μ up to which it sticks in this step
  Eigen::Vector2d direction{1.0, 0.0};             ///< of persistent sliding, a unit vector
  bool is_unilateral = false;                      ///< false: persistent sliding

  /// A regularised law of friction in the place of the two coefficients, not owned.
  const FrictionLaw* creep = nullptr;
  double friction_factor = 1.0;  ///< on that law
  double step = 0.0;             ///< over which it slips, s

  // Answer; on entry the guess from which the iteration starts.
  double normal = 0.0;                                   ///< λ_n, N
  Eigen::Vector2d tangential = Eigen::Vector2d::Zero();  ///< τ, N
  ContactState state = ContactState::open;
};

/// Where the search for η of a slipping contact begins: from the slip under the forces that it has,
/// which is near where visits settle, or from what is known alone. Where several η solve a contact
/// the former may take one and the other from visit to visit without end.
enum class SlipStart { last_forces, known };

/// The solution of one contact with two tangents under forces known. With η ≥ 0 in
///
///   [D_nn  D_nt    ] [λ]   [p*]
///   [D_tn  D_tt + η] [τ] = [σ*],   σ = η τ,   φ(η) = |τ| − μ λ = 0,
///
/// slip is along friction by construction, and φ is a scalar equation: φ(0) > 0 where the contact
/// does not stick, φ → −μ p*/D_nn as η grows. For a regularised law μ = μ(v) s(v) at v = η |τ|/h.
/// @param delassus D, 3 x 3, with the compliance of a penalty
/// @param known    p* and σ*
/// @return false where no force closes the gap
bool solve_planar(PlanarProblem& contact, const Eigen::Matrix3d& delassus,
                  const Eigen::Vector3d& known, SlipStart start = SlipStart::last_forces);

/// The solution of one contact with one tangent, likewise.
/// @param delassus 2 x 2
bool solve_line(LocalProblem& contact, const Eigen::Matrix2d& delassus, double penetration,
                double slip);

enum class ContactStatus {
  converged,
  jammed,         ///< no contact force closes the gap of the contact named
  not_converged,  ///< the iteration has used up its sweeps; the contact named moved last
};

struct ContactAnswer {
  ContactStatus status = ContactStatus::converged;
  int contact = 0;  ///< the one to blame; those with two tangents come after the others
  int sweeps = 0;
};

struct ContactSolverParameters {
  double tolerance =
      1e-12;  ///< largest change of a force in a sweep, relative to the largest force
  int max_sweeps = 1000;
};

/// Solves the contacts of one step.
///
/// Unilateral contacts obey, at the end of the step,
///
///   0 ≤ λ_n ⟂ gap ≥ 0,   |λ_t| ≤ μ λ_n,   slip = 0 where |λ_t| < μ λ_n,
///
/// bilateral ones gap = 0 and λ_t = χ μ λ_n. A penalty 1/k on the diagonal of W makes the gap
/// −λ_n/k in both. Regularised friction is λ_t = μ(v) s(v) λ_n of the mean velocity v = slip/h of
/// the step. Contacts that all slide bilaterally without it are one linear system. Otherwise the
/// contacts are visited in turn, each solved exactly under the forces of the others (Gauss-Seidel
/// over 2 x 2 blocks), until no force changes any more; for a single contact the first visit is the
/// solution. Sweeps over contacts with two tangents are extrapolated while states stay (SweepAcceleration).
/// Sticking is tried first, with the sign of its friction force the direction of sliding
/// where that exceeds the limit (FiLM: Carpenter, Taylor, Katona 1991). A contact with a force law
/// is solved by solve_substrate_step().
class ContactSolver {
 public:
  /// @param num_planar contacts with two tangents, besides
  explicit ContactSolver(int num_contacts, ContactSolverParameters parameters = {},
                         int num_planar = 0);

  /// W, row and column 2i for the normal and 2i+1 for the tangent of contact i; three for each of
  /// the contacts with two tangents after all others (first_planar()). To be filled before `solve`.
  Eigen::MatrixXd& delassus() { return delassus_; }

  /// @param contacts problems in, solutions out
  /// No allocation but where strong friction makes bilateral contacts nearly jam.
  ContactAnswer solve(std::span<LocalProblem> contacts);
  /// The same where some have two tangents, in blocks of 1 + d.
  ContactAnswer solve(std::span<LocalProblem> contacts, std::span<PlanarProblem> planar);
  /// Row of the normal of a contact with two tangents.
  Eigen::Index first_planar(int index) const { return num_lines_ + 3 * index; }

 private:
  ContactAnswer solve_bilateral(std::span<LocalProblem> contacts);
  ContactAnswer iterate(std::span<LocalProblem> contacts);
  ContactAnswer solve_bilateral(std::span<LocalProblem> contacts, std::span<PlanarProblem> planar);
  ContactAnswer iterate(std::span<LocalProblem> contacts, std::span<PlanarProblem> planar);
  /// Visits all contacts once. @returns the one that jams, if any
  std::optional<int> sweep(std::span<LocalProblem> contacts, std::span<PlanarProblem> planar,
                           SlipStart start);
  /// Takes away what forces on the columns from one on do to gaps and slips.
  template <class Forces>
  void act(Eigen::Index column, const Forces& forces);
  /// Takes other forces in the place of after_, unless a closed contact would pull.
  bool take_forces(std::span<LocalProblem> contacts, std::span<PlanarProblem> planar,
                   const Eigen::VectorXd& forces);

  ContactSolverParameters parameters_;
  Eigen::MatrixXd delassus_;
  Eigen::MatrixXd sliding_;  ///< B_C W B_Eᵀ
  Eigen::VectorXd right_side_;
  Eigen::VectorXd forces_;
  Eigen::PartialPivLU<Eigen::MatrixXd> factor_;
  JammingTest jamming_;
  Eigen::Index num_lines_;  ///< rows of contacts with one tangent
  // Scratch; empty without contacts of two tangents.
  Eigen::VectorXd left_;            ///< of gaps and slips
  Eigen::VectorXd before_, after_;  ///< all forces, of a sweep
  SweepAcceleration acceleration_;
};

}  // namespace stridor
