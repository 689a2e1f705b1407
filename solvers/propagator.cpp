#include "solvers/propagator.hpp"

#include <algorithm>
#include <utility>

#include "core/clones.hpp"

namespace stridor {
namespace {

/// Of f_{n−2} in f_n + Δf + ½ Δ²f.
constexpr double last_but_one_share = 0.5;

#define STRIDOR_INLINE inline __attribute__((always_inline))

// Two, four or eight slots in arrays that need not be aligned.
using Slots2 = double __attribute__((vector_size(16), aligned(8), may_alias));
using Slots4 = double __attribute__((vector_size(32), aligned(8), may_alias));
using Slots8 = double __attribute__((vector_size(64), aligned(8), may_alias));

/// y += M x for a symmetric M, column after column.
template <class Slots>
STRIDOR_INLINE void add_product(const double* matrix, const double* x, double* y) {
  constexpr std::size_t n = sizeof(Slots) / sizeof(double);
  Slots sum = *reinterpret_cast<const Slots*>(y);
  for (std::size_t b = 0; b < n; ++b) sum += *reinterpret_cast<const Slots*>(matrix + b * n) * x[b];
  *reinterpret_cast<Slots*>(y) = sum;
}

STRIDOR_INLINE void add_product(std::size_t n, const double* matrix, const double* x, double* y) {
  // The sizes that bodies commonly have go without loops.
  switch (n) {
    case 2:
      return add_product<Slots2>(matrix, x, y);
    case 4:
      return add_product<Slots4>(matrix, x, y);
    case 8:
      return add_product<Slots8>(matrix, x, y);
    default:
      for (std::size_t b = 0; b < n; ++b) {
        for (std::size_t a = 0; a < n; ++a) y[a] += matrix[b * n + a] * x[b];
      }
  }
}

/// From u*_{n+1} to u_{n+1} = u* + W f, in place, and its increment.
STRIDOR_CLONES
void correct(std::size_t n, const double* compliance, const double* forces, const double* current,
             double* __restrict corrected, double* __restrict increment) {
  add_product(n, compliance, forces, corrected);
  for (std::size_t a = 0; a < n; ++a) increment[a] = corrected[a] - current[a];
}

/// Adds R f_{n−1}, R f_{n−2} and the answer to the loads to predictions of the moving modes.
STRIDOR_CLONES
void carry_on(std::size_t n, const double* flexibility, const double* last_forces,
              const double* load, double last_share, const double* by_last_but_one,
              double* __restrict by_last, double* __restrict predicted,
              double* __restrict expected) {
  for (std::size_t a = 0; a < n; ++a) by_last[a] = 0.0;
  add_product(n, flexibility, last_forces, by_last);
  for (std::size_t a = 0; a < n; ++a) {
    const double moving = predicted[a] + load[a];
    expected[a] = moving + by_last[a];
    predicted[a] = moving + last_share * by_last[a] + last_but_one_share * by_last_but_one[a];
  }
}

}  // namespace

Propagator::Propagator(int num_slots, Residual residual)
    : rows_(at(num_slots), 0),
      predicted_(at(num_slots), 0.0),
      current_(at(num_slots), 0.0),
      increment_(at(num_slots), 0.0),
      compliance_(at(num_slots) * at(num_slots), 0.0),
      residual_(std::move(residual)) {
  if (!has_residual()) return;
  // u_{n+1} = R (f_{n+1} − β ḟ) with f_{n+1} = f_n + Δf + ½ Δ²f and ḟ = Δf/h.
  const double lead = std::max(0.0, 1.0 - residual_.modes.beta / residual_.step);
  present_share_ = 1.5 + lead;
  last_share_ = -1.0 - lead;
  amplitudes_.assign(static_cast<std::size_t>(residual_.load_patterns.cols()), 0.0);
  last_ = {rows_, std::vector<double>(at(num_slots), 0.0)};
  last_but_one_ = last_;
  slot_flexibility_.assign(compliance_.size(), 0.0);
  slot_load_.assign(at(num_slots), 0.0);
  by_last_.assign(at(num_slots), 0.0);
  by_last_but_one_ = by_last_;
  expected_.assign(at(num_slots), 0.0);
}

void Propagator::start() {
  for (int slot = 0; slot < num_slots(); ++slot) slot_changed(slot);
  const std::vector<double> no_forces(rows_.size(), 0.0);
  advance_body(no_forces.data(), predicted_.data());
}

double Propagator::residual_flexibility(int row, const RowForces& forces) const {
  double sum = 0.0;
  for (std::size_t j = 0; j < forces.rows.size(); ++j)
    sum += residual_.modes.flexibility(row, forces.rows[j]) * forces.forces[j];
  return sum;
}

double Propagator::load_residual(int row) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < amplitudes_.size(); ++k)
    sum += residual_.load_patterns(row, static_cast<Eigen::Index>(k)) * amplitudes_[k];
  return sum;
}

double Propagator::displacement(int row) const {
  const double u = body_displacement(row);
  return has_residual() ? u + load_residual(row) + residual_flexibility(row, last_) : u;
}

Eigen::VectorXd Propagator::residual_displacement() const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(residual_.modes.shapes.rows());
  for (std::size_t j = 0; j < last_.rows.size(); ++j)
    sum += residual_.modes.shapes.col(last_.rows[j]) * last_.forces[j];
  for (std::size_t k = 0; k < amplitudes_.size(); ++k)
    sum += residual_.load_shapes.col(static_cast<Eigen::Index>(k)) * amplitudes_[k];
  return sum;
}

