#include "analysis/locus.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

#include "core/errors.hpp"
#include "solvers/dense_eigenvalues.hpp"
#include "solvers/secular_eigenvalues.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

constexpr double inf = std::numeric_limits<double>::infinity();

bool is_pair(Complex s) {
  return s.imag() > 0.0;
}

void sort_eigenvalues(std::vector<Complex>& values) {
  std::sort(values.begin(), values.end(), [](Complex a, Complex b) {
    return std::pair(a.imag(), a.real()) < std::pair(b.imag(), b.real());
  });
}

/// What a locus needs of an eigenvalue method. Sets are of the upper half plane and the real axis.
class SpectrumSource {
 public:
  struct Followed {
    Complex s;
    bool is_converged = false;
  };

  virtual ~SpectrumSource() = default;
  virtual void move_to(double value) = 0;
  /// All eigenvalues below some height, those wanted among them; empty where the search failed.
  virtual std::optional<std::vector<Complex>> search() = 0;
  /// The eigenvalue next to a guess.
  virtual Followed follow(Complex guess, double spacing, int& hint) = 0;
  /// Whether every eigenvalue with Im s <= needed is in the set, and no stranger.
  virtual bool covers(const std::vector<Complex>& set, double needed) = 0;
  virtual Eigen::VectorXcd shape(Complex s) = 0;
  /// Size of the numbers of which an eigenvalue is the difference, 1/s: what its rounding is in
  /// proportion to.
  virtual double magnitude(Complex s) const = 0;
};

class SecularSource : public SpectrumSource {
 public:
  SecularSource(const PencilFamily& family, double value, const LocusOptions& options)
      : family_(family), function_(first_pencil(value)) {
    // Two more than wanted: what comes down from above is then known before it counts.
    window_.count = options.count + 2;
    window_.frequency = options.frequency;
  }

  void move_to(double value) override {
    family_.place(value, pencil_);
    function_.assign(pencil_);
  }

  std::optional<std::vector<Complex>> search() override {
    SecularSpectrum spectrum = secular_spectrum(function_, window_);
    if (!spectrum.is_complete) return std::nullopt;
    if (spectrum.height == inf) drop_unwanted(spectrum);
    return std::move(spectrum.found);
  }

  Followed follow(Complex guess, double spacing, int& hint) override {
    const SecularFunction::Zero zero = function_.find_zero(guess, spacing, hint);
    return {zero.s, zero.is_converged};
  }

  bool covers(const std::vector<Complex>& set, double needed) override {
    int below = 0;
    int total = 0;
    if (!find_line(set, needed)) {
      for (const Complex s : set) total += is_pair(s) ? 2 : 1;
      return total == function_.num_zeros();
    }
    for (const Complex s : set) below += s.imag() < line_ ? (is_pair(s) ? 2 : 1) : 0;
    return function_.count_zeros_below(line_) == below;
  }

  Eigen::VectorXcd shape(Complex s) override { return eigenvector(pencil_, s).right; }
  double magnitude(Complex s) const override { return std::abs(s); }

 private:
  const Pencil& first_pencil(double value) {
    family_.place(value, pencil_);
    return pencil_;
  }

  /// Where no line was of use, the search had to find all eigenvalues. Those far above the window
  /// would only be in the way: where two of them meet, every step would have to be small.
  void drop_unwanted(SecularSpectrum& spectrum) {
    double needed = 2.0 * std::numbers::pi * window_.frequency;
    int num_pairs = 0;
    for (const Eigenvalue& eigenvalue : spectrum.eigenvalues) {
      if (is_pair(eigenvalue.s) && ++num_pairs == window_.count) needed = eigenvalue.s.imag();
    }
    if (!find_line(spectrum.found, needed)) return;
    std::erase_if(spectrum.found, [&](Complex s) { return s.imag() > line_; });
  }

  double clearance(const std::vector<Complex>& set, double line) const {
    double least = inf;
    for (const Complex s : set) least = std::min(least, std::abs(s.imag() - line));
    return least;
  }

