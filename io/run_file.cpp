#include "io/run_file.hpp"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <hdf5.h>
#include <hdf5_hl.h>
#include <stdio.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>
#include <functional>
#include <set>
#include <stdexcept>

#include "core/errors.hpp"

namespace stridor {
namespace {

constexpr hsize_t chunk_rows = 16384;

// ---------------------------------------------------------------- handles and errors of HDF5

// Owns one HDF5 identifier of any kind.
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

// HDF5 prints its error stack by default; here it is kept and read instead.
class QuietErrors {
 public:
  QuietErrors() {
    // Before anything else of HDF5: a file whose closing failed stays in its books, and its
    // clean-up at exit crashes over it. All handles are closed here, there is nothing for it to
    // clean up.
    H5dont_atexit();
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;
  ~QuietErrors() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

herr_t keep_description(unsigned, const H5E_error2_t* error, void* text) {
  // Upwards: the first one is the innermost and the most telling.
  auto& description = *static_cast<std::string*>(text);
  if (description.empty() && error->desc != nullptr) description = error->desc;
  return 0;
}

// What HDF5 says about the call that has just failed; the text of errno where there is one.
std::string hdf5_cause() {
  std::string description;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_description, &description);
  const std::string marker = "error message = '";
  const auto begin = description.find(marker);
  if (begin != std::string::npos) {
    const auto text = begin + marker.size();
    return description.substr(text, description.find('\'', text) - text);
  }
  return description.empty() ? "HDF5 gives no reason" : "HDF5: " + description;
}

std::string errno_text(int number) {
  return std::strerror(number);
}

// Turns failed HDF5 calls into FileErrors that name the file and the dataset.
class Checker {
 public:
  explicit Checker(std::string path) : path_(std::move(path)) {}
  const std::string& path() const { return path_; }

  [[noreturn]] void fail(const std::string& dataset, const std::string& what) const {
    throw FileError(path_, dataset, fmt::format("{}: {}", what, hdf5_cause()));
  }
  void check(herr_t status, const std::string& dataset, const char* what) const {
    if (status < 0) fail(dataset, what);
  }
  Handle own(hid_t id, Handle::Close close, const std::string& dataset, const char* what) const {
    if (id < 0) fail(dataset, what);
    return {id, close};
  }

