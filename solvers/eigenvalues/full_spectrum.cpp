#include "solvers/eigenvalues/full_spectrum.hpp"

#include <algorithm>
#include <complex>
#include <numbers>
#include <optional>
#include <random>
#include <stdexcept>
#include <utility>

#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/eigenvalues/linear_pencil.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

/// A height with as many vibrations below as are wanted.
double height_of_window(const std::vector<Eigenvalue>& all, const SpectrumWindow& window) {
  if (!window.count) return 2.0 * std::numbers::pi * window.frequency;
  std::vector<double> heights;
  for (const Eigenvalue& one : all)
    if (one.s.imag() > 0.0) heights.push_back(one.s.imag());
  return heights.empty() ? 0.0 : height_above(heights, *window.count);
}

/// Pairs at eigenvalues that are known, from any vectors.
TwoSidedPairs pairs_at(const SparseSystem& system, std::vector<Complex> s, double height) {
  TwoSidedPairs guesses;
  guesses.s = std::move(s);
  guesses.right.resize(system.size(), static_cast<Eigen::Index>(guesses.s.size()));
  std::mt19937 generator{1};
  std::normal_distribution<double> normal;
  for (Complex& entry : guesses.right.reshaped()) {
    const double re = normal(generator);
    entry = {re, normal(generator)};
  }
  int factorisations = 0;
  return pairs_near(system, guesses, height, factorisations, SpectrumWork::Sides::right);
}

}  // namespace

SparseSystem modal_system(const Pencil& pencil) {
  if (pencil.num_constraints() > 0)
    throw std::invalid_argument("modal system: the pencil has constraints");
  const Eigen::Index n = pencil.num_modes();
  // Modes that are ports need no product.
  const bool has_own_ports = pencil.num_ports() != n || !pencil.ports.isIdentity(0.0);
  const auto with_ports = [&](const Eigen::VectorXd& diagonal,
                              const Eigen::MatrixXd& terms) -> SparseMatrix {
    Eigen::MatrixXd sum = diagonal.asDiagonal();
    if (terms.size() > 0 && !has_own_ports) sum += terms;
    if (terms.size() > 0 && has_own_ports)
      sum += pencil.ports.transpose() * (terms * pencil.ports).eval();
    return sum.sparseView(1.0, 0.0);
  };
  SparseSystem system;
  system.mass.resize(n, n);
  system.mass.setIdentity();
  system.velocity = with_ports(pencil.damping, pencil.port_damping);
  system.position = with_ports(pencil.omega.cwiseAbs2(), pencil.port_stiffness);
  return system;
}

SparseSpectrum full_spectrum(const SparseSystem& system, const SpectrumWindow& window) {
  LinearSystem linear;
  linear.mass = system.mass;
  linear.velocity = system.velocity;
  linear.position = system.position;
  linear.gaps = linear.forces = Eigen::MatrixXd(0, system.size());
  const Pencil pencil = make_pencil(linear);
  const std::vector<Eigenvalue> all = dense_eigenvalues(pencil, DenseWork::eigenvalues);
  SparseSpectrum spectrum;
  spectrum.rectangle.height = height_of_window(all, window);
  const double height = spectrum.rectangle.height;
  std::vector<Complex> near;
  for (const Eigenvalue& one : all) {
    const bool is_beside =
        one.s.real() >= spectrum.rectangle.left() && one.s.real() <= spectrum.rectangle.right();
    if (is_beside && one.s.imag() <= 1.1 * height) near.push_back(one.s);
    if (!spectrum.rectangle.contains(one.s)) continue;
    spectrum.eigenvalues.push_back(one);
    spectrum.num_found += one.s.imag() > 0.0 ? 2 : 1;
  }
  spectrum.num_counted = spectrum.num_found;
  spectrum.is_complete = true;
  spectrum.omega = pencil.omega;
  spectrum.pairs = pairs_at(system, near, height);
  return spectrum;
}

bool are_pairs(const SparseSystem& system, const TwoSidedPairs& pairs) {
  constexpr double largest_residual = 1e-6;
  constexpr double rigid = 1e-6;  // of the highest
  const Eigen::Map<const Eigen::RowVectorXcd> s(pairs.s.data(), pairs.size());
  const auto image = [&](const SparseMatrix& matrix) {
    const Eigen::MatrixXd full = matrix;
    Eigen::MatrixXcd product(full.rows(), pairs.size());
    product.real() = full * pairs.right.real().eval();
    product.imag() = full * pairs.right.imag().eval();
    return product;
  };
  const Eigen::MatrixXcd inertia =
      (system.mass * pairs.right) * s.cwiseProduct(s).eval().asDiagonal();
  const Eigen::MatrixXcd damping = image(system.velocity) * s.asDiagonal();
  const Eigen::MatrixXcd stiffness = image(system.position);
  const double highest = pairs.s.empty() ? 0.0 : s.cwiseAbs().maxCoeff();
  std::optional<SparsePencil> pencil;  // for rigid motions alone
  for (Eigen::Index i = 0; i < pairs.size(); ++i) {
    const double residual = (inertia.col(i) + damping.col(i) + stiffness.col(i)).norm();
    const double terms = inertia.col(i).norm() + damping.col(i).norm() + stiffness.col(i).norm();
    if (residual <= largest_residual * terms) continue;
    if (std::abs(s(i)) >= rigid * highest) return false;
    if (!pencil) pencil.emplace(system);
    if (!(pencil->backward_error(s(i), pairs.right.col(i)) < 1e-13)) return false;
  }
  return true;
}

}  // namespace stridor
