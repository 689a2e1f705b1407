// Rows through which contacts see and push bodies: gathered and scattered without their zeros.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "solvers/padded_matrix.hpp"

namespace stridor {

/// Ports y = R z of coordinates z, and forces Rᵀ p on these of forces p at the ports.
///
/// Neighbouring rows that move coordinates in common are one band; between bands, as between
/// bodies, there are only zeros.
class PortRows {
 public:
  PortRows() = default;
  explicit PortRows(const Eigen::MatrixXd& rows);

  Eigen::Index num_ports() const { return num_ports_; }
  Eigen::Index num_coordinates() const { return num_coordinates_; }
  /// y = R z. @param ports padded_size(num_ports()) numbers
  void gather(const double* coordinates, double* ports) const;
  /// f = Rᵀ p. @param coordinates padded_size(num_coordinates()) numbers
  void scatter(const double* ports, double* coordinates) const;

 private:
  struct Band {
    Eigen::Index first_port = 0, first_coordinate = 0;
    PaddedMatrix rows, columns;  ///< R and Rᵀ within the band
  };
  Eigen::Index num_ports_ = 0, num_coordinates_ = 0;
  std::vector<Band> bands_;
};

}  // namespace stridor
