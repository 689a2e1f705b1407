#include "analysis/ridges.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "analysis/spectrogram.hpp"
#include "analysis/vibration_blocks.hpp"

namespace stridor {
namespace {

/// Lines of the window's length to either side within which a sound has no other beside it.
constexpr double lines_apart = 3.0;
/// And within which it is in the next piece.
constexpr double lines_on = 2.0;
/// Zeros to so many times the length, so that the parabola through three lines meets the peak.
constexpr std::size_t padding = 2;

std::size_t half_of(double interval, Band band, double smoothing) {
  const double duration = std::max(2.0 * smoothing, 8.0 / band.lower);
  return std::max<std::size_t>(2, half_width(interval, duration));
}

}  // namespace

RidgeFinder::RidgeFinder(double interval, Band band, double smoothing, double floor,
                         IndexRange measured, std::size_t count)
    : interval_(interval),
      band_(band),
      floor_(floor),
      measured_(measured),
      count_(count),
      hop_(std::max<std::size_t>(1, half_width(interval, smoothing))),
      half_(half_of(interval, band, smoothing)),
      window_(make_window(WindowKind::blackman_harris, 2 * half_)),
      fft_(fast_fft_length(padding * 2 * half_)),
      next_(measured.begin),
      held_from_(needed().begin) {}

IndexRange RidgeFinder::needed() const {
  return {measured_.begin - std::min(half_, measured_.begin),
          measured_.end + std::min(half_, count_ - measured_.end)};
}

void RidgeFinder::take(std::span<const double> samples) {
  held_.insert(held_.end(), samples.begin(), samples.end());
  const std::size_t last = needed().end;
  while (next_ < measured_.end &&
         std::min(next_ + half_, last) <= held_from_ + held_.size()) {
    transform();
    link(lines());
    next_ += hop_;
  }
  const std::size_t from = next_ - std::min(half_, next_);
  if (from <= held_from_) return;
  const std::size_t done = std::min(from - held_from_, held_.size());
  held_.erase(held_.begin(), held_.begin() + static_cast<std::ptrdiff_t>(done));
  held_from_ += done;
}

void RidgeFinder::transform() {
  const std::span<double> input = fft_.input();
  std::fill(input.begin(), input.end(), 0.0);
  weight_ = 0.0;
  for (std::size_t i = 0; i < window_.size(); ++i) {
    // Sample next − half + i of the whole signal, where there is one.
    if (next_ + i < half_ + held_from_) continue;
    const std::size_t k = next_ + i - half_ - held_from_;
    if (k >= held_.size()) break;
    input[i] = window_[i] * held_[k];
    weight_ += window_[i];
  }
  fft_.execute();
}

/// The sounds of the piece that was transformed last, loudest first.
std::vector<RidgePoint> RidgeFinder::lines() const {
  std::vector<RidgePoint> found;
  const auto spectrum = fft_.output();
  const double spacing = 1.0 / (static_cast<double>(fft_.length()) * interval_);
  const double of_window = 1.0 / (static_cast<double>(window_.size()) * interval_);
  const auto apart = static_cast<std::size_t>(std::ceil(lines_apart * of_window / spacing));
  const auto lowest = std::max<std::size_t>(1, static_cast<std::size_t>(band_.lower / spacing));
  const auto highest = std::min(spectrum.size() - 2,
                                static_cast<std::size_t>(std::ceil(band_.upper / spacing)));
  std::vector<double> power(spectrum.size());
  for (std::size_t k = 0; k < power.size(); ++k) power[k] = std::norm(spectrum[k]);
  const double loudest = *std::max_element(power.begin(), power.end());
  // A sine of amplitude a has a line of a·weight/2, and an r.m.s. value of a/√2.
  const double level_per_line = std::numbers::sqrt2 / weight_;
  constexpr double quietest = 1e-8;  // −80 dB
  for (std::size_t k = lowest; k <= highest; ++k) {
    const double level = level_per_line * std::sqrt(power[k]);
    if (!(level > floor_) || power[k] < quietest * loudest) continue;
    const std::size_t left = k - std::min(k, apart);
    const std::size_t right = std::min(power.size() - 1, k + apart);
    const auto begin = power.begin() + static_cast<std::ptrdiff_t>(left);
    const auto end = power.begin() + static_cast<std::ptrdiff_t>(right) + 1;
    if (std::max_element(begin, end) - power.begin() != static_cast<std::ptrdiff_t>(k)) continue;
    const double before = std::log(power[k - 1]);
    const double here = std::log(power[k]);
    const double after = std::log(power[k + 1]);
    const double curvature = before - 2.0 * here + after;
    const double offset =
        curvature < 0.0 ? std::clamp(0.5 * (before - after) / curvature, -0.5, 0.5) : 0.0;
    found.push_back({next_, spacing * (static_cast<double>(k) + offset), level});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const RidgePoint& a, const RidgePoint& b) { return a.level > b.level; });
  return found;
}

/// Lets every open ridge go on with the line nearest to it, the loudest first; begins new ones with
/// the lines that are left.
void RidgeFinder::link(std::vector<RidgePoint> lines) {
  const double reach =
      lines_on / (static_cast<double>(window_.size()) * interval_);
  std::vector<bool> is_taken(lines.size(), false);
  std::stable_sort(open_.begin(), open_.end(), [](const Ridge& a, const Ridge& b) {
    return a.back().level > b.back().level;
  });
  std::vector<Ridge> going_on;
  for (Ridge& ridge : open_) {
    std::size_t nearest = lines.size();
    double least = reach;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const double off = std::abs(lines[i].frequency - ridge.back().frequency);
      if (is_taken[i] || off > least) continue;
      nearest = i;
      least = off;
    }
    if (nearest == lines.size()) {
      if (ridge.size() > 1) finished_.push_back(std::move(ridge));
      continue;
    }
    is_taken[nearest] = true;
    ridge.push_back(lines[nearest]);
    going_on.push_back(std::move(ridge));
  }
  for (std::size_t i = 0; i < lines.size(); ++i)
    if (!is_taken[i]) going_on.push_back({lines[i]});
  open_ = std::move(going_on);
}

std::vector<Ridge> RidgeFinder::finish() && {
  for (Ridge& ridge : open_)
    if (ridge.size() > 1) finished_.push_back(std::move(ridge));
  return std::move(finished_);
}

}  // namespace stridor
