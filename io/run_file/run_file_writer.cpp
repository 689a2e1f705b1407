// The part of RunFileWriter that fills files.
#include <fmt/format.h>
#include <hdf5.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <stdexcept>

#include "io/hdf5/hdf5_input.hpp"
#include "io/run_file/run_file_writer_impl.hpp"

namespace stridor {

void RunFileWriter::Impl::write_checkpoint(const State& state) {
  const auto start = std::chrono::steady_clock::now();
  const QuietErrors quiet;
  const std::vector<unsigned char> bytes = encode({num_checkpoints + 1, num_written, state});
  const std::size_t slot = num_checkpoints % checkpoints.size();
  modify([&] {
    write_block(checkpoints[slot], checkpoint_paths[slot], 0, H5T_NATIVE_UCHAR, bytes.data(),
                bytes.size());
    commit(checkpoint_paths[slot]);
  });
  ++num_checkpoints;
  write_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void RunFileWriter::Impl::require_usable() const {
  if (closed) throw std::invalid_argument("run file: written to after close()");
  if (broken)
    throw FileError(Refusal::cannot_write, at.path(), "",
                    "an earlier write failed, nothing more can be written");
}

// HDF5 holds changes in memory and would write them, half done, when the file is closed. After a
// failure they must not reach the file, in which all that was committed is still sound.
void RunFileWriter::Impl::abandon() noexcept {
  broken = true;
  staged.freeze();
}

void RunFileWriter::Impl::commit(const std::string& dataset) {
  at.check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), dataset, "cannot be flushed");
  const int error = restructured ? staged.commit_by_copy() : staged.commit();
  if (error != 0)
    throw FileError(Refusal::cannot_write, at.path(), dataset,
                    "cannot be written: " + errno_text(error));
  restructured = false;
}

// Asks the file system for what the next block needs at most. Nothing has been changed if it
// refuses.
void RunFileWriter::Impl::reserve(std::uint64_t rows) const {
  const std::uint64_t chunk_rows = options.chunk_rows;
  const std::uint64_t chunks_before = (num_written + chunk_rows - 1) / chunk_rows;
  const std::uint64_t chunks_after = (num_written + rows + chunk_rows - 1) / chunk_rows;
  std::uint64_t needed = 0;
  if (chunks_after > chunks_before) {
    const std::uint64_t num_series = columns.size() + 1;
    // 16 KiB per series for the chunk index, 64 KiB for the other metadata.
    needed = (chunks_after - chunks_before) * num_series * chunk_rows * sizeof(double) +
             num_series * 16384 + 65536;
  }
  if (needed == 0) return;
  const int error = staged.reserve(needed);
  if (error == 0) return;
  throw FileError(Refusal::cannot_write, at.path(), "/time",
                  fmt::format("no room for rows {} to {} ({} bytes): {}", num_written,
                              num_written + rows - 1, needed, errno_text(error)));
}

// Writes entries of a one-dimensional dataset, which is made longer where it must be.
void RunFileWriter::Impl::write_block(const Handle& dataset, const std::string& path,
                                      hsize_t offset, hid_t type, const void* entries,
                                      hsize_t count) {
  hsize_t extent = 0;
  {
    const Handle space = at.own(H5Dget_space(dataset.id()), H5Sclose, path, "cannot be written");
    at.check(H5Sget_simple_extent_dims(space.id(), &extent, nullptr), path, "cannot be written");
  }
  if (extent < offset + count) {
    extent = offset + count;
    at.check(H5Dset_extent(dataset.id(), &extent), path, "cannot be extended");
  }
  const Handle target = at.own(H5Dget_space(dataset.id()), H5Sclose, path, "cannot be written");
  at.check(H5Sselect_hyperslab(target.id(), H5S_SELECT_SET, &offset, nullptr, &count, nullptr),
           path, "cannot be written");
  const Handle source =
      at.own(H5Screate_simple(1, &count, nullptr), H5Sclose, path, "cannot be written");
  at.check(H5Dwrite(dataset.id(), type, source.id(), target.id(), H5P_DEFAULT, entries), path,
           "cannot be written");
}

void RunFileWriter::Impl::write_rows(const Handle& dataset, const std::string& path,
                                     SeriesKind kind, std::span<const double> rows) {
  if (kind == SeriesKind::real) {
    write_block(dataset, path, num_written, H5T_NATIVE_DOUBLE, rows.data(), rows.size());
    return;
  }
  states.resize(rows.size());
  std::transform(rows.begin(), rows.end(), states.begin(),
                 [](double x) { return static_cast<std::uint8_t>(x); });
  write_block(dataset, path, num_written, H5T_NATIVE_UINT8, states.data(), states.size());
}

