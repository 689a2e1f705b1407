#include "solvers/eigenvalues/eigenvalue_count.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace stridor {
namespace {

using Complex = std::complex<double>;

class PhaseCounter {
 public:
  PhaseCounter(const std::function<Complex(Complex)>& phase, const std::vector<Complex>& known,
               double smallest)
      : phase_(phase), known_(known), smallest_(smallest) {}

  /// Change of phase from a to b; nothing where it cannot be followed.
  std::optional<double> change(Complex a, Complex b, int parts) const {
    double sum = 0.0;
    Complex before = a;
    Complex value = remainder(a);
    for (int i = 1; i <= parts; ++i) {
      const Complex after = i == parts ? b : a + (b - a) * (static_cast<double>(i) / parts);
      const Complex next = remainder(after);
      const auto turned = between(before, value, after, next);
      if (!turned) return std::nullopt;
      sum += *turned;
      before = after;
      value = next;
    }
    return sum;
  }

 private:
  Complex remainder(Complex s) const {
    Complex value = phase_(s);
    for (const Complex& zero : known_) {
      const Complex factor = zero.imag() > 0.0 ? (s - zero) * (s - std::conj(zero)) : s - zero;
      if (factor == 0.0) return 0.0;
      value *= std::abs(factor) / factor;
    }
    return value;
  }

  std::optional<double> between(Complex a, Complex at_a, Complex b, Complex at_b) const {
    constexpr double largest = 1.0;
    if (at_a == 0.0 || at_b == 0.0) return std::nullopt;
    const double turned = std::arg(at_b / at_a);
    if (std::abs(turned) < largest) return turned;
    if (std::abs(b - a) < smallest_) return std::nullopt;
    const Complex middle = 0.5 * (a + b);
    const Complex at_middle = remainder(middle);
    const auto first = between(a, at_a, middle, at_middle);
    if (!first) return std::nullopt;
    const auto second = between(middle, at_middle, b, at_b);
    if (!second) return std::nullopt;
    return *first + *second;
  }

  const std::function<Complex(Complex)>& phase_;
  const std::vector<Complex>& known_;
  double smallest_;
};

}  // namespace

std::optional<int> count_in_rectangle(const std::function<Complex(Complex)>& phase, double left,
                                      double right, double height,
                                      const std::vector<Complex>& known) {
  constexpr int parts_per_height = 16;
  const PhaseCounter counter(phase, known, 1e-9 * height);
  const std::array<Complex, 4> corners{Complex(right, 0.0), Complex(right, height),
                                       Complex(left, height), Complex(left, 0.0)};
  double turned = 0.0;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const double length = std::abs(corners[i + 1] - corners[i]) / height;
    const auto part = counter.change(corners[i], corners[i + 1],
                                     static_cast<int>(std::ceil(parts_per_height * length)));
    if (!part) return std::nullopt;
    turned += *part;
  }
  int count = static_cast<int>(std::lround(turned / std::numbers::pi));
  for (const Complex& zero : known) {
    const bool is_inside = zero.imag() <= height && zero.real() >= left && zero.real() <= right;
    if (is_inside) count += zero.imag() > 0.0 ? 2 : 1;
  }
  return count;
}

}  // namespace stridor
