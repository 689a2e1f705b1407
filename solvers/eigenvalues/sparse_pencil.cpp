#include "solvers/eigenvalues/sparse_pencil.hpp"

#include <fmt/format.h>
#include <umfpack.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <limits>
#include <new>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/blas.hpp"
#include "core/errors.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

double one_norm(const SparseMatrix& matrix) {
  double largest = 0.0;
  for (Eigen::Index j = 0; j < matrix.outerSize(); ++j)
    largest = std::max(largest, matrix.col(j).cwiseAbs().sum());
  return largest;
}

/// Values of a matrix at the places of a pattern that holds all of its own.
std::vector<double> values_on(const SparseMatrix& pattern, const SparseMatrix& matrix) {
  std::vector<double> values(static_cast<std::size_t>(pattern.nonZeros()), 0.0);
  for (Eigen::Index j = 0; j < pattern.outerSize(); ++j) {
    SparseMatrix::InnerIterator place(pattern, j);
    std::size_t k = static_cast<std::size_t>(pattern.outerIndexPtr()[j]);
    for (SparseMatrix::InnerIterator entry(matrix, j); entry; ++entry) {
      while (place.row() < entry.row()) {
        ++place;
        ++k;
      }
      values[k] = entry.value();
    }
  }
  return values;
}

/// The same matrix with 1 for every entry that is stored.
SparseMatrix places_of(SparseMatrix matrix) {
  matrix.makeCompressed();
  matrix.coeffs().setOnes();
  return matrix;
}

/// A x by real arithmetic, which takes half as long for what comes from memory.
Eigen::VectorXcd product(const Eigen::MatrixXd& A, const Eigen::VectorXcd& x) {
  Eigen::MatrixXd parts(x.size(), 2);
  parts << x.real(), x.imag();
  const Eigen::MatrixXd images = A * parts;
  Eigen::VectorXcd image(A.rows());
  image.real() = images.col(0);
  image.imag() = images.col(1);
  return image;
}

/// A⁻¹ b. Of a matrix of one column BLAS would pack A anew.
Eigen::VectorXcd solve_one(const Eigen::PartialPivLU<Eigen::MatrixXcd>& factor,
                           const Eigen::VectorXcd& b) {
  Eigen::VectorXcd with_room = Eigen::VectorXcd::Zero(b.size() + read_beyond_vectors);
  auto x = with_room.head(b.size());
  x = factor.permutationP() * b;
  factor.matrixLU().triangularView<Eigen::UnitLower>().solveInPlace(x);
  factor.matrixLU().triangularView<Eigen::Upper>().solveInPlace(x);
  return x;
}

const double* numbers_of(const std::vector<Complex>& values) {
  return reinterpret_cast<const double*>(values.data());
}

/// A fill-reducing order by nested dissection, of the pattern of A + Aᵀ, and pivots on the diagonal
/// where they are not small: patterns here are symmetric but for friction. No refinement in solves:
/// what they serve are iterations that correct themselves.
std::array<double, UMFPACK_CONTROL> controls() {
  std::array<double, UMFPACK_CONTROL> chosen{};
  umfpack_zi_defaults(chosen.data());
  chosen[UMFPACK_STRATEGY] = UMFPACK_STRATEGY_SYMMETRIC;
  chosen[UMFPACK_ORDERING] = UMFPACK_ORDERING_METIS;
  chosen[UMFPACK_IRSTEP] = 0;
  return chosen;
}

[[noreturn]] void fail(int status) {
  throw NumericalError(
      Refusal::eigenvalues_incomplete,
      status == UMFPACK_ERROR_out_of_memory
          ? std::string("sparse factorisation: memory is exhausted")
          : fmt::format("sparse factorisation: UMFPACK ends with status {}", status));
}

}  // namespace

bool is_full(const SparseMatrix& matrix) {
  const double places = static_cast<double>(matrix.rows()) * static_cast<double>(matrix.cols());
  return static_cast<double>(matrix.nonZeros()) > 0.25 * places;
}

struct SparsePencil::Pattern {
  struct FullTerms {
    Eigen::MatrixXd velocity, position;
  };
  SparseSystem system;
  std::optional<FullTerms> full;  ///< of full matrices; what follows is then empty, but for norms
  SparseMatrix places;
  std::vector<double> mass, velocity, position;  ///< on the places
  double mass_norm = 0.0, velocity_norm = 0.0, position_norm = 0.0;
  void* symbolic = nullptr;

