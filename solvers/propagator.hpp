// How one body moves from step to step under point forces.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "core/state.hpp"
#include "substructures/modal_body.hpp"

namespace stridor {

/// Marches one body with a two-step scheme: u_{n+1} = u*_{n+1} + W f_n.
///
/// The contacts see a body through its slots: each slot watches one row of ReducedBody::rows (the
/// displacement of a point in one direction). After construction and after every `advance` the body
/// stands at t_n with u*_{n+1} predicted from the loads at t_n; `advance` takes the slot forces at
/// t_n, corrects to u_{n+1} and predicts u*_{n+2}. Public functions keep the slots, the private
/// hooks compute.
///
/// Where a body leaves modes out, their static answer is part of it (docs/theory.md, 3.6): of the
/// residual displacement at t_{n+1}, R ((3/2 + θ) f_n − (1 + θ) f_{n−1} + ½ f_{n−2}), the first
/// term belongs to W, the others and the answer to the loads to u*; `expected` has R f_{n−1}
/// instead.
class Propagator {
 public:
  /// The modes that a body leaves out.
  struct Residual {
    ModalResidual modes;            ///< empty where there are none
    Eigen::MatrixXd load_patterns;  ///< displacement of every row per amplitude of a load
    Eigen::MatrixXd load_shapes;    ///< the same in reduced coordinates
    double step = 0.0;              ///< h, s
  };
  virtual ~Propagator() = default;
  Propagator(const Propagator&) = delete;
  Propagator& operator=(const Propagator&) = delete;

  int num_slots() const { return static_cast<int>(rows_.size()); }
  int row(int slot) const { return rows_[at(slot)]; }

  /// Lets a slot watch another row. Its increment is not known until the next `advance`.
  /// Cost: a few products of the length of the body.
  void watch(int slot, int row);

  /// u*_{n+1} at a slot, m.
  double predicted(int slot) const { return predicted_[at(slot)]; }
  /// The same with what the modes left out are expected to add under the contact forces, m.
  double expected(int slot) const { return (expected_.empty() ? predicted_ : expected_)[at(slot)]; }
  /// u_n at a slot, m.
  double current(int slot) const { return current_[at(slot)]; }
  /// u_n − u_{n−1} at a slot, m, for the row it watched when `advance` was called.
  double increment(int slot) const { return increment_[at(slot)]; }
  /// W between slots: displacement of `a` at t_{n+1} per force on `b` at t_n, m/N.
  double compliance(int a, int b) const { return compliance_[at(a) * rows_.size() + at(b)]; }
  const double* increments() const { return increment_.data(); }
  const double* compliances() const { return compliance_.data(); }

  /// Makes u_n = u and its rate v, in the coordinates of the body, and predicts anew from the loads
  /// and the damping set last.
  /// @param forces that will act on the slots at t_n, as far as they are known
  void set_motion(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity,
                  const double* forces);

  /// @param forces on the slots at t_n, N
  void advance(const double* forces);

  /// u_n of any row, m. Cost: one product of the length of the body.
  double displacement(int row) const;

  /// u_n and its rate in the coordinates of the body: by the scheme itself where it knows the
  /// velocity, else (u_n − u_{n−1})/h.
  struct Motion {
    Eigen::VectorXd displacement;
    Eigen::VectorXd velocity;
  };
  /// @param forces on the slots at t_n, N
  virtual Motion motion(const double* forces) const = 0;
  /// What the modes left out add to u_n in reduced coordinates, m; empty where there are none.
  Eigen::VectorXd residual_displacement() const;

  /// The step that `advance` would make with these forces: u_n and u_{n+1} − u_n in the coordinates
  /// of the body, which stays where it is.
  /// @param forces on the slots at t_n, N
  /// Cost: less than that of `advance`. No allocation.
  virtual void foresee(const double* forces, std::span<double> position,
                       std::span<double> increment) const = 0;

  /// Amplitudes of the load patterns for the next prediction (N and m/s²; see make_propagator).
  void set_loads(std::span<const double> amplitudes);
  /// α of the Rayleigh damping for the next prediction, 1/s.
  virtual void set_mass_damping(double alpha) = 0;

  /// Everything that a later `load` into a propagator of the same body needs to go on bitwise
  /// equally.
  void save(State& state, const std::string& prefix) const;
  /// @throws std::invalid_argument if the state is of another body or lacks arrays
  void load(const State& state, const std::string& prefix);

 protected:
  explicit Propagator(int num_slots) : Propagator(num_slots, Residual{}) {}
  Propagator(int num_slots, Residual residual);

  /// Sets u_n = u_{n−1} = 0 and predicts u*_1; the constructor of a derived class calls it last.
  void start();

  const std::vector<int>& rows() const { return rows_; }
  /// W is another from here on.
  void renew_compliances();

 private:
  /// Forces on rows of the body.
  struct RowForces {
    std::vector<int> rows;
    std::vector<double> forces;
  };

  static std::size_t at(int slot) { return static_cast<std::size_t>(slot); }
  bool has_residual() const { return residual_.modes.flexibility.size() > 0; }
  void renew_compliance(int slot);
  void add_residual(int slot);
  void add_residuals();
  double residual_flexibility(int row, const RowForces& forces) const;
  /// Of a row by the loads.
  double load_residual(int row) const;

  virtual void advance_body(const double* forces, double* predicted) = 0;
  /// u_n of a row.
  virtual double body_displacement(int row) const = 0;
  /// u*_{n+1} of a row.
  virtual double predicted_displacement(int row) const = 0;
  virtual double row_compliance(int row_a, int row_b) const = 0;
  virtual void slot_changed(int slot) = 0;
  virtual void set_body_loads(std::span<const double> amplitudes) = 0;
  virtual void set_body_motion(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity,
                               const double* forces) = 0;
  /// u_n − u_{n−1} of a row as set_body_motion() has left it.
  virtual double initial_increment(int row, const Eigen::VectorXd& velocity) const = 0;
  virtual void save_body(State& state, const std::string& prefix) const = 0;
  virtual void load_body(const State& state, const std::string& prefix) = 0;

  std::vector<int> rows_;
  std::vector<double> predicted_;
  std::vector<double> current_;
  std::vector<double> increment_;
  std::vector<double> compliance_;

  Residual residual_;
  double present_share_ = 0.0;      ///< of f_n in the force that the modes left out answer to
  double last_share_ = 0.0;         ///< of f_{n−1} in it
  std::vector<double> amplitudes_;  ///< of the loads
  RowForces last_;                  ///< of the last `advance`
  RowForces last_but_one_;
  int advances_on_rows_ = 0;  ///< since a slot got another row; 2: both are of the present rows
  std::vector<double> slot_flexibility_;  ///< R between slots
  std::vector<double> slot_load_;         ///< load_residual() of the slots
  std::vector<double> by_last_;           ///< R f_{n−1} at the slots
  std::vector<double> by_last_but_one_;   ///< R f_{n−2} at the slots
  std::vector<double> expected_;          ///< as predicted_ where empty: without residual
};

}  // namespace stridor