 private:
  std::string path_;
};

Handle file_access(const Checker& at) {
  // Locks fail on many network file systems and would keep readers out while a run goes on.
#if H5_VERSION_GE(1, 10, 7)
  Handle access = at.own(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "", "cannot set up HDF5");
  at.check(H5Pset_file_locking(access.id(), false, true), "", "cannot switch file locking off");
#else
  setenv("HDF5_USE_FILE_LOCKING", "FALSE", 0);
  Handle access = at.own(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "", "cannot set up HDF5");
#endif
  at.check(H5Pset_fclose_degree(access.id(), H5F_CLOSE_STRONG), "", "cannot set up HDF5");
  return access;
}

Handle link_creation(const Checker& at) {
  Handle links = at.own(H5Pcreate(H5P_LINK_CREATE), H5Pclose, "", "cannot set up HDF5");
  at.check(H5Pset_create_intermediate_group(links.id(), 1), "", "cannot set up HDF5");
  at.check(H5Pset_char_encoding(links.id(), H5T_CSET_UTF8), "", "cannot set up HDF5");
  return links;
}

// ---------------------------------------------------------------- text and numbers as attributes

Handle text_type(const Checker& at, std::size_t length, const std::string& dataset) {
  Handle type = at.own(H5Tcopy(H5T_C_S1), H5Tclose, dataset, "cannot make a text type");
  at.check(H5Tset_size(type.id(), length + 1), dataset, "cannot make a text type");
  at.check(H5Tset_cset(type.id(), H5T_CSET_UTF8), dataset, "cannot make a text type");
  return type;
}

void write_attribute(const Checker& at, hid_t object, const std::string& dataset,
                     const std::string& name, const std::variant<std::string, double>& value) {
  const Handle space = at.own(H5Screate(H5S_SCALAR), H5Sclose, dataset, "cannot make an attribute");
  const std::string* text = std::get_if<std::string>(&value);
  const Handle type =
      text != nullptr ? text_type(at, text->size(), dataset)
                      : at.own(H5Tcopy(H5T_IEEE_F64LE), H5Tclose, dataset, "cannot make a type");
  const std::string what = fmt::format("cannot write attribute '{}'", name);
  const Handle attribute =
      at.own(H5Acreate2(object, name.c_str(), type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT),
             H5Aclose, dataset, what.c_str());
  const herr_t status =
      text != nullptr ? H5Awrite(attribute.id(), type.id(), text->c_str())
                      : H5Awrite(attribute.id(), H5T_NATIVE_DOUBLE, std::get_if<double>(&value));
  at.check(status, dataset, what.c_str());
}

void write_text(const Checker& at, hid_t file, const Handle& links, const std::string& path,
                const std::string& text) {
  const Handle space = at.own(H5Screate(H5S_SCALAR), H5Sclose, path, "cannot make the dataset");
  const Handle type = text_type(at, text.size(), path);
  const Handle dataset = at.own(
      H5Dcreate2(file, path.c_str(), type.id(), space.id(), links.id(), H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose, path, "cannot make the dataset");
  at.check(H5Dwrite(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()), path,
           "cannot write");
}

bool is_object_path(const std::string& path) {
  return path.size() >= 2 && path.front() == '/' && path.back() != '/' &&
         path.find("//") == std::string::npos && path.find("/./") == std::string::npos &&
         path.find('\0') == std::string::npos && !path.ends_with("/.");
}

void check_object_path(const std::string& path) {
  if (!is_object_path(path)) {
    throw std::invalid_argument(
        fmt::format("run file: '{}' is not a path of the form /group/name", path));
  }
  for (const char* reserved : {"/time", "/results", "/scene"}) {
    if (path == reserved || path.starts_with(std::string(reserved) + "/")) {
      throw std::invalid_argument(fmt::format("run file: the path '{}' is reserved", path));
    }
  }
}

// ---------------------------------------------------------------- the temporary file

std::string folder_of(const std::string& path) {
  const auto slash = path.rfind('/');
  if (slash == std::string::npos) return ".";
  return slash == 0 ? "/" : path.substr(0, slash);
}

// @throws FileError unless a file of this name may be made
void check_target(const std::string& path, Overwrite overwrite) {
  struct stat status = {};
  const std::string folder = folder_of(path);
  if (path.empty() || path.back() == '/') throw FileError(path, "", "is not the name of a file");
  if (stat(folder.c_str(), &status) != 0) {
    throw FileError(path, "",
                    fmt::format("the folder '{}' cannot be used: {}", folder, errno_text(errno)));
  }
  if (!S_ISDIR(status.st_mode))
    throw FileError(path, "", fmt::format("'{}' is not a folder", folder));
  if (stat(path.c_str(), &status) == 0) {
    if (S_ISDIR(status.st_mode)) throw FileError(path, "", "is a folder");
    if (!S_ISREG(status.st_mode))
      throw FileError(path, "", "is not a regular file and is not replaced");
    if (overwrite == Overwrite::no)
      throw FileError(path, "", "exists; use --force to overwrite it");
  }
  if (access(folder.c_str(), W_OK | X_OK) != 0) {
    throw FileError(path, "",
                    fmt::format("cannot write in the folder '{}': {}", folder, errno_text(errno)));
  }
}

// A name that is removed again unless the file is moved onto its final name.
class PartFile {
 public:
  explicit PartFile(const std::string& path) : path_(fmt::format("{}.part-{}", path, getpid())) {}
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;
  ~PartFile() {
    if (made_) unlink(path_.c_str());
  }
  const std::string& path() const { return path_; }
  void made() { made_ = true; }

  void move_to(const std::string& final_path, Overwrite overwrite) {
    int status = -1;
    if (overwrite == Overwrite::no) {
      // Another process may have made the file meanwhile; not every file system can tell.
      status = renameat2(AT_FDCWD, path_.c_str(), AT_FDCWD, final_path.c_str(), RENAME_NOREPLACE);
      if (status != 0 && errno == EEXIST)
        throw FileError(final_path, "", "exists; use --force to overwrite it");
    }
    if (status != 0) status = std::rename(path_.c_str(), final_path.c_str());
    if (status != 0)
      throw FileError(final_path, "", "cannot be given its name: " + errno_text(errno));
    made_ = false;
  }

 private:
  std::string path_;
  bool made_ = false;
};

}  // namespace

void check_output(const std::string& path, Overwrite overwrite) { check_target(path, overwrite); }

std::string utc_now() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

// ==================================================================== writer

struct RunFileWriter::Impl {
  struct Column {
    SeriesSpec spec;
    Handle dataset;
    std::vector<double> rows;  // not yet written
  };

