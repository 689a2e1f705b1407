// Run files: results of a simulation, as HDF5 that h5py, Octave and ncdump read.
//
//     /                      format, version, commit, command, scene_hash, date
//     /scene/text, resolved  the scene as given and as resolved
//     /scene/digests         of the text and of the files that the scene names, a line each
//     /time                  s; dimension scale of every series
//     /channels/<name>       recorded quantities, thinned
//     /contact/<name>/…      force, gap, slip_velocity, position, state; force_min, force_max,
//                            friction_force_min, friction_force_max, stick_fraction, open_fraction: over every step since the row before;
//                            the attribute `filter` states which are low-passed
//     /energy/…              energy ledger
//     /modal/<body>/…        static arrays
//     /results               numbers computed from the run, as attributes
//     /checkpoint/a, b       the two latest states from which the run can go on, as bytes
//
// A series may be longer than /time while the run goes on, or after it was killed: len(/time) rows
// of every series are complete, later rows are not to be trusted.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "io/hdf5/output_options.hpp"
#include "io/run_file/checkpoint.hpp"

namespace stridor {

/// Number of the layout above; readers refuse files with a higher one.
inline constexpr int run_file_format = 1;

/// Origin of a run. Text is UTF-8 without zero bytes.
struct RunFileHeader {
  std::string version;          ///< of the program
  std::string commit;           ///< of the source
  std::string command;          ///< the command line
  std::string scene_hash;       ///< of the resolved scene and the files that it names
  std::string date;             ///< start of the run, ISO 8601 UTC; see utc_now()
  std::string scene_text;       ///< the scene as given
  std::string scene_resolved;   ///< the scene with all defaults and --set
  std::string scene_digests{};  ///< of the text and the files it names (io/scene/scene_files.hpp)
};

enum class SeriesKind {
  real,   ///< 64-bit floating point
  state,  ///< unsigned 8-bit integer; needs the attribute "meaning"
};

/// One recorded quantity, a value per entry of /time.
struct SeriesSpec {
  std::string path;   ///< "/channels/tip.y.velocity"; groups are made as needed
  std::string units;  ///< "m/s"; "1" where dimensionless
  SeriesKind kind = SeriesKind::real;
  Attributes attributes = {};  ///< e.g. {"filter", "…"}, {"acts_at", "…"}; not "units"
};

/// An array that does not depend on time.
struct StaticArray {
  std::string path;  ///< e.g. "/modal/plate/frequency"
  std::vector<double> values;
  std::string units;
  /// What numbers its entries: a dimension scale in the same group, 1, 2, … where it is not there
  /// yet; or the array itself.
  std::string along = "number";
};

/// Options of a RunFileWriter.
struct RunFileOptions {
  /// Rows kept in memory before they are written and flushed, at least 1.
  std::size_t block_rows = 16384;
  /// Rows to a piece of a series in the file, at least 1.
  std::size_t chunk_rows = 16384;
  /// Space on the disk is asked for before each block, so that a full disk is noticed while nothing
  /// has been changed yet. Switch off on file systems where that is slow.
  enum class Reservation { on, off } reservation = Reservation::on;
  /// Called after every single write to the file, with the file as a reader would find it if the
  /// process died now; for tests.
  std::function<void()> on_write = {};
};

/// Destination of the rows of a recorder.
class RowSink {
 public:
  virtual ~RowSink() = default;
  /// Adds one row: `row` has one entry per series. @throws FileError if it cannot be kept
  virtual void append(double time, std::span<const double> row) = 0;
};

/// Writes a run file in blocks.
///
/// The file is made under the temporary name `<name>.part-<pid>` in the same folder and takes its
/// name when header, datasets and a first flush have succeeded: an existing file is replaced only
/// by a readable one, and a set-up that fails leaves nothing behind. Every block is written
/// channels first, then /time, in an order in which the file is readable after every single write;
/// statics and results go into a copy that then takes the name of the file, after all rows that
/// were appended before them. So a process that is killed at any moment leaves a file that holds
/// the blocks flushed before, and one whose results say how the run ended holds all its rows. A
/// crash of the machine may leave less rows: only what takes a name waits for the disk.
///
/// If a write fails, the rows up to the present len(/time) stay readable. With a failed reservation
/// (disk full) nothing is lost: the rows stay in memory and a later flush() may succeed. After any
/// other failure the writer accepts nothing more.
class RunFileWriter : public RowSink {
 public:
  /// @param path      final name; an existing file is replaced only with Overwrite::yes
  /// @param overwrite whether an existing file may be replaced
  /// @param header    text for root attributes and /scene
  /// @param series    series of append(), in this order; may be empty
  /// @param statics   arrays that the file holds from the moment when it takes its name
  /// @throws FileError if the file exists ("exists; use --force to overwrite it"), is no regular
  ///         file, its folder is missing, no folder or not writable, or anything cannot be written;
  ///         what was there before is untouched then
  /// @throws std::invalid_argument if a path is not of the form /a/b, appears twice or is reserved,
  /// a
  ///         state series has no "meaning", or block_rows is 0
  RunFileWriter(const std::string& path, Overwrite overwrite, const RunFileHeader& header,
                std::vector<SeriesSpec> series, RunFileOptions options = {},
                const std::vector<StaticArray>& statics = {});
  /// Goes on with the file of a run from one of its checkpoints. The next row to append is row
  /// `checkpoint.rows`; rows that the file holds from there on are written over and must come again
  /// as they were. Results of the stopped run (/final, /results, /bursts) are removed.
  ///
  /// @throws FileError if the file cannot be changed, or does not hold these series
  static RunFileWriter resume(const std::string& path, std::vector<SeriesSpec> series,
                              const Checkpoint& checkpoint, RunFileOptions options = {});
  /// Closes without reporting errors; call close() to learn of them.
  ~RunFileWriter() override;
  RunFileWriter(RunFileWriter&&) noexcept;
  RunFileWriter& operator=(RunFileWriter&&) noexcept;

