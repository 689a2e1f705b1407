// Bodies given by their modes, as a modal test or a computation delivers them.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/schema.hpp"
#include "substructures/bodies/body_parameters.hpp"
#include "substructures/bodies/matrix_body.hpp"
#include "substructures/bodies/modal_test.hpp"

namespace stridor {

/// A place of the body at which the shapes of its modes are known.
struct ModesPortParameters {
  std::vector<double> at;            ///< x, y and perhaps z in the frame of the body, m
  std::optional<std::int64_t> node;  ///< of the file, in the place of the shapes, and of `at` too
  std::vector<double> x, y, z;       ///< of every mode; empty: the port does not move so
  static const Schema& schema();
};

/// Rigid motions of a body that is free.
struct RigidMotionParameters {
  double mass = 0.0;            ///< kg, > 0
  std::vector<double> centre;   ///< of mass in the frame of the body, m
  std::vector<double> inertia;  ///< about it, kg m²: about z, or about x, y and z
  static const Schema& schema();
};

/// Flexibility of what is not among the modes.
struct ResidualParameters {
  std::vector<std::string> on;      ///< "<port>.<x|y|z>"
  MatrixText flexibility;           ///< F, of these, symmetric, m/N
  std::optional<double> frequency;  ///< at which it vibrates, Hz; default: 10 times the highest
  static const Schema& schema();
};

/// A body in the coordinates of its modes (docs/theory.md, 1.8),
///
///   q̈ + diag(2 ζ ω) q̇ + diag(ω²) q = Φᵀ f,   u = Φ q
///
/// Φ normalised to the modal masses. Rigid motions are modes of frequency 0; the residual flexibility
/// F = Σ f_k v_k v_kᵀ becomes modes of shapes ω_r √f_k v_k at the residual frequency ω_r, whose
/// flexibility is F at rest.
struct ModesBodyParameters : BodyParametersOf<ModesBodyParameters> {
  static constexpr const char* type_name = "modes";

  std::vector<double> frequencies;     ///< Hz; empty: those of the file
  std::vector<double> damping_ratios;  ///< of each, or one of all; empty: of the file, else none
  std::vector<double> modal_masses;    ///< of each, kg; empty: of the file, else 1
  std::string file;                    ///< universal file
  std::vector<double> take;            ///< numbers of the modes of the file; empty: all
  double complexity = 0.1;             ///< largest part of a shape out of phase that is left out
  std::map<std::string, ModesPortParameters> ports;
  std::map<std::string, MatrixSurfaceParameters> surfaces;
  std::optional<RigidMotionParameters> rigid;
  std::optional<ResidualParameters> residual;
  std::optional<double> complete_up_to;  ///< Hz, below which no mode is missing
  std::shared_ptr<const ModalTest> test;         ///< of `file`, read
  std::shared_ptr<const SparseMatrix> residual_flexibility;  ///< read
  static const Schema& schema();

  std::vector<NamedFile> files() override;
  void read(const BodyFiles& files) override;
  bool take_contents(const BodyParameters& other) override;
  BodyMatrices make() const override;
  double num_slave_nodes(const std::string& name) const override;
  ReductionSize reduction_size(double interface_nodes) const override;
  SizeKey size_key() const override;
  std::vector<Problem> warnings() const override;
};

}  // namespace stridor
