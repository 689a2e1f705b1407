// The amplitudes of a spectrogram on the cells of a picture.
#pragma once

#include <Eigen/Core>

#include "analysis/spectrogram.hpp"
#include "io/figures/axes.hpp"

namespace stridor {

/// Amplitudes on the raster of a picture. The cells are equal and fill the rectangle.
struct AmplitudeRaster {
  Eigen::MatrixXd amplitude;   ///< row per frequency, from low to high; column per time
  double from = 0.0;           ///< s, left edge
  double to = 0.0;             ///< s, right edge
  double max_frequency = 0.0;  ///< Hz, upper edge; the lower one is 0
};

/// Brings a spectrogram onto the raster of a picture, coarser or finer, by taking maxima.
///
/// A column of the spectrogram represents the time up to half-way to its neighbours, the first and
/// the last one for all of their piece; a line for the frequencies up to half-way to its
/// neighbours. A cell of the raster is the largest amplitude of all that it touches, so that a
/// burst of a single column, or a single line, does not vanish from the picture.
///
/// @param spectrogram   at least one column
/// @param max_frequency upper edge of the raster, Hz, positive; at most the last line is used up to
///                      half a line above itself
/// @param rows, columns of the raster, positive
/// @throws std::invalid_argument if one of these is out of range
AmplitudeRaster rasterise(const Spectrogram& spectrogram, double max_frequency, Eigen::Index rows,
                          Eigen::Index columns);

/// From the beginning of the first piece to the end of the last one, s.
/// @throws std::invalid_argument for a spectrogram without a column or with a single line
ValueRange times_of(const Spectrogram& spectrogram);

}  // namespace stridor
