// State common to the two sources of RunFileWriter: one makes and opens files, one fills them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "io/hdf5/hdf5_output.hpp"
#include "io/hdf5/staged_file.hpp"
#include "io/run_file/run_file.hpp"

namespace stridor {

/// @throws std::invalid_argument unless this is the path of a dataset that users may make
void check_object_path(const std::string& path);

struct RunFileWriter::Impl {
  struct Column {
    SeriesSpec spec;
    Handle dataset;
    std::vector<double> rows;  // not yet written
  };

  Impl(const std::string& path, std::vector<SeriesSpec> specs, RunFileOptions chosen)
      : at(path, Refusal::cannot_write), options(std::move(chosen)), access(staged.access(at)), links(link_creation(at)) {
    for (SeriesSpec& spec : specs) columns.push_back({std::move(spec), {}, {}});
  }
  ~Impl() {
    const QuietErrors quiet;
    staged.freeze();
    if (file.is_open()) close_file();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void check_specs() const;
  void create(Overwrite overwrite, const RunFileHeader& header,
              const std::vector<StaticArray>& statics);
  void reopen(const Checkpoint& checkpoint);
  void create_checkpoints();
  void write_checkpoint(const State& state);
  Handle create_series(const std::string& path, SeriesKind kind, const std::string& units);
  std::optional<std::string> default_series() const;
  void check_array(const StaticArray& array) const;
  void write_array(const StaticArray& array);
  void reserve(std::uint64_t rows) const;
  void write_block(const Handle& dataset, const std::string& path, hsize_t offset, hid_t type,
                   const void* entries, hsize_t count);
  void write_rows(const Handle& dataset, const std::string& path, SeriesKind kind,
                  std::span<const double> rows);
  void flush();
  void settle();
  void require_usable() const;
  template <typename Action>
  void modify(const Action& action);
  void abandon() noexcept;
  void commit(const std::string& dataset);
  std::string close_file();

  /// Rows in memory would be lost.
  std::optional<OrderlyStop> orderly{std::in_place};
  Checker at;
  RunFileOptions options;
  StagedFile staged;
  Handle access;
  Handle links;
  Handle file;
  Handle time_dataset;
  std::vector<Column> columns;
  std::array<Handle, checkpoint_paths.size()> checkpoints;
  std::uint64_t num_checkpoints = 0;
  std::vector<double> times;  // not yet written
  std::vector<std::uint8_t> states;
  std::uint64_t num_written = 0;
  double write_seconds = 0.0;
  bool restructured = false;  // changed otherwise than by rows; no rows are in memory then
  bool closed = false;
  bool broken = false;
};

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

}  // namespace stridor
