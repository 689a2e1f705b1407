#include <fmt/format.h>
#include <hdf5.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <functional>
#include <stdexcept>
#include <utility>

#include "core/errors.hpp"
#include "io/hdf5/hdf5_input.hpp"
#include "io/run_file/run_file.hpp"

namespace stridor {

namespace {

/// The kind of a file that holds results of another verb, and what reads it; else what it lacks.
std::string instead_of_run(const AttributeValues& values) {
  const auto found = values.find("kind");
  const auto* kind = found == values.end() ? nullptr : std::get_if<std::string>(&found->second);
  if (kind == nullptr) return " (no attribute 'format')";
  return fmt::format(", but of the kind '{}', which `stridor report` draws and HDF5 viewers read",
                     *kind);
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

  void read_header();
  Hdf5Array rows_of(const std::string& path) const;
  std::vector<double> read_all(const std::string& path) const;
  void read_part(const std::string& path, std::uint64_t begin, std::span<double> target) const;
  std::vector<std::string> arrays(bool series) const;

  Checker at;
  Handle file;
  RunFileHeader header;
  std::uint64_t num_rows = 0;
  std::optional<std::vector<double>> times{};  ///< once they were asked for
};

void RunFileReader::Impl::read_header() {
  const AttributeValues values = read_attributes(at, file.id(), file.id(), "/");
  const auto format = values.find("format");
  const double* number = format == values.end() ? nullptr : std::get_if<double>(&format->second);
  if (number == nullptr)
    throw FileError(Refusal::other_kind_of_file, at.path(), "",
                    "is not a run file of stridor" + instead_of_run(values));
  if (*number > run_file_format) {
    throw FileError(
        Refusal::other_kind_of_file, at.path(), "",
        fmt::format("has format {:g}, this program reads formats up to {}; use a newer one",
                    *number, run_file_format));
  }
  if (*number != run_file_format)
    throw FileError(Refusal::other_kind_of_file, at.path(), "",
                    fmt::format("has the unknown format {:g}", *number));
  for (const auto& [name, target] :
       {std::pair{"version", &header.version}, std::pair{"commit", &header.commit},
        std::pair{"command", &header.command}, std::pair{"scene_hash", &header.scene_hash},
        std::pair{"date", &header.date}}) {
    const auto found = values.find(name);
    const std::string* value =
        found == values.end() ? nullptr : std::get_if<std::string>(&found->second);
    if (value == nullptr) {
      throw FileError(Refusal::other_kind_of_file, at.path(), "",
                      fmt::format("is not a run file of stridor (no attribute '{}')", name));
    }
    *target = *value;
  }
  header.scene_text = read_text_dataset(at, file.id(), "/scene/text");
  header.scene_resolved = read_text_dataset(at, file.id(), "/scene/resolved");
  // Files of earlier versions have none.
  if (H5LTpath_valid(file.id(), "/scene/digests", true) > 0)
    header.scene_digests = read_text_dataset(at, file.id(), "/scene/digests");
  num_rows = open_array(at, file.id(), "/time", 1).shape.front();
}

/// A series, which has a value for every row.
Hdf5Array RunFileReader::Impl::rows_of(const std::string& path) const {
  Hdf5Array array = open_array(at, file.id(), path, 1);
  const hsize_t length = array.shape.front();
  if (length < num_rows) {
    throw FileError(Refusal::file_damaged, at.path(), path,
                    fmt::format("has {} rows, but /time has {}", length, num_rows));
  }
  return array;
}

std::vector<double> RunFileReader::Impl::read_all(const std::string& path) const {
  return read_array(at, open_array(at, file.id(), path, 1), path);
}

void RunFileReader::Impl::read_part(const std::string& path, std::uint64_t begin,
                                    std::span<double> target) const {
  const Hdf5Array array = rows_of(path);
  const hsize_t offset = begin;
  const hsize_t count = target.size();
  if (count == 0) return;
  const Handle source = at.own(H5Dget_space(array.dataset.id()), H5Sclose, path, "cannot be read");
  at.check(H5Sselect_hyperslab(source.id(), H5S_SELECT_SET, &offset, nullptr, &count, nullptr),
           path, "cannot be read");
  const Handle memory =
      at.own(H5Screate_simple(1, &count, nullptr), H5Sclose, path, "cannot be read");
  at.check(H5Dread(array.dataset.id(), H5T_NATIVE_DOUBLE, memory.id(), source.id(), H5P_DEFAULT,
                   target.data()),
           path, "cannot be read");
}

std::vector<std::string> RunFileReader::Impl::arrays(bool series) const {
  std::vector<std::string> found;
  for (const std::string& path : dataset_paths(at, file.id())) {
    const Handle dataset =
        at.own(H5Dopen2(file.id(), path.c_str(), H5P_DEFAULT), H5Dclose, path, "cannot be opened");
    const Handle space = at.own(H5Dget_space(dataset.id()), H5Sclose, path, "cannot be read");
    if (path == "/time" || path.starts_with("/checkpoint/") ||
        H5Sget_simple_extent_ndims(space.id()) != 1)
      continue;
    // Series, and nothing else but checkpoints, were made to grow.
    hsize_t most = 0;
    at.check(H5Sget_simple_extent_dims(space.id(), nullptr, &most), path, "cannot be read");
    if ((most == H5S_UNLIMITED) == series) found.push_back(path);
  }
  std::sort(found.begin(), found.end());
  return found;
}

RunFileReader::RunFileReader(const std::string& path) : impl_(std::make_unique<Impl>(path)) {
  const QuietErrors quiet;
  impl_->file = open_hdf5_file(impl_->at);
  impl_->read_header();
}

RunFileReader::~RunFileReader() = default;
RunFileReader::RunFileReader(RunFileReader&&) noexcept = default;
RunFileReader& RunFileReader::operator=(RunFileReader&&) noexcept = default;

const RunFileHeader& RunFileReader::header() const {
  return impl_->header;
}
const std::vector<double>& RunFileReader::times() const {
  if (!impl_->times) {
    std::vector<double> values(num_rows());
    read("/time", 0, values);
    impl_->times = std::move(values);
  }
  return *impl_->times;
}

std::size_t RunFileReader::num_rows() const {
  return impl_->num_rows;
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
  impl_->rows_of(path);  // before memory is taken
  std::vector<double> values(num_rows());
  impl_->read_part(path, 0, values);
  return values;
}

void RunFileReader::read(const std::string& path, std::size_t begin,
                         std::span<double> target) const {
  if (begin > num_rows() || target.size() > num_rows() - begin)
    throw std::invalid_argument("RunFileReader: there are no such rows");
  const QuietErrors quiet;
  impl_->read_part(path, begin, target);
}

std::vector<double> RunFileReader::static_array(const std::string& path) const {
  const QuietErrors quiet;
  return impl_->read_all(path);
}

std::string RunFileReader::units(const std::string& path) const {
  const auto all = attributes(path);
  const auto found = all.find("units");
  const std::string* text = found == all.end() ? nullptr : std::get_if<std::string>(&found->second);
  if (text == nullptr)
    throw FileError(Refusal::file_damaged, impl_->at.path(), path, "has no attribute 'units'");
  return *text;
}

std::map<std::string, std::variant<std::string, double>> RunFileReader::attributes(
    const std::string& path) const {
  if (!has(path)) throw FileError(Refusal::file_damaged, impl_->at.path(), path, "is missing");
  const QuietErrors quiet;
  const Handle object = impl_->at.own(H5Oopen(impl_->file.id(), path.c_str(), H5P_DEFAULT),
                                      H5Oclose, path, "cannot be opened");
  return read_attributes(impl_->at, impl_->file.id(), object.id(), path);
}

std::optional<Checkpoint> RunFileReader::checkpoint() const {
  std::optional<Checkpoint> latest;
  for (const char* path : checkpoint_paths) {
    if (!has(path)) continue;
    const QuietErrors quiet;
    const std::vector<double> stored = impl_->read_all(path);
    const bool holds_bytes =
        std::all_of(stored.begin(), stored.end(), [](double b) { return b >= 0.0 && b <= 255.0; });
    if (!holds_bytes) continue;
    const std::vector<unsigned char> bytes(stored.begin(), stored.end());
    std::optional<Checkpoint> found = decode(bytes);
    if (found && found->rows <= impl_->num_rows && (!latest || found->number > latest->number))
      latest = std::move(found);
  }
  return latest;
}

std::map<std::string, std::variant<std::string, double>> RunFileReader::results() const {
  if (!has("/results")) return {};
  return attributes("/results");
}

}  // namespace stridor
