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

/// Displacements of the bodies by contact forces, loads and rigid modes. Unknown are the
/// displacements z of all ports, elastic modes eliminated,
///
///   z = z_load + S_r a − R B_Eᵀλ,   R = S D Sᵀ
///
/// with D = diag(1/ω²), or, where the ports are more than the elastic modes, those p of these
/// modes,
///
///   p = p_load − R B_Eᵀλ,   R = D Sᵀ,   z = S p + S_r a
///
/// for the segments on which the contacts are.
class StaticPorts {
 public:
  /// @param system and state must outlive it; loads are those of the state
  StaticPorts(const System& system, const EquilibriumState& state);

  /// Rows and static flexibility at the ports of the present segments.
  /// @param contacts with the places of their ports among all
  void gather(const std::vector<SoughtContact>& contacts);

  /// z of the unknown displacements and the amplitudes of the rigid modes.
  Eigen::VectorXd at_ports(const Eigen::VectorXd& unknown, const Eigen::VectorXd& rigid) const;

  /// Displacement of the modes of a body.
  /// @param forces on all ports, N
  /// @param rigid  amplitudes of all rigid modes
  Eigen::VectorXd modes(std::size_t body, const Eigen::VectorXd& forces,
                        const Eigen::VectorXd& rigid) const;

  /// Name of the body that a rigid mode among all belongs to.
  const std::string& body_of(Eigen::Index rigid_mode) const;

  Eigen::Index num_ports = 0;
  Eigen::Index num_rigid = 0;
  Eigen::Index num_unknown = 0;  ///< displacements: of the ports, or of elastic modes
  bool is_modal = false;         ///< whether they are those of elastic modes
  Eigen::MatrixXd flexibility;   ///< R, over the elastic modes; unknown displacements x ports
  Eigen::MatrixXd elastic_rows;  ///< S, ports x elastic modes; where these are unknown
  Eigen::MatrixXd rigid_rows;    ///< S_r, ports x rigid modes
  Eigen::VectorXd loaded;        ///< z_load or p_load, by the load, elastic
  Eigen::VectorXd loaded_ports;  ///< z_load in both cases
  Eigen::VectorXd rigid_load;    ///< load on the rigid modes

 private:
  /// Where the ports and rigid modes of one body stand among all, and its rows there.
  struct BodyPorts {
    std::vector<int> ports;
    Eigen::MatrixXd rows;  ///< ports x modes
    Eigen::Index num_rigid = 0;
    Eigen::Index first_rigid = 0;
    Eigen::Index first_elastic = 0;
  };

  /// The part of a body. @param watched rows at its ports
  void gather_body(std::size_t b, const std::vector<int>& watched);
  /// On the modes of a body: loads of drives and what it holds.
  Eigen::VectorXd load_on(const SystemBody& body) const;

  const System& system_;
  const EquilibriumState& state_;
  std::vector<BodyPorts> bodies_;
};

}  // namespace stridor
