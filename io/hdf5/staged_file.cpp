#include "io/hdf5/staged_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <tuple>

#include "core/errors.hpp"
#include "io/hdf5/part_file.hpp"
#include "io/hdf5/write_lock.hpp"

#if H5_VERSION_GE(1, 13, 0)
#include <H5FDdevelop.h>
#endif

namespace stridor {
namespace {

/// A write may be cut off by a kill between two pages of memory, not within one.
constexpr haddr_t page = 4096;

int write_all(int descriptor, const unsigned char* bytes, std::size_t size, haddr_t address) {
  while (size > 0) {
    const ssize_t written = pwrite(descriptor, bytes, size, static_cast<off_t>(address));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return written < 0 ? errno : ENOSPC;
    bytes += written;
    size -= static_cast<std::size_t>(written);
    address += static_cast<haddr_t>(written);
  }
  return 0;
}

/// Height of a block in an index: a node points to nodes below it, the lowest ones (leaves of the
/// chunk index, nodes of symbols) to what is no index.
int height_of(const std::vector<unsigned char>& bytes) {
  const bool is_tree_node = bytes.size() > 5 && std::memcmp(bytes.data(), "TREE", 4) == 0;
  return is_tree_node ? 1 + bytes[5] : 0;
}

std::uint64_t size_of(int descriptor) {
  struct stat status = {};
  return fstat(descriptor, &status) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
}

}  // namespace

// ---------------------------------------------------------------- functions called by HDF5

/// A file as HDF5 knows it.
struct StagedFileDriver {
  H5FD_t base;  // must come first; HDF5 fills it
  StagedFile* file;

  static StagedFile& of(H5FD_t* file) { return *reinterpret_cast<StagedFileDriver*>(file)->file; }
  static const StagedFile& of(const H5FD_t* file) {
    return *reinterpret_cast<const StagedFileDriver*>(file)->file;
  }

  static H5FD_t* open(const char*, unsigned, hid_t access, haddr_t) {
    const auto* file = static_cast<StagedFile* const*>(H5Pget_driver_info(access));
    if (file == nullptr) return nullptr;
    return &(new StagedFileDriver{{}, *file})->base;
  }
  static herr_t close(H5FD_t* file) {
    delete reinterpret_cast<StagedFileDriver*>(file);
    return 0;
  }
  static int compare(const H5FD_t* a, const H5FD_t* b) {
    const StagedFile* first = &of(a);
    const StagedFile* second = &of(b);
    if (first == second) return 0;
    return std::less<>()(first, second) ? -1 : 1;
  }
  static herr_t query(const H5FD_t*, unsigned long* flags) {
    // No accumulation of metadata: blocks must come one by one to be put in order.
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_DATA_SIEVE | H5FD_FEAT_AGGREGATE_SMALLDATA |
             H5FD_FEAT_POSIX_COMPAT_HANDLE | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
    return 0;
  }
  static haddr_t allocated_end(const H5FD_t* file, H5FD_mem_t) { return of(file).allocated_end_; }
  static herr_t set_allocated_end(H5FD_t* file, H5FD_mem_t, haddr_t end) {
    of(file).allocated_end_ = end;
    return 0;
  }
  static haddr_t end(const H5FD_t* file, H5FD_mem_t) {
    return std::max(of(file).written_end_, of(file).allocated_end_);
  }
  static herr_t handle(H5FD_t* file, hid_t, void** handle) {
    *handle = &of(file).descriptor_;
    return 0;
  }
  static herr_t read(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t address, size_t size, void* bytes) {
    return of(file).read(address, static_cast<unsigned char*>(bytes), size) ? 0 : -1;
  }
  static herr_t write(H5FD_t* file, H5FD_mem_t type, hid_t, haddr_t address, size_t size,
                      const void* bytes) {
    try {
      of(file).stage(type, address, static_cast<const unsigned char*>(bytes), size);
    } catch (const std::bad_alloc&) {
      return -1;
    }
    return 0;
  }
  static herr_t nothing(H5FD_t*, hid_t, hbool_t) { return 0; }
  static herr_t no_lock(H5FD_t*, hbool_t) { return 0; }
  static herr_t no_unlock(H5FD_t*) { return 0; }

