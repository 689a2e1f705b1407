#include "io/hdf5/part_file.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "core/errors.hpp"
#include "io/hdf5/write_lock.hpp"

namespace stridor {
namespace {

constexpr std::string_view part = ".part-";

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  int number() const { return number_; }
  bool is_open() const { return number_ >= 0; }

 private:
  int number_;
};

struct Folder {
  void operator()(DIR* folder) const { closedir(folder); }
};

/// Waits until a file or folder is on the disk. @return an error number, or 0
int sync_to_disk(const std::string& path, int flags) {
  const Descriptor file(::open(path.c_str(), flags | O_RDONLY | O_CLOEXEC));
  if (!file.is_open()) return errno;
  int status = 0;
  do {
    status = ::fsync(file.number());
  } while (status != 0 && errno == EINTR);
  // Some file systems know no such service.
  return status == 0 || errno == EINVAL || errno == EROFS || errno == ENOTSUP ? 0 : errno;
}

/// The process that the name of a part file tells; 0 where it tells none.
pid_t process_of(std::string_view number) {
  constexpr std::size_t most_digits = 9;
  if (number.empty() || number.size() > most_digits || number.front() == '0') return 0;
  pid_t process = 0;
  for (const char digit : number) {
    if (digit < '0' || digit > '9') return 0;
    process = 10 * process + (digit - '0');
  }
  return process;
}

/// Whether a file begins as one that this program makes, or holds nothing on the disk yet.
bool is_ours(const Descriptor& file, const struct stat& status) {
  if (!S_ISREG(status.st_mode) || status.st_uid != geteuid()) return false;
  if (status.st_blocks == 0) return true;
  std::array<char, 16> head{};
  const ssize_t count = pread(file.number(), head.data(), head.size(), 0);
  const std::string_view begin(head.data(), count > 0 ? static_cast<std::size_t>(count) : 0);
  constexpr std::array<std::string_view, 9> beginnings{
      "\x89HDF", "\x89PNG", "<?xml", "%PDF", "{", "# vtk", "//", "<!DOCTYPE html>", "RIFF"};
  return std::any_of(beginnings.begin(), beginnings.end(),
                     [&](std::string_view one) { return begin.substr(0, one.size()) == one; });
}

}  // namespace

std::string folder_of(const std::string& path) {
  const auto slash = path.rfind('/');
  if (slash == std::string::npos) return ".";
  return slash == 0 ? "/" : path.substr(0, slash);
}

void remove_leftovers(const std::string& final_path) {
  const std::string folder = folder_of(final_path);
  const auto slash = final_path.rfind('/');
  const std::string beginning =
      final_path.substr(slash == std::string::npos ? 0 : slash + 1) + std::string(part);
  const std::unique_ptr<DIR, Folder> entries(opendir(folder.c_str()));
  if (!entries) return;
  std::vector<std::string> names;
  while (const dirent* entry = readdir(entries.get())) {
    const std::string_view name = entry->d_name;
    if (!name.starts_with(beginning)) continue;
    const pid_t process = process_of(name.substr(beginning.size()));
    const bool is_dead = process > 0 && kill(process, 0) != 0 && errno == ESRCH;
    if (is_dead) names.emplace_back(name);
  }
  for (const std::string& name : names) {
    const std::string path = folder + "/" + name;
    // Its process may live on another machine; it holds a lock there.
    const Descriptor file(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC));
    struct stat status = {};
    if (file.is_open() && fstat(file.number(), &status) == 0 && is_ours(file, status) &&
        lock_for_writing(file.number()))
      unlink(path.c_str());
  }
}

PartFile::PartFile(std::string final_path)
    : final_path_(std::move(final_path)),
      path_(fmt::format("{}{}{}", final_path_, part, getpid())) {
  remove_leftovers(final_path_);
}

PartFile::~PartFile() {
  if (is_made_) unlink(path_.c_str());
}

void PartFile::sync() const {
  const int error = sync_to_disk(path_, 0);
  if (error != 0)
    throw FileError(Refusal::cannot_write, final_path_, "",
                    fmt::format("cannot be written: {}", std::strerror(error)));
}

// The file has its name already, so that an error here is not one of the file.
void PartFile::sync_name() {
  is_made_ = false;
  note_written_file();
  sync_to_disk(folder_of(final_path_), O_DIRECTORY);
}

void PartFile::move_to_final(Overwrite overwrite) {
  sync();
  // What is replaced stays locked until then: of two that replace it at once one is refused.
  std::optional<WriteLock> replaced;
  if (overwrite == Overwrite::yes) replaced.emplace(final_path_);
  if (!replaced || !replaced->is_held()) {
    // Another process may have made the file meanwhile; not every file system can tell.
    if (renameat2(AT_FDCWD, path_.c_str(), AT_FDCWD, final_path_.c_str(), RENAME_NOREPLACE) == 0) {
      sync_name();
      return;
    }
    if (errno == EEXIST && overwrite == Overwrite::yes) throw_being_written(final_path_);
    if (errno == EEXIST)
      throw FileError(Refusal::file_exists, final_path_, "", "exists; use --force to overwrite it");
  }
  replace();
}

void PartFile::replace() {
  sync();
  if (std::rename(path_.c_str(), final_path_.c_str()) != 0) {
    throw FileError(Refusal::cannot_write, final_path_, "",
                    fmt::format("cannot be given its name: {}", std::strerror(errno)));
  }
  sync_name();
}

void write_text_file(const std::string& path, const std::function<void(const TextSink&)>& fill) {
  PartFile file(path);
  const auto refuse = [&] {
    throw FileError(Refusal::cannot_write, path, "",
                    fmt::format("cannot be written: {}", std::strerror(errno)));
  };
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.path().c_str(), "we"),
                                                         &std::fclose);
  if (!stream) refuse();
  file.made();
  lock_for_writing(fileno(stream.get()));
  fill([&](std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), stream.get()) != text.size()) refuse();
  });
  if (std::fflush(stream.get()) != 0 || std::fclose(stream.release()) != 0) refuse();
  file.replace();
}

void write_text_file(const std::string& path, const std::string& text) {
  write_text_file(path, [&](const TextSink& sink) { sink(text); });
}

}  // namespace stridor
