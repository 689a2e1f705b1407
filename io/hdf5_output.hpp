// What writers of HDF5 files share: attributes, and a file that appears under its name only when it
// is whole. Only for the sources of io, whose users need no HDF5.
#pragma once

#include <string>
#include <variant>

#include "io/hdf5_handles.hpp"
#include "io/run_file.hpp"

namespace stridor {

/// The type of a text of fixed length in UTF-8. @throws FileError if HDF5 refuses
Handle text_type(const Checker& at, std::size_t length, const std::string& dataset);

/// Writes an attribute of an object, a text or one number.
/// @param object  that it belongs to
/// @param dataset its path, for messages
/// @throws FileError if HDF5 refuses
void write_attribute(const Checker& at, hid_t object, const std::string& dataset,
                     const std::string& name, const std::variant<std::string, double>& value);

/// The temporary name of a file, in the same folder; what has been made under it is removed unless
/// it takes its final name.
class PartFile {
 public:
  explicit PartFile(std::string final_path);
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;
  ~PartFile();

  const std::string& path() const { return path_; }
  /// Says that there is a file of this name now.
  void made() { is_made_ = true; }
  /// Gives the file its final name.
  /// @throws FileError if the system refuses, or another process has made a file of that name
  ///         meanwhile and `overwrite` is no
  void move_to_final(Overwrite overwrite);

 private:
  std::string final_path_;
  std::string path_;
  bool is_made_ = false;
};

}  // namespace stridor
