#include "io/results/spectrogram_file.hpp"

#include <hdf5.h>
#include <hdf5_hl.h>

#include "io/hdf5/hdf5_output.hpp"

namespace stridor {

void write_spectrogram_file(const std::string& path, Overwrite overwrite,
                            const Spectrogram& spectrogram, const std::string& units,
                            const Attributes& attributes) {
  Attributes all = attributes;
  all.emplace_back("noise_bandwidth", spectrogram.noise_bandwidth);
  write_hdf5_file(path, overwrite, all, [&](const Hdf5Writer& writer) {
    const Checker& at = writer.checker();
    const Handle times = writer.write("/times", spectrogram.times, "s");
    const Handle frequencies = writer.write("/frequencies", spectrogram.frequencies, "Hz");
    // A column of the matrix, contiguous in memory, is a row of the dataset.
    const Handle amplitude =
        writer.write("/amplitude", {spectrogram.times.size(), spectrogram.frequencies.size()},
                     spectrogram.amplitude.data(), units);
    at.check(H5DSset_scale(times.id(), "time"), "/times", "cannot be made a dimension scale");
    at.check(H5DSset_scale(frequencies.id(), "frequency"), "/frequencies",
             "cannot be made a dimension scale");
    at.check(H5DSattach_scale(amplitude.id(), times.id(), 0), "/amplitude",
             "cannot be tied to /times");
    at.check(H5DSattach_scale(amplitude.id(), frequencies.id(), 1), "/amplitude",
             "cannot be tied to /frequencies");
  });
}

}  // namespace stridor
