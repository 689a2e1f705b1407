#include "io/figures/amplitude_raster.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "analysis/statistics.hpp"

namespace stridor {
namespace {

[[noreturn]] void refuse_raster(const std::string& what) {
  throw std::invalid_argument("spectrogram plot: " + what);
}

// The sources that each cell of an axis touches. Source k reaches from edges[k] to edges[k+1].
std::vector<IndexRange> touched(const std::vector<double>& edges, double from, double to,
                                Eigen::Index cells) {
  const std::size_t count = edges.size() - 1;
  const double width = (to - from) / static_cast<double>(cells);
  const double rounding = 1e-9 * width;  // an edge upon an edge touches nothing
  std::vector<IndexRange> ranges;
  std::size_t begin = 0;
  for (Eigen::Index cell = 0; cell < cells; ++cell) {
    const double lower = from + width * static_cast<double>(cell) + rounding;
    const double upper = from + width * static_cast<double>(cell + 1) - rounding;
    while (begin + 1 < count && edges[begin + 1] <= lower) ++begin;
    std::size_t end = begin + 1;
    while (end < count && edges[end] < upper) ++end;
    ranges.push_back({begin, end});
  }
  return ranges;
}

// Half-way between neighbours; the outermost edges are given.
std::vector<double> edges_between(const std::vector<double>& centres, double first, double last) {
  std::vector<double> edges{first};
  for (std::size_t i = 1; i < centres.size(); ++i)
    edges.push_back(0.5 * (centres[i - 1] + centres[i]));
  edges.push_back(last);
  return edges;
}

}  // namespace

ValueRange times_of(const Spectrogram& spectrogram) {
  if (spectrogram.times.empty() || spectrogram.frequencies.size() < 2)
    refuse_raster("a spectrogram without a column or with a single line");
  const double half_piece = 0.5 / spectrogram.frequencies[1];
  return {spectrogram.times.front() - half_piece, spectrogram.times.back() + half_piece};
}

AmplitudeRaster rasterise(const Spectrogram& spectrogram, double max_frequency, Eigen::Index rows,
                          Eigen::Index columns) {
  if (spectrogram.times.empty() || spectrogram.frequencies.size() < 2)
    refuse_raster("a spectrogram without a column or with a single line");
  if (rows < 1 || columns < 1) refuse_raster("a raster without cells");
  if (!(max_frequency > 0.0 && std::isfinite(max_frequency)))
    refuse_raster("the highest frequency must be positive");
  const double spacing = spectrogram.frequencies[1];
  const ValueRange times = times_of(spectrogram);
  const double highest = spectrogram.frequencies.back() + 0.5 * spacing;

  AmplitudeRaster raster;
  raster.from = times.lower;
  raster.to = times.upper;
  raster.max_frequency = std::min(max_frequency, highest);
  const std::vector<IndexRange> lines =
      touched(edges_between(spectrogram.frequencies, -0.5 * spacing, highest), 0.0,
              raster.max_frequency, rows);
  const std::vector<IndexRange> pieces = touched(
      edges_between(spectrogram.times, raster.from, raster.to), raster.from, raster.to, columns);

  raster.amplitude.resize(rows, columns);
  for (Eigen::Index column = 0; column < columns; ++column) {
    const IndexRange& piece = pieces[static_cast<std::size_t>(column)];
    const Eigen::VectorXd largest = spectrogram.amplitude
                                        .middleCols(static_cast<Eigen::Index>(piece.begin),
                                                    static_cast<Eigen::Index>(piece.size()))
                                        .rowwise()
                                        .maxCoeff();
    for (Eigen::Index row = 0; row < rows; ++row) {
      const IndexRange& line = lines[static_cast<std::size_t>(row)];
      raster.amplitude(row, column) = largest
                                          .segment(static_cast<Eigen::Index>(line.begin),
                                                   static_cast<Eigen::Index>(line.size()))
                                          .maxCoeff();
    }
  }
  return raster;
}

}  // namespace stridor
