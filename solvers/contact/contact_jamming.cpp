#include "solvers/contact/contact_jamming.hpp"

#include <Eigen/LU>
#include <vector>

namespace stridor {
namespace {

using Indices = std::vector<Eigen::Index>;

/// Whether all principal minors are positive: those without the first row and column, and those
/// with it, which are its entry times those of its Schur complement.
bool has_positive_minors(const Eigen::MatrixXd& D) {
  const Eigen::Index n = D.rows();
  if (n == 0) return true;
  if (!(D(0, 0) > 0.0)) return false;
  const Eigen::MatrixXd rest = D.bottomRightCorner(n - 1, n - 1);
  return has_positive_minors(rest) &&
         has_positive_minors(rest - D.bottomLeftCorner(n - 1, 1) / D(0, 0) *
                                        D.topRightCorner(1, n - 1));
}

/// Of a group that is too large for all: pairs, leading minors and the determinant.
bool has_some_positive_minors(const Eigen::MatrixXd& D) {
  const Eigen::Index n = D.rows();
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < i; ++j)
      if (!(D(i, i) * D(j, j) > D(i, j) * D(j, i))) return false;
  }
  Eigen::MatrixXd left = D;  // elimination without pivots: its pivots are ratios of leading minors
  for (Eigen::Index k = 0; k < n; ++k) {
    if (!(left(k, k) > 0.0)) return false;
    const Eigen::Index m = n - k - 1;
    left.bottomRightCorner(m, m) -=
        left.col(k).tail(m) / left(k, k) * left.row(k).tail(m).eval();
  }
  return true;
}

/// Contacts that act on each other, directly or through others, `first` among them.
Indices group_of(const Eigen::MatrixXd& D, Eigen::Index first, std::vector<bool>& is_taken) {
  Indices group{first};
  is_taken[static_cast<std::size_t>(first)] = true;
  for (std::size_t at = 0; at < group.size(); ++at) {
    const Eigen::Index i = group[at];
    for (Eigen::Index j = 0; j < D.rows(); ++j) {
      if (is_taken[static_cast<std::size_t>(j)] || (D(i, j) == 0.0 && D(j, i) == 0.0)) continue;
      is_taken[static_cast<std::size_t>(j)] = true;
      group.push_back(j);
    }
  }
  return group;
}

}  // namespace

JammingTest::JammingTest(Eigen::Index num_contacts)
    : factor_(Eigen::MatrixXd(Eigen::MatrixXd::Identity(num_contacts, num_contacts))) {}

std::optional<int> JammingTest::operator()(const Eigen::MatrixXd& D) {
  for (Eigen::Index i = 0; i < D.rows(); ++i)
    if (!(D(i, i) > 0.0)) return static_cast<int>(i);
  factor_.compute(0.5 * (D + D.transpose()));
  if (factor_.info() == Eigen::Success) return std::nullopt;
  std::vector<bool> is_taken(static_cast<std::size_t>(D.rows()), false);
  for (Eigen::Index first = 0; first < D.rows(); ++first) {
    if (is_taken[static_cast<std::size_t>(first)]) continue;
    const Indices group = group_of(D, first, is_taken);
    const Eigen::MatrixXd among = D(group, group);
    const bool is_free = among.rows() <= largest_group ? has_positive_minors(among)
                                                       : has_some_positive_minors(among);
    if (!is_free) return static_cast<int>(first);
  }
  return std::nullopt;
}

}  // namespace stridor
