// Two eigenvalues that approach each other, by functions that stay smooth where they meet.
#pragma once

#include <complex>
#include <cstddef>
#include <optional>
#include <vector>

namespace stridor {

/// Two eigenvalues at one value of a parameter: s = m ± √D.
struct PairLook {
  double value = 0.0;
  std::complex<double> mean;    ///< m = (s₁ + s₂)/2
  std::complex<double> square;  ///< D = ((s₁ − s₂)/2)²

  static PairLook of(double value, std::complex<double> one, std::complex<double> other) {
    const std::complex<double> half = 0.5 * (one - other);
    return {value, 0.5 * (one + other), half * half};
  }
  /// Re m + |Re √D|: the growth of the faster one.
  double growth() const;
};

/// A pair that was found, and which eigenvalues it is made of; conjugates have the same index.
struct FoundPair {
  std::size_t first = 0, second = 0;
  PairLook look;
};

/// The two eigenvalues whose mean and square are closest to those expected; conjugates take part.
/// @param eigenvalues Im s >= 0
/// @return nothing where there are not two
std::optional<FoundPair> closest_pair(const std::vector<std::complex<double>>& eigenvalues,
                                      const PairLook& expected);

/// Mean and square at a value by the parabola through the three looks closest to another value, or
/// what fewer allow.
/// @param looks of different values, at least one
PairLook interpolated(const std::vector<PairLook>& looks, double value, double centre);

/// Bound of the growth of a pair between two values, by polynomials through mean and square:
///
///   max Re m + δm + √((|D| + Re D)/2 + δD)
///
/// of those of degree 5 through six looks; δ is four times the largest difference to those of
/// degree 3 through the four in the middle, and twice what a parabola rises above the 65 places in
/// the interval at which they are compared.
///
/// @param looks ascending values, the third and the fourth at `from` and `to`
/// @return +∞ where there are not six
double growth_bound(const std::vector<PairLook>& looks, double from, double to);

/// Solves for the value between two others at which a pair grows most, or grows least.
///
/// Mean and square are interpolated by parabolas through three looks. Proposed is the extremum of
/// Re D, then that of the growth, until neither would change by an amount that matters for
/// stability.
class PairSearch {
 public:
  enum class Aim {
    growth,  ///< the pair grows at neither end
    gap,     ///< it grows at both
  };

  /// @param looks both ends and samples beside them, ascending values
  /// @param scale of the eigenvalues, 1/s
  PairSearch(std::vector<PairLook> looks, double from, double to, double scale, Aim aim);

  /// Value to compute next; nothing once the search has converged.
  std::optional<double> next() const;
  /// Prediction of the parabolas at a value.
  PairLook expected(double value) const;
  void add(const PairLook& look);
  /// Whether the parabolas at the extremum also hold at both ends, within a factor of 3: there is
  /// no second extremum then.
  bool fits_ends() const;

 private:
  PairLook expected(double value, double centre) const {
    return interpolated(looks_, value, centre);
  }
  const PairLook& best() const;
  double side() const { return aim_ == Aim::growth ? 1.0 : -1.0; }
  std::optional<double> vertex() const;
  double fastest_place(double around) const;
  bool is_inside(double value) const { return value > from_ && value < to_; }

  std::vector<PairLook> looks_;
  std::size_t num_given_;
  double from_, to_, scale_;
  Aim aim_;
  double error_ = 0.0;  ///< of the square that was expected of the last look
};

}  // namespace stridor