  /// Sets line_ above a height, between two poles and clear of the set; false above all poles.
  bool find_line(const std::vector<Complex>& set, double needed) {
    constexpr double least_clearance = 0.1;  // of the interval between the poles
    const std::vector<double>& heights = function_.pole_heights();
    // The samples of a line are kept, so the last one is much cheaper than another.
    if (line_ > needed && line_ < heights.back() && line_ < highest_line(needed) &&
        clearance(set, line_) >= least_clearance * line_gap_) {
      return true;
    }
    constexpr double narrowest = 1e-3;  // of the height
    auto upper = std::upper_bound(heights.begin(), heights.end(), needed);
    for (; upper != heights.end(); ++upper) {
      const double lower = upper == heights.begin() ? 0.0 : *(upper - 1);
      line_gap_ = *upper - lower;
      if (line_gap_ <= narrowest * *upper) continue;
      for (const double fraction : {0.5, 0.65, 0.35, 0.8, 0.2}) {
        line_ = lower + fraction * line_gap_;
        if (line_ > needed && clearance(set, line_) >= least_clearance * line_gap_) return true;
      }
    }
    line_ = -1.0;
    return false;
  }

  /// A line farther up than this counts eigenvalues that nobody wants.
  double highest_line(double needed) const {
    const std::vector<double>& heights = function_.pole_heights();
    const auto upper = std::upper_bound(heights.begin(), heights.end(), needed);
    const auto ahead = std::min<std::ptrdiff_t>(3, heights.end() - upper);
    return ahead == 0 ? inf : *(upper + ahead - 1);
  }

  const PencilFamily& family_;
  Pencil pencil_;
  SecularFunction function_;
  SpectrumWindow window_;
  double line_ = -1.0;
  double line_gap_ = 0.0;
};

class DenseSource : public SpectrumSource {
 public:
  DenseSource(const PencilFamily& family, const LocusOptions& options)
      : family_(family), count_(options.count + 2) {}

  void move_to(double value) override {
    if (value == value_) return;
    family_.place(value, pencil_);
    known_.clear();
    for (const Eigenvalue& eigenvalue : dense_eigenvalues(pencil_, DenseWork::eigenvalues)) {
      known_.push_back(eigenvalue.s);
    }
    value_ = value;
  }

  std::optional<std::vector<Complex>> search() override {
    std::vector<Complex> lowest;
    int num_pairs = 0;
    for (const Complex s : known_) {
      if (is_pair(s) && ++num_pairs > count_) break;
      lowest.push_back(s);
    }
    return lowest;
  }

  Followed follow(Complex guess, double, int&) override {
    const auto nearest = std::min_element(known_.begin(), known_.end(), [&](Complex a, Complex b) {
      return std::abs(a - guess) < std::abs(b - guess);
    });
    return {*nearest, true};
  }

  bool covers(const std::vector<Complex>& set, double needed) override {
    return std::all_of(known_.begin(), known_.end(), [&](Complex s) {
      return s.imag() > needed || std::find(set.begin(), set.end(), s) != set.end();
    });
  }

  Eigen::VectorXcd shape(Complex s) override { return eigenvector(pencil_, s).right; }
  double magnitude(Complex) const override { return pencil_.omega.maxCoeff(); }

 private:
  const PencilFamily& family_;
  Pencil pencil_;
  int count_;
  double value_ = std::numeric_limits<double>::quiet_NaN();
  std::vector<Complex> known_;  ///< ascending imaginary part
};

/// Values to be visited in any case, ascending.
struct Grid {
  std::vector<double> values;
  std::vector<double> kinks;  ///< those inside the range

  bool is_kink(double value) const { return std::binary_search(kinks.begin(), kinks.end(), value); }
};

