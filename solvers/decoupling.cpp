#include "solvers/decoupling.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "substructures/proportional_damping.hpp"
#include "substructures/symmetric_eigenpairs.hpp"

namespace stridor {
namespace {

using Indices = std::vector<Eigen::Index>;

/// Coordinates that M, P or Q couple, in their order; parts by their first coordinate.
std::vector<Indices> coupled_parts(const LinearSystem& system) {
  const Eigen::Index n = system.size();
  Indices part(static_cast<std::size_t>(n));
  std::iota(part.begin(), part.end(), Eigen::Index{0});
  const auto root = [&](Eigen::Index i) {
    while (part[static_cast<std::size_t>(i)] != i) i = part[static_cast<std::size_t>(i)];
    return i;
  };
  for (const Eigen::MatrixXd* matrix : {&system.mass, &system.velocity, &system.position}) {
    for (Eigen::Index j = 0; j < n; ++j)
      for (Eigen::Index i = 0; i < n; ++i) {
        if ((*matrix)(i, j) == 0.0) continue;
        const Eigen::Index a = root(i), b = root(j);
        part[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
      }
  }
  std::vector<Indices> parts;
  Indices number(static_cast<std::size_t>(n), -1);
  for (Eigen::Index i = 0; i < n; ++i) {
    Eigen::Index& of_root = number[static_cast<std::size_t>(root(i))];
    if (of_root < 0) {
      of_root = static_cast<Eigen::Index>(parts.size());
      parts.emplace_back();
    }
    parts[static_cast<std::size_t>(of_root)].push_back(i);
  }
  return parts;
}

/// Symmetric up to the rounding of its assembly.
bool is_symmetric(const Eigen::MatrixXd& matrix) {
  constexpr double rounding = 16.0 * std::numeric_limits<double>::epsilon();
  for (Eigen::Index j = 0; j < matrix.cols(); ++j)
    for (Eigen::Index i = 0; i < j; ++i) {
      const double scale = std::sqrt(std::abs(matrix(i, i) * matrix(j, j)));
      if (std::abs(matrix(i, j) - matrix(j, i)) >
          rounding * std::max(scale, std::abs(matrix(i, j))))
        return false;
    }
  return true;
}

/// α and β of the damping of a part whose modes nothing couples.
std::optional<RayleighDamping> modal_damping(const Eigen::MatrixXd& M, const Eigen::MatrixXd& P,
                                             const Eigen::MatrixXd& Q) {
  if (!is_symmetric(M) || !is_symmetric(Q)) return std::nullopt;
  if (Eigen::LLT<Eigen::MatrixXd>(M).info() != Eigen::Success) return std::nullopt;
  if (P.isZero(0.0)) return RayleighDamping{};
  return proportional_damping(P.sparseView(), M.sparseView(), Q.sparseView());
}

}  // namespace

DecoupledSystem decouple(const LinearSystem& system) {
  const Eigen::Index n = system.size();
  DecoupledSystem apart;
  apart.motion = apart.inverse = Eigen::MatrixXd::Zero(n, n);
  apart.system.mass = apart.system.velocity = apart.system.position = Eigen::MatrixXd::Zero(n, n);
  apart.system.gaps = apart.system.forces = Eigen::MatrixXd(0, n);
  Eigen::Index first = 0;
  for (const Indices& part : coupled_parts(system)) {
    const auto size = static_cast<Eigen::Index>(part.size());
    const Eigen::MatrixXd M = system.mass(part, part);
    const Eigen::MatrixXd P = system.velocity(part, part);
    const Eigen::MatrixXd Q = system.position(part, part);
    const auto place = [&](const Eigen::MatrixXd& T, const Eigen::MatrixXd& inverse) {
      apart.motion(part, Eigen::seqN(first, size)) = T;
      apart.inverse(Eigen::seqN(first, size), part) = inverse;
    };
    const auto damping = size > 1 ? modal_damping(M, P, Q) : std::nullopt;
    if (damping) {
      const SymmetricEigenpairs modes = generalised_eigenpairs(Q, M, "modes of a part");
      place(modes.vectors, modes.vectors.transpose() * M);
      for (Eigen::Index i = 0; i < size; ++i) {
        const Eigen::Index k = first + i;
        apart.system.mass(k, k) = 1.0;
        apart.system.velocity(k, k) = damping->alpha + damping->beta * modes.values(i);
        apart.system.position(k, k) = modes.values(i);
        apart.groups.push_back({k, 1});
      }
    } else {
      const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(size, size);
      place(one, one);
      apart.system.mass.block(first, first, size, size) = M;
      apart.system.velocity.block(first, first, size, size) = P;
      apart.system.position.block(first, first, size, size) = Q;
      apart.groups.push_back({first, size});
    }
    first += size;
  }
  return apart;
}

}  // namespace stridor
