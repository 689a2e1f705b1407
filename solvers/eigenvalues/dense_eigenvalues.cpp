#include "solvers/eigenvalues/dense_eigenvalues.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "core/errors.hpp"
#include "solvers/algebra/matrix_modes.hpp"
#include "solvers/eigenvalues/eigenvector.hpp"
#include "solvers/eigenvalues/hessenberg_eigenvalues.hpp"

extern "C" void dgeevx_(const char* balance, const char* left, const char* right, const char* sense,
                        const int* n, double* a, const int* lda, double* wr, double* wi, double* vl,
                        const int* ldvl, double* vr, const int* ldvr, int* ilo, int* ihi,
                        double* scale, double* abnrm, double* rconde, double* rcondv, double* work,
                        const int* lwork, int* iwork, int* info);

namespace stridor {
namespace {

using Complex = std::complex<double>;

/// Orthonormal basis of the vectors that every row maps to zero.
Eigen::MatrixXd null_space(const Eigen::MatrixXd& rows, const char* name) {
  const Eigen::Index n = rows.cols();
  if (rows.rows() == 0) return Eigen::MatrixXd::Identity(n, n);
  Eigen::VectorXd lengths = rows.rowwise().norm();
  for (double& length : lengths) length = length > 0.0 ? 1.0 / length : 1.0;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(
      Eigen::MatrixXd(rows.transpose() * lengths.asDiagonal()));
  qr.setThreshold(1e-12);
  if (qr.rank() < rows.rows()) {
    throw NumericalError(Refusal::eigenvalues_incomplete,
                         fmt::format("dense eigenvalues: the {} rows of {} have rank {}",
                                     rows.rows(), name, qr.rank()));
  }
  const Eigen::MatrixXd Q = qr.householderQ() * Eigen::MatrixXd::Identity(n, n);
  return Q.rightCols(n - rows.rows());
}

/// ω of every mode, that of rigid ones replaced by the lowest elastic one.
Eigen::VectorXd displacement_scale(const Pencil& pencil) {
  double slowest = 0.0;
  for (const double omega : pencil.omega) {
    if (omega > 0.0 && (slowest == 0.0 || omega < slowest)) slowest = omega;
  }
  return pencil.omega.cwiseMax(slowest > 0.0 ? slowest : 1.0);
}

struct LapackResult {
  Eigen::VectorXd re, im;
  Eigen::MatrixXd vectors;  ///< in LAPACK's packing: a pair holds real and imaginary part
  Eigen::VectorXd reciprocal_condition;
  double norm = 0.0;  ///< of the balanced matrix
};

LapackResult eigenvalues_of(Eigen::MatrixXd matrix, DenseWork wanted_work) {
  const bool with_vectors = wanted_work != DenseWork::eigenvalues;
  const bool with_conditions = wanted_work == DenseWork::conditions;
  const auto n = static_cast<int>(matrix.rows());
  LapackResult result;
  result.re.resize(n);
  result.im.resize(n);
  result.vectors.resize(with_vectors ? n : 1, with_vectors ? n : 1);
  Eigen::VectorXd scale(n);
  const int ldvr = with_vectors ? n : 1;
  const int ldvl = with_conditions ? n : 1;
  Eigen::MatrixXd left(ldvl, ldvl);
  result.reciprocal_condition.resize(with_conditions ? n : 1);
  int ilo = 0;
  int ihi = 0;
  double unused = 0.0;
  int unused_integer = 0;
  int info = 0;
  const auto call = [&](double* work, int size) {
    dgeevx_("B", with_conditions ? "V" : "N", with_vectors ? "V" : "N", with_conditions ? "E" : "N",
            &n, matrix.data(), &n, result.re.data(), result.im.data(), left.data(), &ldvl,
            result.vectors.data(), &ldvr, &ilo, &ihi, scale.data(), &result.norm,
            result.reciprocal_condition.data(), &unused, work, &size, &unused_integer, &info);
  };
  double wanted = 0.0;
  call(&wanted, -1);
  Eigen::VectorXd work(static_cast<Eigen::Index>(wanted));
  call(work.data(), static_cast<int>(work.size()));
  if (info != 0) {
    throw NumericalError(
        Refusal::eigenvalues_incomplete,
        fmt::format("dense eigenvalues: the QR iteration failed at {} of {}", info, n));
  }
  return result;
}

/// Those of eigenvalues near the axis; condition numbers of all where hessenberg_eigenvalues()
/// gives none.
LapackResult eigenvalues_near_axis(const Eigen::MatrixXd& matrix) {
  constexpr int most = 8;
  std::optional<HessenbergEigenvalues> found = hessenberg_eigenvalues(matrix, is_near_axis, most);
  if (!found) return eigenvalues_of(matrix, DenseWork::conditions);
  LapackResult result;
  result.re = found->values.real();
  result.im = found->values.imag();
  result.vectors.resize(1, 1);
  result.reciprocal_condition = std::move(found->reciprocal_condition);
  result.norm = found->norm;
  return result;
}

/// Copies eigenvalue i of one result, with all that belongs to it, to place j of another.
void copy_eigenvalue(const LapackResult& from, Eigen::Index i, LapackResult& to, Eigen::Index j) {
  to.re(j) = from.re(i);
  to.im(j) = from.im(i);
  if (from.vectors.cols() == from.re.size()) to.vectors.col(j) = from.vectors.col(i);
  if (from.reciprocal_condition.size() == from.re.size())
    to.reciprocal_condition(j) = from.reciprocal_condition(i);
}

/// Those of A from the ones of (A − σ)⁻¹: s = σ + 1/μ. Of a pair the one with Im s > 0 comes first.
void undo_inversion(LapackResult& result, double shift) {
  const bool has_vectors = result.vectors.cols() == result.re.size();
  for (Eigen::Index i = 0; i < result.re.size(); ++i) {
    const Complex s = shift + 1.0 / Complex(result.re(i), result.im(i));
    result.re(i) = s.real();
    result.im(i) = -s.imag();
    if (has_vectors && result.im(i) < 0.0) result.vectors.col(i) *= -1.0;
  }
}

/// All eigenvalues of a matrix; the slow ones, where its norm would drown them, from the inverse.
/// @param slowest order of the slowest that matter, 1/s
LapackResult graded_eigenvalues_of(const Eigen::MatrixXd& matrix, double slowest, DenseWork work) {
  constexpr double wide = 1e10;
  LapackResult fast =
      work == DenseWork::near_axis ? eigenvalues_near_axis(matrix) : eigenvalues_of(matrix, work);
  if (!(fast.norm > wide * slowest)) return fast;
  if (work == DenseWork::near_axis)
    return graded_eigenvalues_of(matrix, slowest, DenseWork::conditions);
  Eigen::MatrixXd shifted = matrix;
  shifted.diagonal().array() -= slowest;
  const Eigen::MatrixXd inverse = shifted.partialPivLu().inverse();
  if (!inverse.allFinite()) return fast;
  LapackResult slow = eigenvalues_of(inverse, work);
  undo_inversion(slow, slowest);
  LapackResult all = fast;
  const double border = std::sqrt(slowest) * std::sqrt(fast.norm);
  Eigen::Index num = 0;
  const Eigen::Index size = matrix.rows();
  for (const LapackResult* one : {&slow, &fast}) {
    for (Eigen::Index i = 0; i < size; ++i) {
      const bool is_slow = std::hypot(one->re(i), one->im(i)) < border;
      if (is_slow != (one == &slow)) continue;
      if (num == size) return fast;
      copy_eigenvalue(*one, i, all, num++);
    }
  }
  return num == size ? all : fast;
}

}  // namespace

bool is_near_axis(Complex s) {
  constexpr double near = 1e-6;
  return std::abs(s.real()) <= near * std::abs(s);
}

namespace {

/// The pencil on the motions that fit its constraints, as a matrix of states: displacements scaled by W, and
/// velocities.
struct StateMatrix {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd scale;          ///< W
  Eigen::MatrixXd displacements;  ///< L_p: W times the modes of every scaled displacement
  Eigen::Index size() const { return displacements.cols(); }
};

/// @throws NumericalError if the contact jams
StateMatrix state_matrix(const Pencil& pencil) {
  const Eigen::MatrixXd gap_rows = pencil.compatibility * pencil.ports;
  const Eigen::MatrixXd force_rows = pencil.equilibrium * pencil.ports;
  const Eigen::VectorXd W = displacement_scale(pencil);
  const Eigen::VectorXd inverse_W = W.cwiseInverse();
  const Eigen::MatrixXd L_C = null_space(gap_rows, "B_C");
  const Eigen::MatrixXd L_E = null_space(force_rows, "B_E");
  const Eigen::MatrixXd L_p = null_space(gap_rows * inverse_W.asDiagonal(), "B_C");

  Eigen::MatrixXd K = pencil.omega.array().square().matrix().asDiagonal();
  Eigen::MatrixXd C = pencil.damping.asDiagonal();
  if (pencil.port_stiffness.size() > 0)
    K += pencil.ports.transpose() * pencil.port_stiffness * pencil.ports;
  if (pencil.port_damping.size() > 0)
    C += pencil.ports.transpose() * pencil.port_damping * pencil.ports;

  const Eigen::Index size = pencil.num_modes() - pencil.num_constraints();
  const Eigen::PartialPivLU<Eigen::MatrixXd> mass(Eigen::MatrixXd(L_E.transpose() * L_C));
  const double rcond = mass.rcond();
  if (!(rcond > 1e-14)) {
    throw NumericalError(Refusal::contact_jams,
                         fmt::format("dense eigenvalues: the reduced mass matrix is singular "
                                     "(reciprocal condition {:.1e}): the contact jams",
                                     rcond));
  }
  StateMatrix state{Eigen::MatrixXd::Zero(2 * size, 2 * size), W, L_p};
  state.matrix.topRightCorner(size, size) = L_p.transpose() * W.asDiagonal() * L_C;
  state.matrix.bottomLeftCorner(size, size) =
      -mass.solve(L_E.transpose() * (K * (inverse_W.asDiagonal() * L_p)));
  state.matrix.bottomRightCorner(size, size) = -mass.solve(L_E.transpose() * (C * L_C));
  return state;
}

/// Those not below the real axis, by frequency and growth.
std::vector<Eigen::Index> upper_ones(const Eigen::VectorXd& re, const Eigen::VectorXd& im) {
  std::vector<Eigen::Index> order;
  for (Eigen::Index i = 0; i < im.size(); ++i) {
    if (im(i) >= 0.0) order.push_back(i);
  }
  std::sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return std::pair(im(a), re(a)) < std::pair(im(b), re(b));
  });
  return order;
}

