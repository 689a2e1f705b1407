#include "solvers/integrators/propagator.hpp"

#include <algorithm>
#include <utility>

#include "core/clones.hpp"
#include "solvers/algebra/ports.hpp"

namespace stridor {
namespace {

/// From u*_{n+1} to u_{n+1} = u* + W f, in place, and its increment.
struct Correct {
  const double* compliance;
  const double* forces;
  const double* current;
  double* corrected;
  double* increment;

  template <class Lanes>
  STRIDOR_INLINE void operator()(Lanes lanes) const {
    const auto settled = lanes.load(corrected) + lanes.product(compliance, forces);
    lanes.store(corrected, settled);
    lanes.store(increment, settled - lanes.load(current));
  }
};
STRIDOR_CLONES
void correct_all(std::size_t n, const Correct& work) {
  for_lanes(n, work);
}

/// Propagator::settle() for ports that have kept their rows.
struct Settle {
  const FeedthroughPorts& ports;
  const double* forces;

  template <class Lanes>
  STRIDOR_INLINE void operator()(Lanes lanes) const {
    const auto f = lanes.load(forces);
    const auto answer = lanes.product(ports.compliance, forces);
    const auto settled = lanes.load(ports.predicted) + answer;
    lanes.store(ports.increment, settled - lanes.load(ports.current));
    lanes.store(ports.current, settled);
    lanes.store(ports.acting, f);
    lanes.store(ports.answer, answer);
    if (ports.lag == nullptr) return;
    const auto lagging = lanes.load(ports.lagging);
    lanes.store(ports.lagging, lagging + ports.share * (f - lagging));
  }
};
STRIDOR_CLONES
void settle_all(const FeedthroughPorts& ports, const double* forces) {
  for_lanes(ports.n, Settle{ports, forces});
}

/// Adds the instantaneous response to the displacements of the body, (1 − w) R f~ and the response
/// of the truncated modes to the loads; the last response to the forces gives the expected value.
struct Expect {
  const FeedthroughPorts& ports;

