#include "io/hdf5/hdf5_output.hpp"

#include <fmt/format.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <numeric>

#include "core/errors.hpp"
#include "io/hdf5/dataset_names.hpp"
#include "io/hdf5/part_file.hpp"

namespace stridor {

Handle link_creation(const Checker& at) {
  Handle links = at.own(H5Pcreate(H5P_LINK_CREATE), H5Pclose, "", "cannot set up HDF5");
  at.check(H5Pset_create_intermediate_group(links.id(), 1), "", "cannot set up HDF5");
  at.check(H5Pset_char_encoding(links.id(), H5T_CSET_UTF8), "", "cannot set up HDF5");
  return links;
}

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

Handle Hdf5Writer::write(const std::string& path, const std::vector<hsize_t>& shape,
                         const double* values, const std::string& units) const {
  const Handle space =
      at_.own(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose,
              path, "cannot make the dataset");
  Handle dataset = at_.own(H5Dcreate2(file_, path.c_str(), H5T_IEEE_F64LE, space.id(), links_.id(),
                                      H5P_DEFAULT, H5P_DEFAULT),
                           H5Dclose, path, "cannot make the dataset");
  at_.check(H5Dwrite(dataset.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), path,
            "cannot be written");
  write_attribute(at_, dataset.id(), path, "units", units);
  write_attribute(at_, dataset.id(), path, "long_name", long_name_of(path));
  return dataset;
}

Handle Hdf5Writer::write_numbers(const std::string& path, std::size_t count) const {
  std::vector<double> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 1.0);
  Handle dataset = write(path, numbers, "1");
  make_scale(dataset, path);
  return dataset;
}

Handle Hdf5Writer::write_texts(const std::string& path,
                               const std::vector<std::string>& texts) const {
  std::size_t longest = 0;
  for (const std::string& text : texts) longest = std::max(longest, text.size());
  const hsize_t count = texts.size();
  const Handle space =
      at_.own(H5Screate_simple(1, &count, nullptr), H5Sclose, path, "cannot make the dataset");
  const Handle type = text_type(at_, longest, path);
  // Marked as ASCII though it may hold UTF-8: Octave stops at the first text of another kind.
  at_.check(H5Tset_cset(type.id(), H5T_CSET_ASCII), path, "cannot make a text type");
  Handle dataset = at_.own(
      H5Dcreate2(file_, path.c_str(), type.id(), space.id(), links_.id(), H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose, path, "cannot make the dataset");
  std::string stored(texts.size() * (longest + 1), '\0');
  for (std::size_t i = 0; i < texts.size(); ++i) texts[i].copy(&stored[i * (longest + 1)], longest);
  if (!texts.empty()) {
    at_.check(H5Dwrite(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, stored.data()), path,
              "cannot be written");
  }
  write_attribute(at_, dataset.id(), path, "encoding", std::string("UTF-8"));
  write_attribute(at_, dataset.id(), path, "units", std::string("1"));
  write_attribute(at_, dataset.id(), path, "long_name", long_name_of(path));
  return dataset;
}

void Hdf5Writer::make_scale(const Handle& dataset, const std::string& path) const {
  const std::string name = path.substr(path.rfind('/') + 1);
  at_.check(H5DSset_scale(dataset.id(), name.c_str()), path, "cannot be made a dimension scale");
}

void Hdf5Writer::tie(const Handle& dataset, const std::string& path, const Handle& scale,
                     unsigned extent) const {
  at_.check(H5DSattach_scale(dataset.id(), scale.id(), extent), path, "cannot be tied to its scale");
}

void Hdf5Writer::make_default_plot(const std::string& signal,
                                   const std::vector<std::string>& axes) const {
  write_default_plot(at_, file_, signal, axes);
}

void write_introduction(const Checker& at, hid_t file, const Attributes& attributes) {
  const auto text = [&](const std::string& name) -> std::string {
    for (const auto& [known, value] : attributes) {
      const std::string* found = std::get_if<std::string>(&value);
      if (known == name && found != nullptr) return *found;
    }
    return "";
  };
  const std::string scene =
      text("scene").empty() ? scene_of_command(text("command")) : text("scene");
  const std::string title =
      text("kind") + (scene.empty() ? "" : " of " + scene.substr(scene.rfind('/') + 1));
  const std::string source =
      text("version").empty() ? "" : fmt::format("stridor {} ({})", text("version"), text("commit"));
  for (const auto& [name, value] :
       {std::pair{"title", title}, std::pair{"history", text("command")}, std::pair{"source", source}})
    if (!value.empty()) write_attribute(at, file, "", name, value);
}

void write_default_plot(const Checker& at, hid_t file, const std::string& signal,
                        const std::vector<std::string>& axes) {
  constexpr const char* group_path = "/plot";
  const auto name_of = [](const std::string& path) {
    return path.empty() ? std::string(".") : path.substr(path.rfind('/') + 1);
  };
  const Handle group = at.own(H5Gcreate2(file, group_path, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                              H5Gclose, group_path, "cannot make the group");
  write_attribute(at, file, "", "default", name_of(group_path));
  write_attribute(at, group.id(), group_path, "NX_class", std::string("NXdata"));
  write_attribute(at, group.id(), group_path, "signal", name_of(signal));
  std::size_t longest = 1;
  for (const std::string& axis : axes) longest = std::max(longest, name_of(axis).size());
  const hsize_t count = axes.size();
  const Handle space =
      at.own(H5Screate_simple(1, &count, nullptr), H5Sclose, group_path, "cannot make an attribute");
  const Handle type = text_type(at, longest, group_path);
  std::string stored(axes.size() * (longest + 1), '\0');
  for (std::size_t i = 0; i < axes.size(); ++i)
    name_of(axes[i]).copy(&stored[i * (longest + 1)], longest);
  const Handle attribute =
      at.own(H5Acreate2(group.id(), "axes", type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT),
             H5Aclose, group_path, "cannot write attribute 'axes'");
  at.check(H5Awrite(attribute.id(), type.id(), stored.data()), group_path,
           "cannot write attribute 'axes'");
  std::vector<std::string> linked{signal};
  linked.insert(linked.end(), axes.begin(), axes.end());
  for (const std::string& path : linked) {
    if (path.empty()) continue;
    at.check(H5Lcreate_soft(path.c_str(), group.id(), name_of(path).c_str(), H5P_DEFAULT, H5P_DEFAULT),
             group_path, "cannot link a dataset");
  }
}

Handle Hdf5Writer::write(const std::string& path, const std::vector<double>& values,
                         const std::string& units) const {
  return write(path, {values.size()}, values.data(), units);
}

void write_hdf5_file(const std::string& path, Overwrite overwrite, const Attributes& attributes,
                     const std::function<void(const Hdf5Writer&)>& fill) {
  const QuietErrors quiet;
  check_output(path, overwrite);
  const Checker at(path, Refusal::cannot_write);
  PartFile part(path);
  const Handle access = file_access(at);
  Handle file = at.own(H5Fcreate(part.path().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()),
                       H5Fclose, "", "cannot be made");
  part.made();
  // The file then begins as one of HDF5: should the process die, the next one knows it.
  at.check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), "", "cannot be written");
  for (const auto& [name, value] : attributes) write_attribute(at, file.id(), "", name, value);
  write_introduction(at, file.id(), attributes);
  fill(Hdf5Writer(at, file.id()));
  at.check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), "", "cannot be written");
  at.check(file.close(), "", "cannot be closed");
  part.move_to_final(overwrite);
}

}  // namespace stridor
