// Spectrograms as HDF5 files, for programs that go on with the numbers.
//
//     /             attributes: what the spectrogram was made of and how
//     /times        s, centres of the pieces
//     /frequencies  Hz
//     /amplitude    peak amplitude of a sine, [time][frequency]; the two above are its scales
#pragma once

#include <string>

#include "analysis/spectrogram.hpp"
#include "io/hdf5/output_options.hpp"

namespace stridor {

/// Writes a spectrogram to a file of its own.
///
/// The file is made under a temporary name and takes its own when it is whole; a failure leaves
/// what was there before.
///
/// @param path       final name; an existing file is replaced only with Overwrite::yes
/// @param units      of the amplitudes
/// @param attributes of the root, next to `noise_bandwidth` (Hz)
/// @throws FileError if the file exists ("exists; use --force to overwrite it"), its folder is not
///         writable, or anything cannot be written
void write_spectrogram_file(const std::string& path, Overwrite overwrite,
                            const Spectrogram& spectrogram, const std::string& units,
                            const Attributes& attributes);

}  // namespace stridor