/// The modal coordinates of an eigenvector, of length 1.
Eigen::VectorXcd modal_vector(const StateMatrix& state, const LapackResult& found, Eigen::Index i) {
  // Of a pair the real part stands in its first column, the imaginary part in its second.
  const Eigen::Index first = found.im(i) < 0.0 ? i - 1 : i;
  Eigen::VectorXcd scaled = found.vectors.col(first).head(state.size()).cast<Complex>();
  if (found.im(i) != 0.0) scaled.imag() = found.vectors.col(first + 1).head(state.size());
  Eigen::VectorXcd q = state.scale.cwiseInverse().asDiagonal() * (state.displacements * scaled);
  q.normalize();
  return q;
}

}  // namespace

DenseSpectrum dense_spectrum(const Pencil& pencil, DenseWork work) {
  check_pencil(pencil);
  const StateMatrix state = state_matrix(pencil);
  const bool with_vectors = work == DenseWork::residuals || work == DenseWork::conditions;
  const bool with_conditions = work == DenseWork::near_axis || work == DenseWork::conditions;
  const LapackResult found = graded_eigenvalues_of(state.matrix, state.scale.minCoeff(), work);
  // Two equal real ones come out as a pair by rounding.
  Eigen::VectorXd im = found.im;
  constexpr double real_ratio = 1e-10;
  for (Eigen::Index i = 0; i < im.size(); ++i)
    if (std::abs(im(i)) <= real_ratio * std::abs(found.re(i))) im(i) = 0.0;
  const std::vector<Eigen::Index> order = upper_ones(found.re, im);

  DenseSpectrum spectrum;
  spectrum.norm = found.norm;
  if (with_vectors) {
    spectrum.right.resize(pencil.num_modes(), static_cast<Eigen::Index>(order.size()));
  }
  for (const Eigen::Index i : order) {
    Eigenvalue eigenvalue{Complex(found.re(i), im(i)), 0.0};
    if (with_vectors) {
      const Eigen::VectorXcd q = modal_vector(state, found, i);
      eigenvalue.residual = relative_residual(pencil, eigenvalue.s, q);
      spectrum.right.col(static_cast<Eigen::Index>(spectrum.eigenvalues.size())) = q;
    }
    if (with_conditions) spectrum.conditions.push_back(1.0 / found.reciprocal_condition(i));
    spectrum.eigenvalues.push_back(eigenvalue);
  }
  return spectrum;
}