  static hid_t id() {
    static const H5FD_class_t driver = [] {
      H5FD_class_t made{};
#if H5_VERSION_GE(1, 13, 0)
      made.version = H5FD_CLASS_VERSION;
      made.value = static_cast<H5FD_class_value_t>(H5_VFD_RESERVED + 17);
#endif
      made.name = "stridor staged file";
      made.maxaddr = static_cast<haddr_t>(1) << 62;
      made.fc_degree = H5F_CLOSE_WEAK;
      made.fapl_size = sizeof(void*);
      made.open = open;
      made.close = close;
      made.cmp = compare;
      made.query = query;
      made.get_eoa = allocated_end;
      made.set_eoa = set_allocated_end;
      made.get_eof = end;
      made.get_handle = handle;
      made.read = read;
      made.write = write;
      made.flush = nothing;
      made.truncate = nothing;
      made.lock = no_lock;
      made.unlock = no_unlock;
      const H5FD_mem_t map[] = H5FD_FLMAP_DICHOTOMY;
      std::copy(std::begin(map), std::end(map), made.fl_map);
      return made;
    }();
    static const hid_t registered = H5FDregister(&driver);
    return registered;
  }
};

// ---------------------------------------------------------------- the file

StagedFile::~StagedFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void StagedFile::create(const std::string& path) {
  path_ = path;
  descriptor_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0)
    throw FileError(Refusal::cannot_write, path, "", "cannot be made: " + errno_text(errno));
  lock_for_writing(descriptor_);
}

void StagedFile::open(const std::string& path) {
  path_ = path;
  descriptor_ = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor_ < 0)
    throw FileError(Refusal::cannot_write, path, "",
                    "cannot be opened for writing: " + errno_text(errno));
  // The process that wrote it may have replaced it by a copy meanwhile (commit_by_copy).
  if (!lock_for_writing(descriptor_) || !is_named(descriptor_, path)) throw_being_written(path);
  written_end_ = size_of(descriptor_);
}

Handle StagedFile::access(const Checker& at) {
  Handle access = file_access(at);
  StagedFile* const self = this;
  // A node that splits is written anew, so it must lie within one page.
  constexpr hsize_t size_of_small_things = 1024;
  at.check(H5Pset_alignment(access.id(), size_of_small_things, page), "", "cannot set up HDF5");
  at.check(H5Pset_driver(access.id(), StagedFileDriver::id(), &self), "", "cannot set up HDF5");
  return access;
}

void StagedFile::stage(H5FD_mem_t type, haddr_t address, const unsigned char* bytes,
                       std::size_t size) {
  const haddr_t end = address + size;
  auto block = blocks_.upper_bound(address);
  if (block != blocks_.begin()) --block;
  haddr_t covered = address;  // up to here the bytes have found a place
  while (covered < end) {
    while (block != blocks_.end() && block->first + block->second.bytes.size() <= covered) ++block;
    if (block == blocks_.end() || block->first > covered) {
      const haddr_t until = block == blocks_.end() ? end : std::min(end, block->first);
      block = blocks_
                  .emplace(covered,
                           Block{type, {bytes + (covered - address), bytes + (until - address)}})
                  .first;
      covered = until;
    } else {
      const haddr_t until = std::min(end, block->first + block->second.bytes.size());
      std::copy(bytes + (covered - address), bytes + (until - address),
                block->second.bytes.begin() + static_cast<std::ptrdiff_t>(covered - block->first));
      covered = until;
    }
  }
}

bool StagedFile::read(haddr_t address, unsigned char* bytes, std::size_t size) const {
  std::fill_n(bytes, size, static_cast<unsigned char>(0));
  std::size_t done = 0;
  while (done < size) {
    const ssize_t count =
        pread(descriptor_, bytes + done, size - done, static_cast<off_t>(address + done));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    if (count == 0) break;
    done += static_cast<std::size_t>(count);
  }
  const haddr_t end = address + size;
  auto block = blocks_.upper_bound(address);
  if (block != blocks_.begin()) --block;
  for (; block != blocks_.end() && block->first < end; ++block) {
    const haddr_t from = std::max(address, block->first);
    const haddr_t until = std::min(end, block->first + block->second.bytes.size());
    if (from >= until) continue;
    std::copy_n(block->second.bytes.begin() + static_cast<std::ptrdiff_t>(from - block->first),
                until - from, bytes + (from - address));
  }
  return true;
}

