// Annular plates in the coordinates of their modes, for discs that spin under fixed contacts.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/schema.hpp"
#include "substructures/bodies/beam.hpp"

namespace stridor {

/// A Kirchhoff plate between two circles, clamped at the inner one, free at the outer one.
struct AnnularPlateParameters {
  double inner_radius = 0.0;  ///< a, m, > 0
  double outer_radius = 0.0;  ///< b, m, > a
  double thickness = 0.0;     ///< h, m, > 0
  MaterialParameters material;
  int nodal_diameters = 0;  ///< largest n that is kept, >= 0
  int radial_modes = 1;     ///< modes kept for every n, lowest first, >= 1
  int radial_terms = 8;     ///< polynomials of the Ritz basis for every n, >= radial_modes
  static const Schema& schema();
};

/// Values of the deflection of every coordinate, and of its derivatives, at one place.
struct PlateRows {
  Eigen::VectorXd w;
  Eigen::VectorXd w_r;        ///< ∂w/∂r, 1/m
  Eigen::VectorXd w_phi;      ///< ∂w/∂φ
  Eigen::VectorXd w_r_phi;    ///< ∂²w/∂r∂φ, 1/m
  Eigen::VectorXd w_phi_phi;  ///< ∂²w/∂φ²
};

/// Radial and circumferential membrane stress, Pa.
struct MembraneStress {
  double radial = 0.0;
  double circumferential = 0.0;
};

/// Stress of a disc that is held at its inner edge and spins (docs/theory.md, 10.1).
/// @param speed  Ω, rad/s
/// @param radius m, between the edges
MembraneStress centrifugal_stress(const AnnularPlateParameters& plate, double speed, double radius);

/// Modes of an annular plate as seen from a frame that does not turn with it (docs/theory.md, 10.1;
/// HS (6), (7), (14)).
///
///   w(r, φ, t) = Σ R_nj(r) (q_c cos nφ + q_s sin nφ)
///
/// The shapes R_nj are Ritz solutions in x² P_k(2x − 1), x = (r − a)/(b − a), with P_k the Legendre
/// polynomials. Coordinates are mass-normalised and ordered by n, then by j; for n > 0 the cosine
/// comes before the sine. Where the plate turns with Ω towards +φ, a particle sees
/// ẅ = ∂²w/∂t² + 2Ω ∂²w/∂t∂φ + Ω² ∂²w/∂φ², hence
///
///   q̈ + 2Ω S q̇ + (diag(ω²) − Ω² SᵀS) q = f
class AnnularPlate {
 public:
  /// @param prestress_speed speed whose centrifugal stress stiffens the plate, rad/s; 0: none
  /// @throws std::invalid_argument if a parameter is out of range
  explicit AnnularPlate(const AnnularPlateParameters& plate, double prestress_speed = 0.0);

  Eigen::Index size() const { return omega_.size(); }
  /// ω of every coordinate, rad/s.
  const Eigen::VectorXd& omega() const { return omega_; }
  /// S: the φ-derivative on the coordinates, skew-symmetric.
  Eigen::MatrixXd spin() const;
  /// @param radius m, between the edges
  PlateRows rows(double radius, double angle) const;
  /// Lowest ω among the modes that are not kept, rad/s.
  double lowest_omitted() const { return lowest_omitted_; }

 private:
  struct Coordinate {
    int nodal_diameters = 0;
    bool is_sine = false;
    Eigen::VectorXd shape;  ///< coefficients of the Ritz basis
  };

  AnnularPlateParameters plate_;
  std::vector<Coordinate> coordinates_;
  Eigen::VectorXd omega_;
  double lowest_omitted_ = 0.0;
};

}  // namespace stridor