Grid make_grid(const std::vector<double>& wanted, const std::vector<double>& kinks) {
  constexpr int least_per_piece = 4;
  constexpr int least_in_all = 64;
  const double range = wanted.back() - wanted.front();
  const double rounding = 1e-12 * range;
  Grid grid;
  for (const double kink : kinks) {
    if (kink <= wanted.front() + rounding || kink >= wanted.back() - rounding) continue;
    // A kink that a value was meant to hit is hit by it.
    const auto next = std::lower_bound(wanted.begin(), wanted.end(), kink - rounding);
    grid.kinks.push_back(next != wanted.end() && *next <= kink + rounding ? *next : kink);
  }
  std::vector<double> nodes;
  std::set_union(wanted.begin(), wanted.end(), grid.kinks.begin(), grid.kinks.end(),
                 std::back_inserter(nodes));
  grid.values.push_back(nodes.front());
  auto piece_end = grid.kinks.begin();
  double piece_begin = nodes.front();
  for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
    while (piece_end != grid.kinks.end() && *piece_end <= nodes[i]) piece_begin = *piece_end++;
    const double end = piece_end != grid.kinks.end() ? *piece_end : nodes.back();
    const double longest = std::min((end - piece_begin) / least_per_piece, range / least_in_all);
    const double length = nodes[i + 1] - nodes[i];
    const auto parts = std::max(1, static_cast<int>(std::ceil(length / longest * (1.0 - 1e-9))));
    for (int part = 1; part < parts; ++part) {
      grid.values.push_back(nodes[i] + length * part / parts);
    }
    grid.values.push_back(nodes[i + 1]);
  }
  return grid;
}

/// A branch with what is needed to come back to it.
struct Track {
  Branch branch;
  std::vector<double> spacing;  ///< of every sample: distance to the nearest other eigenvalue
  int hint = -1;
  bool is_followed = true;

  Complex last() const { return branch.s.back(); }
};

/// Value at x of the parabola through three points, or of the line where two coincide.
Complex extrapolate(const double* v, const Complex* s, std::size_t count, double x) {
  if (count == 1) return s[0];
  const Complex first = (s[1] - s[0]) / (v[1] - v[0]);
  if (count == 2) return s[1] + first * (x - v[1]);
  const Complex second = ((s[2] - s[1]) / (v[2] - v[1]) - first) / (v[2] - v[0]);
  return s[2] + (x - v[2]) * ((s[2] - s[1]) / (v[2] - v[1]) + second * (x - v[1]));
}

/// Goes through the grid and follows every eigenvalue.
class Tracker {
 public:
  Tracker(SpectrumSource& source, const LocusOptions& options, const Grid& grid, Locus& locus)
      : source_(source),
        options_(options),
        grid_(grid),
        locus_(locus),
        smallest_step_(options.resolution * (grid.values.back() - grid.values.front())) {}

  void run() {
    start();
    auto wanted = locus_.values.begin();
    for (std::size_t i = 0; i < grid_.values.size(); ++i) {
      if (i > 0) advance_to(grid_.values[i]);
      if (wanted != locus_.values.end() && *wanted == grid_.values[i]) {
        record();
        ++wanted;
      }
      if (grid_.is_kink(grid_.values[i])) last_kink_ = grid_.values[i];
    }
  }

  std::vector<Track> take_tracks() { return std::move(tracks_); }

 private:
  void start() {
    value_ = grid_.values.front();
    last_kink_ = -inf;
    source_.move_to(value_);
    const auto found = source_.search();
    if (!found) {
      throw NumericalError(
          fmt::format("locus: the eigenvalues at the first value, {:g}, were not found", value_));
    }
    ++locus_.num_places;
    for (const Complex s : *found) begin_track(s);
    set_spacings(*found);
  }

  void begin_track(Complex s) {
    Track track;
    track.branch.values.push_back(value_);
    track.branch.s.push_back(s);
    track.spacing.push_back(0.0);
    active_.push_back(tracks_.size());
    tracks_.push_back(std::move(track));
  }

  /// Distance of every active eigenvalue to the nearest other one, conjugates included.
  void set_spacings(const std::vector<Complex>& set) {
    squares_.resize(set.size());
    for (std::size_t j = 0; j < set.size(); ++j) {
      squares_[j] = is_pair(set[j]) ? 4.0 * set[j].imag() * set[j].imag() : inf;
      for (std::size_t k = 0; k < j; ++k) {
        const double square = std::norm(set[k] - set[j]);
        squares_[j] = std::min(squares_[j], square);
        squares_[k] = std::min(squares_[k], square);
      }
    }
    for (std::size_t j = 0; j < set.size(); ++j) {
      tracks_[active_[j]].spacing.back() = std::sqrt(squares_[j]);
    }
  }

