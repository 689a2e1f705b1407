#include "io/results/spectrogram_file.hpp"

#include <hdf5.h>
#include <hdf5_hl.h>

#include "io/hdf5/hdf5_output.hpp"

namespace stridor {

void write_spectrogram_file(const std::string& path, Overwrite overwrite,
                            const Spectrogram& spectrogram, const std::string& units,
                            const Attributes& attributes) {
  Attributes all{{"kind", std::string("spectrogram")}};
  all.insert(all.end(), attributes.begin(), attributes.end());
  all.emplace_back("noise_bandwidth", spectrogram.noise_bandwidth);
  write_hdf5_file(path, overwrite, all, [&](const Hdf5Writer& writer) {
    const Handle times = writer.write("/times", spectrogram.times, "s");
    const Handle frequencies = writer.write("/frequencies", spectrogram.frequencies, "Hz");
    // A column of the matrix, contiguous in memory, is a row of the dataset.
    const Handle amplitude =
        writer.write("/amplitude", {spectrogram.times.size(), spectrogram.frequencies.size()},
                     spectrogram.amplitude.data(), units);
    writer.make_scale(times, "/times");
    writer.make_scale(frequencies, "/frequencies");
    writer.tie(amplitude, "/amplitude", times, 0);
    writer.tie(amplitude, "/amplitude", frequencies, 1);
    writer.make_default_plot("/amplitude", {"/times", "/frequencies"});
  });
}

}  // namespace stridor
