#include "analysis/window_finder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace stridor {
namespace {

using Complex = std::complex<double>;

/// Finds where the real part of a branch is positive.
class WindowFinder {
 public:
  WindowFinder(SpectrumSource& source, const LocusOptions& options, const Grid& grid, Locus& locus)
      : source_(source),
        grid_(grid),
        locus_(locus),
        smallest_(options.resolution * (grid.values.back() - grid.values.front())) {}

  /// Refines the samples of a track and appends its windows and crossings to the locus.
  void search(Track& track, int branch) {
    track_ = &track;
    num_looks_ = 0;
    growth_.clear();
    for (std::size_t i = 0; i < values().size(); ++i) {
      growth_.push_back(growth_of(track.branch.s[i], track.nearest[i]));
    }
    for (std::size_t i = 0; i + 1 < values().size();) {
      if (is_resolved(i)) {
        ++i;
      } else if (is_spent()) {
        note_unresolved(i++);
      } else {
        insert_middle(i);
      }
    }
    std::optional<UnstableWindow> open;
    if (growth(0) > 0.0) open.emplace().from = values().front();
    for (std::size_t i = 0; i + 1 < values().size(); ++i) {
      const bool is_unstable = growth(i) > 0.0;
      if (is_unstable == (growth(i + 1) > 0.0)) continue;
      const double value = crossing(i);
      locus_.crossings.push_back(
          {value, at(value).imag() / (2.0 * std::numbers::pi), is_unstable ? -1 : 1, branch});
      if (is_unstable) {
        close(*open, value, branch);
        open.reset();
      } else {
        open.emplace().from = value;
      }
    }
    if (open) close(*open, values().back(), branch);
  }

 private:
  /// Values at which one branch is looked at. Smooth branches take some hundred; one whose rounding
  /// errors are larger than its changes, as beside jamming, would take all of them down to the
  /// smallest interval.
  static constexpr int most_looks = 20'000;
  bool is_spent() const { return num_looks_ >= most_looks; }
  void note_unresolved(std::size_t i) {
    locus_.unresolved = std::max(locus_.unresolved, values()[i + 1] - values()[i]);
  }

  const std::vector<double>& values() const { return track_->branch.values; }
  double growth(std::size_t i) const { return growth_[i]; }

  /// Re s less the rounding error of zero: without damping eigenvalues lie on the axis over
  /// whole intervals. Next to another one an eigenvalue is ill-conditioned, and a double one is off
  /// by the root of the rounding.
  double growth_of(Complex s, double nearest) const {
    constexpr double rounding = 20.0 * std::numeric_limits<double>::epsilon();
    constexpr double closest = 1e-7;  // of |s|
    const double distance = std::max(nearest, closest * std::abs(s));
    return s.real() - rounding * source_.magnitude(s) * (1.0 + std::abs(s) / distance);
  }

  double spacing_in(std::size_t i) const {
    return std::min(track_->spacing[i], track_->spacing[i + 1]);
  }
  double nearest_in(std::size_t i) const {
    return std::min(track_->nearest[i], track_->nearest[i + 1]);
  }

  /// The branch at a value between two of its samples.
  Complex at(double value) {
    const auto upper = std::upper_bound(values().begin(), values().end(), value);
    if (upper == values().end()) return track_->branch.s.back();
    const auto i = static_cast<std::size_t>(upper - values().begin()) - 1;
    if (value == values()[i]) return track_->branch.s[i];
    return between(i, value);
  }

  Complex between(std::size_t i, double value) {
    const std::vector<Complex>& s = track_->branch.s;
    const double fraction = (value - values()[i]) / (values()[i + 1] - values()[i]);
    const Complex guess = (1.0 - fraction) * s[i] + fraction * s[i + 1];
    // Two eigenvalues meet there; the line between the samples is all that is known.
    if (values()[i + 1] - values()[i] <= 2.0 * smallest_) return guess;
    if (is_spent()) {
      note_unresolved(i);
      return guess;
    }
    ++num_looks_;
    const double spacing = spacing_in(i);
    source_.move_to(value);
    ++locus_.num_refined;
    const auto followed = source_.follow(guess, 0.1 * spacing, track_->hint);
    if (!followed.is_converged || std::abs(followed.s - guess) > 0.5 * spacing) {
      locus_.unverified.push_back(value);
      return guess;
    }
    return followed.s;
  }

