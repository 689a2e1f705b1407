// Eigenvalues of large systems along a parameter from the eigenvectors at a few values.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "solvers/eigenvalues/sparse_spectrum.hpp"
#include "solvers/eigenvalues/system_span.hpp"

namespace stridor {

/// Eigenvalues of one system by a projection.
struct ProjectedSpectrum {
  /// Im s >= 0, ascending Im s; those whose residual at full size is small enough.
  std::vector<std::complex<double>> eigenvalues;
  /// Whether none that the basis shows was left out for its residual, and there are no fewer than
  /// at all systems of the basis.
  bool is_certified = true;
  double largest_residual = 0.0;  ///< scaled_residual() of those in the list
};

/// Eigenpairs of a few systems of a span as a basis for others of it (docs/theory.md, 10.5).
///
/// Right states (x, v = s x) and left ones (y, z = s̄ y) of all of them are tested against one
/// another, which leaves of M q̈ + P q̇ + Q q = 0 the small problem
///
///   s (Zᴴ M X + Yᴴ P X + Yᴴ M V) a + (Yᴴ Q X − Zᴴ M V) a = 0 .
///
/// Errors of its eigenvalues are products of those of both sides. It falls into groups of
/// neighbours that no gap without eigenvalues at any of the values is part of. An eigenvalue counts
/// when its vector X a has a scaled_residual() of 1e-6 at full size, as in sparse_spectrum().
///
/// A system of a span is projected by sums of products that are made once, any other one by
/// products of its own.
class PairBasis {
 public:
  /// @param height of the window, rad/s
  explicit PairBasis(double height) : rectangle_{height} {}

  const SpectrumRectangle& rectangle() const { return rectangle_; }
  std::size_t num_systems() const { return known_.size(); }
  /// @param pairs of one more system
  void add(TwoSidedPairs pairs);
  /// Leaves out the pairs that joined last; others must be there.
  void drop_latest();

  /// A system of a span, by its factors there.
  /// @param place where there is one, only the groups around it are looked at
  ProjectedSpectrum project(const SystemSpan& span, const Eigen::VectorXd& factors,
                            const SparseSystem& system,
                            std::optional<std::complex<double>> place = std::nullopt);
  /// Any system of the same size.
  ProjectedSpectrum project(const SparseSystem& system,
                            std::optional<std::complex<double>> place = std::nullopt);
  /// The pairs that joined last.
  const TwoSidedPairs& latest() const { return known_.back(); }

 private:
  /// Displacements and velocities of the right states and of the left ones, a column for each
  /// direction.
  struct Sides {
    Eigen::MatrixXcd X, V, Y, Z;
  };
  /// Products of the bases with the matrices of one system, or of one part of a span.
  struct Products {
    Eigen::MatrixXcd slope;  ///< Zᴴ M X + Yᴴ P X + Yᴴ M V
    Eigen::MatrixXcd rest;   ///< Yᴴ Q X − Zᴴ M V

    explicit Products(Eigen::Index size) : slope(Eigen::MatrixXcd::Zero(size, size)), rest(slope) {}
    void add(const Sides& sides, const SparseMatrix& matrix, int power,
             const Eigen::MatrixXcd& image);
  };
  /// A product of the right basis with one matrix: sᵖ c_k times it is a term of the residual.
  struct Term {
    std::size_t part;
    int power;
  };
  struct Group {
    std::size_t first = 0, last = 0;  ///< of the pairs of every system
    bool is_top = false;
    double low = 0.0, high = 0.0;  ///< of Im s
    double omega = 0.0;            ///< about |s|, rad/s
    Eigen::MatrixXcd mixture;      ///< basis of right states = those of the systems, and left ones
                                   ///< after them, times this
    Sides sides;                   ///< where systems of no span are projected
    std::vector<Products> products;  ///< of the parts of a span
    std::vector<Term> terms;
    Eigen::MatrixXcd gram;  ///< of the terms, powers of s/omega
  };
  /// A system to be projected.
  struct Projected {
    const SparseSystem& system;
    const SystemSpan* span = nullptr;
    const Eigen::VectorXd* factors = nullptr;  ///< in the span
  };
  struct Solution {
    std::vector<std::complex<double>> s;  ///< in the group, ascending Im s
    Eigen::MatrixXcd right;               ///< a of each
  };

  ProjectedSpectrum project(const Projected& one, std::optional<std::complex<double>> place);
  void make_groups(const SystemSpan* span);
  std::size_t fewest_within(const Group& group) const;
  Sides reduce(Group& group) const;
  void multiply(Group& group, const Sides& sides, const SystemSpan& span) const;
  Products products_of(const Group& group, const Projected& one) const;
  Eigen::MatrixXcd states(const Group& group, bool are_left) const;
  Solution solve(const Group& group, const Products& products) const;
  double residual(const Group& group, const Eigen::VectorXd& factors, std::complex<double> s,
                  const Eigen::VectorXcd& a) const;
  Eigen::VectorXcd vector_of(const Group& group, const Eigen::VectorXcd& a) const;
  bool is_pair(const Group& group, const Projected& one, std::complex<double> s,
               const Eigen::VectorXcd& a, double& residual_of) const;

  SpectrumRectangle rectangle_;
  std::vector<TwoSidedPairs> known_;
  std::vector<Group> groups_;    ///< empty where they are not known
  std::size_t grouped_parts_ = 0;  ///< of the span when they were made; 0: of no span
};

}  // namespace stridor