  void advance_to(double target) {
    double next = target;
    while (value_ < target) {
      if (try_step(next)) {
        next = target;
      } else if (next - value_ <= smallest_step_) {
        jump_to(next);
        next = target;
      } else {
        next = value_ + std::max(0.5 * (next - value_), 0.9 * smallest_step_);
      }
    }
  }

  Complex guess_at(const Track& track, double value) const {
    const std::size_t size = track.branch.values.size();
    // A parabola across a kink would be worse than a line.
    std::size_t count = std::min<std::size_t>(3, size);
    if (count == 3 && track.branch.values[size - 3] < last_kink_) count = 2;
    return extrapolate(track.branch.values.data() + size - count,
                       track.branch.s.data() + size - count, count, value);
  }

  /// Im s of the highest eigenvalue that is wanted of a set.
  double needed_height(const std::vector<Complex>& set) {
    const double top = 2.0 * std::numbers::pi * options_.frequency;
    heights_.clear();
    for (const Complex s : set) {
      if (is_pair(s)) heights_.push_back(s.imag());
    }
    const auto count = static_cast<std::size_t>(options_.count);
    if (heights_.size() < count) return top;
    std::nth_element(heights_.begin(), heights_.begin() + (options_.count - 1), heights_.end());
    return std::min(top, heights_[count - 1]);
  }

  /// Whether no two eigenvalues can have been exchanged from one set to the next.
  static bool is_resolved(const std::vector<Complex>& before, const std::vector<Complex>& after) {
    // |a − b| ≤ ½ min(|a|, |b|), in squares.
    const auto turns = [](Complex a, Complex b) {
      return 4.0 * std::norm(a - b) > std::min(std::norm(a), std::norm(b));
    };
    for (std::size_t j = 0; j < before.size(); ++j) {
      if (is_pair(before[j]) && turns(before[j].imag(), after[j].imag())) return false;
      for (std::size_t k = 0; k < j; ++k) {
        if (turns(before[j] - before[k], after[j] - after[k])) return false;
      }
    }
    return true;
  }

  bool try_step(double value) {
    source_.move_to(value);
    before_.clear();
    next_.clear();
    for (const std::size_t index : active_) {
      Track& track = tracks_[index];
      const Complex guess = guess_at(track, value);
      const double spacing = track.spacing.back();
      const SpectrumSource::Followed followed = source_.follow(guess, 0.1 * spacing, track.hint);
      if (!followed.is_converged || std::abs(followed.s - guess) > 0.25 * spacing) return false;
      if (is_pair(track.last()) != is_pair(followed.s)) return false;
      before_.push_back(track.last());
      next_.push_back(followed.s);
    }
    if (!is_resolved(before_, next_)) return false;
    const bool is_covered = source_.covers(next_, needed_height(next_));
    if (!is_covered && !add_newcomers(value)) return false;
    accept(value);
    return true;
  }

  /// Eigenvalues that have come into view from above. False where those followed are not among all.
  bool add_newcomers(double value) {
    const auto found = source_.search();
    if (!found) {
      locus_.unverified.push_back(value);
      return true;
    }
    std::vector<Complex> rest = *found;
    double height = 0.0;
    for (const Complex s : rest) height = std::max(height, s.imag());
    for (const Complex s : next_) {
      const auto same = std::find_if(rest.begin(), rest.end(), [&](Complex other) {
        return std::abs(other - s) <= 1e-8 * std::abs(s);
      });
      if (same != rest.end()) {
        rest.erase(same);
      } else if (s.imag() < height) {
        return false;
      }
    }
    newcomers_ = std::move(rest);
    return true;
  }

  void accept(double value) {
    value_ = value;
    ++locus_.num_places;
    for (std::size_t j = 0; j < active_.size(); ++j) {
      Track& track = tracks_[active_[j]];
      track.branch.values.push_back(value);
      track.branch.s.push_back(next_[j]);
      track.spacing.push_back(0.0);
    }
    for (const Complex s : newcomers_) {
      begin_track(s);
      next_.push_back(s);
    }
    newcomers_.clear();
    set_spacings(next_);
  }

