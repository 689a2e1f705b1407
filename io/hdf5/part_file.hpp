// Files that appear under their name only when they are whole and on the disk.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "core/stop_token.hpp"
#include "io/hdf5/output_options.hpp"

namespace stridor {

/// The temporary name `<name>.part-<pid>` of a file, in the same folder. What has been made under
/// it is removed unless it takes its final name.
///
/// The file is on the disk before it takes its name, and the folder is synchronised after that: a
/// crash of the machine leaves the former file or the new one, whole.
class PartFile {
 public:
  /// Removes what processes that died have left of files of the same name, see remove_leftovers().
  explicit PartFile(std::string final_path);
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;
  ~PartFile();

  const std::string& path() const { return path_; }
  /// Says that there is a file of this name now.
  void made() { is_made_ = true; }
  /// Gives the file its final name.
  /// @throws FileError if the system refuses, another process has made a file of that name
  ///         meanwhile and `overwrite` is no, or is writing the one that would be replaced
  void move_to_final(Overwrite overwrite);
  /// Gives the file its final name, in place of one that this process may replace.
  /// @throws FileError if the system refuses
  void replace();

 private:
  void sync() const;
  void sync_name();

  std::string final_path_;
  std::string path_;
  UnfinishedFile unfinished_{path_};
  bool is_made_ = false;
};

/// The folder in which a file of this name stands: "." where the name has none.
std::string folder_of(const std::string& path);

/// Removes `<name>.part-<pid>` of processes that were killed. Kept are files of a process that
/// lives, or that another one holds locked, of other users, and whatever does not begin as a file
/// of this program does: somebody else's piece of a file may be called like that.
/// @param final_path of the file that was being made
void remove_leftovers(const std::string& final_path);

/// Takes pieces of a text, one behind the other.
using TextSink = std::function<void(std::string_view)>;

/// Writes a text into a file that appears when it is whole; one of that name is replaced.
/// @param fill gives the text piece by piece; where it throws, nothing is left behind
/// @throws FileError if the system refuses
void write_text_file(const std::string& path, const std::function<void(const TextSink&)>& fill);
void write_text_file(const std::string& path, const std::string& text);

}  // namespace stridor
