// Functions common to writers of HDF5 files: attributes, and files that are filled at once. Only
// for the sources of io, whose users need no HDF5.
#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "io/hdf5/hdf5_handles.hpp"
#include "io/hdf5/output_options.hpp"

namespace stridor {

/// The type of a text of fixed length in UTF-8. @throws FileError if HDF5 refuses
Handle text_type(const Checker& at, std::size_t length, const std::string& dataset);

/// Writes an attribute of an object, a text or one number.
/// @param object  that it belongs to
/// @param dataset its path, for messages
/// @throws FileError if HDF5 refuses
void write_attribute(const Checker& at, hid_t object, const std::string& dataset,
                     const std::string& name, const std::variant<std::string, double>& value);

/// Fills a file that is being made.
class Hdf5Writer {
 public:
  /// @param at, file must live longer
  Hdf5Writer(const Checker& at, hid_t file) : at_(at), file_(file) {}

  const Checker& checker() const { return at_; }

  /// @throws FileError if HDF5 refuses, like the next
  void make_group(const std::string& path) const;
  /// Writes a dataset of numbers with its unit as an attribute.
  /// @param shape  extents, the last one contiguous in `values`
  /// @return the dataset
  Handle write(const std::string& path, const std::vector<hsize_t>& shape, const double* values,
               const std::string& units) const;
  Handle write(const std::string& path, const std::vector<double>& values,
               const std::string& units) const;

 private:
  const Checker& at_;
  hid_t file_;
};

/// Makes a file with attributes at its root, lets it be filled, and gives it its name when it is
/// whole.
/// @throws FileError if it exists and must not be overwritten, or the system or HDF5 refuses;
///         nothing is left behind then
void write_hdf5_file(const std::string& path, Overwrite overwrite, const Attributes& attributes,
                     const std::function<void(const Hdf5Writer&)>& fill);

}  // namespace stridor
