#include "solvers/eigenvalues/eigenvector.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>
#include <optional>
#include <vector>

namespace stridor {
namespace {

using Complex = std::complex<double>;

/// Null vector of a nearly singular matrix, after both its sides are scaled.
Eigen::VectorXcd null_vector(Eigen::MatrixXcd matrix) {
  Eigen::VectorXd column_scale = matrix.cwiseAbs().colwise().maxCoeff().transpose();
  for (double& scale : column_scale) scale = scale > 0.0 ? 1.0 / scale : 1.0;
  matrix = matrix * column_scale.asDiagonal();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    const double largest = matrix.row(i).cwiseAbs().maxCoeff();
    if (largest > 0.0) matrix.row(i) /= largest;
  }
  const Eigen::JacobiSVD<Eigen::MatrixXcd> svd(matrix, Eigen::ComputeFullV);
  return column_scale.asDiagonal() * svd.matrixV().col(matrix.cols() - 1);
}

/// The vector that a nearly singular matrix makes smallest, by inverse iteration.
Eigen::VectorXcd smallest_image(const Eigen::MatrixXcd& matrix) {
  const Eigen::PartialPivLU<Eigen::MatrixXcd> lu(matrix);
  Eigen::VectorXcd vector = Eigen::VectorXcd::NullaryExpr(
      matrix.rows(), [](Eigen::Index i) { return std::polar(1.0, static_cast<double>(i)); });
  constexpr int num_iterations = 3;
  for (int i = 0; i < num_iterations; ++i) vector = lu.solve(vector).normalized().eval();
  return vector;
}

/// Eigenvector from all modes and multipliers, for as many ports as bodies with coupled terms have:
/// the small problem on the ports would divide by modes near their poles, of which there are many.
///
///   [P(s)  B_Eᵀ] [q ]
///   [B_C    0  ] [δλ] = 0,   rows and columns of modes over |s| + ω, those of B_C and B_E over
///                            their lengths
///
/// @param d s² + s c + ω²
/// @return nothing where the matrix is singular to the last digit
std::optional<Eigenvector> eigenvector_of_all_modes(const Pencil& pencil, const ModalRows& rows,
                                                    const Eigen::ArrayXcd& d, Complex s) {
  const Eigen::Index n = pencil.num_modes();
  const Eigen::Index k = rows.num_constraints;
  Eigen::MatrixXcd matrix = Eigen::MatrixXcd::Zero(n + k, n + k);
  matrix.topLeftCorner(n, n) = d.matrix().asDiagonal();
  if (rows.rank > 0) {
    const Eigen::MatrixXcd inputs = rows.inputs.middleRows(k, rows.rank).cast<Complex>() +
                                    s * rows.inputs.bottomRows(rows.rank).cast<Complex>();
    matrix.topLeftCorner(n, n) +=
        inputs.transpose() * rows.outputs.bottomRows(rows.rank).cast<Complex>();
  }
  matrix.topRightCorner(n, k) = rows.inputs.topRows(k).transpose().cast<Complex>();
  matrix.bottomLeftCorner(k, n) = rows.outputs.topRows(k).cast<Complex>();
  Eigen::VectorXd row_scale(n + k), column_scale(n + k);
  row_scale.head(n) = (pencil.omega.array() + std::abs(s)).inverse();
  column_scale.head(n) = row_scale.head(n);
  for (Eigen::Index i = 0; i < k; ++i) {
    const double length_of_row = matrix.row(n + i).head(n).cwiseAbs().dot(row_scale.head(n));
    const double length_of_column = matrix.col(n + i).head(n).cwiseAbs().dot(row_scale.head(n));
    row_scale(n + i) = length_of_row > 0.0 ? 1.0 / length_of_row : 1.0;
    column_scale(n + i) = length_of_column > 0.0 ? 1.0 / length_of_column : 1.0;
  }
  matrix = row_scale.asDiagonal() * matrix * column_scale.asDiagonal();
  const Eigen::VectorXcd right = column_scale.asDiagonal() * smallest_image(matrix);
  const Eigen::VectorXcd left = row_scale.asDiagonal() * smallest_image(matrix.transpose());
  if (!right.allFinite() || !left.allFinite()) return std::nullopt;
  const double length = right.head(n).norm();
  return Eigenvector{right.head(n) / length, left.head(n).conjugate().normalized(),
                     right.tail(k) / length};
}

}  // namespace

Eigenvector eigenvector(const Pencil& pencil, Complex s) {
  check_pencil(pencil);
  return eigenvector(pencil, modal_rows(pencil), s);
}

