// Steady sliding of a rigid axisymmetric indenter over a linear viscoelastic half-space.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "coupling/laws/indenter_profile.hpp"
#include "coupling/laws/sliding_contact_parameters.hpp"
#include "solvers/half_space/contact_complementarity.hpp"
#include "solvers/half_space/contact_edge.hpp"
#include "solvers/half_space/half_space_convolution.hpp"
#include "substructures/elements/viscoelastic_material.hpp"

namespace stridor {

/// One creep time as it acts on a contact: share w_k of the compliance 1/E_0 and v τ_k in m, which
/// is negative for sliding towards −x.
using CreepLengths = std::vector<SlidingCreep>;

/// Shares and lengths of the creep times of a material at a dimensionless speed.
/// @param radius R, m
/// @param speed  v̂ = v τ_1/R, of either sign
CreepLengths creep_lengths(const ViscoelasticMaterial& material, double radius, double speed);

/// Result at one speed and indentation, and how far it can be trusted. Where the solver diverged,
/// force, area and friction are NaN.
struct SlidingContactResult {
  double indentation = 0.0;  ///< δ, m
  double force = 0.0;        ///< F/E_0*, m²
  double area = 0.0;         ///< A, m², to a fraction of a cell
  /// μ = (1/F) ∫ p ∂f/∂x dA; for a paraboloid the offset of the centre of pressure over R. Positive
  /// for sliding towards +x.
  double friction = 0.0;

  bool converged = false;
  bool touches_window = false;    ///< contact reaches the border: the window is too small
  bool has_resolved_edge = true;  ///< the area is not just counted
  /// The shortest v τ_k in cells; below 2 the layer in which the material stiffens at the edge is
  /// not resolved and the friction is too low. Infinite without creep or at rest.
  double memory_in_cells = 0.0;
  bool has_resolved_memory() const { return memory_in_cells >= 2.0; }
  std::size_t rounds = 0;    ///< sets of contact cells tried on this grid
  std::size_t products = 0;  ///< transforms there and back on this grid
  double residual = 0.0;     ///< as ComplementarityOutcome

  /// Limitations of the result, in words; empty where there are none.
  std::vector<std::string> remarks() const;
};

/// Solves contacts one after the other, each from the one before (docs/theory.md, 8.2 and 8.3).
///
/// The window is `window` times the elastic contact radius wide at any indentation, so the grid is
/// the same in units of the contact. Coarser grids of half the cells, down to about 32 a side, are
/// solved first: the change on them from one problem to the next corrects the pressures that the
/// fine grid starts from. Memory grows as N².
class SlidingContact {
 public:
  /// @throws std::invalid_argument if a parameter is out of its range; std::bad_alloc
  SlidingContact(const SlidingContactParameters& parameters, const IndenterProfile& profile);

  const SlidingContactParameters& parameters() const { return parameters_; }
  const IndenterProfile& profile() const { return profile_; }

  /// Contact at a given indentation. Where it does not converge from the last solution it is tried
  /// again without that.
  /// @param indentation δ > 0, m
  /// @throws std::invalid_argument as SlidingInfluence::table(), or if δ is not > 0 or the indenter
  ///         is in contact up to its end
  SlidingContactResult indent(double indentation, const CreepLengths& creep);

  /// Contact under a given force; secants in log F over log δ.
  /// @param force     F/E_0* > 0, m²
  /// @param tolerance relative, of the force, > 0
  /// @return the last contact tried; `converged` only if it carries the force
  /// @throws std::invalid_argument as indent(), or if the force is not > 0
  SlidingContactResult load(double force, const CreepLengths& creep, double tolerance = 1e-6);

  /// Forgets the last solution, so that the next one does not depend on it.
  void restart();

  /// Side of a cell of the last solution, m.
  double cell_side() const { return cell_side_; }
  /// p/E_0* of the last solution: N/2 rows of N along x, the first next to the axis.
  const std::vector<double>& pressure() const { return pressure_; }
  /// Gap between the indenter and the surface, m, likewise; infinite beyond the indenter.
  std::vector<double> gap() const;
  /// Edge of the contact, in cells.
  const ContactEdge& edge() const { return edge_; }

 private:
  /// Solves K p = h at a window of this half-width, the coarser grids first.
  ComplementarityOutcome solve_pressure(double indentation, double half_width,
                                        const CreepLengths& creep);
  /// Sets the pressures to start from.
  /// @param scale          from the pressures of the last solution to those of this one
  /// @param coarse_before  solution of the coarse grid before its present one; empty if there is
  ///                       none, or no present one
  void predict(double scale, std::span<const double> coarse_before);

  SlidingContactParameters parameters_;
  IndenterProfile profile_;
  HalfSpaceConvolution half_space_;
  ContactComplementarity complementarity_;
  std::unique_ptr<SlidingContact> coarse_;
  bool has_solution_ = false;
  double cell_side_ = 0.0;
  double indentation_ = 0.0;
  std::vector<double> target_;    ///< K p of contact: π h/(side of a cell)
  std::vector<double> pressure_;  ///< over E_0*
  ContactEdge edge_;
};

}  // namespace stridor
