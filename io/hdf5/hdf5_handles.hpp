// Identifiers and errors of HDF5, common to writing and reading run files. Only for the sources of
// io/run_file/run_file.hpp, whose users need no HDF5.
#pragma once

#include "core/refusals.hpp"

#include <hdf5.h>

#include <array>
#include <string>
#include <utility>

namespace stridor {

/// Paths of the two latest checkpoints in a run file.
inline constexpr std::array checkpoint_paths{"/checkpoint/a", "/checkpoint/b"};

/// Owns one HDF5 identifier of any kind.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle() = default;
  Handle(hid_t id, Close how) : id_(id), close_(how) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    if (this != &other) {
      close();
      id_ = std::exchange(other.id_, -1);
      close_ = other.close_;
    }
    return *this;
  }
  ~Handle() { close(); }

  hid_t id() const { return id_; }
  bool is_open() const { return id_ >= 0; }
  herr_t close() { return id_ < 0 ? 0 : close_(std::exchange(id_, -1)); }

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

/// HDF5 prints its error stack by default; while one of these lives it is kept and read instead.
class QuietErrors {
 public:
  QuietErrors();
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;
  ~QuietErrors();

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

/// Message of HDF5 about the call that has just failed; the text of errno where there is one.
std::string hdf5_cause();

/// The text of an error number of the system.
std::string errno_text(int number);

/// Turns failed HDF5 calls into FileErrors that name the file and the dataset.
class Checker {
 public:
  /// @param refusal kind of what fails: file_damaged where the file is read, cannot_write where it is
  ///                written
  explicit Checker(std::string path, Refusal refusal = Refusal::file_damaged)
      : path_(std::move(path)), refusal_(refusal) {}
  const std::string& path() const { return path_; }

  /// @throws FileError always: `what`, then hdf5_cause()
  [[noreturn]] void fail(const std::string& dataset, const std::string& what) const;
  /// @throws FileError as fail() if `status` is negative
  void check(herr_t status, const std::string& dataset, const char* what) const;
  /// The owner of `id`. @throws FileError as fail() if `id` is negative
  Handle own(hid_t id, Handle::Close close, const std::string& dataset, const char* what) const;

 private:
  std::string path_;
  Refusal refusal_;
};

/// Access to run files: without locks, and closed together with all that is open in them.
/// @throws FileError if HDF5 refuses
Handle file_access(const Checker& at);

/// Whether a path is of the form /group/name.
bool is_object_path(const std::string& path);

}  // namespace stridor
