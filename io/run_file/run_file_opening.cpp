// The part of RunFileWriter that makes files, and opens those of interrupted runs.
#include <fmt/format.h>
#include <hdf5.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <stdexcept>

#include "io/hdf5/dataset_names.hpp"
#include "io/hdf5/part_file.hpp"
#include "io/run_file/run_file_writer_impl.hpp"

namespace stridor {
namespace {

// ---------------------------------------------------------------- text and numbers as attributes

// Marked as ASCII though it may hold UTF-8: Octave reads texts of no other kind, and stops at the
// first that it cannot read.
void write_text(const Checker& at, hid_t file, const Handle& links, const std::string& path,
                const std::string& text) {
  const Handle space = at.own(H5Screate(H5S_SCALAR), H5Sclose, path, "cannot make the dataset");
  const Handle type = text_type(at, text.size(), path);
  at.check(H5Tset_cset(type.id(), H5T_CSET_ASCII), path, "cannot make a text type");
  const Handle dataset = at.own(
      H5Dcreate2(file, path.c_str(), type.id(), space.id(), links.id(), H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose, path, "cannot make the dataset");
  at.check(H5Dwrite(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()), path,
           "cannot write");
  write_attribute(at, dataset.id(), path, "encoding", std::string("UTF-8"));
  write_attribute(at, dataset.id(), path, "units", std::string("1"));
  write_attribute(at, dataset.id(), path, "long_name", long_name_of(path));
}

// ---------------------------------------------------------------- the temporary file

// Takes what a run leaves at its end out of its file. In a file of its own, because HDF5 would use
// the room that becomes free again while the file stays open, and StagedFile rules that out.
void remove_results(const Checker& at) {
  StagedFile staged;
  staged.open(at.path());
  const Handle access = staged.access(at);
  Handle file = at.own(H5Fopen(at.path().c_str(), H5F_ACC_RDWR, access.id()), H5Fclose, "",
                       "is damaged or truncated");
  staged.opened();
  bool has_results = false;
  for (const char* path : {"/final", "/results", "/bursts", "/windows"}) {
    if (H5Lexists(file.id(), path, H5P_DEFAULT) <= 0) continue;
    has_results = true;
    at.check(H5Ldelete(file.id(), path, H5P_DEFAULT), path, "cannot be removed");
  }
  if (!has_results) {
    staged.freeze();
    return;
  }
  at.check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), "", "cannot be flushed");
  const int error = staged.commit_by_copy(StagedFile::WithoutRoom::fail);
  staged.freeze();
  if (error == 0) return;
  throw FileError(
      Refusal::cannot_write, at.path(), "",
      fmt::format("results of the stopped run cannot be taken out of it: {}; this takes "
                  "room for a copy of the file beside it, {} bytes. Nothing has changed",
                  errno_text(error), std::filesystem::file_size(at.path())));
}

/// The attributes of a series, with a long name where it brings none.
void write_series_attributes(const Checker& at, hid_t dataset, const SeriesSpec& spec) {
  bool has_long_name = false;
  for (const auto& [name, value] : spec.attributes) {
    has_long_name = has_long_name || name == "long_name";
    write_attribute(at, dataset, spec.path, name, value);
  }
  if (!has_long_name) write_attribute(at, dataset, spec.path, "long_name", long_name_of(spec.path));
}

}  // namespace

void check_object_path(const std::string& path) {
  if (!is_object_path(path)) {
    throw std::invalid_argument(
        fmt::format("run file: '{}' is not a path of the form /group/name", path));
  }
  for (const char* reserved : {"/time", "/results", "/scene", "/checkpoint"}) {
    if (path == reserved || path.starts_with(std::string(reserved) + "/")) {
      throw std::invalid_argument(fmt::format("run file: the path '{}' is reserved", path));
    }
  }
}

void RunFileWriter::Impl::check_specs() const {
  if (options.block_rows == 0)
    throw std::invalid_argument("run file: block_rows must be at least 1");
  if (options.chunk_rows == 0)
    throw std::invalid_argument("run file: chunk_rows must be at least 1");
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
  const hsize_t chunk = options.chunk_rows;
  at.check(H5Pset_chunk(creation.id(), 1, &chunk), path, "cannot make the dataset");
  const hid_t type = kind == SeriesKind::real ? H5T_IEEE_F64LE : H5T_STD_U8LE;
  Handle dataset = at.own(
      H5Dcreate2(file.id(), path.c_str(), type, space.id(), links.id(), creation.id(), H5P_DEFAULT),
      H5Dclose, path, "cannot make the dataset");
  write_attribute(at, dataset.id(), path, "units", units);
  return dataset;
}

