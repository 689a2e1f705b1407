// Unstable windows of a locus beside the bursts of a run.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/results/pictures.hpp"
#include "app/terminal/command.hpp"
#include "io/figures/spectrogram_plot.hpp"
#include "io/results/locus_file.hpp"
#include "io/scene/scene_mechanics.hpp"

namespace stridor {

/// A window that the run passes, and the burst that it belongs to.
struct PredictedBurst {
  TimedWindow window;
  std::optional<NumberedBurst> burst;
};

/// The unstable windows of a locus, to be set beside the bursts of a run; a warning where the locus
/// is not of the scene of the run (has_same_mechanics()), or looked less high than bursts are
/// sought.
/// @param file as given with --predict
/// @param highest_burst upper end of the band in which bursts are sought, Hz
/// @throws ConfigError where the locus is over something that a run does not pass through,
///         FileError where the file cannot be read or is no locus
std::vector<TimedWindow> read_predictions(const std::string& file, const SceneInFile& of_run,
                                          double highest_burst);

/// Gives every window the burst of like frequency that overlaps it most in time, and every burst to
/// no more than the one window that it overlaps most.
///
/// Windows without times are omitted. A burst lags behind its window, since it starts where it
/// rises out of the quiet and ends long after: it counts if it is present in the window, or
/// starts at most 0.05 s after it, within 2 % of the frequency (at the steepest rise) of the
/// window.
std::vector<PredictedBurst> match_bursts(const std::vector<TimedWindow>& windows,
                                         const std::vector<NumberedBurst>& bursts);

/// For every burst the index of the window among the predictions that explains it, if one does.
std::vector<std::optional<std::size_t>> windows_of(const std::vector<PredictedBurst>& predictions,
                                                   const std::vector<NumberedBurst>& bursts);
/// "bursts 1 to 3, 7 belong to no window".
std::string unexplained_text(const std::vector<std::size_t>& numbers);
/// Numbers, ascending, of the bursts to which no window belongs, and which are no harmonics of
/// others.
std::vector<std::size_t> unexplained(const std::vector<PredictedBurst>& predictions,
                                     const std::vector<NumberedBurst>& bursts);

std::vector<SpectrogramMark> predicted_marks(const std::vector<PredictedBurst>& predictions);

Json prediction_json(const std::vector<PredictedBurst>& predictions);
void print_prediction(const std::vector<PredictedBurst>& predictions);

}  // namespace stridor
