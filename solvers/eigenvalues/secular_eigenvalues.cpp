#include "solvers/eigenvalues/secular_eigenvalues.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/errors.hpp"
#include "solvers/eigenvalues/aberth.hpp"
#include "solvers/eigenvalues/eigenvector.hpp"
#include "solvers/eigenvalues/search_failure.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

/// Whether a pole is far from the imaginary axis, as those of high modes under damping in
/// proportion to stiffness: its height says little about where it is.
bool is_strongly_damped(Complex pole) {
  return pole.imag() > 0.0 && std::abs(pole.real()) > 0.3 * pole.imag();
}

/// Modes whose poles are within the wedge, rigid ones left out.
std::size_t num_heavily_damped(const SecularFunction& function) {
  std::size_t num = 0;
  for (Eigen::Index i = 0; i < function.num_modes(); ++i) {
    const auto poles = function.poles(i);
    if (poles[1] != 0.0 && SecularFunction::height_of(poles[0]) <= 0.0) ++num;
  }
  return num;
}

/// Starts for so many zeros below a line: between the heights of the poles, beside those that are
/// strongly damped.
std::vector<Complex> starts_below(const SecularFunction& function, double height, int count) {
  std::vector<Complex> aside;
  std::vector<double> heights;
  for (Eigen::Index i = 0; i < function.num_modes(); ++i) {
    const Complex pole = function.poles(i).front();
    const double own = SecularFunction::height_of(pole);
    if (!is_strongly_damped(pole)) {
      heights.push_back(std::max(0.0, own));
    } else if (own < height) {
      aside.push_back(pole * Complex(1.0, 1e-3 * (1.0 + 0.37 * static_cast<double>(i % 7))));
    }
  }
  std::sort(heights.begin(), heights.end());
  const auto num_real = static_cast<std::size_t>(std::count(heights.begin(), heights.end(), 0.0));
  const double top = std::isfinite(height) ? height : 1.5 * function.pole_heights().back();
  std::vector<Complex> starts;
  for (std::size_t j = 0; starts.size() < static_cast<std::size_t>(count); ++j) {
    if (j == num_real) starts.insert(starts.end(), aside.begin(), aside.end());
    const double lower = j < heights.size() ? std::min(heights[j], top) : top;
    const double upper = j + 1 < heights.size() ? std::min(heights[j + 1], top) : top;
    const double middle = std::sqrt(0.5 * (lower * lower + upper * upper));
    // Off the axis, and never twice the same.
    const double shift = 1e-3 * (1.0 + 0.37 * static_cast<double>(j % 7));
    const double width = std::max({upper - lower, 1e-3 * top, 1e-6 * function.extent()});
    starts.emplace_back(-shift * width, middle + shift * width);
  }
  starts.resize(static_cast<std::size_t>(count));
  return starts;
}

/// Whether only rounding keeps a zero off the real axis.
bool is_real(const SecularFunction& function, Complex s) {
  constexpr double ratio = 1e-10;
  return std::abs(s.imag()) <= ratio * function.size_of(s);
}

/// The zeros of the upper half plane and the real ones out of a set that should be its own
/// conjugate; false where it is not.
bool fold(const SecularFunction& function, const std::vector<Complex>& zeros,
          std::vector<Complex>& folded) {
  std::vector<Complex> lower;
  folded.clear();
  for (const Complex& s : zeros) {
    if (is_real(function, s)) {
      folded.emplace_back(s.real(), 0.0);
    } else if (s.imag() > 0.0) {
      folded.push_back(s);
    } else {
      lower.push_back(std::conj(s));
    }
  }
  const auto num_real = static_cast<std::size_t>(
      std::count_if(folded.begin(), folded.end(), [](Complex s) { return s.imag() == 0.0; }));
  return lower.size() == folded.size() - num_real;
}

void sort_zeros(std::vector<Complex>& zeros) {
  std::sort(zeros.begin(), zeros.end(), [](Complex a, Complex b) {
    return std::pair(a.imag(), a.real()) < std::pair(b.imag(), b.real());
  });
}

/// Conjugates and real zeros below the line, counted one by one.
int count_below(const std::vector<Complex>& zeros, double height) {
  int count = 0;
  for (const Complex& s : zeros) {
    if (SecularFunction::height_of(s) < height) count += s.imag() > 0.0 ? 2 : 1;
  }
  return count;
}

/// A pair as its member in the upper half plane; false where it lies on the real axis, on which
/// no two of a pair are distinct.
bool turn_up(const SecularFunction& function, Complex& s) {
  s.imag(std::abs(s.imag()));
  return !is_real(function, s);
}

/// The start that is farthest from everything in `zeros`, in proportion to its height.
Complex loneliest(const std::vector<Complex>& starts, const std::vector<Complex>& zeros) {
  Complex best = starts.front();
  double farthest = -1.0;
  for (const Complex& start : starts) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Complex& s : zeros) nearest = std::min(nearest, std::abs(s - start));
    if (nearest / std::abs(start) > farthest) {
      farthest = nearest / std::abs(start);
      best = start;
    }
  }
  return best;
}