  /// Two eigenvalues meet: all are found anew, and go to the branch that they are nearest to, or,
  /// where several are equally near, whose shape they have.
  void jump_to(double value) {
    std::vector<Complex> before;
    for (const std::size_t index : active_) before.push_back(tracks_[index].last());
    source_.move_to(value);
    std::vector<Complex> after;
    double height = 0.0;
    if (auto found = source_.search()) {
      after = std::move(*found);
      for (const Complex s : after) height = std::max(height, s.imag());
    } else {
      locus_.unverified.push_back(value);
    }
    // Eigenvalues above those searched are followed as before.
    for (const std::size_t index : active_) {
      Track& track = tracks_[index];
      if (track.last().imag() <= height) continue;
      const auto followed = source_.follow(track.last(), 0.1 * track.spacing.back(), track.hint);
      const bool is_known = std::any_of(after.begin(), after.end(), [&](Complex s) {
        return std::abs(s - followed.s) <= 1e-8 * std::abs(s);
      });
      if (followed.is_converged && !is_known && followed.s.imag() >= 0.0) {
        after.push_back(followed.s);
      }
    }

    const std::vector<int> partner = connect(before, after, value);
    std::vector<std::size_t> still_active;
    next_.clear();
    std::vector<bool> is_taken(after.size(), false);
    for (std::size_t j = 0; j < active_.size(); ++j) {
      if (partner[j] < 0) {
        tracks_[active_[j]].is_followed = false;
        continue;
      }
      const auto k = static_cast<std::size_t>(partner[j]);
      is_taken[k] = true;
      still_active.push_back(active_[j]);
      next_.push_back(after[k]);
    }
    active_ = std::move(still_active);
    for (std::size_t k = 0; k < after.size(); ++k) {
      if (!is_taken[k]) newcomers_.push_back(after[k]);
    }
    accept(value);
  }

  /// For every eigenvalue before, the index of the one after that continues it, or −1.
  std::vector<int> connect(const std::vector<Complex>& before, const std::vector<Complex>& after,
                           double value) {
    std::vector<int> partner(before.size(), -1);
    std::vector<bool> is_taken(after.size(), false);
    const auto nearest = [&](Complex s, const std::vector<Complex>& others) {
      return std::min_element(
                 others.begin(), others.end(),
                 [&](Complex a, Complex b) { return std::abs(a - s) < std::abs(b - s); }) -
             others.begin();
    };
    // Those that have hardly moved, in proportion to their distance to the others.
    for (std::size_t j = 0; j < before.size() && !after.empty(); ++j) {
      const auto k = static_cast<std::size_t>(nearest(before[j], after));
      const bool is_clear =
          std::abs(after[k] - before[j]) <= 0.1 * tracks_[active_[j]].spacing.back();
      if (!is_clear || is_taken[k] || is_pair(before[j]) != is_pair(after[k])) continue;
      partner[j] = static_cast<int>(k);
      is_taken[k] = true;
    }
    struct Candidate {
      double assurance;
      std::size_t j, k;
    };
    std::vector<std::size_t> open_before;
    std::vector<std::size_t> open_after;
    for (std::size_t j = 0; j < before.size(); ++j)
      if (partner[j] < 0) open_before.push_back(j);
    for (std::size_t k = 0; k < after.size(); ++k)
      if (!is_taken[k]) open_after.push_back(k);
    if (open_before.empty() || open_after.empty()) return partner;

    std::vector<Eigen::VectorXcd> shapes_after;
    for (const std::size_t k : open_after) shapes_after.push_back(source_.shape(after[k]));
    source_.move_to(value_);
    std::vector<Candidate> candidates;
    for (const std::size_t j : open_before) {
      const Eigen::VectorXcd shape = source_.shape(before[j]);
      for (std::size_t i = 0; i < open_after.size(); ++i) {
        const Complex s = after[open_after[i]];
        // Only what is about as near as the nearest can be its continuation.
        if (std::abs(s - before[j]) > 0.1 * std::abs(before[j])) continue;
        candidates.push_back({modal_assurance(shape, shapes_after[i]), j, open_after[i]});
      }
    }
    source_.move_to(value);
    std::stable_sort(
        candidates.begin(), candidates.end(),
        [](const Candidate& a, const Candidate& b) { return a.assurance > b.assurance; });
    for (const Candidate& candidate : candidates) {
      if (partner[candidate.j] >= 0 || is_taken[candidate.k]) continue;
      partner[candidate.j] = static_cast<int>(candidate.k);
      is_taken[candidate.k] = true;
    }
    return partner;
  }