  /// Half the second derivative of the growth around sample i, if it is smooth there.
  std::optional<double> curvature(std::size_t i) const {
    if (i == 0 || i + 1 >= values().size() || grid_.is_kink(values()[i])) return std::nullopt;
    const double before = (growth(i) - growth(i - 1)) / (values()[i] - values()[i - 1]);
    const double after = (growth(i + 1) - growth(i)) / (values()[i + 1] - values()[i]);
    return (after - before) / (values()[i + 1] - values()[i - 1]);
  }

  /// Whether the samples show how often the growth changes sign between i and i + 1.
  bool is_resolved(std::size_t i) const {
    const double length = values()[i + 1] - values()[i];
    if (length <= smallest_) return true;
    const auto left = curvature(i);
    const auto right = curvature(i + 1);
    if (!left && !right) return false;
    // Deviation from the chord, ½ |f″| length²/4, twice for deviations between the samples.
    const double deviation = 0.5 * length * length *
                             std::max(std::abs(left.value_or(0.0)), std::abs(right.value_or(0.0)));
    const double low = std::min(growth(i), growth(i + 1));
    const double high = std::max(growth(i), growth(i + 1));
    if (high + deviation < 0.0 || low - deviation > 0.0) return true;
    // One crossing, if the slope cannot change its sign.
    return low <= 0.0 && high > 0.0 && high - low > 4.0 * deviation;
  }

  void insert_middle(std::size_t i) {
    const double middle = 0.5 * (values()[i] + values()[i + 1]);
    const Complex s = between(i, middle);
    const double spacing = spacing_in(i);
    const double nearest = nearest_in(i);
    const auto offset = static_cast<std::ptrdiff_t>(i) + 1;
    Branch& branch = track_->branch;
    branch.values.insert(branch.values.begin() + offset, middle);
    branch.s.insert(branch.s.begin() + offset, s);
    track_->spacing.insert(track_->spacing.begin() + offset, spacing);
    track_->nearest.insert(track_->nearest.begin() + offset, nearest);
    growth_.insert(growth_.begin() + offset, growth_of(s, nearest));
  }

  /// Zero of the growth between samples i and i + 1, which have different signs: regula falsi, the
  /// retained end weighed down (Illinois).
  double crossing(std::size_t i) {
    double a = values()[i];
    double b = values()[i + 1];
    double growth_a = growth(i);
    double growth_b = growth(i + 1);
    if (growth_b == 0.0) return b;
    if (growth_a == 0.0) return a;
    constexpr int max_iterations = 60;
    int side = 0;
    double middle = a;
    for (int iteration = 0; iteration < max_iterations; ++iteration) {
      const double last = middle;
      middle = (a * growth_b - b * growth_a) / (growth_b - growth_a);
      if (!(middle > a && middle < b)) middle = 0.5 * (a + b);
      const double found = growth_of(between(i, middle), nearest_in(i));
      if (found == 0.0) return middle;
      if ((found > 0.0) == (growth_a > 0.0)) {
        a = middle;
        growth_a = found;
        if (side == -1) growth_b *= 0.5;
        side = -1;
      } else {
        b = middle;
        growth_b = found;
        if (side == 1) growth_a *= 0.5;
        side = 1;
      }
      if (std::abs(middle - last) <= 1e-13 * std::max(std::abs(a), std::abs(b))) break;
    }
    return middle;
  }

