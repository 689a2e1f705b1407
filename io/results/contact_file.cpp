#include "io/results/contact_file.hpp"

#include <fmt/format.h>

#include "io/hdf5/hdf5_output.hpp"

namespace stridor {
namespace {

void write_fields(const Hdf5Writer& writer, const std::string& group, const ContactFields& fields) {
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
  Attributes all{{"kind", std::string("sliding contacts")}};
  all.insert(all.end(), attributes.begin(), attributes.end());
  write_hdf5_file(path, overwrite, all, [&](const Hdf5Writer& writer) {
    writer.make_group("/rows");
    for (const ContactColumn& column : columns)
      writer.write("/rows/" + column.name, column.values, column.units);
    writer.make_group("/contacts");
    for (std::size_t k = 0; k < fields.size(); ++k)
      write_fields(writer, fmt::format("/contacts/{:03}", k), fields[k]);
  });
}

}  // namespace stridor
