// Motion of one body from step to step under point forces.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/state.hpp"
#include "substructures/reduction/modal_body.hpp"

namespace stridor {

/// Data of the ports of a body with direct feedthrough, for the functions of every step.
struct FeedthroughPorts {
  std::size_t n = 0;                   ///< number of ports
  double share = 1.0;                  ///< w
  const double* compliance = nullptr;  ///< W, column after column
  const double* lag = nullptr;         ///< (1 − w) R, likewise; null without truncated modes
  const double* load = nullptr;        ///< response of the truncated modes to the loads
  double* predicted = nullptr;         ///< u*
  double* expected = nullptr;          ///< u* + W f_{n−1}
  double* current = nullptr;           ///< u_n
  double* increment = nullptr;         ///< u_n − u_{n−1}
  double* acting = nullptr;            ///< f of the last `settle`
  double* answer = nullptr;            ///< W f
  double* lagging = nullptr;           ///< f~
};

/// Marches one body with a two-step scheme under forces at its ports.
///
/// The contacts see a body through its ports: each port watches one row of ReducedBody::rows (the
/// displacement of a point in one direction). They seek the forces f_n for which the displacements
/// at one instant satisfy the contact conditions; there u = u* + W f_n with u* the prediction
/// without them. After construction and after every `advance` the body is at t_n with u* predicted.
/// `settle` takes the forces found, after which everything at t_n is known, and `advance` continues
/// under them.
///
/// That instant is t_{n+1} where the body responds in the next step (W = e of the scheme), and t_n
/// where it has direct feedthrough: the instantaneous parts g of its modes, and the residual
/// flexibility R of its truncated modes,
///
///   W = Σ φ g φᵀ + w R,   u* = Σ φ r_n + R_loads + (1 − w) R f~_{n−1},
///   f~_n = w f_n + (1 − w) f~_{n−1},   w = h/(h + β)
///
/// where f~ lags behind f by β, the damping of the truncated modes (docs/theory.md, 3.5 and 3.6).
///
/// Public functions keep the ports, the private hooks compute.
class Propagator {
  friend struct LaneAccess;

 public:
  /// The truncated modes of a body with direct feedthrough.
  struct Residual {
    ModalResidual modes;            ///< empty where there are none
    Eigen::MatrixXd load_patterns;  ///< displacement of every row per amplitude of a load
    Eigen::MatrixXd load_shapes;    ///< the same in reduced coordinates
    double step = 0.0;              ///< h, s
  };
  virtual ~Propagator() = default;
  Propagator(const Propagator&) = delete;
  Propagator& operator=(const Propagator&) = delete;

  int num_ports() const { return static_cast<int>(rows_.size()); }
  /// Adds ports behind the others, which watch row 0 until they are told otherwise, or takes some away that
  /// nothing acts on. Cost: that of all arrays between ports; `watch` of the new ones comes on top.
  void set_num_ports(int count);
  int row(int port) const { return rows_[at(port)]; }

  /// Lets a port watch another row. Its increment is not known until the next `advance`.
  /// Cost: a few products of the length of the body.
  void watch(int port, int row);

  /// Whether W is the instantaneous response to the forces, at t_n (direct feedthrough).
  bool has_feedthrough() const { return has_feedthrough_; }
  /// Whether u* and W are those of predict_start().
  bool is_starting() const { return is_starting_; }

  /// u* at a port, m.
  double predicted(int port) const { return predicted_[at(port)]; }
  /// The same with the instantaneous response to the last forces: the expected displacement, m.
  double expected(int port) const { return expected()[at(port)]; }
  /// u_n at a port, m, after `settle`.
  double current(int port) const { return current_[at(port)]; }
  /// u_n − u_{n−1} at a port, m, after `settle`; that of the step before where the port was given
  /// another row since.
  double increment(int port) const { return increment_[at(port)]; }
  /// W between ports: displacement of `a` per force on `b` at t_n, m/N.
  double compliance(int a, int b) const { return compliance_[at(b) * rows_.size() + at(a)]; }
  /// The same for all ports, in their order.
  const double* predicted() const { return predicted_.data(); }
  const double* expected() const { return (has_feedthrough_ ? expected_ : predicted_).data(); }
  const double* current() const { return current_.data(); }
  const double* increments() const { return increment_.data(); }
  /// W, column after column.
  const double* compliances() const { return compliance_.data(); }
  /// Grows whenever W, or that of predict_ahead(), becomes another.
  std::uint64_t compliance_version() const { return compliance_version_; }

  /// For a body with direct feedthrough: predicts its ports in the next step. Cost: a product of
  /// the length of the body for every port, and `watch` for ports that have changed their rows.
  void predict_ahead();
  /// The compliances of predict_ahead() alone, where they are not known yet. @returns whether they
  /// were not
  bool find_ahead_compliances();
  /// u at the ports at t_{n+1} without forces from t_n on, m, as of the last `predict_ahead`.
  const double* ahead() const { return ahead_.data(); }
  /// Displacement of ports at t_{n+1} per force that is constant from t_n on, m/N, column after
  /// column, as of the last `predict_ahead` or `find_ahead_compliances`.
  const double* ahead_compliances() const { return ahead_compliance_.data(); }

  /// Makes u_n = u and its rate v, in the coordinates of the body, and predicts anew from the loads
  /// and the damping set last.
  /// @param forces on the ports at t_n; they matter to a body with direct feedthrough
  void set_motion(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity,
                  const double* forces);
  /// First part of a start with unknown forces, for a body with direct feedthrough: until the next
  /// `set_motion`, u* and W are those of t_{n+1} under forces constant in the step.
  void predict_start(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity);

