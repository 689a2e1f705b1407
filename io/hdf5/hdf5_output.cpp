#include "io/hdf5/hdf5_output.hpp"

#include <fmt/format.h>

#include "core/errors.hpp"
#include "io/hdf5/part_file.hpp"

namespace stridor {

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

void Hdf5Writer::make_group(const std::string& path) const {
  at_.own(H5Gcreate2(file_, path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, path,
          "cannot make the group");
}

Handle Hdf5Writer::write(const std::string& path, const std::vector<hsize_t>& shape,
                         const double* values, const std::string& units) const {
  const Handle space =
      at_.own(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose,
              path, "cannot make the dataset");
  Handle dataset = at_.own(H5Dcreate2(file_, path.c_str(), H5T_IEEE_F64LE, space.id(), H5P_DEFAULT,
                                      H5P_DEFAULT, H5P_DEFAULT),
                           H5Dclose, path, "cannot make the dataset");
  at_.check(H5Dwrite(dataset.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), path,
            "cannot be written");
  write_attribute(at_, dataset.id(), path, "units", units);
  return dataset;
}

Handle Hdf5Writer::write(const std::string& path, const std::vector<double>& values,
                         const std::string& units) const {
  return write(path, {values.size()}, values.data(), units);
}

void write_hdf5_file(const std::string& path, Overwrite overwrite, const Attributes& attributes,
                     const std::function<void(const Hdf5Writer&)>& fill) {
  const QuietErrors quiet;
  check_output(path, overwrite);
  const Checker at(path);
  PartFile part(path);
  const Handle access = file_access(at);
  Handle file = at.own(H5Fcreate(part.path().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()),
                       H5Fclose, "", "cannot be made");
  part.made();
  // The file then begins as one of HDF5: should the process die, the next one knows it.
  at.check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), "", "cannot be written");
  for (const auto& [name, value] : attributes) write_attribute(at, file.id(), "", name, value);
  fill(Hdf5Writer(at, file.id()));
  at.check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), "", "cannot be written");
  at.check(file.close(), "", "cannot be closed");
  part.move_to_final(overwrite);
}

}  // namespace stridor