  template <class Lanes>
  STRIDOR_INLINE void operator()(Lanes lanes) const {
    auto predicted = lanes.load(ports.predicted);
    if (ports.lag != nullptr) {
      predicted += lanes.load(ports.load) + lanes.product(ports.lag, ports.lagging);
      lanes.store(ports.predicted, predicted);
    }
    lanes.store(ports.expected, predicted + lanes.load(ports.answer));
  }
};
STRIDOR_CLONES
void expect_all(const FeedthroughPorts& ports) {
  for_lanes(ports.n, Expect{ports});
}

}  // namespace

Propagator::Propagator(int num_ports, bool has_feedthrough, Residual residual)
    : rows_(at(num_ports), 0),
      predicted_(at(num_ports), 0.0),
      current_(at(num_ports), 0.0),
      increment_(at(num_ports), 0.0),
      compliance_(at(num_ports) * at(num_ports), 0.0),
      has_feedthrough_(has_feedthrough),
      residual_(std::move(residual)) {
  if (!has_feedthrough_) return;
  expected_ = predicted_;
  acting_ = {rows_, std::vector<double>(at(num_ports), 0.0)};
  answer_ = predicted_;
  ahead_ = predicted_;
  ahead_compliance_ = compliance_;
  lacks_ahead_compliance_.assign(at(num_ports), 1);
  if (!has_residual()) {
    find_feedthrough_ports();
    return;
  }
  share_ = residual_.step / (residual_.step + residual_.modes.beta);
  amplitudes_.assign(static_cast<std::size_t>(residual_.load_patterns.cols()), 0.0);
  port_load_.assign(at(num_ports), 0.0);
  lagging_ = acting_;
  port_lag_.assign(compliance_.size(), 0.0);
  find_feedthrough_ports();
}

void Propagator::find_feedthrough_ports() {
  if (!has_feedthrough_) return;
  const bool lags = has_residual();
  feedthrough_ports_ = {rows_.size(),       share_,
                   compliance_.data(), lags ? port_lag_.data() : nullptr,
                   port_load_.data(),  predicted_.data(),
                   expected_.data(),   current_.data(),
                   increment_.data(),  acting_.forces.data(),
                   answer_.data(),     lagging_.forces.data()};
}

void Propagator::set_num_ports(int count) {
  const std::size_t before = rows_.size();
  const std::size_t n = at(count);
  const auto resize_table = [&](std::vector<double>& table) {
    std::vector<double> resized(n * n, 0.0);
    for (std::size_t j = 0; j < std::min(n, before); ++j)
      std::copy_n(table.begin() + static_cast<std::ptrdiff_t>(j * before), std::min(n, before),
                  resized.begin() + static_cast<std::ptrdiff_t>(j * n));
    table = std::move(resized);
  };
  rows_.resize(n, 0);
  for (std::vector<double>* const one : {&predicted_, &current_, &increment_}) one->resize(n, 0.0);
  resize_table(compliance_);
  if (has_feedthrough_) {
    for (std::vector<double>* const one : {&expected_, &answer_, &ahead_}) one->resize(n, 0.0);
    resize_table(ahead_compliance_);
    lacks_ahead_compliance_.resize(n, 1);
  }
  if (has_residual()) {
    port_load_.resize(n, 0.0);
    resize_table(port_lag_);
  }
  // Forces that act are on the former ports until the next `settle`.
  has_new_rows_ = true;
  num_ports_changed();
}

void Propagator::start() {
  for (int port = 0; port < num_ports(); ++port) port_changed(port);
  const std::vector<double> no_forces(rows_.size(), 0.0);
  advance_body(no_forces.data(), predicted_.data());
}

double Propagator::lagging_residual(int row) const {
  double sum = load_residual(row);
  for (std::size_t j = 0; j < lagging_.rows.size(); ++j)
    sum += (1.0 - share_) * residual_.modes.flexibility(row, lagging_.rows[j]) * lagging_.forces[j];
  return sum;
}

double Propagator::load_residual(int row) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < amplitudes_.size(); ++k)
    sum += residual_.load_patterns(row, static_cast<Eigen::Index>(k)) * amplitudes_[k];
  return sum;
}

double Propagator::feedthrough_compliance(int row_a, int row_b) const {
  double sum = row_compliance(row_a, row_b);
  // A force that is constant over a step does not lag.
  if (has_residual())
    sum += (is_starting_ ? 1.0 : share_) * residual_.modes.flexibility(row_a, row_b);
  return sum;
}

double Propagator::displacement(int row) const {
  double sum = body_displacement(row);
  if (!has_feedthrough_) return sum;
  const Influence& influence = influence_on(row);
  for (std::size_t j = 0; j < acting_.forces.size(); ++j)
    sum += influence.modes[j] * acting_.forces[j];
  if (!has_residual()) return sum;
  // f~ is that at t_n by now.
  sum += load_residual(row);
  for (std::size_t j = 0; j < lagging_.forces.size(); ++j)
    sum += influence.residual[j] * lagging_.forces[j];
  return sum;
}

const Propagator::Influence& Propagator::influence_on(int row) const {
  for (const Influence& influence : influences_) {
    if (influence.row == row) return influence;
  }
  Influence influence{row, {}, {}};
  for (const int acting : acting_.rows) influence.modes.push_back(row_compliance(row, acting));
  if (has_residual()) {
    for (const int acting : lagging_.rows)
      influence.residual.push_back(residual_.modes.flexibility(row, acting));
  }
  return influences_.emplace_back(std::move(influence));
}

