// A signal of any length in some bands, with its envelope, a block at a time.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "analysis/band_pass.hpp"
#include "analysis/sample_source.hpp"
#include "analysis/statistics.hpp"

namespace stridor {

/// Blocks into which a signal is divided to be filtered.
///
/// Memory: about 70 bytes a sample of a block with its surroundings, whatever the length of the
/// signal. A signal of one block is filtered as a whole.
class SignalBlocks {
 public:
  /// Samples to a block where the response of a filter does not last longer.
  static constexpr std::size_t usual_length = std::size_t{1} << 20;

  /// @param samples   finite, not empty; must live as long
  /// @param interval  dt in s
  /// @param band      the first that will be asked for
  /// @param smoothing T in s, the longest of the envelopes
  /// @param length    of a block, positive; longer where a block would be shorter than what must be
  ///                  filtered beside it, unless it is given
  /// @throws std::invalid_argument as band_pass()
  SignalBlocks(const SampleSource& samples, double interval, Band band, double smoothing,
               std::optional<std::size_t> length = std::nullopt);

  std::size_t size() const { return samples_->size(); }
  double interval() const { return interval_; }
  /// Samples beyond a block that its pieces hold, at least.
  std::size_t margin() const { return margin_; }
  /// The block that holds a sample.
  IndexRange block_of(std::size_t i) const;
  /// A part, which may be longer than a block, in some bands.
  PassedSignal pass(IndexRange part, const std::vector<Band>& bands);

 private:
  const SampleSource* samples_;
  double interval_;
  std::size_t length_;
  std::size_t margin_;
  std::optional<BandSpectrum> spectrum_;
};

/// Half the width of the running mean of an envelope, in samples.
std::size_t half_width(double interval, double smoothing);

/// The samples of a block in some bands, with those around it.
class VibrationPiece {
 public:
  VibrationPiece() = default;
  VibrationPiece(IndexRange core, IndexRange held, std::vector<double> filtered,
                 std::vector<double> envelope);

  /// The samples of the block.
  IndexRange core() const { return core_; }
  bool has(std::size_t i) const { return i - core_.begin < core_.size(); }
  /// Band-passed value of a sample of the whole signal; of the block or within its margin.
  double filtered(std::size_t i) const { return filtered_[i - held_.begin]; }
  /// Likewise its envelope.
  double envelope(std::size_t i) const { return envelope_[i - held_.begin]; }
  /// Values of a part of the block.
  std::span<const double> filtered(IndexRange part) const { return of(filtered_, part); }
  std::span<const double> envelope(IndexRange part) const { return of(envelope_, part); }

 private:
  std::span<const double> of(std::span<const double> values, IndexRange part) const {
    return values.subspan(part.begin - held_.begin, part.size());
  }

  IndexRange core_;
  IndexRange held_;
  std::vector<double> filtered_;
  std::vector<double> envelope_;
};

/// A signal in some bands with its envelope,
///
///     e(t)² = mean over [t − T/2, t + T/2] of |x + i H x|²/2   (burst_envelope()).
///
/// The piece that was asked for last is kept: walks along the signal filter every block once.
class VibrationBlocks {
 public:
  /// @param blocks    must live as long
  /// @param bands     one after the other
  /// @param smoothing T in s, at most that of the blocks
  VibrationBlocks(SignalBlocks& blocks, std::vector<Band> bands, double smoothing);

  std::size_t size() const { return blocks_->size(); }
  double interval() const { return blocks_->interval(); }
  /// The piece of the block that holds a sample, until the next call.
  const VibrationPiece& at(std::size_t i) {
    if (!piece_.has(i)) load(i);
    return piece_;
  }
  /// Calls `visit(piece, part)` with the pieces of a range in turn, and the part of it in each.
  template <class Visit>
  void for_each(IndexRange range, Visit&& visit) {
    for (std::size_t i = range.begin; i < range.end;) {
      const VibrationPiece& piece = at(i);
      const IndexRange part{i, std::min(range.end, piece.core().end)};
      visit(piece, part);
      i = part.end;
    }
  }

 private:
  void load(std::size_t i);

  SignalBlocks* blocks_;
  std::vector<Band> bands_;
  double smoothing_;
  VibrationPiece piece_;
};

}  // namespace stridor
