// Any content of an HDF5 file for all readers: run files, loci and contact laws. The file itself is
// well-formed, since a damaged one is for the library to refuse (io/hdf5/damage_guard.hpp); the bytes
// say which objects it has, of which types, extents and values.
#include <hdf5.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "io/hdf5/hdf5_handles.hpp"
#include "io/imports/law_table_file.hpp"
#include "io/results/locus_file.hpp"
#include "io/results/result_file.hpp"
#include "io/run_file/run_file.hpp"

namespace {

using namespace stridor;

constexpr std::array paths{"/time",
                           "/scene/text",
                           "/scene/resolved",
                           "/channels/a.b",
                           "/contact/c/force",
                           "/modal/oblique/frequency",
                           "/bursts/start",
                           "/checkpoint/a",
                           "/checkpoint/b",
                           "/results",
                           "/unstable/from",
                           "/unstable/to",
                           "/unstable/frequency",
                           "/unstable/growth_max",
                           "/unstable/growth_integral",
                           "/speed",
                           "/indentation",
                           "/force",
                           "/area",
                           "/friction"};
constexpr std::array attribute_names{"format", "version",    "commit", "command",
                                     "date",   "scene_hash", "units",  "DIMENSION_LIST"};

/// The bytes, taken from the front; zeros when they are used up.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  bool are_left() const { return size_ > 0; }
  std::uint8_t byte() {
    if (size_ == 0) return 0;
    --size_;
    return *data_++;
  }
  template <class T>
  T number() {
    T value{};
    const std::size_t count = std::min(sizeof value, size_);
    if (count > 0) std::memcpy(&value, data_, count);
    data_ += count;
    size_ -= count;
    return value;
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

hid_t make_type(Bytes& bytes) {
  switch (bytes.byte() % 10) {
    case 0:
      return H5Tcopy(H5T_IEEE_F32BE);
    case 1:
      return H5Tcopy(H5T_STD_I8LE);
    case 2:
      return H5Tcopy(H5T_STD_U64BE);
    case 3: {
      const hid_t text = H5Tcopy(H5T_C_S1);
      H5Tset_size(text, 1 + bytes.byte());
      return text;
    }
    case 4: {
      const hid_t text = H5Tcopy(H5T_C_S1);
      H5Tset_size(text, H5T_VARIABLE);
      return text;
    }
    case 5: {
      // Text of a size that nobody should take memory for; without data, the file stays small.
      const hid_t text = H5Tcopy(H5T_C_S1);
      H5Tset_size(text, std::size_t{1} << (20 + bytes.byte() % 12));
      return text;
    }
    case 6: {
      const hid_t pair = H5Tcreate(H5T_COMPOUND, 16);
      H5Tinsert(pair, "r", 0, H5T_IEEE_F64LE);
      H5Tinsert(pair, "i", 8, H5T_IEEE_F64LE);
      return pair;
    }
    default:
      return H5Tcopy(H5T_IEEE_F64LE);
  }
}

/// Up to three extents; in some cases ones that only a damaged file has.
std::vector<hsize_t> make_shape(Bytes& bytes) {
  std::vector<hsize_t> shape(bytes.byte() % 4);
  for (hsize_t& extent : shape) {
    extent = bytes.byte() % 8;
    if (extent == 7) extent = bytes.number<std::uint32_t>();
  }
  return shape;
}

void make_dataset(hid_t file, const char* path, Bytes& bytes) {
  const hid_t type = make_type(bytes);
  const std::vector<hsize_t> shape = make_shape(bytes);
  const hid_t space = shape.empty()
                          ? H5Screate(H5S_SCALAR)
                          : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
  const hid_t links = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(links, 1);
  // Chunks that are never written take no room in the file.
  const hid_t layout = H5Pcreate(H5P_DATASET_CREATE);
  if (!shape.empty()) {
    const std::vector<hsize_t> chunk(shape.size(), 4);
    H5Pset_chunk(layout, static_cast<int>(shape.size()), chunk.data());
  }
  const hid_t dataset = H5Dcreate2(file, path, type, space, links, layout, H5P_DEFAULT);
  if (dataset >= 0) {
    const hssize_t count = H5Sget_simple_extent_npoints(space);
    const H5T_class_t kind = H5Tget_class(type);
    if (count > 0 && count < 600 && (kind == H5T_FLOAT || kind == H5T_INTEGER)) {
      std::vector<double> values(static_cast<std::size_t>(count));
      const bool ascends = bytes.byte() % 2 == 0;
      for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = ascends ? 1.0 + static_cast<double>(i) : bytes.number<double>();
      H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    }
    H5Dclose(dataset);
  }
  H5Pclose(layout);
  H5Pclose(links);
  H5Sclose(space);
  H5Tclose(type);
}

void make_attribute(hid_t file, const char* path, const char* name, Bytes& bytes) {
  const hid_t object = H5Oopen(file, path, H5P_DEFAULT);
  if (object < 0) return;
  const hid_t type = make_type(bytes);
  const std::vector<hsize_t> shape = make_shape(bytes);
  const hid_t space = shape.empty() || shape.front() > 100
                          ? H5Screate(H5S_SCALAR)
                          : H5Screate_simple(1, shape.data(), nullptr);
  const hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  if (attribute >= 0) {
    if (H5Tget_class(type) == H5T_FLOAT && H5Sget_simple_extent_npoints(space) == 1) {
      const double value = bytes.byte() % 2 == 0 ? 1.0 : bytes.number<double>();
      H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value);
    }
    H5Aclose(attribute);
  }
  H5Sclose(space);
  H5Tclose(type);
  H5Oclose(object);
}

/// A file that is a run file as far as its header goes, so that the rest is read as well.
void make_header(hid_t file) {
  const auto add_text = [&](const char* name) {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, 2);
    const hid_t space = H5Screate(H5S_SCALAR);
    const hid_t attribute = H5Acreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, type, "x");
    H5Aclose(attribute);
    H5Sclose(space);
    H5Tclose(type);
  };
  for (const char* name : {"version", "commit", "command", "date", "scene_hash"}) add_text(name);
  const hid_t space = H5Screate(H5S_SCALAR);
  const hid_t attribute =
      H5Acreate2(file, "format", H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT);
  const double format = run_file_format;
  H5Awrite(attribute, H5T_NATIVE_DOUBLE, &format);
  H5Aclose(attribute);
  const hid_t links = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(links, 1);
  const hid_t type = H5Tcopy(H5T_C_S1);
  for (const char* path : {"/scene/text", "/scene/resolved"}) {
    const hid_t dataset = H5Dcreate2(file, path, type, space, links, H5P_DEFAULT, H5P_DEFAULT);
    H5Dclose(dataset);
  }
  H5Tclose(type);
  H5Pclose(links);
  H5Sclose(space);
}