  /// Adds rows; writes and flushes when block_rows have gathered.
  ///
  /// @param time    s, one entry per row
  /// @param columns one span per series, in the order of the constructor, each as long as `time`;
  ///                entries of a state series are integers 0 … 255
  /// @throws FileError if a block cannot be written; see the class comment for what is left
  /// @throws std::invalid_argument if a length or a state is wrong, or after close(); nothing is
  ///         added then
  void append(std::span<const double> time, const std::vector<std::span<const double>>& columns);
  /// Adds one row: `row` has one entry per series. @throws as above
  void append(double time, std::span<const double> row) override;
  /// Writes and flushes the rows in memory. @throws FileError as append()
  void flush();

  /// Writes and flushes the rows in memory and then the state of the run, in place of the last but
  /// one checkpoint: there is a whole one at any moment. @throws FileError as append()
  void write_checkpoint(const State& state);

  /// Writes an array that does not depend on time, e.g. "/modal/plate/frequency", units "Hz". Rows
  /// in memory are written before, like for results.
  /// @throws FileError, std::invalid_argument as the constructor; the latter also if its scale has
  ///         another length
  void write_static(const StaticArray& array);
  /// Writes a result as an attribute of /results; a result of the same name is replaced.
  /// @throws FileError if it cannot be written
  void write_result(const std::string& name, double value);
  void write_result(const std::string& name, const std::string& value);

  /// Flushes and closes. The file is closed in any case, also when this throws. A second call does
  /// nothing. @throws FileError as append()
  void close();

  /// Rows on disk, len(/time).
  std::uint64_t num_written() const;
  /// Time spent in writing blocks so far, s.
  double write_seconds() const;

 private:
  struct Impl;
  RunFileWriter() = default;
  std::unique_ptr<Impl> impl_;
};

/// Reads a run file, also one that is still being written or whose run was killed.
class RunFileReader {
 public:
  /// @throws FileError if the file is missing, unreadable, not HDF5, damaged or truncated, not a
  /// run
  ///         file, or of a newer format
  explicit RunFileReader(const std::string& path);
  ~RunFileReader();
  RunFileReader(RunFileReader&&) noexcept;
  RunFileReader& operator=(RunFileReader&&) noexcept;

  const RunFileHeader& header() const;
  /// Length of every series, as it was when the file was opened.
  std::size_t num_rows() const;
  /// Times of all rows in s; read when they are asked for first. @throws FileError as series()
  const std::vector<double>& times() const;

  /// Paths of all series and of all other one-dimensional arrays but checkpoints, in alphabetical
  /// order.
  std::vector<std::string> series_names() const;
  std::vector<std::string> static_names() const;
  bool has(const std::string& path) const;

  /// A series, cut to num_rows(); states as numbers.
  /// @throws FileError naming the dataset if it is missing, not numeric, not one-dimensional or
  ///         shorter than /time
  std::vector<double> series(const std::string& path) const;
  /// The rows `begin` … `begin + target.size() − 1` of a series or of /time.
  /// @throws FileError as series(); std::invalid_argument if there are no such rows
  void read(const std::string& path, std::size_t begin, std::span<double> target) const;
  /// An array that does not depend on time. @throws FileError as series()
  std::vector<double> static_array(const std::string& path) const;

  /// Attribute `units` of a dataset. @throws FileError if there is none
  std::string units(const std::string& path) const;
  /// All attributes of a dataset or group that are text or one number, by name.
  /// @throws FileError if there is no such object
  std::map<std::string, std::variant<std::string, double>> attributes(
      const std::string& path) const;
  /// The latest whole checkpoint; empty where there is none.
  std::optional<Checkpoint> checkpoint() const;
  /// Attributes of /results; empty if the run has not got that far.
  std::map<std::string, std::variant<std::string, double>> results() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace stridor
