// Contacts on the faces of a spinning plate as they see and push bodies at their ports.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "coupling/face_contact.hpp"

namespace stridor {

/// What of a contact can be recorded.
enum class FacePort { plate_w = 0, pad_r = 5, pad_phi = 6, pad_z = 7 };

/// The displacements of bodies that contacts see, y = R x, and how they act on them
/// (docs/theory.md, 10.2, 10.6); x and y are counted from a sliding state.
///
/// Each contact has eight ports: w, w_r, w_φ, w_rφ, w_φφ of the plate, which contacts at one place
/// share, and r, φ and z of its pad. In their order FaceContact says of them what it says of all
/// coordinates.
class FaceContactPorts {
 public:
  static constexpr int plate_ports = 5;
  static constexpr int pad_ports = 3;
  static constexpr int per_contact = plate_ports + pad_ports;
  using Local = Eigen::Matrix<double, per_contact, 1>;
  /// Three of a contact: along its normal, along the sliding direction and across it.
  using LocalRows = Eigen::Matrix<double, 3, per_contact>;
  using LocalColumns = Eigen::Matrix<double, per_contact, 3>;

  FaceContactPorts(const std::vector<FaceContact>& contacts, const FaceContactLaw& law,
                   const FaceSlidingState& state);

  int num_contacts() const { return static_cast<int>(contacts_.size()); }
  Eigen::Index num_ports() const { return rows_.rows(); }
  /// R, on the coordinates of the bodies.
  const Eigen::MatrixXd& rows() const { return rows_; }

  /// Rows of every contact on all ports: 3k x ports.
  Eigen::MatrixXd placed(const std::vector<LocalRows>& rows) const;
  /// Forces on the ports of unit forces of the undisplaced contacts: ports x 3k.
  Eigen::MatrixXd inputs() const;
  /// Gap and velocities of the sliding state, and its forces, 3k.
  const Eigen::VectorXd& drive() const { return drive_; }
  const Eigen::VectorXd& preload() const { return preload_; }
  bool bends() const { return bends_; }

  /// The ports of one contact.
  Local of(int contact, const double* ports) const {
    const Contact& one = contacts_[static_cast<std::size_t>(contact)];
    Local local;
    for (int i = 0; i < plate_ports; ++i) local[i] = ports[one.plate + i];
    for (int i = 0; i < pad_ports; ++i) local[plate_ports + i] = ports[one.pad + i];
    return local;
  }
  /// Adds to its ports.
  void add(int contact, const Local& local, double* ports) const {
    const Contact& one = contacts_[static_cast<std::size_t>(contact)];
    for (int i = 0; i < plate_ports; ++i) ports[one.plate + i] += local[i];
    for (int i = 0; i < pad_ports; ++i) ports[one.pad + i] += local[plate_ports + i];
  }
  double at(int contact, FacePort port, const double* ports) const {
    const Contact& one = contacts_[static_cast<std::size_t>(contact)];
    const int i = static_cast<int>(port);
    return i < plate_ports ? ports[one.plate + i] : ports[one.pad + i - plate_ports];
  }

  /// Gap and velocities on y and on ẏ.
  const LocalRows& displacement(int contact) const { return local(contact).displacement; }
  const LocalRows& velocity(int contact) const { return local(contact).velocity; }
  /// Unit forces, as of inputs().
  const LocalColumns& inputs(int contact) const { return local(contact).inputs; }
  /// A y and B y: by how much unit forces along the normal and along the sliding direction turn.
  /// Not by BLAS, whose call would take longer.
  Local normal_turn(int contact, const Local& y) const {
    if (!bends_) return Local::Zero();
    return local(contact).normal_bending.lazyProduct(y);
  }
  Local friction_turn(int contact, const Local& y) const {
    if (!bends_) return Local::Zero();
    return local(contact).friction_bending.lazyProduct(y);
  }
  /// ½ yᵀ A y, m.
  double gap_bending(int contact, const Local& y) const {
    return bends_ ? 0.5 * y.dot(normal_turn(contact, y)) : 0.0;
  }

 private:
  using LocalMatrix = Eigen::Matrix<double, per_contact, per_contact>;
  struct Contact {
    Eigen::Index plate = 0, pad = 0;  ///< first ports
    LocalRows displacement, velocity;
    LocalColumns inputs;  ///< n + A q₀, b + B q₀ and a
    LocalMatrix normal_bending, friction_bending;  ///< A, B
  };

  const Contact& local(int contact) const { return contacts_[static_cast<std::size_t>(contact)]; }
  void place_ports(const std::vector<FaceContact>& contacts);
  void set_rows(Contact& local, const FaceContact& contact, const FaceContactLaw& law,
                const Eigen::VectorXd& sliding);

  Eigen::MatrixXd rows_;
  std::vector<Contact> contacts_;
  Eigen::VectorXd drive_, preload_;
  bool bends_;
};

}  // namespace stridor