/// P_h has zeros above the line as well. Those below that were found are divided out, so another
/// start is drawn towards the one that is missing.
/// @return whether any was above
bool send_back(std::vector<Complex>& found, std::vector<bool>& is_done,
               const std::vector<Complex>& starts, double height, int attempt) {
  bool is_any = false;
  for (std::size_t j = 0; j < found.size(); ++j) {
    if (SecularFunction::height_of(found[j]) < height) continue;
    is_any = true;
    is_done[j] = false;
    found[j] = loneliest(starts, found) * Complex(1.0, 1e-3 * (attempt + 1));
  }
  return is_any;
}

enum class Settled { all_below, some_above, not_converged };

/// AberthIterates until every zero is below the line; those above it start anew.
/// @param movable  pairs or singles of the iterates: those that may start anew
/// @param is_valid called after each iteration; where it returns false, that counts as not converged
template <class IsValid>
Settled settle_below(SecularFunction& function, double height, AberthIterates& iterates,
                     std::vector<Complex>& movable, int& evaluations, const IsValid& is_valid) {
  std::vector<bool> is_done(iterates.pairs.size() + iterates.singles.size(), false);
  const std::vector<Complex> starts =
      starts_below(function, height, static_cast<int>(function.pole_heights().size()));
  constexpr int max_attempts = 8;
  for (int attempt = 0; attempt < max_attempts; ++attempt) {
    Aberth aberth(function, height);
    const bool is_converged = aberth.run(iterates, is_done);
    evaluations += aberth.evaluations();
    if (!is_converged || !is_valid()) return Settled::not_converged;
    if (!send_back(movable, is_done, starts, height, attempt)) return Settled::all_below;
  }
  return Settled::some_above;
}

/// Zeros of P_h as conjugate pairs, `number` of them with one on the real axis where it is odd.
bool find_pairs(SecularFunction& function, double height, int number, std::vector<Complex>& zeros,
                int& evaluations) {
  AberthIterates iterates;
  iterates.pairs = starts_below(function, height, number / 2);
  if (number % 2 == 1) iterates.singles.emplace_back(-0.1 * function.extent(), 0.0);
  const Settled settled = settle_below(function, height, iterates, iterates.pairs, evaluations, [&] {
    return std::all_of(iterates.pairs.begin(), iterates.pairs.end(),
                       [&](Complex& s) { return turn_up(function, s); });
  });
  if (settled == Settled::not_converged) return false;
  zeros = iterates.pairs;
  zeros.insert(zeros.end(), iterates.singles.begin(), iterates.singles.end());
  return settled == Settled::all_below;
}

/// Those of rigid and overdamped modes, ascending.
std::vector<double> real_poles(const SecularFunction& function) {
  std::vector<double> real;
  for (Eigen::Index i = 0; i < function.num_modes(); ++i) {
    const auto poles = function.poles(i);
    if (poles[0].imag() > 0.0) continue;
    for (const Complex pole : poles) real.push_back(pole.real());
  }
  std::sort(real.begin(), real.end());
  return real;
}

/// So many zeros of P_h; false where the iteration does not settle on a conjugate set.
bool find_zeros(SecularFunction& function, double height, int number, std::vector<Complex>& zeros,
                int& evaluations) {
  // Mostly there are no real eigenvalues, and pairs stay pairs.
  if (find_pairs(function, height, number, zeros, evaluations)) return true;
  // Two real zeros cannot come out of a pair: all on their own, from starts that are not conjugate.
  AberthIterates iterates;
  std::vector<Complex>& starts = iterates.singles;
  const std::vector<double> real = real_poles(function);
  for (std::size_t j = 0; j < real.size(); ++j) {
    const double far = 1e-3 * (std::abs(real[j]) + 1e-3 * function.extent());
    const double gap = j + 1 < real.size() ? real[j + 1] - real[j] : far;
    // Poles may coincide, as those of two rigid modes; starts must not, or they move as one.
    constexpr double coincident = 1e-4;
    const double distance = gap > coincident * far ? std::min(far, 0.25 * gap) : far;
    starts.push_back(real[j] + std::polar(distance, 0.5 + static_cast<double>(starts.size())));
  }
  // The starts between the lowest poles would stand beside these.
  const std::vector<Complex> pairs = starts_below(function, height, number / 2 + 1);
  for (std::size_t j = starts.size() / 2; j < pairs.size(); ++j) {
    starts.push_back(pairs[j]);
    starts.push_back(std::conj(pairs[j]) * Complex(1.0, 1e-3));
  }
  starts.resize(static_cast<std::size_t>(number));
  const Settled settled = settle_below(function, height, iterates, iterates.singles, evaluations,
                                       [] { return true; });
  return fold(function, iterates.singles, zeros) && settled == Settled::all_below;
}

/// A line above a height, between two poles, below which zeros can be counted.
struct Line {
  double height = 0.0;
  int num_zeros = 0;
};