  Impl(const std::string& path, std::vector<SeriesSpec> specs, RunFileOptions chosen)
      : at(path), options(chosen), access(file_access(at)), links(link_creation(at)) {
    for (SeriesSpec& spec : specs) columns.push_back({std::move(spec), {}, {}});
  }
  ~Impl() {
    const QuietErrors quiet;
    if (file.is_open()) close_file();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void check_specs() const;
  void create(Overwrite overwrite, const RunFileHeader& header);
  Handle create_series(const std::string& path, SeriesKind kind, const std::string& units);
  void reserve(std::uint64_t rows) const;
  void write_rows(const Handle& dataset, const std::string& path, SeriesKind kind,
                  std::span<const double> rows);
  void flush();
  void require_usable() const;
  template <typename Action>
  void modify(const Action& action);
  void abandon() noexcept;
  std::string close_file();

  Checker at;
  RunFileOptions options;
  Handle access;
  Handle links;
  Handle file;
  Handle time_dataset;
  std::vector<Column> columns;
  std::vector<double> times;  // not yet written
  std::vector<std::uint8_t> states;
  std::uint64_t num_written = 0;
  bool closed = false;
  bool broken = false;
};

void RunFileWriter::Impl::check_specs() const {
  if (options.block_rows == 0)
    throw std::invalid_argument("run file: block_rows must be at least 1");
  std::set<std::string> paths;
  for (const Column& column : columns) {
    check_object_path(column.spec.path);
    if (!paths.insert(column.spec.path).second) {
      throw std::invalid_argument(
          fmt::format("run file: the series '{}' appears twice", column.spec.path));
    }
    const auto is_meaning = [](const auto& attribute) { return attribute.first == "meaning"; };
    const auto& attributes = column.spec.attributes;
    if (column.spec.kind == SeriesKind::state &&
        std::none_of(attributes.begin(), attributes.end(), is_meaning)) {
      throw std::invalid_argument(fmt::format(
          "run file: the state series '{}' needs the attribute 'meaning'", column.spec.path));
    }
  }
}

Handle RunFileWriter::Impl::create_series(const std::string& path, SeriesKind kind,
                                          const std::string& units) {
  constexpr hsize_t none = 0;
  const hsize_t unlimited = H5S_UNLIMITED;
  const Handle space =
      at.own(H5Screate_simple(1, &none, &unlimited), H5Sclose, path, "cannot make the dataset");
  const Handle creation =
      at.own(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, path, "cannot make the dataset");
  at.check(H5Pset_chunk(creation.id(), 1, &chunk_rows), path, "cannot make the dataset");
  const hid_t type = kind == SeriesKind::real ? H5T_IEEE_F64LE : H5T_STD_U8LE;
  Handle dataset = at.own(
      H5Dcreate2(file.id(), path.c_str(), type, space.id(), links.id(), creation.id(), H5P_DEFAULT),
      H5Dclose, path, "cannot make the dataset");
  write_attribute(at, dataset.id(), path, "units", units);
  return dataset;
}

void RunFileWriter::Impl::create(Overwrite overwrite, const RunFileHeader& header) {
  check_target(at.path(), overwrite);
  PartFile part(at.path());

  const Handle creation = at.own(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "", "cannot set up HDF5");
  // 256 chunks (4 million rows) to a node of the chunk index, so that nodes hardly ever split: a
  // split rewrites old entries, which a kill in between could leave half done.
  at.check(H5Pset_istore_k(creation.id(), 128), "", "cannot set up HDF5");
  file = at.own(H5Fcreate(part.path().c_str(), H5F_ACC_TRUNC, creation.id(), access.id()), H5Fclose,
                "", "cannot be made");
  part.made();

  try {
    const Handle space = at.own(H5Screate(H5S_SCALAR), H5Sclose, "", "cannot make an attribute");
    const Handle format =
        at.own(H5Acreate2(file.id(), "format", H5T_STD_I32LE, space.id(), H5P_DEFAULT, H5P_DEFAULT),
               H5Aclose, "", "cannot write attribute 'format'");
    at.check(H5Awrite(format.id(), H5T_NATIVE_INT, &run_file_format), "",
             "cannot write attribute 'format'");
    for (const auto& [name, text] :
         {std::pair{"version", &header.version}, std::pair{"commit", &header.commit},
          std::pair{"command", &header.command}, std::pair{"scene_hash", &header.scene_hash},
          std::pair{"date", &header.date}}) {
      write_attribute(at, file.id(), "", name, *text);
    }
    write_text(at, file.id(), links, "/scene/text", header.scene_text);
    write_text(at, file.id(), links, "/scene/resolved", header.scene_resolved);

    time_dataset = create_series("/time", SeriesKind::real, "s");
    at.check(H5DSset_scale(time_dataset.id(), "time"), "/time", "cannot be made a dimension scale");
    for (Column& column : columns) {
      const SeriesSpec& spec = column.spec;
      column.dataset = create_series(spec.path, spec.kind, spec.units);
      for (const auto& [name, value] : spec.attributes) {
        write_attribute(at, column.dataset.id(), spec.path, name, value);
      }
      at.check(H5DSattach_scale(column.dataset.id(), time_dataset.id(), 0), spec.path,
               "cannot be tied to /time");
    }
    at.check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), "", "cannot be written");
    part.move_to(at.path(), overwrite);
  } catch (...) {
    abandon();
    close_file();
    throw;
  }
}

void RunFileWriter::Impl::require_usable() const {
  if (closed) throw std::invalid_argument("run file: written to after close()");
  if (broken)
    throw FileError(at.path(), "", "an earlier write failed, nothing more can be written");
}

// HDF5 holds changes in memory and would write them, half done, when the file is closed. After a
// failure they must not reach the file, in which all that was flushed is still sound: its
// descriptor is pointed to a file in memory that nobody sees.
void RunFileWriter::Impl::abandon() noexcept {
  broken = true;
  void* handle = nullptr;
  if (!file.is_open() || H5Fget_vfd_handle(file.id(), H5P_DEFAULT, &handle) < 0 ||
      handle == nullptr)
    return;
  int nowhere = memfd_create("stridor", MFD_CLOEXEC);
  if (nowhere < 0) nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
  if (nowhere < 0) return;
  dup2(nowhere, *static_cast<int*>(handle));
  ::close(nowhere);
}

template <typename Action>
void RunFileWriter::Impl::modify(const Action& action) {
  const QuietErrors quiet;
  try {
    action();
  } catch (const FileError&) {
    abandon();
    throw;
  }
}

// Asks the file system for what the next block needs at most. Nothing has been changed if it
// refuses.
void RunFileWriter::Impl::reserve(std::uint64_t rows) const {
  void* handle = nullptr;
  hsize_t size = 0;
  if (H5Fget_vfd_handle(file.id(), H5P_DEFAULT, &handle) < 0 ||
      H5Fget_filesize(file.id(), &size) < 0) {
    at.fail("", "cannot be measured");
  }
  const std::uint64_t chunks_before = (num_written + chunk_rows - 1) / chunk_rows;
  const std::uint64_t chunks_after = (num_written + rows + chunk_rows - 1) / chunk_rows;
  std::uint64_t needed = 0;
  if (chunks_after > chunks_before) {
    const std::uint64_t num_series = columns.size() + 1;
    // 16 KiB per series for the chunk index, 64 KiB for the rest of what describes the data.
    needed = (chunks_after - chunks_before) * num_series * chunk_rows * sizeof(double) +
             num_series * 16384 + 65536;
  }
  if (needed == 0) return;
  const int error = posix_fallocate(*static_cast<int*>(handle), static_cast<off_t>(size),
                                    static_cast<off_t>(needed));
  if (error == 0 || error == EOPNOTSUPP || error == EINVAL)
    return;  // no such service here: just try
  throw FileError(at.path(), "/time",
                  fmt::format("no room for rows {} to {} ({} bytes): {}", num_written,
                              num_written + rows - 1, needed, errno_text(error)));
}

void RunFileWriter::Impl::write_rows(const Handle& dataset, const std::string& path,
                                     SeriesKind kind, std::span<const double> rows) {
  const hsize_t offset = num_written;
  const hsize_t count = rows.size();
  const hsize_t extent = offset + count;
  at.check(H5Dset_extent(dataset.id(), &extent), path, "cannot be extended");
  const Handle target = at.own(H5Dget_space(dataset.id()), H5Sclose, path, "cannot be written");
  at.check(H5Sselect_hyperslab(target.id(), H5S_SELECT_SET, &offset, nullptr, &count, nullptr),
           path, "cannot be written");
  const Handle source =
      at.own(H5Screate_simple(1, &count, nullptr), H5Sclose, path, "cannot be written");
  herr_t status = -1;
  if (kind == SeriesKind::real) {
    status = H5Dwrite(dataset.id(), H5T_NATIVE_DOUBLE, source.id(), target.id(), H5P_DEFAULT,
                      rows.data());
  } else {
    states.resize(rows.size());
    std::transform(rows.begin(), rows.end(), states.begin(),
                   [](double x) { return static_cast<std::uint8_t>(x); });
    status = H5Dwrite(dataset.id(), H5T_NATIVE_UINT8, source.id(), target.id(), H5P_DEFAULT,
                      states.data());
  }
  at.check(status, path, "cannot be written");
  // One by one, because a flush of the whole file goes on after an error and would record a length
  // of the file that it does not have.
  at.check(H5Dflush(dataset.id()), path, "cannot be flushed");
}

void RunFileWriter::Impl::flush() {
  require_usable();
  if (times.empty()) return;
  const QuietErrors quiet;
  if (options.reservation == RunFileOptions::Reservation::on) reserve(times.size());
  modify([this] {
    for (const Column& column : columns) {
      write_rows(column.dataset, column.spec.path, column.spec.kind, column.rows);
    }
    at.check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), "", "cannot be flushed");
    write_rows(time_dataset, "/time", SeriesKind::real, times);
    at.check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), "/time", "cannot be flushed");
  });
  num_written += times.size();
  times.clear();
  for (Column& column : columns) column.rows.clear();
}

