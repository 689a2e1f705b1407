#include "analysis/branch_tracker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "analysis/continuation.hpp"
#include "core/errors.hpp"
#include "solvers/eigenvalues/search_failure.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

constexpr double infinity = std::numeric_limits<double>::infinity();

void sort_eigenvalues(std::vector<Complex>& values) {
  std::sort(values.begin(), values.end(), [](Complex a, Complex b) {
    return std::pair(a.imag(), a.real()) < std::pair(b.imag(), b.real());
  });
}

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
    last_kink_ = -infinity;
    source_.move_to(value_);
    const auto found = source_.search();
    if (!found) {
      throw SearchFailure(
          Refusal::eigenvalues_incomplete,
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
    track.nearest.push_back(0.0);
    active_.push_back(tracks_.size());
    tracks_.push_back(std::move(track));
  }

  static bool are_tied(Complex a, Complex b) {
    return std::norm(a - b) <= tie * tie * std::max(std::norm(a), std::norm(b));
  }

  /// Distances of every active eigenvalue to other ones, conjugates included.
  void set_spacings(const std::vector<Complex>& set) {
    spacings_.assign(set.size(), {});
    for (std::size_t j = 0; j < set.size(); ++j) {
      Spacing& one = spacings_[j];
      if (is_pair(set[j])) one.spacing = one.nearest = 4.0 * set[j].imag() * set[j].imag();
      for (std::size_t k = 0; k < j; ++k) {
        Spacing& other = spacings_[k];
        const double square = std::norm(set[k] - set[j]);
        one.nearest = std::min(one.nearest, square);
        other.nearest = std::min(other.nearest, square);
        if (are_tied(set[j], set[k])) {
          one.is_tied = other.is_tied = true;
        } else {
          one.spacing = std::min(one.spacing, square);
          other.spacing = std::min(other.spacing, square);
        }
      }
    }
    for (std::size_t j = 0; j < set.size(); ++j) {
      Track& track = tracks_[active_[j]];
      track.spacing.back() = std::sqrt(spacings_[j].spacing);
      track.nearest.back() = std::sqrt(spacings_[j].nearest);
      track.is_tied = spacings_[j].is_tied;
    }
  }

  void advance_to(double target) {
    // Where eigenvalues cross some hundred steps are tried. Where Newton's method leads to other
    // zeros of the secular function all along, the dense method gets by with large steps.
    constexpr int most_tries = 10'000;
    int num_tries = 0;
    double next = target;
    while (value_ < target) {
      if (++num_tries > most_tries && options_.method == LocusMethod::secular) {
        throw SearchFailure(
            Refusal::eigenvalues_incomplete,
            fmt::format("locus: eigenvalues could not be followed from {:g} on", value_));
      }
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
    const double top = 2.0 * std::numbers::pi * options_.window.frequency;
    heights_.clear();
    for (const Complex s : set) {
      if (is_pair(s)) heights_.push_back(s.imag());
    }
    const auto count = static_cast<std::size_t>(options_.window.count.value_or(0));
    if (count == 0 || heights_.size() < count) return top;
    const auto last = heights_.begin() + static_cast<std::ptrdiff_t>(count) - 1;
    std::nth_element(heights_.begin(), last, heights_.end());
    return std::min(top, *last);
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
        if (are_tied(before[j], before[k]) && are_tied(after[j], after[k])) continue;
        if (turns(before[j] - before[k], after[j] - after[k])) return false;
      }
    }
    return true;
  }

  bool try_step(double value) {
    source_.move_to(value);
    before_.clear();
    next_.clear();
    bool has_ties = false;
    for (const std::size_t index : active_) {
      Track& track = tracks_[index];
      const Complex guess = guess_at(track, value);
      before_.push_back(track.last());
      next_.push_back(guess);
      has_ties = has_ties || track.is_tied;
      if (!track.is_tied && !follow(track, next_.back())) return false;
    }
    if (has_ties && !place_tied()) return false;
    if (!is_resolved(before_, next_)) return false;
    const bool is_covered = source_.covers(next_, needed_height(next_));
    if (!is_covered && !add_newcomers(value)) return false;
    accept(value);
    return true;
  }

  /// Whether what was found may be what a track was thought to go on with.
  static bool is_continuation(const Track& track, Complex guess, Complex found) {
    return std::abs(found - guess) <= 0.25 * track.spacing.back() &&
           is_pair(track.last()) == is_pair(found);
  }

  /// Corrects a guess of what a track goes on with; false where that is in doubt.
  bool follow(Track& track, Complex& s) {
    const Complex guess = s;
    const SpectrumSource::Followed followed =
        source_.follow(guess, 0.1 * track.spacing.back(), track.hint);
    s = followed.s;
    return followed.is_converged && is_continuation(track, guess, s);
  }

  /// Corrects the guesses in next_ of what is tied: from any of them Newton's method would find the
  /// same one, so they are taken from all there are.
  bool place_tied() {
    const auto found = source_.search();
    if (!found) return false;
    std::vector<Complex> rest = *found;
    const auto take_nearest = [&](Complex s) -> std::optional<Complex> {
      const auto nearest = std::min_element(rest.begin(), rest.end(), [&](Complex a, Complex b) {
        return std::norm(a - s) < std::norm(b - s);
      });
      if (nearest == rest.end()) return std::nullopt;
      const Complex taken = *nearest;
      rest.erase(nearest);
      return taken;
    };
    for (std::size_t j = 0; j < active_.size(); ++j) {
      if (!tracks_[active_[j]].is_tied && source_.is_searched(next_[j])) take_nearest(next_[j]);
    }
    for (std::size_t j = 0; j < active_.size(); ++j) {
      Track& track = tracks_[active_[j]];
      if (!track.is_tied) continue;
      if (!source_.is_searched(next_[j])) {
        if (!follow(track, next_[j])) return false;
        continue;
      }
      const auto taken = take_nearest(next_[j]);
      if (!taken || !is_continuation(track, next_[j], *taken)) return false;
      next_[j] = *taken;
    }
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
    for (const Complex s : next_) {
      const auto same =
          std::find_if(rest.begin(), rest.end(), [&](Complex other) { return are_tied(other, s); });
      if (same != rest.end()) {
        rest.erase(same);
      } else if (source_.is_searched(s)) {
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
      track.nearest.push_back(0.0);
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
    constexpr int most_jumps = 10'000;
    if (++num_jumps_ > most_jumps) {
      throw SearchFailure(
          Refusal::eigenvalues_incomplete,
          fmt::format("locus: eigenvalues that nearly coincide cannot be told apart along {:g} to "
                      "{:g}; several "
                      "equal bodies? Ask for single values, or vary what makes the bodies differ",
                      grid_.values.front(), grid_.values.back()));
    }
    FormerSpectrum former;
    former.value = value_;
    for (const std::size_t index : active_) {
      former.s.push_back(tracks_[index].last());
      former.spacing.push_back(tracks_[index].spacing.back());
    }
    source_.move_to(value);
    std::vector<Complex> after;
    const auto found = source_.search();
    if (found) {
      after = *found;
    } else {
      locus_.unverified.push_back(value);
    }
    // Eigenvalues beyond the search are followed as before.
    for (const std::size_t index : active_) {
      Track& track = tracks_[index];
      if (found && source_.is_searched(track.last())) continue;
      const auto followed = source_.follow(track.last(), 0.1 * track.spacing.back(), track.hint);
      const bool is_known = std::any_of(after.begin(), after.end(), [&](Complex s) {
        return std::abs(s - followed.s) <= 1e-8 * std::abs(s);
      });
      if (followed.is_converged && !is_known && followed.s.imag() >= 0.0) {
        after.push_back(followed.s);
      }
    }

    const std::vector<int> partner = continuations(source_, former, after, value);
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

  /// Keeps the eigenvalues wanted at the present value.
  void record() {
    std::vector<Complex> wanted;
    for (const std::size_t index : active_) wanted.push_back(tracks_[index].last());
    sort_eigenvalues(wanted);
    int num_pairs = 0;
    std::size_t size = 0;
    for (; size < wanted.size(); ++size) {
      if (is_pair(wanted[size])) ++num_pairs;
      if (options_.window.ends_before(wanted[size].imag(), num_pairs)) break;
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
  int num_jumps_ = 0;
  std::vector<Track> tracks_;
  std::vector<std::size_t> active_;  ///< tracks that are followed
  std::vector<Complex> before_, next_, newcomers_;
  /// Squares of Track::spacing and Track::nearest.
  struct Spacing {
    double spacing = infinity;
    double nearest = infinity;
    bool is_tied = false;
  };
  std::vector<double> heights_;    ///< scratch
  std::vector<Spacing> spacings_;  ///< scratch
};

}  // namespace

std::vector<Track> follow_branches(SpectrumSource& source, const LocusOptions& options,
                                   const Grid& grid, Locus& locus) {
  Tracker tracker(source, options, grid, locus);
  tracker.run();
  return tracker.take_tracks();
}

}  // namespace stridor
