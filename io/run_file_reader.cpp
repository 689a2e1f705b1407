#include <fmt/format.h>
#include <hdf5.h>
#include <hdf5_hl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <functional>

#include "core/errors.hpp"
#include "io/hdf5_handles.hpp"
#include "io/run_file.hpp"

namespace stridor {
namespace {

std::string read_text(const Checker& at, hid_t type, const std::string& dataset,
                      const std::function<herr_t(hid_t, void*)>& read) {
  if (H5Tis_variable_str(type) > 0) {
    char* text = nullptr;
    const Handle memory = at.own(H5Tcopy(type), H5Tclose, dataset, "cannot be read");
    at.check(read(memory.id(), &text), dataset, "cannot be read");
    const std::string result = text != nullptr ? text : "";
    H5free_memory(text);
    return result;
  }
  std::string text(H5Tget_size(type), '\0');
  at.check(read(type, text.data()), dataset, "cannot be read");
  return text.substr(0, text.find('\0'));
}

using Values = std::map<std::string, std::variant<std::string, double>>;

// Text or one number; anything else (references of dimension scales, arrays) is not given.
void read_attribute(const Checker& at, hid_t object, const std::string& path,
                    const std::string& name, Values& values) {
  const Handle attribute = at.own(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, path,
                                  "cannot read an attribute");
  const Handle type =
      at.own(H5Aget_type(attribute.id()), H5Tclose, path, "cannot read an attribute");
  const Handle space =
      at.own(H5Aget_space(attribute.id()), H5Sclose, path, "cannot read an attribute");
  if (H5Sget_simple_extent_npoints(space.id()) != 1) return;
  const H5T_class_t kind = H5Tget_class(type.id());
  if (kind == H5T_STRING) {
    values[name] = read_text(at, type.id(), path, [&](hid_t memory, void* target) {
      return H5Aread(attribute.id(), memory, target);
    });
  } else if (kind == H5T_FLOAT || kind == H5T_INTEGER) {
    double number = 0.0;
    at.check(H5Aread(attribute.id(), H5T_NATIVE_DOUBLE, &number), path, "cannot read an attribute");
    values[name] = number;
  }
}

herr_t keep_name(hid_t, const char* name, const H5A_info_t*, void* names) {
  static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

Values read_attributes(const Checker& at, hid_t object, const std::string& path) {
  std::vector<std::string> names;
  at.check(H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, keep_name, &names), path,
           "cannot read its attributes");
  Values values;
  for (const std::string& name : names) read_attribute(at, object, path, name, values);
  return values;
}

herr_t keep_dataset(hid_t, const char* name, const H5O_info_t* info, void* paths) {
  if (info->type == H5O_TYPE_DATASET)
    static_cast<std::vector<std::string>*>(paths)->push_back(std::string("/") + name);
  return 0;
}

}  // namespace

struct RunFileReader::Impl {
  explicit Impl(const std::string& path) : at(path) {}
  ~Impl() {
    const QuietErrors quiet;
    file.close();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void open_file();
  void read_header();
  std::string text(const std::string& path) const;
  void check_plausible(std::uint64_t length, const std::string& path) const;
  Handle open_array(const std::string& path, hsize_t& length) const;
  std::vector<double> read_array(const std::string& path, const std::uint64_t* wanted) const;
  std::vector<std::string> arrays(bool series) const;

  Checker at;
  Handle file;
  RunFileHeader header;
  std::vector<double> times;
};

void RunFileReader::Impl::open_file() {
  const std::string& path = at.path();
  struct stat status = {};
  if (stat(path.c_str(), &status) != 0 || ::access(path.c_str(), R_OK) != 0) {
    throw FileError(path, "", "cannot be opened: " + errno_text(errno));
  }
  if (S_ISDIR(status.st_mode)) throw FileError(path, "", "is a folder");
  const htri_t is_hdf5 = H5Fis_hdf5(path.c_str());
  if (is_hdf5 == 0) throw FileError(path, "", "is not an HDF5 file");
  const Handle access = file_access(at);
  file = at.own(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose, "",
                "is damaged or truncated");
}

void RunFileReader::Impl::read_header() {
  const Values values = read_attributes(at, file.id(), "/");
  const auto format = values.find("format");
  const double* number = format == values.end() ? nullptr : std::get_if<double>(&format->second);
  if (number == nullptr)
    throw FileError(at.path(), "", "is not a run file of stridor (no attribute 'format')");
  if (*number > run_file_format) {
    throw FileError(
        at.path(), "",
        fmt::format("has format {:g}, this program reads formats up to {}; use a newer one",
                    *number, run_file_format));
  }
  if (*number != run_file_format)
    throw FileError(at.path(), "", fmt::format("has the unknown format {:g}", *number));
  for (const auto& [name, target] :
       {std::pair{"version", &header.version}, std::pair{"commit", &header.commit},
        std::pair{"command", &header.command}, std::pair{"scene_hash", &header.scene_hash},
        std::pair{"date", &header.date}}) {
    const auto found = values.find(name);
    const std::string* value =
        found == values.end() ? nullptr : std::get_if<std::string>(&found->second);
    if (value == nullptr) {
      throw FileError(at.path(), "",
                      fmt::format("is not a run file of stridor (no attribute '{}')", name));
    }
    *target = *value;
  }
  header.scene_text = text("/scene/text");
  header.scene_resolved = text("/scene/resolved");
  times = read_array("/time", nullptr);
}

std::string RunFileReader::Impl::text(const std::string& path) const {
  if (H5LTpath_valid(file.id(), path.c_str(), true) <= 0)
    throw FileError(at.path(), path, "is missing");
  const Handle dataset =
      at.own(H5Dopen2(file.id(), path.c_str(), H5P_DEFAULT), H5Dclose, path, "cannot be opened");
  const Handle type = at.own(H5Dget_type(dataset.id()), H5Tclose, path, "cannot be read");
  const Handle space = at.own(H5Dget_space(dataset.id()), H5Sclose, path, "cannot be read");
  if (H5Tget_class(type.id()) != H5T_STRING || H5Sget_simple_extent_npoints(space.id()) != 1) {
    throw FileError(at.path(), path, "is not text");
  }
  return read_text(at, type.id(), path, [&](hid_t memory, void* target) {
    return H5Dread(dataset.id(), memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, target);
  });
}

// Before memory is taken. No file holds more numbers than this, not even a compressed one.
void RunFileReader::Impl::check_plausible(std::uint64_t length, const std::string& path) const {
  constexpr std::uint64_t most_per_byte = 1100;
  hsize_t size = 0;
  at.check(H5Fget_filesize(file.id(), &size), path, "cannot be read");
  if (length / most_per_byte > size) {
    throw FileError(at.path(), path,
                    fmt::format("is damaged: {} entries in a file of {} bytes", length, size));
  }
}

Handle RunFileReader::Impl::open_array(const std::string& path, hsize_t& length) const {
  if (!is_object_path(path) || H5LTpath_valid(file.id(), path.c_str(), true) <= 0) {
    throw FileError(at.path(), path, "is missing");
  }
  Handle dataset =
      at.own(H5Dopen2(file.id(), path.c_str(), H5P_DEFAULT), H5Dclose, path, "is not a dataset");
  const Handle type = at.own(H5Dget_type(dataset.id()), H5Tclose, path, "cannot be read");
  const H5T_class_t kind = H5Tget_class(type.id());
  if (kind != H5T_FLOAT && kind != H5T_INTEGER)
    throw FileError(at.path(), path, "does not hold real numbers");
  const Handle space = at.own(H5Dget_space(dataset.id()), H5Sclose, path, "cannot be read");
  if (const int rank = H5Sget_simple_extent_ndims(space.id()); rank != 1) {
    throw FileError(at.path(), path, fmt::format("has {} dimensions, expected 1", rank));
  }
  at.check(H5Sget_simple_extent_dims(space.id(), &length, nullptr), path, "cannot be read");
  check_plausible(length, path);
  return dataset;
}

std::vector<double> RunFileReader::Impl::read_array(const std::string& path,
                                                    const std::uint64_t* wanted) const {
  hsize_t length = 0;
  const Handle dataset = open_array(path, length);
  if (wanted != nullptr && length < *wanted) {
    throw FileError(at.path(), path, fmt::format("has {} rows, but /time has {}", length, *wanted));
  }
  const hsize_t count = wanted != nullptr ? *wanted : length;
  const hsize_t offset = 0;
  std::vector<double> values(count);
  if (count == 0) return values;
  const Handle source = at.own(H5Dget_space(dataset.id()), H5Sclose, path, "cannot be read");
  at.check(H5Sselect_hyperslab(source.id(), H5S_SELECT_SET, &offset, nullptr, &count, nullptr),
           path, "cannot be read");
  const Handle target =
      at.own(H5Screate_simple(1, &count, nullptr), H5Sclose, path, "cannot be read");
  at.check(H5Dread(dataset.id(), H5T_NATIVE_DOUBLE, target.id(), source.id(), H5P_DEFAULT,
                   values.data()),
           path, "cannot be read");
  return values;
}

std::vector<std::string> RunFileReader::Impl::arrays(bool series) const {
  std::vector<std::string> datasets;
  at.check(
      H5Ovisit2(file.id(), H5_INDEX_NAME, H5_ITER_INC, keep_dataset, &datasets, H5O_INFO_BASIC), "",
      "cannot be searched");
  std::vector<std::string> found;
  for (const std::string& path : datasets) {
    const Handle dataset =
        at.own(H5Dopen2(file.id(), path.c_str(), H5P_DEFAULT), H5Dclose, path, "cannot be opened");
    const Handle space = at.own(H5Dget_space(dataset.id()), H5Sclose, path, "cannot be read");
    if (path == "/time" || path.starts_with("/checkpoint/") ||
        H5Sget_simple_extent_ndims(space.id()) != 1)
      continue;
    if ((H5Aexists(dataset.id(), "DIMENSION_LIST") > 0) == series) found.push_back(path);
  }
  std::sort(found.begin(), found.end());
  return found;
}

RunFileReader::RunFileReader(const std::string& path) : impl_(std::make_unique<Impl>(path)) {
  const QuietErrors quiet;
  impl_->open_file();
  impl_->read_header();
}

RunFileReader::~RunFileReader() = default;
RunFileReader::RunFileReader(RunFileReader&&) noexcept = default;
RunFileReader& RunFileReader::operator=(RunFileReader&&) noexcept = default;

const RunFileHeader& RunFileReader::header() const {
  return impl_->header;
}
const std::vector<double>& RunFileReader::times() const {
  return impl_->times;
}

std::vector<std::string> RunFileReader::series_names() const {
  const QuietErrors quiet;
  return impl_->arrays(true);
}

std::vector<std::string> RunFileReader::static_names() const {
  const QuietErrors quiet;
  return impl_->arrays(false);
}

bool RunFileReader::has(const std::string& path) const {
  const QuietErrors quiet;
  return is_object_path(path) && H5LTpath_valid(impl_->file.id(), path.c_str(), true) > 0;
}

std::vector<double> RunFileReader::series(const std::string& path) const {
  const QuietErrors quiet;
  const std::uint64_t count = impl_->times.size();
  return impl_->read_array(path, &count);
}

std::vector<double> RunFileReader::static_array(const std::string& path) const {
  const QuietErrors quiet;
  return impl_->read_array(path, nullptr);
}

std::string RunFileReader::units(const std::string& path) const {
  const auto all = attributes(path);
  const auto found = all.find("units");
  const std::string* text = found == all.end() ? nullptr : std::get_if<std::string>(&found->second);
  if (text == nullptr) throw FileError(impl_->at.path(), path, "has no attribute 'units'");
  return *text;
}

std::map<std::string, std::variant<std::string, double>> RunFileReader::attributes(
    const std::string& path) const {
  if (!has(path)) throw FileError(impl_->at.path(), path, "is missing");
  const QuietErrors quiet;
  const Handle object = impl_->at.own(H5Oopen(impl_->file.id(), path.c_str(), H5P_DEFAULT),
                                      H5Oclose, path, "cannot be opened");
  return read_attributes(impl_->at, object.id(), path);
}

std::optional<Checkpoint> RunFileReader::checkpoint() const {
  std::optional<Checkpoint> latest;
  for (const char* path : checkpoint_paths) {
    if (!has(path)) continue;
    const QuietErrors quiet;
    const std::vector<double> stored = impl_->read_array(path, nullptr);
    const std::vector<unsigned char> bytes(stored.begin(), stored.end());
    std::optional<Checkpoint> found = decode(bytes);
    if (found && found->rows <= impl_->times.size() && (!latest || found->number > latest->number))
      latest = std::move(found);
  }
  return latest;
}

std::map<std::string, std::variant<std::string, double>> RunFileReader::results() const {
  if (!has("/results")) return {};
  return attributes("/results");
}

}  // namespace stridor