/// The series that viewers draw: an acceleration where there is one.
std::optional<std::string> RunFileWriter::Impl::default_series() const {
  for (const Column& column : columns)
    if (column.spec.path.ends_with(".acceleration")) return column.spec.path;
  return columns.empty() ? std::nullopt : std::optional(columns.front().spec.path);
}

void RunFileWriter::Impl::create(Overwrite overwrite, const RunFileHeader& header,
                                 const std::vector<StaticArray>& statics) {
  check_output(at.path(), overwrite);
  PartFile part(at.path());

  staged.create(part.path());
  part.made();
  file = at.own(H5Fcreate(part.path().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), H5Fclose,
                "", "cannot be made");

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
    write_attribute(at, file.id(), "", "kind", std::string("run"));
    write_introduction(at, file.id(),
                       {{"kind", std::string("run")},
                        {"version", header.version},
                        {"commit", header.commit},
                        {"command", header.command}});
    write_text(at, file.id(), links, "/scene/text", header.scene_text);
    write_text(at, file.id(), links, "/scene/resolved", header.scene_resolved);
    write_text(at, file.id(), links, "/scene/digests", header.scene_digests);

    time_dataset = create_series("/time", SeriesKind::real, "s");
    at.check(H5DSset_scale(time_dataset.id(), "time"), "/time", "cannot be made a dimension scale");
    write_attribute(at, time_dataset.id(), "/time", "long_name", long_name_of("/time"));
    for (Column& column : columns) {
      const SeriesSpec& spec = column.spec;
      column.dataset = create_series(spec.path, spec.kind, spec.units);
      write_series_attributes(at, column.dataset.id(), spec);
      at.check(H5DSattach_scale(column.dataset.id(), time_dataset.id(), 0), spec.path,
               "cannot be tied to /time");
    }
    if (const auto series = default_series()) write_default_plot(at, file.id(), *series, {"/time"});
    create_checkpoints();
    for (const StaticArray& array : statics) write_array(array);
    commit("");
    part.move_to_final(overwrite);
    staged.renamed(at.path());
    if (options.on_write) staged.observe(options.on_write);
  } catch (...) {
    abandon();
    close_file();
    throw;
  }
}

void RunFileWriter::Impl::create_checkpoints() {
  constexpr hsize_t none = 0;
  constexpr hsize_t piece = 65536;
  const hsize_t unlimited = H5S_UNLIMITED;
  for (std::size_t i = 0; i < checkpoints.size(); ++i) {
    const char* path = checkpoint_paths[i];
    const Handle space =
        at.own(H5Screate_simple(1, &none, &unlimited), H5Sclose, path, "cannot make the dataset");
    const Handle creation =
        at.own(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, path, "cannot make the dataset");
    at.check(H5Pset_chunk(creation.id(), 1, &piece), path, "cannot make the dataset");
    checkpoints[i] = at.own(H5Dcreate2(file.id(), path, H5T_STD_U8LE, space.id(), links.id(),
                                       creation.id(), H5P_DEFAULT),
                            H5Dclose, path, "cannot make the dataset");
    write_attribute(at, checkpoints[i].id(), path, "units", "1");
    write_attribute(at, checkpoints[i].id(), path, "long_name", long_name_of(path));
    // Its length changes with every checkpoint: a name for its extent, no scale.
    at.check(H5DSset_label(checkpoints[i].id(), 0, "byte"), path, "cannot be labelled");
  }
}

void RunFileWriter::Impl::reopen(const Checkpoint& checkpoint) {
  remove_leftovers(at.path());
  remove_results(at);
  staged.open(at.path());
  file = at.own(H5Fopen(at.path().c_str(), H5F_ACC_RDWR, access.id()), H5Fclose, "",
                "is damaged or truncated");
  staged.opened();
  const auto open_dataset = [this](const std::string& path) {
    return at.own(H5Dopen2(file.id(), path.c_str(), H5P_DEFAULT), H5Dclose, path,
                  "is not in the file");
  };
  time_dataset = open_dataset("/time");
  for (Column& column : columns) column.dataset = open_dataset(column.spec.path);
  for (std::size_t i = 0; i < checkpoints.size(); ++i)
    checkpoints[i] = open_dataset(checkpoint_paths[i]);
  num_checkpoints = checkpoint.number;
  num_written = checkpoint.rows;
  if (options.on_write) staged.observe(options.on_write);
}

}  // namespace stridor