// @return what went wrong, empty if nothing
std::string RunFileWriter::Impl::close_file() {
  bool failed = false;
  std::string cause;
  const auto note = [&](herr_t status) {
    if (status >= 0 || failed) return;
    failed = true;
    cause = hdf5_cause();
  };
  for (Column& column : columns) note(column.dataset.close());
  note(time_dataset.close());
  note(file.close());
  return cause;
}

RunFileWriter::RunFileWriter(const std::string& path, Overwrite overwrite,
                             const RunFileHeader& header, std::vector<SeriesSpec> series,
                             RunFileOptions options) {
  const QuietErrors quiet;
  impl_ = std::make_unique<Impl>(path, std::move(series), options);
  impl_->check_specs();
  impl_->create(overwrite, header);
}

RunFileWriter::~RunFileWriter() {
  if (!impl_) return;
  try {
    close();
  } catch (const std::exception&) {  // the caller did not ask
  }
}
RunFileWriter::RunFileWriter(RunFileWriter&&) noexcept = default;
RunFileWriter& RunFileWriter::operator=(RunFileWriter&& other) noexcept {
  RunFileWriter old(std::move(*this));  // closes as the destructor does
  impl_ = std::move(other.impl_);
  return *this;
}

void RunFileWriter::append(std::span<const double> time,
                           const std::vector<std::span<const double>>& columns) {
  Impl& impl = *impl_;
  impl.require_usable();
  if (columns.size() != impl.columns.size()) {
    throw std::invalid_argument(
        fmt::format("run file: {} columns for {} series", columns.size(), impl.columns.size()));
  }
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const SeriesSpec& spec = impl.columns[i].spec;
    if (columns[i].size() != time.size()) {
      throw std::invalid_argument(fmt::format("run file: series '{}' has {} rows, time has {}",
                                              spec.path, columns[i].size(), time.size()));
    }
    const auto is_state = [](double x) { return x >= 0.0 && x <= 255.0 && x == std::floor(x); };
    if (spec.kind == SeriesKind::state &&
        !std::all_of(columns[i].begin(), columns[i].end(), is_state)) {
      throw std::invalid_argument(
          fmt::format("run file: states of '{}' must be integers 0 to 255", spec.path));
    }
  }
  for (std::size_t begin = 0; begin < time.size();) {
    // Not less than one row, so that a block left over by a failed flush is tried again.
    const std::size_t room =
        std::max<std::size_t>(impl.options.block_rows, impl.times.size() + 1) - impl.times.size();
    const std::size_t count = std::min(room, time.size() - begin);
    const auto take = [&](std::vector<double>& rows, std::span<const double> values) {
      const auto part = values.subspan(begin, count);
      rows.insert(rows.end(), part.begin(), part.end());
    };
    take(impl.times, time);
    for (std::size_t i = 0; i < columns.size(); ++i) take(impl.columns[i].rows, columns[i]);
    begin += count;
    if (impl.times.size() >= impl.options.block_rows) impl.flush();
  }
}