  /// Completes everything at t_n from the forces on the ports at t_n, N.
  void settle(const double* forces);
  /// @param forces those of `settle`
  void advance(const double* forces);

  /// u_n of any row, m, after `settle`. Cost: a product of the length of the body; the
  /// instantaneous response of a row is computed when it is first asked for with these ports.
  double displacement(int row) const;

  /// u_n and its rate in the coordinates of the body: by the scheme itself where it knows the
  /// velocity, else (u_n − u_{n−1})/h.
  struct Motion {
    Eigen::VectorXd displacement;
    Eigen::VectorXd velocity;
  };
  /// @param forces on the ports at t_n, N
  virtual Motion motion(const double* forces) const = 0;
  /// Contribution of the truncated modes to u_n in reduced coordinates, m; empty without them.
  Eigen::VectorXd residual_displacement() const;

  /// The step that `advance` would make with these forces: u_n and u_{n+1} − u_n in the coordinates
  /// of the body, which stays where it is.
  /// @param forces on the ports at t_n, N
  /// Cost: less than that of `advance`. No allocation.
  virtual void predict_step(const double* forces, std::span<double> position,
                       std::span<double> increment) const = 0;

  /// Amplitudes of the load patterns for the next prediction (N and m/s²; see make_propagator).
  void set_loads(std::span<const double> amplitudes);
  /// α of the Rayleigh damping for the next prediction, 1/s.
  virtual void set_mass_damping(double alpha) = 0;

  /// State from which a later `load` into a propagator of the same body resumes bit-identically to
  /// an uninterrupted run.
  void save(State& state, const std::string& prefix) const;
  /// @throws std::invalid_argument if the state is of another body or lacks arrays
  void load(const State& state, const std::string& prefix);

 protected:
  explicit Propagator(int num_ports) : Propagator(num_ports, false, Residual{}) {}
  Propagator(int num_ports, bool has_feedthrough, Residual residual);

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

  /// Instantaneous response of another row to forces on the ports.
  struct Influence {
    int row;
    std::vector<double> modes;     ///< of the retained modes, per port
    std::vector<double> residual;  ///< of the truncated modes
  };

  static std::size_t at(int port) { return static_cast<std::size_t>(port); }
  bool has_residual() const { return residual_.modes.flexibility.size() > 0; }
  /// `watch` for all ports as they are.
  void place_ports();
  void find_feedthrough_ports();
  void take_new_rows(const double* forces);
  /// W between a port and all others.
  void renew_compliance(int port);
  /// W between two ports, in both directions.
  void renew_compliance(int port, int other);
  /// Predicts a port whose row and compliances are known.
  void look(int port);
  const Influence& influence_on(int row) const;
  double feedthrough_compliance(int row_a, int row_b) const;
  /// Displacement of a row by the truncated modes, due to the loads and the forces before t_n.
  double lagging_residual(int row) const;
  /// Displacement of a row by the truncated modes, due to the loads.
  double load_residual(int row) const;

  virtual void advance_body(const double* forces, double* predicted) = 0;
  /// u_n of a row, without the instantaneous response.
  virtual double body_displacement(int row) const = 0;
  /// u* of a row.
  virtual double predicted_displacement(int row) const = 0;
  virtual double row_compliance(int row_a, int row_b) const = 0;
  /// u at t_{n+1} without forces from t_n on, and its change per constant force, of a body with
  /// direct feedthrough.
  virtual double ahead_displacement(int /*row*/) const { return 0.0; }
  virtual double ahead_compliance(int /*row_a*/, int /*row_b*/) const { return 0.0; }
  virtual void port_changed(int port) = 0;
  /// There are more or fewer of them.
  virtual void num_ports_changed() {}
  virtual void set_body_loads(std::span<const double> amplitudes) = 0;
  virtual void set_body_motion(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity,
                               const double* forces) = 0;
  /// u* and W by is_starting() for the motion at t_n; for a body with direct feedthrough.
  virtual void predict_body_start(const Eigen::VectorXd& /*displacement*/,
                                  const Eigen::VectorXd& /*velocity*/) {}
  /// u_n − u_{n−1} of a row as set_body_motion() has left it.
  virtual double initial_increment(int row, const Eigen::VectorXd& velocity) const = 0;
  virtual void save_body(State& state, const std::string& prefix) const = 0;
  virtual void load_body(const State& state, const std::string& prefix) = 0;

  std::vector<int> rows_;
  std::vector<double> predicted_;
  std::vector<double> current_;
  std::vector<double> increment_;
  std::vector<double> compliance_;

  bool has_feedthrough_;
  bool is_starting_ = false;
  bool has_new_rows_ = false;  ///< since the last `settle`
  std::vector<double> expected_;
  RowForces acting_;            ///< f of the last `settle`
  std::vector<double> answer_;  ///< W f at the ports
  std::vector<double> ahead_;
  std::vector<double> ahead_compliance_;
  bool has_ahead_compliance_ = false;
  std::vector<char> lacks_ahead_compliance_;  ///< of the ports
  std::uint64_t compliance_version_ = 0;
  std::vector<double> last_increment_;
  /// Of the rows of acting_ on the rows asked for; emptied when either changes.
  mutable std::vector<Influence> influences_;

  Residual residual_;
  double share_ = 1.0;              ///< w
  std::vector<double> amplitudes_;  ///< of the loads
  std::vector<double> port_load_;   ///< load_residual() of the ports
  RowForces lagging_;               ///< f~
  std::vector<double> port_lag_;    ///< (1 − w) R between ports
  FeedthroughPorts feedthrough_ports_;
};

}  // namespace stridor
