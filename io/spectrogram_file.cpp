#include "io/spectrogram_file.hpp"

#include <hdf5.h>
#include <hdf5_hl.h>

#include <vector>

#include "core/errors.hpp"
#include "io/hdf5_output.hpp"

namespace stridor {
namespace {

Handle write_array(const Checker& at, hid_t file, const std::string& path,
                   const std::vector<hsize_t>& shape, const double* values,
                   const std::string& units) {
  const Handle space =
      at.own(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose,
             path, "cannot make the dataset");
  Handle dataset = at.own(H5Dcreate2(file, path.c_str(), H5T_IEEE_F64LE, space.id(), H5P_DEFAULT,
                                     H5P_DEFAULT, H5P_DEFAULT),
                          H5Dclose, path, "cannot make the dataset");
  at.check(H5Dwrite(dataset.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), path,
           "cannot be written");
  write_attribute(at, dataset.id(), path, "units", units);
  return dataset;
}

}  // namespace

void write_spectrogram_file(const std::string& path, Overwrite overwrite,
                            const Spectrogram& spectrogram, const std::string& units,
                            const Attributes& attributes) {
  const QuietErrors quiet;
  check_output(path, overwrite);
  const Checker at(path);
  PartFile part(path);
  const Handle access = file_access(at);
  Handle file = at.own(H5Fcreate(part.path().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()),
                       H5Fclose, "", "cannot be made");
  part.made();
  {
    for (const auto& [name, value] : attributes) write_attribute(at, file.id(), "", name, value);
    write_attribute(at, file.id(), "", "noise_bandwidth", spectrogram.noise_bandwidth);
    const hsize_t num_times = spectrogram.times.size();
    const hsize_t num_lines = spectrogram.frequencies.size();
    const Handle times =
        write_array(at, file.id(), "/times", {num_times}, spectrogram.times.data(), "s");
    const Handle frequencies = write_array(at, file.id(), "/frequencies", {num_lines},
                                           spectrogram.frequencies.data(), "Hz");
    // A column of the matrix, contiguous in memory, is a row of the dataset.
    const Handle amplitude = write_array(at, file.id(), "/amplitude", {num_times, num_lines},
                                         spectrogram.amplitude.data(), units);
    at.check(H5DSset_scale(times.id(), "time"), "/times", "cannot be made a dimension scale");
    at.check(H5DSset_scale(frequencies.id(), "frequency"), "/frequencies",
             "cannot be made a dimension scale");
    at.check(H5DSattach_scale(amplitude.id(), times.id(), 0), "/amplitude",
             "cannot be tied to /times");
    at.check(H5DSattach_scale(amplitude.id(), frequencies.id(), 1), "/amplitude",
             "cannot be tied to /frequencies");
    at.check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), "", "cannot be written");
  }
  at.check(file.close(), "", "cannot be closed");
  part.move_to_final(overwrite);
}

}  // namespace stridor