std::vector<StagedFile::Blocks::const_iterator> StagedFile::safe_order() const {
  const auto rank = [this](const Blocks::const_iterator& block) {
    const haddr_t address = block->first;
    const auto& content = block->second;
    const auto known = committed_.find(address);
    // Room that was freed counts as new where it now serves another purpose.
    const bool is_new =
        known == committed_.end() ? address >= opened_end_ : known->second != content.type;
    const auto order = [&](int stage) {
      return std::tuple(stage, stage == 3 ? -height_of(content.bytes) : 0, address);
    };
    if (content.type == H5FD_MEM_SUPER) return order(0);
    if (content.type == H5FD_MEM_DRAW || is_new) return order(1);
    if (content.type == H5FD_MEM_LHEAP || content.type == H5FD_MEM_GHEAP) return order(2);
    if (content.type == H5FD_MEM_BTREE) return order(3);
    return order(4);
  };
  std::vector<Blocks::const_iterator> order;
  for (auto block = blocks_.begin(); block != blocks_.end(); ++block) order.push_back(block);
  std::sort(order.begin(), order.end(),
            [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
  return order;
}

int StagedFile::write_block(int descriptor, haddr_t address, const Block& block) const {
  if (block.type == H5FD_MEM_DRAW) {
    const int error = write_all(descriptor, block.bytes.data(), block.bytes.size(), address);
    if (observer_) observer_();
    return error;
  }
  // Page by page from the last one on: a header counts its entries at its beginning.
  haddr_t until = address + block.bytes.size();
  while (until > address) {
    const haddr_t from = std::max(address, (until - 1) / page * page);
    const int error =
        write_all(descriptor, block.bytes.data() + (from - address), until - from, from);
    if (observer_) observer_();
    if (error != 0) return error;
    until = from;
  }
  return 0;
}

int StagedFile::settle(int error) {
  if (error != 0) {
    freeze();
    return error;
  }
  for (const auto& [address, block] : blocks_) {
    if (block.type != H5FD_MEM_DRAW) committed_[address] = block.type;
  }
  blocks_.clear();
  return 0;
}

int StagedFile::commit() {
  if (is_frozen_ || (blocks_.empty() && allocated_end_ <= written_end_)) return 0;
  if (allocated_end_ > written_end_) {
    if (ftruncate(descriptor_, static_cast<off_t>(std::max<std::uint64_t>(
                                   allocated_end_, size_of(descriptor_)))) != 0)
      return settle(errno);
    written_end_ = allocated_end_;
    if (observer_) observer_();
  }
  for (const auto& block : safe_order()) {
    const int error = write_block(descriptor_, block->first, block->second);
    if (error != 0) return settle(error);
  }
  return settle(0);
}

int StagedFile::copy_to(int descriptor) const {
  struct stat status = {};
  if (fstat(descriptor_, &status) != 0 || fchmod(descriptor, status.st_mode & 07777) != 0)
    return errno;
  if (ftruncate(descriptor, static_cast<off_t>(allocated_end_)) != 0) return errno;
  std::vector<unsigned char> buffer(std::size_t{1} << 20);
  const haddr_t end = std::min<haddr_t>(allocated_end_, written_end_);
  for (haddr_t at = 0; at < end;) {
    const std::size_t wanted = std::min<std::size_t>(buffer.size(), end - at);
    const ssize_t count = pread(descriptor_, buffer.data(), wanted, static_cast<off_t>(at));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno;
    if (count == 0) break;
    const int error = write_all(descriptor, buffer.data(), static_cast<std::size_t>(count), at);
    if (error != 0) return error;
    at += static_cast<haddr_t>(count);
  }
  for (const auto& [address, block] : blocks_) {
    const int error = write_block(descriptor, address, block);
    if (error != 0) return error;
  }
  return 0;
}

/// @return 0, or the error number of the system; nothing has changed then
int StagedFile::replace_by_copy() {
  PartFile part(path_);
  const int copy = ::open(part.path().c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (copy < 0) return errno;
  part.made();
  lock_for_writing(copy);
  int error = copy_to(copy);
  if (error == 0) {
    try {
      part.replace();
    } catch (const FileError&) {
      error = EIO;
    }
  }
  if (error == 0 && dup3(copy, descriptor_, O_CLOEXEC) < 0) error = errno;
  ::close(copy);
  return error;
}

int StagedFile::commit_by_copy(WithoutRoom otherwise) {
  if (is_frozen_ || blocks_.empty()) return 0;
  // A file that was moved or replaced meanwhile keeps its name to itself.
  const int error = is_named(descriptor_, path_) ? replace_by_copy() : ESTALE;
  if (error != 0) return otherwise == WithoutRoom::fail ? settle(error) : commit();
  written_end_ = allocated_end_;
  if (observer_) observer_();
  return settle(0);
}

int StagedFile::reserve(std::uint64_t bytes) const {
  const int error =
      posix_fallocate(descriptor_, static_cast<off_t>(allocated_end_), static_cast<off_t>(bytes));
  // No such service here: just try.
  return error == EOPNOTSUPP || error == EINVAL ? 0 : error;
}

void StagedFile::trim() const {
  if (is_frozen_ || descriptor_ < 0 || !blocks_.empty()) return;
  if (ftruncate(descriptor_, static_cast<off_t>(written_end_)) != 0) return;  // no harm in it
}

}  // namespace stridor
