#include "io/results/result_file.hpp"

#include <hdf5.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <set>

#include "core/errors.hpp"
#include "io/hdf5/hdf5_input.hpp"

namespace stridor {
namespace {

constexpr const char* text_units = "text";

/// An array; its shape is empty where it is a single text or number.
ResultArray described(const Checker& at, hid_t file, const std::string& path) {
  ResultArray array{path, {}, ""};
  const Handle dataset =
      at.own(H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose, path, "cannot be opened");
  const Handle type = at.own(H5Dget_type(dataset.id()), H5Tclose, path, "cannot be read");
  const H5T_class_t kind = H5Tget_class(type.id());
  const Handle space = at.own(H5Dget_space(dataset.id()), H5Sclose, path, "cannot be read");
  const int rank = H5Sget_simple_extent_ndims(space.id());
  if (rank > 0) {
    std::vector<hsize_t> extents(static_cast<std::size_t>(rank));
    at.check(H5Sget_simple_extent_dims(space.id(), extents.data(), nullptr), path,
             "cannot be read");
    array.shape.assign(extents.begin(), extents.end());
  }
  if (kind != H5T_FLOAT && kind != H5T_INTEGER) {
    array.units = text_units;
    return array;
  }
  const AttributeValues values = read_attributes(at, file, dataset.id(), path);
  if (const auto units = values.find("units"); units != values.end()) {
    if (const auto* text = std::get_if<std::string>(&units->second)) array.units = *text;
  }
  return array;
}

}  // namespace

struct ResultFile::Impl {
  explicit Impl(const std::string& path) : at(path) {}
  ~Impl() {
    const QuietErrors quiet;
    file.close();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  Checker at;
  Handle file;
  Values attributes;
  std::vector<ResultArray> arrays;
  std::vector<ResultArray> others;
};

ResultFile::ResultFile(const std::string& path) : impl_(std::make_unique<Impl>(path)) {
  const QuietErrors quiet;
  impl_->file = open_hdf5_file(impl_->at);
  const hid_t file = impl_->file.id();
  impl_->attributes = read_attributes(impl_->at, file, file, "/");
  for (const std::string& dataset : dataset_paths(impl_->at, file)) {
    ResultArray array = described(impl_->at, file, dataset);
    const bool is_array_of_numbers = !array.shape.empty() && array.units != text_units;
    (is_array_of_numbers ? impl_->arrays : impl_->others).push_back(std::move(array));
  }
  std::sort(impl_->arrays.begin(), impl_->arrays.end(),
            [](const ResultArray& a, const ResultArray& b) { return a.path < b.path; });
}

ResultFile::~ResultFile() = default;
ResultFile::ResultFile(ResultFile&&) noexcept = default;
ResultFile& ResultFile::operator=(ResultFile&&) noexcept = default;

const std::string& ResultFile::path() const {
  return impl_->at.path();
}

const ResultFile::Values& ResultFile::attributes() const {
  return impl_->attributes;
}

std::string ResultFile::text(const std::string& name) const {
  const auto found = impl_->attributes.find(name);
  const auto* text =
      found == impl_->attributes.end() ? nullptr : std::get_if<std::string>(&found->second);
  return text == nullptr ? "" : *text;
}

std::optional<double> ResultFile::told(const std::string& name) const {
  const auto found = impl_->attributes.find(name);
  if (found == impl_->attributes.end()) return std::nullopt;
  const auto* value = std::get_if<double>(&found->second);
  return value != nullptr ? std::optional(*value) : std::nullopt;
}

std::string ResultFile::kind() const {
  const std::string kind = text("kind");
  if (!kind.empty()) return kind;
  // Run files and spectrograms of earlier versions have no kind.
  if (impl_->attributes.contains("format") && has("/time")) return "run";
  return has("/times") && has("/frequencies") && has("/amplitude") ? "spectrogram" : "";
}

const std::vector<ResultArray>& ResultFile::arrays() const {
  return impl_->arrays;
}

const std::vector<ResultArray>& ResultFile::texts_and_numbers() const {
  return impl_->others;
}

bool ResultFile::has(const std::string& path) const {
  return std::any_of(impl_->arrays.begin(), impl_->arrays.end(),
                     [&](const ResultArray& array) { return array.path == path; });
}

const ResultArray& ResultFile::array(const std::string& path) const {
  for (const ResultArray& array : impl_->arrays)
    if (array.path == path) return array;
  throw FileError(Refusal::file_damaged, impl_->at.path(), path, "is missing");
}

std::vector<double> ResultFile::read(const std::string& path, std::size_t rank) const {
  const QuietErrors quiet;
  return read_array(impl_->at, open_array(impl_->at, impl_->file.id(), path, rank), path);
}

std::optional<double> ResultFile::number(const std::string& path) const {
  const QuietErrors quiet;
  if (H5LTpath_valid(impl_->file.id(), path.c_str(), true) <= 0) return std::nullopt;
  return read(path, 0).front();
}

std::vector<std::string> ResultFile::texts(const std::string& path) const {
  const QuietErrors quiet;
  const Checker& at = impl_->at;
  const hid_t file = impl_->file.id();
  if (H5Lexists(file, path.c_str(), H5P_DEFAULT) <= 0) return {};
  const Handle dataset =
      at.own(H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose, path, "cannot be opened");
  const Handle type = at.own(H5Dget_type(dataset.id()), H5Tclose, path, "cannot be read");
  const Handle space = at.own(H5Dget_space(dataset.id()), H5Sclose, path, "cannot be read");
  if (H5Tget_class(type.id()) != H5T_STRING || H5Tis_variable_str(type.id()) > 0 ||
      H5Sget_simple_extent_ndims(space.id()) != 1)
    throw FileError(Refusal::file_damaged, at.path(), path, "does not hold texts of one length");
  const std::size_t length = H5Tget_size(type.id());
  const auto count = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space.id()));
  check_plausible(at, file, static_cast<std::uint64_t>(length) * count, path);
  std::string stored(length * count, '\0');
  if (count > 0) {
    at.check(H5Dread(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, stored.data()), path,
             "cannot be read");
  }
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string text = stored.substr(i * length, length);
    texts.push_back(text.substr(0, text.find('\0')));
  }
  return texts;
}

std::vector<std::string> ResultFile::names_in(const std::string& group) const {
  std::set<std::string> names;
  const std::string start = group + "/";
  for (const ResultArray& array : impl_->arrays) {
    if (!array.path.starts_with(start)) continue;
    const std::string rest = array.path.substr(start.size());
    names.insert(rest.substr(0, rest.find('/')));
  }
  return {names.begin(), names.end()};
}

}  // namespace stridor