void RunFileWriter::append(double time, std::span<const double> row) {
  Impl& impl = *impl_;
  std::vector<std::span<const double>> columns;
  columns.reserve(row.size());
  for (std::size_t i = 0; i < row.size(); ++i) columns.push_back(row.subspan(i, 1));
  impl.require_usable();
  append({&time, 1}, columns);
}

void RunFileWriter::flush() {
  impl_->flush();
}

void RunFileWriter::write_static(const std::string& path, std::span<const double> values,
                                 const std::string& units) {
  Impl& impl = *impl_;
  impl.require_usable();
  check_object_path(path);
  const QuietErrors quiet;
  if (H5LTpath_valid(impl.file.id(), path.c_str(), true) > 0) {
    throw std::invalid_argument(fmt::format("run file: there is a dataset '{}' already", path));
  }
  impl.modify([&] {
    const Checker& at = impl.at;
    const hsize_t count = values.size();
    const Handle space =
        at.own(H5Screate_simple(1, &count, nullptr), H5Sclose, path, "cannot make the dataset");
    const Handle dataset = at.own(H5Dcreate2(impl.file.id(), path.c_str(), H5T_IEEE_F64LE,
                                             space.id(), impl.links.id(), H5P_DEFAULT, H5P_DEFAULT),
                                  H5Dclose, path, "cannot make the dataset");
    at.check(
        H5Dwrite(dataset.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
        path, "cannot be written");
    write_attribute(at, dataset.id(), path, "units", units);
    at.check(H5Fflush(impl.file.id(), H5F_SCOPE_GLOBAL), path, "cannot be flushed");
  });
}

namespace {

void write_result_attribute(const Checker& at, const Handle& file, const Handle& links,
                            const std::string& name,
                            const std::variant<std::string, double>& value) {
  const bool exists = H5Lexists(file.id(), "/results", H5P_DEFAULT) > 0;
  const Handle group =
      at.own(exists ? H5Gopen2(file.id(), "/results", H5P_DEFAULT)
                    : H5Gcreate2(file.id(), "/results", links.id(), H5P_DEFAULT, H5P_DEFAULT),
             H5Gclose, "/results", "cannot be made");
  if (H5Aexists(group.id(), name.c_str()) > 0) {
    at.check(H5Adelete(group.id(), name.c_str()), "/results", "cannot be replaced");
  }
  write_attribute(at, group.id(), "/results", name, value);
}

}  // namespace

void RunFileWriter::write_result(const std::string& name, double value) {
  impl_->require_usable();
  impl_->modify([&] { write_result_attribute(impl_->at, impl_->file, impl_->links, name, value); });
}

void RunFileWriter::write_result(const std::string& name, const std::string& value) {
  impl_->require_usable();
  impl_->modify([&] { write_result_attribute(impl_->at, impl_->file, impl_->links, name, value); });
}

void RunFileWriter::close() {
  Impl& impl = *impl_;
  if (impl.closed) return;
  const QuietErrors quiet;
  std::exception_ptr first;
  if (!impl.broken) {
    try {
      impl.flush();
      // Results and the like are written here, where a failure can still be kept from the file.
      impl.modify([&] {
        impl.at.check(H5Fflush(impl.file.id(), H5F_SCOPE_GLOBAL), "", "cannot be flushed");
      });
    } catch (const FileError&) {
      first = std::current_exception();
    }
  }
  impl.closed = true;
  const std::string cause = impl.close_file();
  if (first) std::rethrow_exception(first);
  if (impl.broken)
    throw FileError(impl.at.path(), "", "an earlier write failed, the last rows are missing");
  if (!cause.empty()) throw FileError(impl.at.path(), "", "cannot be closed: " + cause);
}

std::uint64_t RunFileWriter::num_written() const {
  return impl_->num_written;
}

// ==================================================================== reader

namespace {

std::string read_text(const Checker& at, hid_t type, const std::string& dataset,
                      const std::function<herr_t(hid_t, void*)>& read) {
  if (H5Tis_variable_str(type) > 0) {
    char* text = nullptr;
    const Handle memory = at.own(H5Tcopy(type), H5Tclose, dataset, "cannot be read");
    at.check(read(memory.id(), &text), dataset, "cannot be read");
    const std::string result = text != nullptr ? text : "";
    H5free_memory(text);
    return result;
  }
  std::string text(H5Tget_size(type), '\0');
  at.check(read(type, text.data()), dataset, "cannot be read");
  return text.substr(0, text.find('\0'));
}

using Values = std::map<std::string, std::variant<std::string, double>>;

// Text or one number; anything else (references of dimension scales, arrays) is not given.
void read_attribute(const Checker& at, hid_t object, const std::string& path,
                    const std::string& name, Values& values) {
  const Handle attribute = at.own(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, path,
                                  "cannot read an attribute");
  const Handle type =
      at.own(H5Aget_type(attribute.id()), H5Tclose, path, "cannot read an attribute");
  const Handle space =
      at.own(H5Aget_space(attribute.id()), H5Sclose, path, "cannot read an attribute");
  if (H5Sget_simple_extent_npoints(space.id()) != 1) return;
  const H5T_class_t kind = H5Tget_class(type.id());
  if (kind == H5T_STRING) {
    values[name] = read_text(at, type.id(), path, [&](hid_t memory, void* target) {
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

Values read_attributes(const Checker& at, hid_t object, const std::string& path) {
  std::vector<std::string> names;
  at.check(H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, keep_name, &names), path,
           "cannot read its attributes");
  Values values;
  for (const std::string& name : names) read_attribute(at, object, path, name, values);
  return values;
}

herr_t keep_dataset(hid_t, const char* name, const H5O_info_t* info, void* paths) {
  if (info->type == H5O_TYPE_DATASET)
    static_cast<std::vector<std::string>*>(paths)->push_back("/" + std::string(name));
  return 0;
}

}  // namespace

struct RunFileReader::Impl {
  explicit Impl(const std::string& path) : at(path) {}
  ~Impl() {
    const QuietErrors quiet;
    file.close();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void open_file();
  void read_header();
  std::string text(const std::string& path) const;
  Handle open_array(const std::string& path, hsize_t& length) const;
  std::vector<double> read_array(const std::string& path, const std::uint64_t* wanted) const;
  std::vector<std::string> arrays(bool series) const;

  Checker at;
  Handle file;
  RunFileHeader header;
  std::vector<double> times;
};

void RunFileReader::Impl::open_file() {
  const std::string& path = at.path();
  struct stat status = {};
  if (stat(path.c_str(), &status) != 0 || ::access(path.c_str(), R_OK) != 0) {
    throw FileError(path, "", "cannot be opened: " + errno_text(errno));
  }
  if (S_ISDIR(status.st_mode)) throw FileError(path, "", "is a folder");
  const htri_t is_hdf5 = H5Fis_hdf5(path.c_str());
  if (is_hdf5 == 0) throw FileError(path, "", "is not an HDF5 file");
  const Handle access = file_access(at);
  file = at.own(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose, "",
                "is damaged or truncated");
}

void RunFileReader::Impl::read_header() {
  const Values values = read_attributes(at, file.id(), "/");
  const auto format = values.find("format");
  const double* number = format == values.end() ? nullptr : std::get_if<double>(&format->second);
  if (number == nullptr)
    throw FileError(at.path(), "", "is not a run file of stridor (no attribute 'format')");
  if (*number > run_file_format) {
    throw FileError(
        at.path(), "",
        fmt::format("has format {:g}, this program reads formats up to {}; use a newer one",
                    *number, run_file_format));
  }
  if (*number != run_file_format)
    throw FileError(at.path(), "", fmt::format("has the unknown format {:g}", *number));
  for (const auto& [name, target] :
       {std::pair{"version", &header.version}, std::pair{"commit", &header.commit},
        std::pair{"command", &header.command}, std::pair{"scene_hash", &header.scene_hash},
        std::pair{"date", &header.date}}) {
    const auto found = values.find(name);
    const std::string* value =
        found == values.end() ? nullptr : std::get_if<std::string>(&found->second);
    if (value == nullptr) {
      throw FileError(at.path(), "",
                      fmt::format("is not a run file of stridor (no attribute '{}')", name));
    }
    *target = *value;
  }
  header.scene_text = text("/scene/text");
  header.scene_resolved = text("/scene/resolved");
  times = read_array("/time", nullptr);
}

std::string RunFileReader::Impl::text(const std::string& path) const {
  if (H5LTpath_valid(file.id(), path.c_str(), true) <= 0)
    throw FileError(at.path(), path, "is missing");
  const Handle dataset =
      at.own(H5Dopen2(file.id(), path.c_str(), H5P_DEFAULT), H5Dclose, path, "cannot be opened");
  const Handle type = at.own(H5Dget_type(dataset.id()), H5Tclose, path, "cannot be read");
  const Handle space = at.own(H5Dget_space(dataset.id()), H5Sclose, path, "cannot be read");
  if (H5Tget_class(type.id()) != H5T_STRING || H5Sget_simple_extent_npoints(space.id()) != 1) {
    throw FileError(at.path(), path, "is not text");
  }
  return read_text(at, type.id(), path, [&](hid_t memory, void* target) {
    return H5Dread(dataset.id(), memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, target);
  });
}

Handle RunFileReader::Impl::open_array(const std::string& path, hsize_t& length) const {
  if (!is_object_path(path) || H5LTpath_valid(file.id(), path.c_str(), true) <= 0) {
    throw FileError(at.path(), path, "is missing");
  }
  Handle dataset =
      at.own(H5Dopen2(file.id(), path.c_str(), H5P_DEFAULT), H5Dclose, path, "is not a dataset");
  const Handle type = at.own(H5Dget_type(dataset.id()), H5Tclose, path, "cannot be read");
  const H5T_class_t kind = H5Tget_class(type.id());
  if (kind != H5T_FLOAT && kind != H5T_INTEGER)
    throw FileError(at.path(), path, "does not hold real numbers");
  const Handle space = at.own(H5Dget_space(dataset.id()), H5Sclose, path, "cannot be read");
  if (const int rank = H5Sget_simple_extent_ndims(space.id()); rank != 1) {
    throw FileError(at.path(), path, fmt::format("has {} dimensions, expected 1", rank));
  }
  at.check(H5Sget_simple_extent_dims(space.id(), &length, nullptr), path, "cannot be read");
  return dataset;
}

std::vector<double> RunFileReader::Impl::read_array(const std::string& path,
                                                    const std::uint64_t* wanted) const {
  hsize_t length = 0;
  const Handle dataset = open_array(path, length);
  if (wanted != nullptr && length < *wanted) {
    throw FileError(at.path(), path, fmt::format("has {} rows, but /time has {}", length, *wanted));
  }
  const hsize_t count = wanted != nullptr ? *wanted : length;
  const hsize_t offset = 0;
  std::vector<double> values(count);
  if (count == 0) return values;
  const Handle source = at.own(H5Dget_space(dataset.id()), H5Sclose, path, "cannot be read");
  at.check(H5Sselect_hyperslab(source.id(), H5S_SELECT_SET, &offset, nullptr, &count, nullptr),
           path, "cannot be read");
  const Handle target =
      at.own(H5Screate_simple(1, &count, nullptr), H5Sclose, path, "cannot be read");
  at.check(H5Dread(dataset.id(), H5T_NATIVE_DOUBLE, target.id(), source.id(), H5P_DEFAULT,
                   values.data()),
           path, "cannot be read");
  return values;
}

std::vector<std::string> RunFileReader::Impl::arrays(bool series) const {
  std::vector<std::string> datasets;
  at.check(
      H5Ovisit2(file.id(), H5_INDEX_NAME, H5_ITER_INC, keep_dataset, &datasets, H5O_INFO_BASIC), "",
      "cannot be searched");
  std::vector<std::string> found;
  for (const std::string& path : datasets) {
    const Handle dataset =
        at.own(H5Dopen2(file.id(), path.c_str(), H5P_DEFAULT), H5Dclose, path, "cannot be opened");
    const Handle space = at.own(H5Dget_space(dataset.id()), H5Sclose, path, "cannot be read");
    if (path == "/time" || H5Sget_simple_extent_ndims(space.id()) != 1) continue;
    if ((H5Aexists(dataset.id(), "DIMENSION_LIST") > 0) == series) found.push_back(path);
  }
  std::sort(found.begin(), found.end());
  return found;
}

RunFileReader::RunFileReader(const std::string& path) : impl_(std::make_unique<Impl>(path)) {
  const QuietErrors quiet;
  impl_->open_file();
  impl_->read_header();
}

RunFileReader::~RunFileReader() = default;
RunFileReader::RunFileReader(RunFileReader&&) noexcept = default;
RunFileReader& RunFileReader::operator=(RunFileReader&&) noexcept = default;

const RunFileHeader& RunFileReader::header() const {
  return impl_->header;
}
const std::vector<double>& RunFileReader::times() const {
  return impl_->times;
}

std::vector<std::string> RunFileReader::series_names() const {
  const QuietErrors quiet;
  return impl_->arrays(true);
}

std::vector<std::string> RunFileReader::static_names() const {
  const QuietErrors quiet;
  return impl_->arrays(false);
}

bool RunFileReader::has(const std::string& path) const {
  const QuietErrors quiet;
  return is_object_path(path) && H5LTpath_valid(impl_->file.id(), path.c_str(), true) > 0;
}

std::vector<double> RunFileReader::series(const std::string& path) const {
  const QuietErrors quiet;
  const std::uint64_t count = impl_->times.size();
  return impl_->read_array(path, &count);
}

std::vector<double> RunFileReader::static_array(const std::string& path) const {
  const QuietErrors quiet;
  return impl_->read_array(path, nullptr);
}

std::string RunFileReader::units(const std::string& path) const {
  const auto all = attributes(path);
  const auto found = all.find("units");
  const std::string* text = found == all.end() ? nullptr : std::get_if<std::string>(&found->second);
  if (text == nullptr) throw FileError(impl_->at.path(), path, "has no attribute 'units'");
  return *text;
}

std::map<std::string, std::variant<std::string, double>> RunFileReader::attributes(
    const std::string& path) const {
  if (!has(path)) throw FileError(impl_->at.path(), path, "is missing");
  const QuietErrors quiet;
  const Handle object = impl_->at.own(H5Oopen(impl_->file.id(), path.c_str(), H5P_DEFAULT),
                                      H5Oclose, path, "cannot be opened");
  return read_attributes(impl_->at, object.id(), path);
}

std::map<std::string, std::variant<std::string, double>> RunFileReader::results() const {
  if (!has("/results")) return {};
  return attributes("/results");
}

}  // namespace stridor