  int size() const { return static_cast<int>(system.size()); }
  /// P(s) of full matrices.
  Eigen::MatrixXcd full_values(Complex s) const {
    Eigen::MatrixXcd sum(system.size(), system.size());
    sum.real() = full->position + s.real() * full->velocity;
    sum.imag() = s.imag() * full->velocity;
    for (Eigen::Index j = 0; j < system.mass.outerSize(); ++j)
      for (SparseMatrix::InnerIterator entry(system.mass, j); entry; ++entry)
        sum(entry.row(), j) += s * s * entry.value();
    return sum;
  }
  std::vector<Complex> values(Complex s) const {
    std::vector<Complex> sum(mass.size());
    for (std::size_t k = 0; k < sum.size(); ++k)
      sum[k] = s * (s * mass[k] + velocity[k]) + position[k];
    return sum;
  }
  ~Pattern() {
    if (symbolic != nullptr) umfpack_zi_free_symbolic(&symbolic);
  }
};

struct SparseFactor::Numbers {
  const SparseMatrix* places = nullptr;
  std::vector<Complex> values;
  void* numeric = nullptr;
  std::optional<Eigen::PartialPivLU<Eigen::MatrixXcd>> full;  ///< in place of all this
  ~Numbers() {
    if (numeric != nullptr) umfpack_zi_free_numeric(&numeric);
  }
};

SparseFactor::SparseFactor(std::unique_ptr<Numbers> numbers) : numbers_(std::move(numbers)) {}
SparseFactor::~SparseFactor() = default;
SparseFactor::SparseFactor(SparseFactor&&) noexcept = default;
SparseFactor& SparseFactor::operator=(SparseFactor&&) noexcept = default;

Eigen::MatrixXcd SparseFactor::solve(const Eigen::MatrixXcd& right_hand_sides) const {
  if (numbers_->full && right_hand_sides.cols() == 1)
    return solve_one(*numbers_->full, right_hand_sides.col(0));
  if (numbers_->full) return numbers_->full->solve(right_hand_sides);
  return solve(UMFPACK_A, right_hand_sides);
}

Eigen::MatrixXcd SparseFactor::solve_adjoint(const Eigen::MatrixXcd& right_hand_sides) const {
  if (numbers_->full) return numbers_->full->adjoint().solve(right_hand_sides);
  return solve(UMFPACK_At, right_hand_sides);
}

Eigen::MatrixXcd SparseFactor::solve(int which, const Eigen::MatrixXcd& right_hand_sides) const {
  const SparseMatrix& places = *numbers_->places;
  const auto control = controls();
  Eigen::MatrixXcd solved(right_hand_sides.rows(), right_hand_sides.cols());
  for (Eigen::Index j = 0; j < solved.cols(); ++j) {
    const int status = umfpack_zi_solve(
        which, places.outerIndexPtr(), places.innerIndexPtr(), numbers_of(numbers_->values),
        nullptr, reinterpret_cast<double*>(solved.col(j).data()), nullptr,
        reinterpret_cast<const double*>(right_hand_sides.col(j).data()), nullptr, numbers_->numeric,
        control.data(), nullptr);
    if (status < 0) fail(status);
  }
  return solved;
}

std::complex<double> SparseFactor::log_determinant() const {
  if (numbers_->full) {
    const auto pivots = numbers_->full->matrixLU().diagonal();
    if ((pivots.array() == 0.0).any()) return -std::numeric_limits<double>::infinity();
    // The sign of the permutation as a turn by π.
    const bool is_even = numbers_->full->permutationP().determinant() > 0;
    return pivots.array().log().sum() + Complex(0.0, is_even ? 0.0 : std::numbers::pi);
  }
  double mantissa[2] = {0.0, 0.0};
  double exponent = 0.0;
  const int status =
      umfpack_zi_get_determinant(mantissa, nullptr, &exponent, numbers_->numeric, nullptr);
  if (status < 0) fail(status);
  const Complex value(mantissa[0], mantissa[1]);
  if (value == 0.0) return -std::numeric_limits<double>::infinity();
  return std::log(value) + exponent * std::numbers::ln10;
}

