#include "solvers/eigenvalues/secular_weights.hpp"

#include <algorithm>

namespace stridor {

void SecularWeights::assign(const Pencil& pencil, const SecularPoles& poles) {
  has_coupled_ = poles.has_coupled();
  if (has_coupled_) {
    const Eigen::Index num_ports = pencil.num_ports() - pencil.num_body_ports;
    Pencil contacts;
    contacts.omega = pencil.omega;
    contacts.ports = pencil.ports.topRows(num_ports);
    contacts.compatibility = pencil.compatibility.leftCols(num_ports);
    contacts.equilibrium = pencil.equilibrium.leftCols(num_ports);
    for (const auto terms : {&Pencil::port_stiffness, &Pencil::port_damping}) {
      if ((pencil.*terms).size() > 0)
        contacts.*terms = (pencil.*terms).topLeftCorner(num_ports, num_ports);
    }
    rows_ = modal_rows(contacts);
    const CoupledModes& coupled = poles.coupled();
    coupled_outputs_ = rows_.outputs(Eigen::all, coupled.modes)
                           .cast<std::complex<double>>()
                           .lazyProduct(coupled.shapes);
    coupled_inputs_ = rows_.inputs(Eigen::all, coupled.modes)
                          .cast<std::complex<double>>()
                          .lazyProduct(coupled.adjoint);
  } else {
    rows_ = modal_rows(pencil);
  }
  constexpr Eigen::Index most_powers = 3;
  const Eigen::Index size = num_rows();
  const std::size_t padded = poles.padded_size();
  weights_.resize(static_cast<std::size_t>(size * size * most_powers));
  for (Eigen::Index b = 0; b < size; ++b) {
    for (Eigen::Index power = 0; power < num_powers(b); ++power) {
      for (Eigen::Index a = 0; a < size; ++a) {
        AlignedArray& weights = of(a, b, power);
        if (weights.size() != padded) {
          weights = AlignedArray(padded);
        } else if (has_coupled_) {
          std::fill_n(weights.data(), padded, 0.0);
        }
      }
    }
  }
  for (std::size_t i = 0; i < poles.size(); ++i)
    poles.is_mode(i) ? add_mode(poles, i) : add_pair(poles, i);
}

void SecularWeights::add_mode(const SecularPoles& poles, std::size_t i) {
  const Eigen::Index k = rows_.num_constraints;
  const Eigen::Index size = num_rows();
  const Eigen::Index mode = poles.mode(i);
  for (Eigen::Index b = 0; b < size; ++b) {
    for (Eigen::Index a = 0; a < size; ++a) {
      of(a, b, 0)[i] = rows_.outputs(a, mode) * rows_.inputs(b, mode);
      if (b >= k) of(a, b, 1)[i] = rows_.outputs(a, mode) * rows_.inputs(b + rows_.rank, mode);
    }
  }
}

/// a/(s − p) + a'/(s − p') = ((a + a') s − (a p' + a' p))/d of the two poles of a pair, where a and
/// a' are conjugates if p and p' are.
void SecularWeights::add_pair(const SecularPoles& poles, std::size_t i) {
  using Complex = std::complex<double>;
  const Eigen::Index k = rows_.num_constraints;
  const Eigen::Index size = num_rows();
  const Eigen::Index at = poles.coupled_pole(i);
  const Complex p = poles.coupled().poles(at);
  const Complex other = poles.coupled().poles(at + 1);
  for (Eigen::Index b = 0; b < size; ++b) {
    for (Eigen::Index a = 0; a < size; ++a) {
      const auto add = [&](Eigen::Index input, Eigen::Index power) {
        const Complex residue = coupled_outputs_(a, at) * coupled_inputs_(input, at);
        const Complex other_residue = coupled_outputs_(a, at + 1) * coupled_inputs_(input, at + 1);
        of(a, b, power)[i] -= (residue * other + other_residue * p).real();
        of(a, b, power + 1)[i] += (residue + other_residue).real();
      };
      add(b, 0);
      if (b >= k) add(b + rows_.rank, 1);
    }
  }
}

void SecularWeights::border(const SecularPoles& poles, std::complex<double> s, std::size_t i,
                            Eigen::Index at, BorderedMatrix& matrix) const {
  if (poles.is_mode(i)) {
    border_mode(poles, s, i, at, matrix);
  } else {
    border_pole(poles, s, poles.coupled_pole(i), at, matrix);
    border_pole(poles, s, poles.coupled_pole(i) + 1, at + 1, matrix);
  }
}

void SecularWeights::border_mode(const SecularPoles& poles, std::complex<double> s, std::size_t i,
                                 Eigen::Index at, BorderedMatrix& matrix) const {
  const Eigen::Index mode = poles.mode(i);
  for (Eigen::Index a = 0; a < num_rows(); ++a) {
    matrix.value(a, at) = rows_.outputs(a, mode);
    matrix.value(at, a) = -rows_.inputs(a, mode);
    if (a < rows_.num_constraints) continue;
    matrix.value(at, a) -= s * rows_.inputs(a + rows_.rank, mode);
    matrix.slope(at, a) = -rows_.inputs(a + rows_.rank, mode);
  }
  matrix.value(at, at) = poles.denominator(i, s);
  matrix.slope(at, at) = poles.denominator_slope(i, s);
}

void SecularWeights::border_pole(const SecularPoles& poles, std::complex<double> s,
                                 Eigen::Index pole, Eigen::Index at, BorderedMatrix& matrix) const {
  for (Eigen::Index a = 0; a < num_rows(); ++a) {
    matrix.value(a, at) = coupled_outputs_(a, pole);
    matrix.value(at, a) = -coupled_inputs_(a, pole);
    if (a < rows_.num_constraints) continue;
    matrix.value(at, a) -= s * coupled_inputs_(a + rows_.rank, pole);
    matrix.slope(at, a) = -coupled_inputs_(a + rows_.rank, pole);
  }
  matrix.value(at, at) = s - poles.coupled().poles(pole);
  matrix.slope(at, at) = 1.0;
}

}  // namespace stridor
