// Static flexibility of all bodies at the ports that contacts touch.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "coupling/system/system.hpp"
#include "solvers/equilibrium/equilibrium.hpp"
#include "solvers/equilibrium/sought_contact.hpp"

namespace stridor {

/// Size of a load of a body in a state, N or m.
double size_of(const BodyLoad& load, const EquilibriumState& state);

/// Elastic modes eliminated: displacements z of all ports by contact forces, loads and rigid modes,
///
///   z = z_load + S_r a − R B_Eᵀλ
///
/// for the segments on which the contacts are.
class StaticPorts {
 public:
  /// @param system and state must outlive it; loads are those of the state
  StaticPorts(const System& system, const EquilibriumState& state);

  /// Rows and static flexibility at the ports of the present segments.
  /// @param contacts with the places of their ports among all
  void gather(const std::vector<SoughtContact>& contacts);

  /// Displacement of the modes of a body.
  /// @param forces on all ports, N
  /// @param rigid  amplitudes of all rigid modes
  Eigen::VectorXd modes(std::size_t body, const Eigen::VectorXd& forces,
                        const Eigen::VectorXd& rigid) const;

  /// Name of the body that a rigid mode among all belongs to.
  const std::string& body_of(Eigen::Index rigid_mode) const;

  Eigen::Index num_ports = 0;
  Eigen::Index num_rigid = 0;
  Eigen::MatrixXd flexibility;  ///< R = S diag(1/ω²) Sᵀ over the elastic modes, m/N
  Eigen::MatrixXd rigid_rows;   ///< S_r
  Eigen::VectorXd loaded;       ///< z_load, displacements of the ports by the load, elastic, m
  Eigen::VectorXd rigid_load;   ///< load on the rigid modes

 private:
  /// Where the ports and rigid modes of one body stand among all, and its rows there.
  struct BodyPorts {
    std::vector<int> ports;
    Eigen::MatrixXd rows;  ///< ports x modes
    Eigen::Index num_rigid = 0;
    Eigen::Index first_rigid = 0;
  };

  /// On the modes of a body: loads of drives and what it holds.
  Eigen::VectorXd load_on(const SystemBody& body) const;

  const System& system_;
  const EquilibriumState& state_;
  std::vector<BodyPorts> bodies_;
};

}  // namespace stridor