std::vector<Eigenvalue> dense_eigenvalues(const Pencil& pencil, DenseWork work) {
  return dense_spectrum(pencil, work).eigenvalues;
}

MatrixModes matrix_modes(Eigen::MatrixXd matrix) {
  const Eigen::Index n = matrix.rows();
  const LapackResult found = eigenvalues_of(std::move(matrix), DenseWork::residuals);
  MatrixModes modes{Eigen::VectorXcd(n), Eigen::MatrixXcd(n, n)};
  modes.values.real() = found.re;
  modes.values.imag() = found.im;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (found.im(i) == 0.0) {
      modes.vectors.col(i) = found.vectors.col(i).cast<Complex>();
    } else if (found.im(i) > 0.0) {
      modes.vectors.col(i).real() = found.vectors.col(i);
      modes.vectors.col(i).imag() = found.vectors.col(i + 1);
      modes.vectors.col(i + 1) = modes.vectors.col(i).conjugate();
    }
  }
  return modes;
}

std::vector<Complex> matrix_eigenvalues(Eigen::MatrixXd matrix) {
  const LapackResult found = eigenvalues_of(std::move(matrix), DenseWork::eigenvalues);
  std::vector<Complex> eigenvalues;
  for (Eigen::Index i = 0; i < found.re.size(); ++i)
    eigenvalues.emplace_back(found.re(i), found.im(i));
  return eigenvalues;
}

bool is_dense_cheaper(const Pencil& pencil) {
  constexpr Eigen::Index least = 100;  // below, a search takes no time
  if (pencil.num_modes() < least) return false;
  const ModalRows rows = modal_rows(pencil);
  const auto size = static_cast<double>(rows.num_constraints + rows.rank);
  const auto num_modes = static_cast<double>(pencil.num_modes());
  constexpr double share = 8.0;
  // A determinant of a third of the modes, some thousand times over, takes longer than all
  // eigenvalues, of however many.
  constexpr double large = 1.0 / 3.0;
  return pencil.num_eigenvalues() <= most_dense ? size * size > share * num_modes
                                                : size > large * num_modes;
}

}  // namespace stridor