Eigen::VectorXd Propagator::residual_displacement() const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(residual_.modes.shapes.rows());
  for (std::size_t j = 0; j < lagging_.rows.size(); ++j)
    sum += residual_.modes.shapes.col(lagging_.rows[j]) * lagging_.forces[j];
  for (std::size_t k = 0; k < amplitudes_.size(); ++k)
    sum += residual_.load_shapes.col(static_cast<Eigen::Index>(k)) * amplitudes_[k];
  return sum;
}

void Propagator::set_loads(std::span<const double> amplitudes) {
  set_body_loads(amplitudes);
  if (!has_residual()) return;
  amplitudes_.assign(amplitudes.begin(), amplitudes.end());
  for (int port = 0; port < num_ports(); ++port) port_load_[at(port)] = load_residual(row(port));
}

void Propagator::watch(int port, int row) {
  rows_[at(port)] = row;
  port_changed(port);
  renew_compliance(port);
  look(port);
}

void Propagator::look(int port) {
  has_new_rows_ = true;
  const int row = this->row(port);
  predicted_[at(port)] = predicted_displacement(row);
  if (!has_feedthrough_) {
    current_[at(port)] = body_displacement(row);
    return;
  }
  if (has_residual()) {
    port_load_[at(port)] = load_residual(row);
    predicted_[at(port)] += lagging_residual(row);
  }
  double& expected = expected_[at(port)];
  expected = predicted_[at(port)];
  const std::size_t n = rows_.size();
  for (std::size_t j = 0; j < acting_.rows.size(); ++j) {
    const bool is_watched = j < n && acting_.rows[j] == rows_[j];
    expected += (is_watched ? compliance_[j * n + at(port)]
                            : feedthrough_compliance(row, acting_.rows[j])) *
                acting_.forces[j];
  }
  current_[at(port)] = expected;
}

void Propagator::set_motion(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity,
                            const double* forces) {
  is_starting_ = false;
  influences_.clear();
  set_body_motion(displacement, velocity, forces);
  if (has_feedthrough_) acting_ = {rows_, {forces, forces + rows_.size()}};
  if (has_residual()) lagging_ = acting_;
  find_feedthrough_ports();
  place_ports();
  for (int port = 0; port < num_ports(); ++port)
    increment_[at(port)] = initial_increment(row(port), velocity);
}

void Propagator::predict_start(const Eigen::VectorXd& displacement,
                               const Eigen::VectorXd& velocity) {
  is_starting_ = true;
  influences_.clear();
  predict_body_start(displacement, velocity);
  const std::vector<double> no_forces(rows_.size(), 0.0);
  acting_ = {rows_, no_forces};
  if (has_residual()) lagging_ = acting_;
  find_feedthrough_ports();
  place_ports();
}

void Propagator::place_ports() {
  for (int port = 0; port < num_ports(); ++port) port_changed(port);
  renew_compliances();
  for (int port = 0; port < num_ports(); ++port) look(port);
}

void Propagator::predict_ahead() {
  const std::size_t n = rows_.size();
  for (std::size_t i = 0; i < n; ++i) {
    ahead_[i] = ahead_displacement(rows_[i]);
    if (has_residual()) ahead_[i] += port_load_[i];
  }
  find_ahead_compliances();
}

bool Propagator::find_ahead_compliances() {
  if (has_ahead_compliance_) return false;
  const std::size_t n = rows_.size();
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = 0; i < n; ++i) {
      if (lacks_ahead_compliance_[i] == 0 && lacks_ahead_compliance_[j] == 0) continue;
      double& compliance = ahead_compliance_[j * n + i];
      compliance = ahead_compliance(rows_[i], rows_[j]);
      // A force that is constant over a step does not lag.
      if (has_residual()) compliance += residual_.modes.flexibility(rows_[i], rows_[j]);
    }
  }
  std::fill(lacks_ahead_compliance_.begin(), lacks_ahead_compliance_.end(), char{0});
  has_ahead_compliance_ = true;
  ++compliance_version_;
  return true;
}