void Propagator::set_loads(std::span<const double> amplitudes) {
  set_body_loads(amplitudes);
  if (!has_residual()) return;
  amplitudes_.assign(amplitudes.begin(), amplitudes.end());
  for (int slot = 0; slot < num_slots(); ++slot) slot_load_[at(slot)] = load_residual(row(slot));
}

void Propagator::watch(int slot, int row) {
  rows_[at(slot)] = row;
  advances_on_rows_ = 0;
  slot_changed(slot);
  predicted_[at(slot)] = predicted_displacement(row);
  current_[at(slot)] = body_displacement(row);
  renew_compliance(slot);
  if (!has_residual()) return;
  add_residual(slot);
  current_[at(slot)] = displacement(row);
}

/// Adds what the loads and the last contact forces make of the modes left out to a prediction of
/// the moving ones.
void Propagator::add_residual(int slot) {
  const int row = rows_[at(slot)];
  const auto a = at(slot);
  by_last_[a] = residual_flexibility(row, last_);
  by_last_but_one_[a] = residual_flexibility(row, last_but_one_);
  slot_load_[a] = load_residual(row);
  const double moving = predicted_[a] + slot_load_[a];
  expected_[a] = moving + by_last_[a];
  predicted_[a] = moving + last_share_ * by_last_[a] + last_but_one_share * by_last_but_one_[a];
}

void Propagator::add_residuals() {
  if (advances_on_rows_ < 2) {
    for (int slot = 0; slot < num_slots(); ++slot) add_residual(slot);
    return;
  }
  // What the last forces did is, a step later, what the last but one did.
  std::swap(by_last_, by_last_but_one_);
  carry_on(rows_.size(), slot_flexibility_.data(), last_.forces.data(), slot_load_.data(),
           last_share_, by_last_but_one_.data(), by_last_.data(), predicted_.data(),
           expected_.data());
}

void Propagator::set_motion(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity,
                            const double* forces) {
  set_body_motion(displacement, velocity, forces);
  if (has_residual()) {
    last_ = {rows_, {forces, forces + rows_.size()}};
    last_but_one_ = last_;
  }
  for (int slot = 0; slot < num_slots(); ++slot) {
    watch(slot, row(slot));
    increment_[at(slot)] = initial_increment(row(slot), velocity);
  }
}

void Propagator::renew_compliance(int slot) {
  const int row_a = row(slot);
  for (int other = 0; other < num_slots(); ++other) {
    const int row_b = row(other);
    double& there = compliance_[at(slot) * rows_.size() + at(other)];
    double& back = compliance_[at(other) * rows_.size() + at(slot)];
    there = row_compliance(row_a, row_b);
    back = row_compliance(row_b, row_a);
    if (!has_residual()) continue;
    const double residual = residual_.modes.flexibility(row_a, row_b);
    slot_flexibility_[at(slot) * rows_.size() + at(other)] = residual;
    slot_flexibility_[at(other) * rows_.size() + at(slot)] = residual;
    there += present_share_ * residual;
    if (other != slot) back += present_share_ * residual;
  }
}

void Propagator::renew_compliances() {
  for (int slot = 0; slot < num_slots(); ++slot) renew_compliance(slot);
}

void Propagator::advance(const double* forces) {
  const std::size_t n = rows_.size();
  correct(n, compliance_.data(), forces, current_.data(), predicted_.data(), increment_.data());
  std::swap(current_, predicted_);
  advance_body(forces, predicted_.data());
  if (!has_residual()) return;
  std::swap(last_.forces, last_but_one_.forces);
  std::copy_n(forces, n, last_.forces.begin());
  if (advances_on_rows_ < 2) {
    std::swap(last_.rows, last_but_one_.rows);
    last_.rows = rows_;
    ++advances_on_rows_;
  }
  add_residuals();
}

void Propagator::save(State& state, const std::string& prefix) const {
  state.put(prefix + "rows", std::vector<double>(rows_.begin(), rows_.end()));
  state.put(prefix + "predicted", predicted_);
  state.put(prefix + "current", current_);
  state.put(prefix + "increment", increment_);
  if (has_residual()) {
    const auto put = [&](const std::string& name, const RowForces& acted) {
      state.put(prefix + name + "_rows", std::vector<double>(acted.rows.begin(), acted.rows.end()));
      state.put(prefix + name + "_forces", acted.forces);
    };
    put("last", last_);
    put("last_but_one", last_but_one_);
    state.put(prefix + "expected", expected_);
    state.put(prefix + "by_last", by_last_);
    state.put(prefix + "advances_on_rows", static_cast<double>(advances_on_rows_));
  }
  save_body(state, prefix);
}

void Propagator::load(const State& state, const std::string& prefix) {
  std::vector<double> rows(rows_.size());
  if (has_residual()) {
    const auto get = [&](const std::string& name, RowForces& acted) {
      state.get(prefix + name + "_rows", rows);
      acted.rows.assign(rows.begin(), rows.end());
      state.get(prefix + name + "_forces", acted.forces);
    };
    get("last", last_);
    get("last_but_one", last_but_one_);
  }
  state.get(prefix + "rows", rows);
  load_body(state, prefix);
  for (int slot = 0; slot < num_slots(); ++slot) watch(slot, static_cast<int>(rows[at(slot)]));
  state.get(prefix + "predicted", predicted_);
  state.get(prefix + "current", current_);
  state.get(prefix + "increment", increment_);
  if (!has_residual()) return;
  state.get(prefix + "expected", expected_);
  state.get(prefix + "by_last", by_last_);
  advances_on_rows_ = static_cast<int>(state.get(prefix + "advances_on_rows"));
}

}  // namespace stridor