SparsePencil::SparsePencil(const SparseSystem& system) : pattern_(std::make_unique<Pattern>()) {
  const Eigen::Index n = system.size();
  for (const SparseMatrix* matrix : {&system.mass, &system.velocity, &system.position}) {
    if (matrix->rows() != n || matrix->cols() != n)
      throw std::invalid_argument("sparse pencil: the matrices differ in size");
    SparseMatrix compressed = *matrix;
    compressed.makeCompressed();
    if (!compressed.coeffs().allFinite())
      throw std::invalid_argument("sparse pencil: a number is not finite");
  }
  Pattern& pattern = *pattern_;
  pattern.system = system;
  pattern.mass_norm = one_norm(system.mass);
  pattern.velocity_norm = one_norm(system.velocity);
  pattern.position_norm = one_norm(system.position);
  if (is_full(system.velocity) || is_full(system.position)) {
    pattern.full = Pattern::FullTerms{system.velocity, system.position};
    return;
  }
  pattern.places =
      places_of(places_of(system.mass) + places_of(system.velocity) + places_of(system.position));
  pattern.mass = values_on(pattern.places, system.mass);
  pattern.velocity = values_on(pattern.places, system.velocity);
  pattern.position = values_on(pattern.places, system.position);
  // Pivots are chosen within the order found here, which depends on the pattern alone.
  const auto control = controls();
  const int status = umfpack_zi_symbolic(
      pattern.size(), pattern.size(), pattern.places.outerIndexPtr(),
      pattern.places.innerIndexPtr(), nullptr, nullptr, &pattern.symbolic, control.data(), nullptr);
  if (status < 0) fail(status);
}

SparsePencil::~SparsePencil() = default;
SparsePencil::SparsePencil(SparsePencil&&) noexcept = default;
SparsePencil& SparsePencil::operator=(SparsePencil&&) noexcept = default;

Eigen::Index SparsePencil::size() const {
  return pattern_->system.size();
}

const SparseSystem& SparsePencil::system() const {
  return pattern_->system;
}

Eigen::VectorXcd SparsePencil::multiply(Complex s, const Eigen::VectorXcd& x) const {
  return s * momentum(s * x, x) + position_times(x);
}

Eigen::VectorXcd SparsePencil::momentum(const Eigen::VectorXcd& v,
                                        const Eigen::VectorXcd& x) const {
  const SparseSystem& system = pattern_->system;
  if (pattern_->full) return system.mass * v + product(pattern_->full->velocity, x);
  return system.mass * v + system.velocity * x;
}

Eigen::VectorXcd SparsePencil::position_times(const Eigen::VectorXcd& x) const {
  if (pattern_->full) return product(pattern_->full->position, x);
  return pattern_->system.position * x;
}

Eigen::VectorXcd SparsePencil::slope(Complex s, Complex t, const Eigen::VectorXcd& x) const {
  return momentum((s + t) * x, x);
}

Eigen::VectorXcd SparsePencil::slope_adjoint(Complex s, Complex t,
                                             const Eigen::VectorXcd& y) const {
  return std::conj(s + t) * (pattern_->system.mass.transpose() * y) +
         pattern_->system.velocity.transpose() * y;
}

SparseFactor SparsePencil::factorise(Complex s) const {
  auto numbers = std::make_unique<SparseFactor::Numbers>();
  if (pattern_->full) {
    try {
      numbers->full.emplace(pattern_->full_values(s));
    } catch (const std::bad_alloc&) {
      fail(UMFPACK_ERROR_out_of_memory);
    }
    return SparseFactor(std::move(numbers));
  }
  const auto control = controls();
  numbers->places = &pattern_->places;
  numbers->values = pattern_->values(s);
  const int status =
      umfpack_zi_numeric(pattern_->places.outerIndexPtr(), pattern_->places.innerIndexPtr(),
                         numbers_of(numbers->values), nullptr, pattern_->symbolic,
                         &numbers->numeric, control.data(), nullptr);
  if (status < 0) fail(status);
  return SparseFactor(std::move(numbers));
}

double SparsePencil::backward_error(Complex s, const Eigen::VectorXcd& x) const {
  const double size = std::abs(s);
  const double norm =
      size * (size * pattern_->mass_norm + pattern_->velocity_norm) + pattern_->position_norm;
  return multiply(s, x).norm() / (norm * x.norm());
}

double SparsePencil::scaled_residual(Complex s, const Eigen::VectorXcd& x) const {
  const SparseSystem& system = pattern_->system;
  const double size = std::abs(s);
  const double terms = size * (size * (system.mass * x).norm() + (system.velocity * x).norm()) +
                       (system.position * x).norm();
  return multiply(s, x).norm() / terms;
}

}  // namespace stridor
