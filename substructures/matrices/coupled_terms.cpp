#include "substructures/matrices/coupled_terms.hpp"

namespace stridor {

CoupledTerms CoupledTerms::in(const Eigen::MatrixXd& T) const {
  if (is_empty()) return {};
  return {T.transpose() * velocity * T, T.transpose() * position * T};
}

}  // namespace stridor
