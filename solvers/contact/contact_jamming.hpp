// Whether sliding contacts jam together.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <optional>

namespace stridor {

/// Seeks contacts that jam: any set of them whose principal minor of D = B_C W B_Eᵀ is not positive
/// (docs/theory.md, 2.3). Where all principal minors are positive, and only there, every set of
/// contact forces moves one of its gaps the way it pushes or pulls.
class JammingTest {
 public:
  /// Contacts of a group, connected by the bodies between them, up to which all 2ᵐ − 1 minors are
  /// formed. Of larger groups those of one and of two contacts, the leading ones and the whole.
  static constexpr Eigen::Index largest_group = 12;

  /// With a factor of something, as one of nothing must not be moved.
  explicit JammingTest(Eigen::Index num_contacts);

  /// @param D num_contacts x num_contacts
  /// @return the first contact of those that jam
  /// Cost: a Cholesky factorisation, without allocation, where the symmetric part of D is positive
  /// definite, which makes all principal minors positive; else of order 2ᵐ m² for the largest group.
  std::optional<int> operator()(const Eigen::MatrixXd& D);

 private:
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

}  // namespace stridor
