// Sounds of a signal followed in time and frequency.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analysis/band_pass.hpp"
#include "analysis/statistics.hpp"
#include "core/fft_plan.hpp"

namespace stridor {

/// Where a sound is at one moment.
struct RidgePoint {
  std::size_t at;    ///< sample of the whole signal
  double frequency;  ///< Hz
  double level;      ///< r.m.s. value
};

/// One sound, as long as it is above the floor: a point every `RidgeFinder::hop()` samples.
using Ridge = std::vector<RidgePoint>;

/// Finds sounds, any number at once, as ridges of a short-time Fourier transform.
///
/// Pieces of W = max(2 T, 8/lower edge), T apart by a half, under the window of Blackman and Harris,
/// whose side lobes lie 92 dB below a line: a sound beside one 60 dB louder has a line of its own
/// where their frequencies differ by more than 4/W. At the ends of the signal a piece is what there
/// is of it. A line is a sound where it is the highest within 3/W to both sides, above the floor, and
/// within 80 dB of the highest of the piece. A sound goes on in the next piece where that has a line
/// within 2/W; the loudest choose first. What is above the floor in no two pieces in a row is noise.
///
/// Memory: a piece, and a point of three numbers for every half T of every sound.
class RidgeFinder {
 public:
  /// @param interval  dt in s
  /// @param band      Hz
  /// @param smoothing T in s
  /// @param floor     r.m.s. value
  /// @param measured  the middles of pieces lie here
  /// @param count     samples of the whole signal
  RidgeFinder(double interval, Band band, double smoothing, double floor, IndexRange measured,
              std::size_t count);

  /// The samples that are needed, which take() is given one after the other.
  IndexRange needed() const;
  /// Samples from one point of a ridge to the next.
  std::size_t hop() const { return hop_; }
  /// Half the length of a piece, in samples.
  std::size_t half_piece() const { return half_; }
  void take(std::span<const double> samples);
  /// All ridges of two points and more, once all samples have been taken, in order of their ends.
  std::vector<Ridge> finish() &&;

 private:
  void transform();
  std::vector<RidgePoint> lines() const;
  void link(std::vector<RidgePoint> lines);

  double interval_;
  Band band_;
  double floor_;
  IndexRange measured_;
  std::size_t count_;
  std::size_t hop_;
  std::size_t half_;
  std::vector<double> window_;
  RealFft fft_;
  std::size_t next_;             ///< middle of the next piece
  std::size_t held_from_;        ///< sample at the start of held_
  std::vector<double> held_;     ///< samples that pieces still need
  double weight_ = 1.0;          ///< of the window as far as there are samples
  std::vector<Ridge> open_;      ///< that reached the last piece
  std::vector<Ridge> finished_;
};

}  // namespace stridor