void make_file(const std::string& path, Bytes bytes) {
  const QuietErrors quiet;
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  if (bytes.byte() % 4 != 0) make_header(file);
  for (int k = 0; bytes.are_left() && k < 40; ++k) {
    const char* name = paths[bytes.byte() % paths.size()];
    if (bytes.byte() % 4 == 0) {
      const char* owner = bytes.byte() % 2 == 0 ? "/" : name;
      make_attribute(file, owner, attribute_names[bytes.byte() % attribute_names.size()], bytes);
    } else {
      make_dataset(file, name, bytes);
    }
  }
  H5Fclose(file);
}

template <class Read>
void attempt(Read&& read) {
  try {
    read();
  } catch (const FileError& error) {
    if (std::string(error.what()).empty()) std::abort();
  }
}

void read_result_file(const std::string& path) {
  const ResultFile file(path);
  (void)file.kind();
  for (const ResultArray& array : file.arrays()) {
    attempt([&] { (void)file.read(array.path, array.shape.size()); });
    attempt([&] { (void)file.texts(array.path); });
    (void)file.names_in(array.path.substr(0, array.path.rfind('/')));
  }
  attempt([&] { (void)file.texts("/scene/text"); });
}

void read_run_file(const std::string& path) {
  const RunFileReader reader(path);
  attempt([&] { (void)reader.series_names(); });
  attempt([&] { (void)reader.static_names(); });
  attempt([&] { (void)reader.checkpoint(); });
  attempt([&] { (void)reader.results(); });
  for (const char* name : paths) {
    attempt([&] {
      if (reader.series(name).size() != reader.times().size()) std::abort();
    });
    attempt([&] { (void)reader.static_array(name); });
    attempt([&] { (void)reader.units(name); });
    attempt([&] { (void)reader.attributes(name); });
  }
}

void read_law(const std::string& path) {
  const TabulatedLaw law = read_law_table(path);
  for (const double y : {1e-6, 1e-2, 1.0, 3.5})
    for (const double v : {0.0, 1e-3, 1.5, 1e3}) (void)law.at(y, v);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string path = "/dev/shm/stridor-fuzz-" + std::to_string(getpid()) + ".h5";
  make_file(path, {data, size});
  attempt([] { read_run_file(path); });
  attempt([] { (void)read_locus_windows(path); });
  attempt([] { read_result_file(path); });
  attempt([] { read_law(path); });
  unlink(path.c_str());
  return 0;
}