void RunFileWriter::Impl::flush() {
  require_usable();
  const QuietErrors quiet;
  if (restructured) modify([this] { commit(""); });
  if (times.empty()) return;
  const auto start = std::chrono::steady_clock::now();
  if (options.reservation == RunFileOptions::Reservation::on) reserve(times.size());
  modify([this] {
    for (const Column& column : columns) {
      write_rows(column.dataset, column.spec.path, column.spec.kind, column.rows);
    }
    commit("/time");
    write_rows(time_dataset, "/time", SeriesKind::real, times);
    commit("/time");
  });
  num_written += times.size();
  times.clear();
  for (Column& column : columns) column.rows.clear();
  write_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Rows and what is not rows reach the file one after the other, never together: results that say a
// run is done must not be in a file whose last rows are missing.
void RunFileWriter::Impl::settle() {
  require_usable();
  if (!times.empty()) flush();
}

// @return the error, empty if there was none
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
  for (Handle& checkpoint : checkpoints) note(checkpoint.close());
  note(file.close());
  orderly.reset();
  return cause;
}

RunFileWriter::RunFileWriter(const std::string& path, Overwrite overwrite,
                             const RunFileHeader& header, std::vector<SeriesSpec> series,
                             RunFileOptions options, const std::vector<StaticArray>& statics) {
  const QuietErrors quiet;
  for (const StaticArray& array : statics) check_object_path(array.path);
  impl_ = std::make_unique<Impl>(path, std::move(series), options);
  impl_->check_specs();
  impl_->create(overwrite, header, statics);
}

RunFileWriter RunFileWriter::resume(const std::string& path, std::vector<SeriesSpec> series,
                                    const Checkpoint& checkpoint, RunFileOptions options) {
  const QuietErrors quiet;
  RunFileWriter writer;
  writer.impl_ = std::make_unique<Impl>(path, std::move(series), std::move(options));
  writer.impl_->check_specs();
  writer.impl_->reopen(checkpoint);
  return writer;
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
  if (impl.restructured) impl.flush();
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

void RunFileWriter::write_checkpoint(const State& state) {
  impl_->flush();
  impl_->write_checkpoint(state);
}

namespace {

/// "/modal/plate/number", beside an array.
std::string numbers_path(const StaticArray& array) {
  return array.path.substr(0, array.path.rfind('/') + 1) + array.along;
}

}  // namespace

void RunFileWriter::Impl::check_array(const StaticArray& array) const {
  check_object_path(array.path);
  const auto is_there = [&](const std::string& path) {
    return H5LTpath_valid(file.id(), path.c_str(), true) > 0;
  };
  if (is_there(array.path)) {
    throw std::invalid_argument(
        fmt::format("run file: there is a dataset '{}' already", array.path));
  }
  const std::string scale = numbers_path(array);
  if (scale == array.path || !is_there(scale)) return;
  const Hdf5Array numbers = open_array(at, file.id(), scale, 1);
  if (numbers.shape.front() != array.values.size()) {
    throw std::invalid_argument(fmt::format("run file: '{}' has {} entries, its scale '{}' {}",
                                            array.path, array.values.size(), scale,
                                            numbers.shape.front()));
  }
}

void RunFileWriter::Impl::write_array(const StaticArray& array) {
  const Hdf5Writer writer(at, file.id());
  const Handle dataset = writer.write(array.path, array.values, array.units);
  const std::string scale = numbers_path(array);
  if (scale == array.path) {
    writer.make_scale(dataset, array.path);
    return;
  }
  const Handle numbers = H5Lexists(file.id(), scale.c_str(), H5P_DEFAULT) > 0
                             ? open_array(at, file.id(), scale, 1).dataset
                             : writer.write_numbers(scale, array.values.size());
  writer.tie(dataset, array.path, numbers, 0);
}

void RunFileWriter::write_static(const StaticArray& array) {
  Impl& impl = *impl_;
  impl.settle();
  const QuietErrors quiet;
  impl.check_array(array);
  impl.modify([&] {
    impl.write_array(array);
    impl.restructured = true;
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
  impl_->settle();
  impl_->modify([&] { write_result_attribute(impl_->at, impl_->file, impl_->links, name, value); });
  impl_->restructured = true;
}

void RunFileWriter::write_result(const std::string& name, const std::string& value) {
  impl_->settle();
  impl_->modify([&] { write_result_attribute(impl_->at, impl_->file, impl_->links, name, value); });
  impl_->restructured = true;
}

void RunFileWriter::close() {
  Impl& impl = *impl_;
  if (impl.closed) return;
  const QuietErrors quiet;
  std::exception_ptr first;
  if (!impl.broken) {
    try {
      impl.flush();
      impl.staged.trim();
    } catch (const FileError&) {
      first = std::current_exception();
    }
  }
  impl.closed = true;
  // All is in the file; what closing would change is of no use to a reader.
  impl.staged.freeze();
  const std::string cause = impl.close_file();
  if (first) std::rethrow_exception(first);
  if (impl.broken)
    throw FileError(Refusal::cannot_write, impl.at.path(), "",
                    "an earlier write failed, the last rows are missing");
  if (!cause.empty())
    throw FileError(Refusal::cannot_write, impl.at.path(), "", "cannot be closed: " + cause);
}

std::uint64_t RunFileWriter::num_written() const {
  return impl_->num_written;
}

double RunFileWriter::write_seconds() const {
  return impl_->write_seconds;
}

}  // namespace stridor