Eigenvector eigenvector(const Pencil& pencil, const ModalRows& rows, Complex s) {
  const Eigen::Index n = pencil.num_modes();
  const Eigen::Index k = rows.num_constraints;
  const Eigen::Index size = k + rows.rank;
  const Eigen::ArrayXcd d = s * s + s * pencil.damping.array().cast<Complex>() +
                            pencil.omega.array().square().cast<Complex>();
  constexpr Eigen::Index most_rows = 24;
  if (size > most_rows) {
    if (const auto vector = eigenvector_of_all_modes(pencil, rows, d, s)) return *vector;
  }
  // Modes at their pole would be divided by next to nothing: they stay unknowns.
  Eigen::Index nearest = 0;
  d.abs().minCoeff(&nearest);
  std::vector<Eigen::Index> near;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (i == nearest || std::abs(d(i)) < 1e-8 * std::norm(s)) near.push_back(i);
  }
  Eigen::ArrayXcd inverse = d.inverse();
  for (const Eigen::Index i : near) inverse(i) = 0.0;

  const Eigen::MatrixXcd outputs = rows.outputs.cast<Complex>();
  Eigen::MatrixXcd inputs = rows.inputs.topRows(size).cast<Complex>();
  if (rows.rank > 0) inputs.bottomRows(rows.rank) += s * rows.inputs.bottomRows(rows.rank);
  const auto num_near = static_cast<Eigen::Index>(near.size());
  Eigen::MatrixXcd bordered = Eigen::MatrixXcd::Zero(size + num_near, size + num_near);
  if (size > 0) {
    bordered.topLeftCorner(size, size) =
        outputs * inverse.matrix().asDiagonal() * inputs.transpose();
  }
  bordered.topLeftCorner(size, size).diagonal().tail(rows.rank).array() += 1.0;
  for (Eigen::Index j = 0; j < num_near; ++j) {
    const Eigen::Index i = near[static_cast<std::size_t>(j)];
    bordered.block(0, size + j, size, 1) = outputs.col(i);
    bordered.block(size + j, 0, 1, size) = -inputs.col(i).transpose();
    bordered(size + j, size + j) = d(i);
  }

  Eigenvector vector;
  const Eigen::VectorXcd right = null_vector(bordered);
  const Eigen::VectorXcd left = null_vector(bordered.transpose());
  vector.right = Eigen::VectorXcd::Zero(n);
  Eigen::VectorXcd transposed = Eigen::VectorXcd::Zero(n);
  if (size > 0) {
    vector.right -= (inverse * (inputs.transpose() * right.head(size)).array()).matrix();
    transposed -= (inverse * (outputs.transpose() * left.head(size)).array()).matrix();
  }
  for (Eigen::Index j = 0; j < num_near; ++j) {
    const Eigen::Index i = near[static_cast<std::size_t>(j)];
    vector.right(i) = -right(size + j);
    transposed(i) = left(size + j);
  }
  const double length = vector.right.norm();
  vector.right /= length;
  vector.force = right.head(k) / length;
  vector.left = transposed.conjugate().normalized();
  return vector;
}

double relative_residual(const Pencil& pencil, Complex s, const Eigen::VectorXcd& right) {
  const Eigen::VectorXd scale = (pencil.omega.array() + std::abs(s)).inverse();
  const auto scaled_norm = [&](const Eigen::VectorXcd& term) {
    return scale.cwiseProduct(term.cwiseAbs()).norm();
  };
  const Eigen::VectorXcd y = pencil.ports * right;
  Eigen::VectorXcd port_force = Eigen::VectorXcd::Zero(pencil.num_ports());
  if (pencil.port_stiffness.size() > 0) port_force += pencil.port_stiffness * y;
  if (pencil.port_damping.size() > 0) port_force += s * (pencil.port_damping * y);
  const Eigen::VectorXcd inertia = s * s * right;
  const Eigen::VectorXcd damping = s * pencil.damping.cast<Complex>().cwiseProduct(right);
  const Eigen::VectorXcd stiffness =
      pencil.omega.array().square().matrix().cast<Complex>().cwiseProduct(right);
  const Eigen::VectorXcd contact = pencil.ports.transpose() * port_force;
  const Eigen::VectorXcd without = inertia + damping + stiffness + contact;
  const double terms =
      scaled_norm(inertia) + scaled_norm(damping) + scaled_norm(stiffness) + scaled_norm(contact);

  const Eigen::MatrixXd force_columns =
      scale.asDiagonal() * (pencil.equilibrium * pencil.ports).transpose();
  const Eigen::VectorXcd target = scale.cast<Complex>().cwiseProduct(without);
  Eigen::VectorXcd rest = target;
  if (force_columns.cols() > 0) {
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(force_columns);
    rest.real() -= force_columns * qr.solve(Eigen::VectorXd(target.real()));
    rest.imag() -= force_columns * qr.solve(Eigen::VectorXd(target.imag()));
  }
  const Eigen::MatrixXd gap_rows = pencil.compatibility * pencil.ports;
  const double gaps = (gap_rows * right).norm();
  const double gap_terms = (gap_rows.cwiseAbs() * right.cwiseAbs()).norm();
  return rest.norm() / (terms + (target - rest).norm()) +
         (gap_terms > 0.0 ? gaps / gap_terms : 0.0);
}

double modal_assurance(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b) {
  return std::norm(a.dot(b)) / (a.squaredNorm() * b.squaredNorm());
}

}  // namespace stridor
