// What a run recorded, as functions of a universal file (dataset 58).
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "analysis/spectrogram.hpp"
#include "app/results/pictures.hpp"
#include "app/results/universal_file.hpp"

namespace stridor {

/// What is said of a file that was written.
struct WrittenFunctions {
  std::size_t count = 0;
  std::string remark;  ///< empty, or why points have no places
};

/// Writes series of a stretch as time responses (function 1), real, one after the other: what it
/// takes in memory is one of them.
/// @param series paths in the run file
/// @throws FileError if one has a value that is not finite, or the file cannot be written
/// @throws ConfigError at --data as write_uff_function()
WrittenFunctions write_history_functions(const std::string& file, const RecordedStretch& run,
                                         const std::vector<std::string>& series,
                                         const UniversalOptions& options);

/// How spectra were made, and what of them is written.
struct WrittenSpectra {
  SpectrogramParameters parameters;
  double max_frequency;  ///< Hz
};

/// Writes spectra of series, peak amplitudes over frequency, as functions 12, real.
/// @param spectra with the paths of their series
/// @throws as write_history_functions()
WrittenFunctions write_spectrum_functions(
    const std::string& file, const RecordedStretch& run,
    const std::vector<std::pair<std::string, Spectrum>>& spectra, const WrittenSpectra& how,
    const UniversalOptions& options);

}  // namespace stridor
