// A file whose changes reach the disk together and in an order that never leaves it unreadable.
// Only for the sources of io/run_file/run_file.hpp, whose users need no HDF5.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "io/hdf5/hdf5_handles.hpp"

namespace stridor {

/// Holds the writes of HDF5 in memory until they are committed (a virtual file driver of HDF5).
///
/// HDF5 flushes its metadata in the order of addresses. A process killed half-way leaves, for
/// example, a node of the chunk index that points beyond the end that the superblock states, and
/// the file cannot be opened. Here every change waits for `commit`, which writes
///
///   1. the end of the file, first of the file itself, then in the superblock;
///   2. raw data, and blocks that the file did not have before: nothing refers to them yet;
///   3. references to those: heaps, index nodes from the root down, object headers.
///
/// The file then is readable after every single write. It takes for granted that rows are only
/// appended: raw data in front of len(/time) do not change, and no block is freed and used anew.
/// Changes of another kind (new datasets, results) go by `commit_by_copy`. What removes links has no
/// safe order at all: HDF5 moves those that stay from one piece of an object header to another.
class StagedFile {
 public:
  /// What a commit by a copy does where there is no room for one.
  enum class WithoutRoom { change_in_place, fail };

  /// Called after every write to the disk, for tests.
  using Observer = std::function<void()>;

  StagedFile() = default;
  StagedFile(const StagedFile&) = delete;
  StagedFile& operator=(const StagedFile&) = delete;
  ~StagedFile();

  /// Makes an empty file. @throws FileError if the system refuses
  void create(const std::string& path);
  /// Opens a file to change it. @throws FileError if the system refuses, or if another process has
  /// it open to change it
  void open(const std::string& path);
  /// Access property list for H5Fcreate or H5Fopen on this file, which must live longer than the
  /// objects that they open. @throws FileError if HDF5 refuses
  Handle access(const Checker& at);

  /// To be called after H5Fopen.
  void opened() { opened_end_ = allocated_end_; }
  /// The file has taken another name.
  void renamed(std::string path) { path_ = std::move(path); }
  /// Writes all changes into the file, call after H5Fflush.
  /// @return 0, or the error number of the system; the file is readable then, later changes are
  ///         dropped
  int commit();
  /// Writes all changes into a copy of the file, which then takes its name.
  /// @param otherwise where the copy cannot be made: as `commit`, or the file stays as it is
  /// @return as `commit`
  int commit_by_copy(WithoutRoom otherwise = WithoutRoom::change_in_place);
  /// From now on no change reaches the file.
  void freeze() { is_frozen_ = true; }
  /// Asks the system for room beyond the end of the file. @return an error number, or 0
  int reserve(std::uint64_t bytes) const;
  /// Gives back space whose reservation was in vain.
  void trim() const;

  void observe(Observer observer) { observer_ = std::move(observer); }

 private:
  friend struct StagedFileDriver;

  struct Block {
    H5FD_mem_t type;
    std::vector<unsigned char> bytes;
  };
  using Blocks = std::map<haddr_t, Block>;

  void stage(H5FD_mem_t type, haddr_t address, const unsigned char* bytes, std::size_t size);
  bool read(haddr_t address, unsigned char* bytes, std::size_t size) const;
  std::vector<Blocks::const_iterator> safe_order() const;
  int write_block(int descriptor, haddr_t address, const Block& block) const;
  int copy_to(int descriptor) const;
  int replace_by_copy();
  int settle(int error);

  std::string path_;
  int descriptor_ = -1;
  Blocks blocks_;                            ///< not yet on the disk, without overlaps
  std::map<haddr_t, H5FD_mem_t> committed_;  ///< blocks of metadata that have been written
  haddr_t opened_end_ = 0;                   ///< in front of it all blocks count as written
  haddr_t allocated_end_ = 0;                ///< of the file as HDF5 sees it
  haddr_t written_end_ = 0;                  ///< of the file on the disk
  bool is_frozen_ = false;
  Observer observer_;
};

}  // namespace stridor