void Propagator::renew_compliance(int port, int other) {
  const int row_a = row(port), row_b = row(other);
  const std::size_t n = rows_.size();
  compliance_[at(other) * n + at(port)] = feedthrough_compliance(row_a, row_b);
  compliance_[at(port) * n + at(other)] = feedthrough_compliance(row_b, row_a);
  if (!has_residual()) return;
  const double lag = (1.0 - share_) * residual_.modes.flexibility(row_a, row_b);
  port_lag_[at(other) * n + at(port)] = lag;
  port_lag_[at(port) * n + at(other)] = lag;
}

void Propagator::renew_compliance(int port) {
  has_ahead_compliance_ = false;
  if (has_feedthrough_) lacks_ahead_compliance_[at(port)] = 1;
  ++compliance_version_;
  for (int other = 0; other < num_ports(); ++other) renew_compliance(port, other);
}

void Propagator::renew_compliances() {
  influences_.clear();
  has_ahead_compliance_ = false;
  std::fill(lacks_ahead_compliance_.begin(), lacks_ahead_compliance_.end(), char{1});
  ++compliance_version_;
  for (int port = 0; port < num_ports(); ++port)
    for (int other = 0; other <= port; ++other) renew_compliance(port, other);
}

void Propagator::settle(const double* forces) {
  if (!has_feedthrough_) return;
  if (has_new_rows_) take_new_rows(forces);
  settle_all(feedthrough_ports_, forces);
  if (has_new_rows_) std::copy(last_increment_.begin(), last_increment_.end(), increment_.begin());
  has_new_rows_ = false;
}

/// The former displacements of new rows are unknown, so the increments stay; the lag has settled.
void Propagator::take_new_rows(const double* forces) {
  last_increment_ = increment_;
  influences_.clear();
  acting_.rows = rows_;
  acting_.forces.resize(rows_.size());
  if (has_residual()) lagging_ = {rows_, {forces, forces + rows_.size()}};
  find_feedthrough_ports();
}

void Propagator::advance(const double* forces) {
  if (has_feedthrough_) {
    advance_body(forces, predicted_.data());
    expect_all(feedthrough_ports_);
    return;
  }
  correct_all(rows_.size(),
              {compliance_.data(), forces, current_.data(), predicted_.data(), increment_.data()});
  std::swap(current_, predicted_);
  advance_body(forces, predicted_.data());
}

void Propagator::save(State& state, const std::string& prefix) const {
  state.put(prefix + "rows", std::vector<double>(rows_.begin(), rows_.end()));
  state.put(prefix + "predicted", predicted_);
  state.put(prefix + "current", current_);
  state.put(prefix + "increment", increment_);
  if (has_feedthrough_) {
    // After `settle` all forces are on the present rows.
    state.put(prefix + "expected", expected_);
    state.put(prefix + "acting", acting_.forces);
    state.put(prefix + "answer", answer_);
    if (has_residual()) state.put(prefix + "lagging", lagging_.forces);
  }
  save_body(state, prefix);
}

void Propagator::load(const State& state, const std::string& prefix) {
  std::vector<double> rows(rows_.size());
  state.get(prefix + "rows", rows);
  load_body(state, prefix);
  std::transform(rows.begin(), rows.end(), rows_.begin(),
                 [](double row) { return static_cast<int>(row); });
  place_ports();
  state.get(prefix + "predicted", predicted_);
  state.get(prefix + "current", current_);
  state.get(prefix + "increment", increment_);
  has_new_rows_ = false;
  if (!has_feedthrough_) return;
  state.get(prefix + "expected", expected_);
  influences_.clear();
  acting_ = {rows_, std::vector<double>(rows_.size(), 0.0)};
  state.get(prefix + "acting", acting_.forces);
  state.get(prefix + "answer", answer_);
  if (has_residual()) {
    lagging_ = acting_;
    state.get(prefix + "lagging", lagging_.forces);
  }
  find_feedthrough_ports();
}

}  // namespace stridor
