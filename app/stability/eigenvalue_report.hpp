// Output of eigenvalues common to all kinds of `eig`.
#pragma once

#include <optional>
#include <vector>

#include "analysis/explanation.hpp"
#include "app/terminal/command.hpp"
#include "solvers/eigenvalues/pencil.hpp"

namespace stridor {

/// Index of the eigenvalue to look at: --mode counts those with positive imaginary part, lowest
/// first; the one that grows fastest where it is not given.
/// @throws ConfigError if there is no such mode
std::size_t chosen_mode(const std::vector<Eigenvalue>& eigenvalues, std::size_t num_real,
                        const std::optional<int>& mode);

/// Number of real eigenvalues.
std::size_t num_real_of(const std::vector<Eigenvalue>& eigenvalues);

Json eigenvalues_json(const std::vector<Eigenvalue>& eigenvalues);

/// @param trusted frequency above which the model is not valid for them, Hz
void print_eigenvalues(const std::vector<Eigenvalue>& eigenvalues, double trusted);

/// Whether rounding may have made an eigenvalue up: more is left of the equations of motion than
/// 1e-6 of their terms.
bool is_doubtful(const Eigenvalue& eigenvalue);
/// Which of them, by their places in the list.
Json doubtful_json(const std::vector<Eigenvalue>& eigenvalues);

/// Whether a model valid up to a frequency resolves an eigenvalue: a real one has no
/// frequency, but a rate, and s = 2πf is as fast as a vibration of frequency f.
/// @param trusted Hz
bool is_resolved(std::complex<double> s, double trusted);

Json quotients_json(const ModeQuotients& seen);
/// @param seen of quotients_json()
void print_quotients(const Json& seen);

}  // namespace stridor
