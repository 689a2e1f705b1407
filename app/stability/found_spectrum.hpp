// Eigenvalues that `eig` lists, by the method that the pencil asks for.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "analysis/explanation.hpp"
#include "app/terminal/command.hpp"
#include "solvers/eigenvalues/secular_eigenvalues.hpp"

namespace stridor {

/// Eigenvalues in a window and what can be said of each, by its place in the list.
struct FoundSpectrum {
  std::string method;  ///< "secular", "dense" or "sparse"
  std::vector<Eigenvalue> eigenvalues;
  double highest = 0.0;                                  ///< up to where the verdict holds, Hz
  std::function<Json(std::size_t)> explain{};            ///< quotients, energy and modes
  std::function<Eigen::VectorXcd(std::size_t)> shape{};  ///< modal coordinates; empty where sparse
  Json more = Json::object();                            ///< what else is reported
};

/// Whether contacts join modes of a pencil: else there is no small problem on their ports that
/// could take the place of the whole one.
bool has_contacts(const Pencil& pencil);

/// By the dense method, with all eigenvalues.
/// @param trusted frequency up to which the model is valid, Hz
FoundSpectrum find_dense(const Pencil& pencil, const SpectrumWindow& window, double trusted);

/// By the sparse method, counted.
/// @throws NumericalError unless every eigenvalue in the window was found
FoundSpectrum find_sparse(const SparseSystem& system, const SpectrumWindow& window);

/// Shares of growth and of the energy in each cycle.
/// @param frequency Hz
Json energy_json(const ModeEnergy& energy, double frequency);

/// The explanation of a mode of find_dense() or find_sparse().
void print_whole_explanation(const Json& explanation);

}  // namespace stridor
