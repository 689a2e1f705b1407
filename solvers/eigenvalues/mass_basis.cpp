#include "solvers/eigenvalues/mass_basis.hpp"

#include <algorithm>
#include <cmath>

namespace stridor {

void MassBasis::reserve(Eigen::Index count) {
  basis_.resize(mass_->rows(), count);
  momenta_.resize(mass_->rows(), count);
  dim_ = 0;
}

void MassBasis::add(const Eigen::VectorXd& vector) {
  constexpr double negligible = 1e-11;
  Eigen::VectorXd rest = vector;
  const double length = std::sqrt(std::max(0.0, rest.dot(*mass_ * rest)));
  if (!(length > 0.0)) return;
  for (int round = 0; round < 2; ++round) rest -= vectors() * (momenta().transpose() * rest);
  Eigen::VectorXd momentum = *mass_ * rest;
  double rest_length = std::sqrt(std::max(0.0, rest.dot(momentum)));
  if (rest_length <= negligible * length || dim_ == mass_->rows()) return;
  rest /= rest_length;
  // A stretched vector is no longer orthogonal.
  rest -= vectors() * (momenta().transpose() * rest);
  momentum = *mass_ * rest;
  rest_length = std::sqrt(rest.dot(momentum));
  if (dim_ == basis_.cols()) {
    basis_.conservativeResize(mass_->rows(), std::max<Eigen::Index>(64, 2 * dim_));
    momenta_.conservativeResize(mass_->rows(), basis_.cols());
  }
  basis_.col(dim_) = rest / rest_length;
  momenta_.col(dim_) = momentum / rest_length;
  ++dim_;
}

double MassBasis::add_complex(const Eigen::VectorXcd& vector) {
  constexpr double least_share = 1e-9;
  const auto length_of = [&](const Eigen::VectorXcd& x) {
    return std::sqrt(std::max(0.0, x.dot(*mass_ * x).real()));
  };
  const Eigen::VectorXcd unit = vector / length_of(vector);
  Eigen::VectorXcd rest = unit;
  for (int round = 0; round < 2; ++round) rest -= vectors() * (momenta().transpose() * rest);
  const double share = length_of(rest);
  // Less is mostly rounding, and gives the projections eigenvalues that were not asked for.
  if (share > least_share) {
    add(unit.real());
    add(unit.imag());
  }
  return share;
}

}  // namespace stridor
