// Functions common to readers of HDF5 files. Only for the sources of io, whose users need no HDF5.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "io/hdf5/hdf5_handles.hpp"

namespace stridor {

/// Opens the file of `at` to be read.
/// @throws FileError if it cannot be opened, is a folder, is not HDF5, or HDF5 refuses it
Handle open_hdf5_file(const Checker& at);

/// Refuses a number of entries that no file of this size holds, not even a compressed one; to be
/// asked before memory is taken.
/// @throws FileError
void check_plausible(const Checker& at, hid_t file, std::uint64_t length,
                     const std::string& dataset);

/// The text in a dataset or attribute.
/// @param type of the file
/// @param read reads it as a given type of memory, as H5Dread and H5Aread do
/// @throws FileError as check_plausible(), or if HDF5 refuses
std::string read_text(const Checker& at, hid_t file, hid_t type, const std::string& dataset,
                      const std::function<herr_t(hid_t, void*)>& read);

/// The text that a dataset holds.
/// @throws FileError if it is missing or holds anything else, or HDF5 refuses
std::string read_text_dataset(const Checker& at, hid_t file, const std::string& path);

/// Text or numbers, by name.
using AttributeValues = std::map<std::string, std::variant<std::string, double>>;

/// The attributes of an object that are a text or one number; others, such as references of
/// dimension scales, are left out.
/// @throws FileError if HDF5 refuses, like the next
AttributeValues read_attributes(const Checker& at, hid_t file, hid_t object,
                                const std::string& path);

/// Paths of all datasets, in alphabetical order within each group.
std::vector<std::string> dataset_paths(const Checker& at, hid_t file);

/// A dataset of real numbers with its extents.
struct Hdf5Array {
  Handle dataset;
  std::vector<hsize_t> shape;
};

/// @param rank how many extents are expected
/// @throws FileError if it is missing, is not of real numbers or of another rank, or is larger than
///         its file could hold
Hdf5Array open_array(const Checker& at, hid_t file, const std::string& path, std::size_t rank);

/// All of an array, the last extent contiguous.
/// @throws FileError if HDF5 refuses
std::vector<double> read_array(const Checker& at, const Hdf5Array& array, const std::string& path);

}  // namespace stridor
