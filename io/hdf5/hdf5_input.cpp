#include "io/hdf5/hdf5_input.hpp"

#include <fmt/format.h>
#include <hdf5_hl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "core/errors.hpp"
#include "io/hdf5/regular_file.hpp"

namespace stridor {
namespace {

// Text or one number; anything else (references of dimension scales, arrays) is not given.
void read_attribute(const Checker& at, hid_t file, hid_t object, const std::string& path,
                    const std::string& name, AttributeValues& values) {
  const Handle attribute = at.own(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, path,
                                  "cannot read an attribute");
  const Handle type =
      at.own(H5Aget_type(attribute.id()), H5Tclose, path, "cannot read an attribute");
  const Handle space =
      at.own(H5Aget_space(attribute.id()), H5Sclose, path, "cannot read an attribute");
  if (H5Sget_simple_extent_npoints(space.id()) != 1) return;
  const H5T_class_t kind = H5Tget_class(type.id());
  if (kind == H5T_STRING) {
    values[name] = read_text(at, file, type.id(), path, [&](hid_t memory, void* target) {
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

herr_t keep_dataset(hid_t, const char* name, const H5O_info_t* info, void* paths) {
  if (info->type == H5O_TYPE_DATASET)
    static_cast<std::vector<std::string>*>(paths)->push_back(std::string("/") + name);
  return 0;
}

}  // namespace

Handle open_hdf5_file(const Checker& at) {
  const std::string& path = at.path();
  struct stat status = {};
  if (stat(path.c_str(), &status) != 0 || ::access(path.c_str(), R_OK) != 0) {
    throw FileError(Refusal::cannot_read, path, "", "cannot be opened: " + errno_text(errno));
  }
  const std::string irregular = irregular_kind(path);
  if (!irregular.empty())
    throw FileError(Refusal::other_kind_of_file, path, "", "is " + irregular + ", not an HDF5 file");
  const htri_t is_hdf5 = H5Fis_hdf5(path.c_str());
  if (is_hdf5 == 0) throw FileError(Refusal::other_kind_of_file, path, "", "is not an HDF5 file");
  const Handle access = file_access(at);
  return at.own(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose, "",
                "is damaged or truncated");
}

void check_plausible(const Checker& at, hid_t file, std::uint64_t length,
                     const std::string& dataset) {
  constexpr std::uint64_t most_per_byte = 1100;
  hsize_t size = 0;
  at.check(H5Fget_filesize(file, &size), dataset, "cannot be read");
  if (length / most_per_byte > size) {
    throw FileError(Refusal::file_damaged, at.path(), dataset,
                    fmt::format("is damaged: {} entries in a file of {} bytes", length, size));
  }
}

std::string read_text(const Checker& at, hid_t file, hid_t type, const std::string& dataset,
                      const std::function<herr_t(hid_t, void*)>& read) {
  if (H5Tis_variable_str(type) > 0) {
    char* text = nullptr;
    const Handle memory = at.own(H5Tcopy(type), H5Tclose, dataset, "cannot be read");
    at.check(read(memory.id(), &text), dataset, "cannot be read");
    std::string result = text != nullptr ? text : "";
    H5free_memory(text);
    return result;
  }
  check_plausible(at, file, H5Tget_size(type), dataset);
  std::string text(H5Tget_size(type), '\0');
  at.check(read(type, text.data()), dataset, "cannot be read");
  return text.substr(0, text.find('\0'));
}

std::string read_text_dataset(const Checker& at, hid_t file, const std::string& path) {
  if (!is_object_path(path) || H5LTpath_valid(file, path.c_str(), true) <= 0)
    throw FileError(Refusal::file_damaged, at.path(), path, "is missing");
  const Handle dataset =
      at.own(H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose, path, "cannot be opened");
  const Handle type = at.own(H5Dget_type(dataset.id()), H5Tclose, path, "cannot be read");
  const Handle space = at.own(H5Dget_space(dataset.id()), H5Sclose, path, "cannot be read");
  if (H5Tget_class(type.id()) != H5T_STRING || H5Sget_simple_extent_npoints(space.id()) != 1)
    throw FileError(Refusal::file_damaged, at.path(), path, "is not text");
  return read_text(at, file, type.id(), path, [&](hid_t memory, void* target) {
    return H5Dread(dataset.id(), memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, target);
  });
}

AttributeValues read_attributes(const Checker& at, hid_t file, hid_t object,
                                const std::string& path) {
  std::vector<std::string> names;
  at.check(H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, keep_name, &names), path,
           "cannot read its attributes");
  AttributeValues values;
  for (const std::string& name : names) read_attribute(at, file, object, path, name, values);
  return values;
}

std::vector<std::string> dataset_paths(const Checker& at, hid_t file) {
  std::vector<std::string> paths;
  at.check(H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, keep_dataset, &paths, H5O_INFO_BASIC), "",
           "cannot be searched");
  return paths;
}

Hdf5Array open_array(const Checker& at, hid_t file, const std::string& path, std::size_t rank) {
  if (!is_object_path(path) || H5LTpath_valid(file, path.c_str(), true) <= 0)
    throw FileError(Refusal::file_damaged, at.path(), path, "is missing");
  Hdf5Array array;
  array.dataset =
      at.own(H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose, path, "is not a dataset");
  const Handle type = at.own(H5Dget_type(array.dataset.id()), H5Tclose, path, "cannot be read");
  const H5T_class_t kind = H5Tget_class(type.id());
  if (kind != H5T_FLOAT && kind != H5T_INTEGER)
    throw FileError(Refusal::file_damaged, at.path(), path, "does not hold real numbers");
  const Handle space = at.own(H5Dget_space(array.dataset.id()), H5Sclose, path, "cannot be read");
  const int found = H5Sget_simple_extent_ndims(space.id());
  if (found < 0 || static_cast<std::size_t>(found) != rank)
    throw FileError(Refusal::file_damaged, at.path(), path,
                    fmt::format("has {} dimensions, expected {}", found, rank));
  array.shape.resize(rank);
  at.check(H5Sget_simple_extent_dims(space.id(), array.shape.data(), nullptr), path,
           "cannot be read");
  check_plausible(at, file, static_cast<std::uint64_t>(H5Sget_simple_extent_npoints(space.id())),
                  path);
  return array;
}

std::vector<double> read_array(const Checker& at, const Hdf5Array& array, const std::string& path) {
  std::size_t size = 1;
  for (const hsize_t extent : array.shape) size *= extent;
  std::vector<double> values(size);
  if (size == 0) return values;
  at.check(
      H5Dread(array.dataset.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
      path, "cannot be read");
  return values;
}

}  // namespace stridor
