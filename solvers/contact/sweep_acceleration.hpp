// Extrapolation of sweeps over the contacts of a step.
#pragma once

#include <Eigen/Core>
#include <array>

namespace stridor {

/// Anderson's acceleration of a fixed-point iteration g(x) = x (Walker, Ni 2011): of the last sweeps it
/// takes that combination of their results of which the change would be the smallest,
///
///   min |r_k − Σ γ_i Δr_i|,   x_{k+1} = g_k − Σ γ_i Δg_i,   r = g − x.
///
/// Where contacts keep their states sweeps are nearly linear, and this is GMRES preconditioned by them.
class SweepAcceleration {
 public:
  static constexpr int depth = 5;

  explicit SweepAcceleration(Eigen::Index size);

  /// Begins anew.
  void forget() { num_kept_ = 0; }
  /// Takes up a sweep from x to g. @returns whether there is an extrapolation, in next()
  /// Cost: depth² + 4 depth products of the length of x. No allocation.
  bool add(const Eigen::VectorXd& x, const Eigen::VectorXd& g);
  const Eigen::VectorXd& next() const { return next_; }

 private:
  int num_kept_ = 0;  ///< sweeps since the last forget()
  Eigen::MatrixXd moved_, changed_;  ///< Δg and Δr, one column for each sweep, the oldest is overwritten
  Eigen::MatrixXd basis_;            ///< orthonormal, of Δr
  Eigen::VectorXd last_, change_, left_, next_;  ///< g, r, scratch, x_{k+1}
};

}  // namespace stridor
