#include "analysis/vibration_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace stridor {
namespace {

/// The samples of a range and `margin` more at both ends, as far as there are any.
IndexRange widened(IndexRange range, std::size_t margin, std::size_t count) {
  return {range.begin - std::min(margin, range.begin),
          range.end + std::min(margin, count - range.end)};
}

/// Means over i − half … i + half, as far as there are values. Sums of neighbours, not differences
/// of one running sum: a quiet stretch after a burst of 10⁸ times its power must not drown in the
/// rounding of the latter. Blocks of the window's length carry sums from both their ends, so that
/// every window is the end of one block and the start of the next.
std::vector<double> running_mean(std::span<const double> values, std::size_t half) {
  const std::size_t count = values.size();
  const std::size_t width = 2 * half + 1;
  std::vector<double> from_left(count);
  std::vector<double> from_right(count);
  for (std::size_t i = 0; i < count; ++i) {
    from_left[i] = values[i] + (i % width == 0 ? 0.0 : from_left[i - 1]);
  }
  for (std::size_t i = count; i-- > 0;) {
    const bool is_last = i + 1 == count || (i + 1) % width == 0;
    from_right[i] = values[i] + (is_last ? 0.0 : from_right[i + 1]);
  }
  std::vector<double> means(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t begin = i < half ? 0 : i - half;
    const std::size_t last = std::min(i + half, count - 1);
    double sum = 0.0;
    if (begin % width == 0) {
      sum = from_left[last];
    } else if (last / width != begin / width) {
      sum = from_right[begin] + from_left[last];
    } else {
      // Cut off by the right end, inside the last block.
      sum = from_right[begin];
    }
    means[i] = sum / static_cast<double>(last - begin + 1);
  }
  return means;
}

}  // namespace

std::size_t half_width(double interval, double smoothing) {
  return static_cast<std::size_t>(std::llround(0.5 * smoothing / interval));
}

SignalBlocks::SignalBlocks(const SampleSource& samples, double interval, Band band,
                           double smoothing, std::optional<std::size_t> length)
    : samples_(&samples), interval_(interval), margin_(2 * half_width(interval, smoothing) + 1) {
  if (length && *length == 0)
    throw std::invalid_argument("SignalBlocks: a block must hold a sample");
  const auto beside = 3.0 * (band_pass_decay(interval, band) + static_cast<double>(margin_));
  // The largest number that a transform can take stands for all above it.
  constexpr double most = 2147483647.0;
  length_ =
      length.value_or(std::max(usual_length, static_cast<std::size_t>(std::min(beside, most))));
}

IndexRange SignalBlocks::block_of(std::size_t i) const {
  const std::size_t begin = i - i % length_;
  return {begin, begin + std::min(length_, size() - begin)};
}

PassedSignal SignalBlocks::pass(IndexRange part, const std::vector<Band>& bands) {
  if (!spectrum_) {
    spectrum_.emplace(*samples_, part, interval_, bands.front());
  } else {
    spectrum_->move_to(part);
  }
  return spectrum_->pass(bands);
}

VibrationPiece::VibrationPiece(IndexRange core, IndexRange held, std::vector<double> filtered,
                               std::vector<double> envelope)
    : core_(core), held_(held), filtered_(std::move(filtered)), envelope_(std::move(envelope)) {}

VibrationBlocks::VibrationBlocks(SignalBlocks& blocks, std::vector<Band> bands, double smoothing)
    : blocks_(&blocks), bands_(std::move(bands)), smoothing_(smoothing) {}

void VibrationBlocks::load(std::size_t i) {
  const IndexRange core = blocks_->block_of(i);
  // Held is wider by the margin; a mean at its ends needs the samples beyond. The same part for
  // every smoothing, so that its spectrum is taken once.
  const std::size_t count = blocks_->size();
  const IndexRange held = widened(core, 2 * blocks_->margin(), count);
  piece_ = {};  // its memory first
  PassedSignal passed = blocks_->pass(held, bands_);
  std::vector<double> envelope =
      running_mean(passed.squared_amplitude, half_width(interval(), smoothing_));
  for (double& e : envelope) e = std::sqrt(e);
  piece_ = {core, held, std::move(passed.samples), std::move(envelope)};
}

}  // namespace stridor
