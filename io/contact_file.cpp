#include "io/contact_file.hpp"

#include <fmt/format.h>
#include <hdf5.h>
#include <hdf5_hl.h>

#include "core/errors.hpp"
#include "io/hdf5_output.hpp"

namespace stridor {
namespace {

class Writer {
 public:
  Writer(const Checker& at, hid_t file) : at_(at), file_(file) {}

  void make_group(const std::string& path) const {
    at_.own(H5Gcreate2(file_, path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, path,
            "cannot make the group");
  }

  void write(const std::string& path, const std::vector<hsize_t>& shape, const double* values,
             const std::string& units) const {
    at_.check(H5LTmake_dataset_double(file_, path.c_str(), static_cast<int>(shape.size()),
                                      shape.data(), values),
              path, "cannot be written");
    const Handle dataset =
        at_.own(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose, path, "cannot be opened");
    write_attribute(at_, dataset.id(), path, "units", units);
  }

 private:
  const Checker& at_;
  hid_t file_;
};

void write_fields(const Writer& writer, const std::string& group, const ContactFields& fields) {
  writer.make_group(group);
  const std::vector<hsize_t> plane{fields.y.size(), fields.x.size()};
  writer.write(group + "/x", {fields.x.size()}, fields.x.data(), "m");
  writer.write(group + "/y", {fields.y.size()}, fields.y.data(), "m");
  writer.write(group + "/pressure", plane, fields.pressure.data(), "Pa");
  writer.write(group + "/gap", plane, fields.gap.data(), "m");
  if (!fields.edge.empty())
    writer.write(group + "/edge", {fields.edge.size(), 2}, fields.edge.front().data(), "m");
}

}  // namespace

void write_contact_file(const std::string& path, Overwrite overwrite,
                        const std::vector<ContactColumn>& columns,
                        const std::vector<ContactFields>& fields, const Attributes& attributes) {
  const QuietErrors quiet;
  check_output(path, overwrite);
  const Checker at(path);
  PartFile part(path);
  const Handle access = file_access(at);
  Handle file = at.own(H5Fcreate(part.path().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()),
                       H5Fclose, "", "cannot be made");
  part.made();
  write_attribute(at, file.id(), "", "kind", std::string("sliding contacts"));
  for (const auto& [name, value] : attributes) write_attribute(at, file.id(), "", name, value);
  const Writer writer(at, file.id());
  writer.make_group("/rows");
  for (const ContactColumn& column : columns)
    writer.write("/rows/" + column.name, {column.values.size()}, column.values.data(),
                 column.units);
  writer.make_group("/contacts");
  for (std::size_t k = 0; k < fields.size(); ++k)
    write_fields(writer, fmt::format("/contacts/{:03}", k), fields[k]);
  at.check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), "", "cannot be written");
  at.check(file.close(), "", "cannot be closed");
  part.move_to_final(overwrite);
}

}  // namespace stridor
