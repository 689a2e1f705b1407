// Pictures of frequency responses: diagrams of Bode and Nyquist.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "io/figures/panel_plot.hpp"
#include "io/results/response_file.hpp"

namespace stridor {

/// Responses at more frequencies, where they turn so far from one to the next that a line between
/// the two would be a chord of their curve. Where a resonance is narrower than a millionth of the
/// distance of two frequencies it stays as it is.
/// @param frequencies Hz, ascending
/// @param curves      at these
/// @param at          responses at other frequencies, in the order of `curves`
/// @return all frequencies, ascending, and the responses there
std::pair<std::vector<double>, std::vector<ResponseCurve>> resolved_curves(
    std::vector<double> frequencies, std::vector<ResponseCurve> curves,
    const std::function<std::vector<ResponseCurve>(const std::vector<double>&)>& at);

/// Magnitude, phase and locus in the complex plane, a row of diagrams for each unit. Lines end
/// where they would be chords: of the phase where it jumps by a turn, of the locus between distant
/// points.
class ResponsePicture {
 public:
  /// @param is_log whether frequencies stand at equal ratios
  explicit ResponsePicture(bool is_log) : is_log_(is_log) {}

  /// @param frequencies Hz, as many as values of the curve
  void add(const std::vector<double>& frequencies, const ResponseCurve& curve,
           const std::string& label, Mark mark, int colour);
  /// The size of a difference to a response, dashed beside its magnitude.
  /// @param curve with its truncation_error at these frequencies
  void add_error(const std::vector<double>& frequencies, const ResponseCurve& curve, int colour);
  /// A diagram of the MAC of measured and computed shapes over the frequency, with a point at each
  /// measured peak for the computed one that belongs to it.
  void add_shapes(const ComparedShapes& shapes) { shapes_.push_back(shapes); }
  /// @throws as plot_panels()
  void draw(const std::string& caption, const std::filesystem::path& figure) const;

 private:
  struct Added {
    std::vector<double> frequencies;
    ResponseCurve curve;
    std::string label;
    Mark mark = Mark::line;
    int colour = 0;
  };
  DiagramPanel panel_of(const ComparedShapes& shapes) const;
  std::vector<DiagramPanel> panels_of(const std::vector<const Added*>& row) const;

  bool is_log_ = false;
  std::vector<Added> added_;
  std::vector<Added> errors_;
  std::vector<ComparedShapes> shapes_;
};

}  // namespace stridor
