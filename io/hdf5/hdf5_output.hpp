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

/// Creation of links: groups as needed, names in UTF-8. @throws FileError if HDF5 refuses
Handle link_creation(const Checker& at);

/// The type of a text of fixed length in UTF-8. @throws FileError if HDF5 refuses
Handle text_type(const Checker& at, std::size_t length, const std::string& dataset);

/// Writes an attribute of an object, a text or one number.
/// @param object  that it belongs to
/// @param dataset its path, for messages
/// @throws FileError if HDF5 refuses
void write_attribute(const Checker& at, hid_t object, const std::string& dataset,
                     const std::string& name, const std::variant<std::string, double>& value);

/// Writes the attributes by which other programs introduce a file, made of those that it has: `title`
/// (kind and scene), `history` (the command), `source` (the program and its version).
/// @throws FileError if HDF5 refuses, like the next
void write_introduction(const Checker& at, hid_t file, const Attributes& attributes);

/// Says what viewers of NeXus draw when a file is opened: a group /plot (NXdata), named by the
/// attribute `default` of the root, with soft links to a dataset and its axes.
/// @param signal path of the dataset
/// @param axes   path of the axis of each of its extents; empty where it has none
void write_default_plot(const Checker& at, hid_t file, const std::string& signal,
                        const std::vector<std::string>& axes);

/// Fills a file that is being made. Every dataset gets its unit ("1": none) and what it is, as
/// long_name_of() says it, as attributes; the groups in its path are made.
class Hdf5Writer {
 public:
  /// @param at, file must live longer
  /// @throws FileError if HDF5 refuses, like the next
  Hdf5Writer(const Checker& at, hid_t file) : at_(at), file_(file), links_(link_creation(at)) {}

  /// Writes a dataset of numbers.
  /// @param shape  extents, the last one contiguous in `values`
  /// @return the dataset
  Handle write(const std::string& path, const std::vector<hsize_t>& shape, const double* values,
               const std::string& units) const;
  Handle write(const std::string& path, const std::vector<double>& values,
               const std::string& units) const;
  /// Writes 1, 2, …, `count` as the scale of what has no coordinate of its own.
  Handle write_numbers(const std::string& path, std::size_t count) const;
  /// Writes texts of one fixed length.
  Handle write_texts(const std::string& path, const std::vector<std::string>& texts) const;
  /// Makes a dataset the scale of an extent of others: their coordinate for readers like xarray.
  void make_scale(const Handle& dataset, const std::string& path) const;
  /// Ties an extent of a dataset to a scale.
  void tie(const Handle& dataset, const std::string& path, const Handle& scale,
           unsigned extent) const;
  /// As write_default_plot().
  void make_default_plot(const std::string& signal, const std::vector<std::string>& axes) const;

 private:
  const Checker& at_;
  hid_t file_;
  Handle links_;
};

/// Makes a file with attributes at its root, lets it be filled, and gives it its name when it is
/// whole.
/// @throws FileError if it exists and must not be overwritten, or the system or HDF5 refuses;
///         nothing is left behind then
void write_hdf5_file(const std::string& path, Overwrite overwrite, const Attributes& attributes,
                     const std::function<void(const Hdf5Writer&)>& fill);

}  // namespace stridor