  /// Keeps the eigenvalues wanted at the present value.
  void record() {
    std::vector<Complex> wanted;
    for (const std::size_t index : active_) wanted.push_back(tracks_[index].last());
    sort_eigenvalues(wanted);
    const double top = 2.0 * std::numbers::pi * options_.frequency;
    int num_pairs = 0;
    std::size_t size = 0;
    while (size < wanted.size() && wanted[size].imag() <= top) {
      if (is_pair(wanted[size]) && ++num_pairs > options_.count) break;
      ++size;
    }
    wanted.resize(size);
    locus_.eigenvalues.push_back(std::move(wanted));
  }

  SpectrumSource& source_;
  const LocusOptions& options_;
  const Grid& grid_;
  Locus& locus_;
  double smallest_step_;
  double value_ = 0.0;
  double last_kink_ = 0.0;
  std::vector<Track> tracks_;
  std::vector<std::size_t> active_;  ///< tracks that are followed
  std::vector<Complex> before_, next_, newcomers_;
  std::vector<double> heights_, squares_;  ///< scratch
};

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
    growth_.clear();
    for (std::size_t i = 0; i < values().size(); ++i) {
      growth_.push_back(growth_of(track.branch.s[i], track.spacing[i]));
    }
    for (std::size_t i = 0; i + 1 < values().size();) {
      if (is_resolved(i)) {
        ++i;
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
  const std::vector<double>& values() const { return track_->branch.values; }
  double growth(std::size_t i) const { return growth_[i]; }

  /// Re s less what rounding may make of zero: without damping eigenvalues lie on the axis over
  /// whole intervals. Next to another one an eigenvalue is ill-conditioned.
  double growth_of(Complex s, double spacing) const {
    constexpr double rounding = 20.0 * std::numeric_limits<double>::epsilon();
    return s.real() - rounding * source_.magnitude(s) * (1.0 + std::abs(s) / spacing);
  }

  double spacing_in(std::size_t i) const {
    return std::min(track_->spacing[i], track_->spacing[i + 1]);
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
    // Deviation from the chord, ½ |f″| length²/4, twice for what the samples do not show.
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
    const auto offset = static_cast<std::ptrdiff_t>(i) + 1;
    Branch& branch = track_->branch;
    branch.values.insert(branch.values.begin() + offset, middle);
    branch.s.insert(branch.s.begin() + offset, s);
    track_->spacing.insert(track_->spacing.begin() + offset, spacing);
    growth_.insert(growth_.begin() + offset, growth_of(s, spacing));
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
      const double found = growth_of(between(i, middle), spacing_in(i));
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
  Track* track_ = nullptr;
  std::vector<double> growth_;  ///< growth_of() of the samples
};

/// Im s of a branch, by its samples; nothing outside them.
std::optional<double> height_at(const Branch& branch, double value) {
  if (value < branch.values.front() || value > branch.values.back()) return std::nullopt;
  const auto upper = std::upper_bound(branch.values.begin(), branch.values.end(), value);
  if (upper == branch.values.end()) return branch.s.back().imag();
  const auto i = static_cast<std::size_t>(upper - branch.values.begin());
  const double fraction =
      (value - branch.values[i - 1]) / (branch.values[i] - branch.values[i - 1]);
  return (1.0 - fraction) * branch.s[i - 1].imag() + fraction * branch.s[i].imag();
}

/// Drops what belongs to eigenvalues that were not asked for.
void keep_wanted(Locus& locus, const LocusOptions& options) {
  const auto is_wanted = [&](const UnstableWindow& window) {
    if (window.frequency > options.frequency) return false;
    int below = 0;
    for (std::size_t b = 0; b < locus.branches.size(); ++b) {
      if (static_cast<int>(b) == window.branch) continue;
      const auto height = height_at(locus.branches[b], window.value_max);
      if (height && *height > 0.0 && *height < 2.0 * std::numbers::pi * window.frequency) ++below;
    }
    return below < options.count;
  };
  std::erase_if(locus.unstable, [&](const UnstableWindow& window) { return !is_wanted(window); });
  std::erase_if(locus.crossings, [&](const Crossing& crossing) {
    return std::none_of(locus.unstable.begin(), locus.unstable.end(), [&](const auto& window) {
      return window.branch == crossing.branch &&
             (window.from == crossing.value || window.to == crossing.value);
    });
  });
}

void check(const PencilFamily& family, const std::vector<double>& values,
           const LocusOptions& options) {
  const auto reject = [](const std::string& message) {
    throw std::invalid_argument("locus: " + message);
  };
  if (!family.place) reject("there is no family");
  if (values.empty()) reject("there are no values");
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i]) || (i > 0 && values[i] <= values[i - 1])) {
      reject(fmt::format("the values must ascend, but value {} is {:g}", i + 1, values[i]));
    }
  }
  if (!std::is_sorted(family.kinks.begin(), family.kinks.end())) reject("the kinks must ascend");
  if (options.count < 1) reject(fmt::format("{} eigenvalues are none", options.count));
  if (!(options.frequency > 0.0)) {
    reject(fmt::format("no eigenvalues below {:g} Hz", options.frequency));
  }
  if (!(options.resolution > 0.0)) {
    reject(fmt::format("the resolution must be positive, is {:g}", options.resolution));
  }
}

}  // namespace