  void close(UnstableWindow window, double to, int branch) {
    window.to = to;
    window.branch = branch;
    std::vector<double> nodes{window.from};
    for (const double value : values()) {
      if (value > window.from && value < to) nodes.push_back(value);
    }
    nodes.push_back(to);
    Complex peak = at(window.from);
    window.value_max = window.from;
    const auto consider = [&](double value, Complex s) {
      if (s.real() <= peak.real()) return;
      peak = s;
      window.value_max = value;
    };
    std::vector<Complex> s;
    for (const double node : nodes) {
      s.push_back(at(node));
      consider(node, s.back());
    }
    for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
      // Between two samples the growth may be larger only next to the largest sample.
      if (nodes[i] == window.value_max || nodes[i + 1] == window.value_max || nodes.size() == 2) {
        climb(nodes[i], s[i], nodes[i + 1], s[i + 1], consider);
        break;
      }
    }
    const auto top = std::find(nodes.begin(), nodes.end(), window.value_max);
    if (top != nodes.end() && top + 1 != nodes.end()) {
      const auto i = static_cast<std::size_t>(top - nodes.begin());
      climb(nodes[i], s[i], nodes[i + 1], s[i + 1], consider);
    }
    window.growth_max = peak.real();
    window.frequency = peak.imag() / (2.0 * std::numbers::pi);
    const double tolerance = 1e-8 * window.growth_max * (to - window.from);
    for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
      const double middle = 0.5 * (nodes[i] + nodes[i + 1]);
      const Simpson part{nodes[i], nodes[i + 1], s[i].real(), at(middle).real(), s[i + 1].real()};
      window.growth_integral += integrate(part, tolerance, 0);
    }
    locus_.unstable.push_back(window);
  }

  /// Offers the largest growth inside an interval, by parabolas through three points.
  template <class Consider>
  void climb(double a, Complex s_a, double b, Complex s_b, Consider consider) {
    double middle = 0.5 * (a + b);
    Complex s_middle = at(middle);
    const double width = b - a;
    consider(middle, s_middle);
    constexpr int max_iterations = 12;
    for (int iteration = 0; iteration < max_iterations; ++iteration) {
      const double left = (s_middle.real() - s_a.real()) / (middle - a);
      const double right = (s_b.real() - s_middle.real()) / (b - middle);
      const double half_curvature = (right - left) / (b - a);
      if (!(half_curvature < 0.0)) return;
      const double top = 0.5 * (a + middle) - 0.5 * left / half_curvature;
      if (!(top > a && top < b) || std::abs(top - middle) <= 1e-8 * width) return;
      const Complex s_top = at(top);
      consider(top, s_top);
      const bool is_higher = s_top.real() > s_middle.real();
      if ((top > middle) == is_higher) {
        a = is_higher ? middle : top;
        s_a = is_higher ? s_middle : s_top;
      } else {
        b = is_higher ? middle : top;
        s_b = is_higher ? s_middle : s_top;
      }
      if (is_higher) {
        middle = top;
        s_middle = s_top;
      }
    }
  }

  /// Growth at the ends and in the middle of an interval.
  struct Simpson {
    double a, b;
    double at_a, at_middle, at_b;
    double integral() const { return (b - a) / 6.0 * (at_a + 4.0 * at_middle + at_b); }
  };

  double integrate(const Simpson& whole, double tolerance, int depth) {
    constexpr int max_depth = 12;
    const double middle = 0.5 * (whole.a + whole.b);
    const Simpson left{whole.a, middle, whole.at_a, at(0.5 * (whole.a + middle)).real(),
                       whole.at_middle};
    const Simpson right{middle, whole.b, whole.at_middle, at(0.5 * (middle + whole.b)).real(),
                        whole.at_b};
    const double halves = left.integral() + right.integral();
    const double error = (halves - whole.integral()) / 15.0;
    if (std::abs(error) <= tolerance || depth == max_depth) return halves + error;
    return integrate(left, 0.5 * tolerance, depth + 1) +
           integrate(right, 0.5 * tolerance, depth + 1);
  }

  SpectrumSource& source_;
  const Grid& grid_;
  Locus& locus_;
  double smallest_;
  int num_looks_ = 0;  ///< at the present branch
  Track* track_ = nullptr;
  std::vector<double> growth_;  ///< growth_of() of the samples
};

}  // namespace

void find_windows(SpectrumSource& source, const LocusOptions& options, const Grid& grid,
                  Track& track, int branch, Locus& locus) {
  WindowFinder(source, options, grid, locus).search(track, branch);
}

}  // namespace stridor