std::optional<Line> line_above(SecularFunction& function, double height) {
  const std::vector<double>& heights = function.pole_heights();
  for (const double narrowest : {1e-2, 1e-3, 1e-5}) {
    auto upper = std::upper_bound(heights.begin(), heights.end(), height);
    for (; upper != heights.end(); ++upper) {
      const double lower = upper == heights.begin() ? 0.0 : *(upper - 1);
      if (*upper - lower <= narrowest * *upper) continue;
      for (const double fraction : {0.5, 0.7, 0.3, 0.85}) {
        const double middle = lower + fraction * (*upper - lower);
        if (middle <= height) continue;
        if (const auto count = function.count_zeros_below(middle)) return Line{middle, *count};
      }
    }
  }
  return std::nullopt;
}

void check_window(const SpectrumWindow& window) {
  if (window.count && *window.count < 1) {
    throw std::invalid_argument(
        fmt::format("secular eigenvalues: {} eigenvalues are none", *window.count));
  }
  if (!(window.frequency >= 0.0)) {
    throw std::invalid_argument(
        fmt::format("secular eigenvalues: no eigenvalues below {:g} Hz", window.frequency));
  }
}

/// Those of the zeros that are in the window.
/// @param zeros in the order of the eigenvalues
std::vector<Eigenvalue> eigenvalues_in(const SpectrumWindow& window,
                                       const std::vector<Complex>& zeros) {
  std::vector<Eigenvalue> eigenvalues;
  int num_pairs = 0;
  for (const Complex& s : zeros) {
    if (s.imag() > 0.0) ++num_pairs;
    if (window.ends_before(s.imag(), num_pairs)) break;
    eigenvalues.push_back({s, 0.0});
  }
  return eigenvalues;
}

}  // namespace

SecularSpectrum secular_spectrum(SecularFunction& function, const SpectrumWindow& window) {
  check_window(window);
  constexpr double inf = std::numeric_limits<double>::infinity();
  const double top = 2.0 * std::numbers::pi * window.frequency;
  const std::vector<double>& heights = function.pole_heights();
  SecularSpectrum spectrum;
  std::vector<Complex>& zeros = spectrum.found;
  const auto is_enough = [&] {
    const auto num_pairs = std::count_if(zeros.begin(), zeros.end(), [&](Complex s) {
      return s.imag() > 0.0 && s.imag() < spectrum.height;
    });
    return spectrum.height > top || (window.count && num_pairs >= *window.count);
  };

  // The zeros lie between the poles, more or less: so many poles and a little more, besides those
  // that are below every line.
  std::size_t wanted = num_heavily_damped(function);
  if (window.count)
    wanted +=
        static_cast<std::size_t>(*window.count + static_cast<int>(function.num_constraints()));
  double start = top;
  while (!spectrum.is_complete) {
    if (window.count) start = wanted < heights.size() ? std::min(top, heights[wanted]) : top;
    const auto line = start < inf ? line_above(function, start) : std::nullopt;
    if (!line) break;
    spectrum.height = line->height;
    spectrum.num_counted = line->num_zeros;
    if (window.count && line->height <= top && line->num_zeros < 2 * *window.count) {
      wanted += 2;
      continue;
    }
    const bool is_converged =
        find_zeros(function, line->height, line->num_zeros, zeros, spectrum.evaluations);
    if (!is_converged || count_below(zeros, line->height) != line->num_zeros) break;
    if (is_enough()) {
      spectrum.is_complete = true;
    } else {
      wanted += 2;  // some of those counted are real
    }
  }
  if (!spectrum.is_complete) {
    spectrum.num_counted = static_cast<int>(function.num_zeros());
    spectrum.height = inf;
    spectrum.is_complete =
        find_zeros(function, inf, spectrum.num_counted, zeros, spectrum.evaluations);
    // Where B_C S Sᵀ B_Eᵀ is singular, P has fewer zeros, and rounding makes up the rest far away.
    for (const Complex s : zeros) {
      spectrum.is_complete = spectrum.is_complete && std::abs(s) < 1e6 * function.extent();
    }
  }
  sort_zeros(zeros);
  spectrum.eigenvalues = eigenvalues_in(window, zeros);
  return spectrum;
}

std::vector<Eigenvalue> secular_eigenvalues(const Pencil& pencil, const SpectrumWindow& window) {
  SecularFunction function(pencil);
  SecularSpectrum spectrum = secular_spectrum(function, window);
  if (!spectrum.is_complete) {
    throw SearchFailure(Refusal::eigenvalues_incomplete,
                        fmt::format("secular eigenvalues: the search for {} eigenvalues did not "
                                    "converge; use the dense method",
                                    spectrum.num_counted));
  }
  const ModalRows rows = modal_rows(pencil);
  for (Eigenvalue& eigenvalue : spectrum.eigenvalues) {
    eigenvalue.residual =
        relative_residual(pencil, eigenvalue.s, eigenvector(pencil, rows, eigenvalue.s).right);
  }
  return spectrum.eigenvalues;
}

}  // namespace stridor
