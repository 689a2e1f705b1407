#include "solvers/eigenvalues/sparse_pencil.hpp"

#include <fmt/format.h>
#include <umfpack.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

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

struct SparsePencil::Pattern {
  SparseSystem system;
  SparseMatrix places;
  std::vector<double> mass, velocity, position;  ///< on the places
  double mass_norm = 0.0, velocity_norm = 0.0, position_norm = 0.0;
  void* symbolic = nullptr;

  int size() const { return static_cast<int>(places.rows()); }
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
  ~Numbers() {
    if (numeric != nullptr) umfpack_zi_free_numeric(&numeric);
  }
};

SparseFactor::SparseFactor(std::unique_ptr<Numbers> numbers) : numbers_(std::move(numbers)) {}
SparseFactor::~SparseFactor() = default;
SparseFactor::SparseFactor(SparseFactor&&) noexcept = default;
SparseFactor& SparseFactor::operator=(SparseFactor&&) noexcept = default;

Eigen::MatrixXcd SparseFactor::solve(const Eigen::MatrixXcd& right_hand_sides) const {
  return solve(UMFPACK_A, right_hand_sides);
}

Eigen::MatrixXcd SparseFactor::solve_adjoint(const Eigen::MatrixXcd& right_hand_sides) const {
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
  pattern.places =
      places_of(places_of(system.mass) + places_of(system.velocity) + places_of(system.position));
  pattern.mass = values_on(pattern.places, system.mass);
  pattern.velocity = values_on(pattern.places, system.velocity);
  pattern.position = values_on(pattern.places, system.position);
  pattern.mass_norm = one_norm(system.mass);
  pattern.velocity_norm = one_norm(system.velocity);
  pattern.position_norm = one_norm(system.position);
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
  const SparseSystem& system = pattern_->system;
  return s * (s * (system.mass * x) + system.velocity * x) + system.position * x;
}

Eigen::VectorXcd SparsePencil::slope(Complex s, Complex t, const Eigen::VectorXcd& x) const {
  return (s + t) * (pattern_->system.mass * x) + pattern_->system.velocity * x;
}

Eigen::VectorXcd SparsePencil::slope_adjoint(Complex s, Complex t,
                                             const Eigen::VectorXcd& y) const {
  return std::conj(s + t) * (pattern_->system.mass.transpose() * y) +
         pattern_->system.velocity.transpose() * y;
}

SparseFactor SparsePencil::factorise(Complex s) const {
  auto numbers = std::make_unique<SparseFactor::Numbers>();
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
