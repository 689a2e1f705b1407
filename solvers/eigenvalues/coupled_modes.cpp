#include "solvers/eigenvalues/coupled_modes.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>

#include "solvers/algebra/matrix_modes.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;
using Indices = std::vector<Eigen::Index>;

/// Sets of numbers below n that two matrices join by entries off their diagonals.
std::vector<Indices> joined(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::Index n = a.rows();
  Indices set(static_cast<std::size_t>(n));
  std::iota(set.begin(), set.end(), 0);
  const auto root = [&](Eigen::Index i) {
    while (set[static_cast<std::size_t>(i)] != i) i = set[static_cast<std::size_t>(i)];
    return i;
  };
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = 0; i < n; ++i) {
      if (i == j || (a(i, j) == 0.0 && b(i, j) == 0.0)) continue;
      const auto [low, high] = std::minmax({root(i), root(j)});
      set[static_cast<std::size_t>(high)] = low;
    }
  }
  std::vector<Indices> sets(static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) sets[static_cast<std::size_t>(root(i))].push_back(i);
  std::erase_if(sets, [](const Indices& one) { return one.empty(); });
  return sets;
}

/// An order in which conjugates stand side by side, and real numbers with others of their sign;
/// nothing where one is left over.
std::optional<Indices> paired(const Eigen::VectorXcd& numbers) {
  Indices order;
  Indices negative;
  Indices others;
  for (Eigen::Index i = 0; i < numbers.size(); ++i) {
    if (numbers(i).imag() == 0.0) {
      (numbers(i).real() < 0.0 ? negative : others).push_back(i);
    } else if (numbers(i).imag() > 0.0) {
      // LAPACK puts the conjugate next.
      if (i + 1 == numbers.size() || numbers(i + 1) != std::conj(numbers(i))) return std::nullopt;
      order.push_back(i);
      order.push_back(i + 1);
    }
  }
  for (Indices* real : {&negative, &others}) {
    if (real->size() % 2 == 1) return std::nullopt;
    std::sort(real->begin(), real->end(), [&](Eigen::Index a, Eigen::Index b) {
      return numbers(a).real() < numbers(b).real();
    });
    order.insert(order.end(), real->begin(), real->end());
  }
  return order;
}

/// Of s² + s C + K with no modes but these.
/// @param omega of the modes, by which displacements are multiplied (docs/theory.md, 7.2)
std::optional<CoupledModes> diagonalised(const Eigen::VectorXd& omega, const Eigen::MatrixXd& C,
                                         const Eigen::MatrixXd& K) {
  const Eigen::Index q = omega.size();
  const double highest = omega.maxCoeff();
  const Eigen::VectorXd W = omega.cwiseMax(highest > 0.0 ? 1e-6 * highest : 1.0);
  const Eigen::VectorXd inverse_W = W.cwiseInverse();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * q, 2 * q);
  A.topRightCorner(q, q) = W.asDiagonal();
  A.bottomLeftCorner(q, q) = -K * inverse_W.asDiagonal();
  A.bottomRightCorner(q, q) = -C;
  const MatrixModes found = matrix_modes(A);
  const auto order = paired(found.values);
  if (!order) return std::nullopt;
  const Eigen::VectorXcd values = found.values(*order);
  const Eigen::MatrixXcd Z = found.vectors(Eigen::all, *order);
  const Eigen::PartialPivLU<Eigen::MatrixXcd> lu(Z);
  constexpr double largest_error = 1e-12;
  if (!(lu.rcond() > 1e-14)) return std::nullopt;
  const Eigen::MatrixXcd Y = lu.inverse();
  const Eigen::MatrixXcd back = Z * values.asDiagonal() * Y;
  if (!((back - A.cast<Complex>()).norm() <= largest_error * A.norm())) return std::nullopt;
  CoupledModes modes;
  modes.poles = values;
  modes.shapes = inverse_W.cast<Complex>().asDiagonal() * Z.topRows(q);
  modes.adjoint = Y.rightCols(q).transpose();
  return modes;
}

}  // namespace

std::optional<CoupledModes> coupled_modes(const Pencil& pencil) {
  CoupledModes all;
  const Eigen::Index num_body_ports = pencil.num_body_ports;
  if (num_body_ports == 0) return all;
  const auto ports = pencil.ports.bottomRows(num_body_ports);
  for (Eigen::Index i = 0; i < pencil.num_modes(); ++i)
    if (!ports.col(i).isZero(0.0)) all.modes.push_back(i);
  const auto size = static_cast<Eigen::Index>(all.modes.size());
  const Eigen::MatrixXd own = ports(Eigen::all, all.modes);
  const auto terms = [&](const Eigen::VectorXd& diagonal, const Eigen::MatrixXd& between_ports) {
    Eigen::MatrixXd sum = diagonal(all.modes).asDiagonal();
    if (between_ports.size() > 0) {
      sum += own.transpose() * between_ports.bottomRightCorner(num_body_ports, num_body_ports) *
             own;
    }
    return sum;
  };
  const Eigen::VectorXd omega = pencil.omega(all.modes);
  const Eigen::MatrixXd K = terms(pencil.omega.cwiseAbs2(), pencil.port_stiffness);
  const Eigen::MatrixXd C = terms(pencil.damping, pencil.port_damping);
  all.poles.resize(2 * size);
  all.shapes = all.adjoint = Eigen::MatrixXcd::Zero(size, 2 * size);
  Eigen::Index first = 0;
  for (const Indices& set : joined(K, C)) {
    const auto one = diagonalised(omega(set), C(set, set), K(set, set));
    if (!one) return std::nullopt;
    const Eigen::Index count = one->poles.size();
    all.poles.segment(first, count) = one->poles;
    all.shapes(set, Eigen::seqN(first, count)) = one->shapes;
    all.adjoint(set, Eigen::seqN(first, count)) = one->adjoint;
    first += count;
  }
  return all;
}

}  // namespace stridor