PencilFamily undeformed_family(const System& system, double friction, double direction,
                               double origin) {
  PencilFamily family;
  family.place = [&system, friction, direction, origin](double value, Pencil& pencil) {
    if (pencil.num_modes() == 0) pencil = make_modal_pencil(system);
    place_undeformed(pencil, system, value - origin, friction, direction);
  };
  for (const ContactPoint& contact : system.contacts) {
    const MasterSurface& surface = system.surfaces[static_cast<std::size_t>(contact.surface)];
    const auto drive_share = [&](int body) {
      return system.bodies[static_cast<std::size_t>(body)].follows_drive ? 1.0 : 0.0;
    };
    const double share = drive_share(contact.slave_body) - drive_share(surface.body);
    for (int i = 0; share != 0.0 && i + 1 < surface.num_segments(); ++i) {
      const Segment segment = surface.undeformed_segment(i);
      const Eigen::Vector2d along = segment.second - segment.first;
      if (along.x() == 0.0) continue;
      family.kinks.push_back(origin + along.dot(segment.second - contact.slave_position) /
                                          (along.x() * share));
    }
  }
  std::sort(family.kinks.begin(), family.kinks.end());
  return family;
}

Locus trace_locus(const PencilFamily& family, const std::vector<double>& values,
                  const LocusOptions& options) {
  check(family, values, options);
  Locus locus;
  locus.values = values;
  std::unique_ptr<SpectrumSource> source;
  if (options.method == LocusMethod::secular) {
    source = std::make_unique<SecularSource>(family, values.front(), options);
  } else {
    source = std::make_unique<DenseSource>(family, options);
  }
  const Grid grid = make_grid(values, family.kinks);
  Tracker tracker(*source, options, grid, locus);
  tracker.run();
  std::vector<Track> tracks = tracker.take_tracks();
  WindowFinder finder(*source, options, grid, locus);
  for (std::size_t b = 0; b < tracks.size(); ++b) {
    finder.search(tracks[b], static_cast<int>(b));
    locus.branches.push_back(std::move(tracks[b].branch));
  }
  keep_wanted(locus, options);
  std::sort(locus.unstable.begin(), locus.unstable.end(),
            [](const auto& a, const auto& b) { return a.from < b.from; });
  std::sort(locus.crossings.begin(), locus.crossings.end(),
            [](const auto& a, const auto& b) { return a.value < b.value; });
  return locus;
}

}  // namespace stridor
