#include "io/results/contact_file.hpp"

#include <fmt/format.h>

#include <optional>
#include <tuple>
#include <utility>

#include "io/hdf5/hdf5_output.hpp"

namespace stridor {
namespace {

void write_fields(const Hdf5Writer& writer, const std::string& group, const ContactFields& fields) {
  const std::vector<hsize_t> plane{fields.y.size(), fields.x.size()};
  const Handle x = writer.write(group + "/x", fields.x, "m");
  const Handle y = writer.write(group + "/y", fields.y, "m");
  writer.make_scale(x, group + "/x");
  writer.make_scale(y, group + "/y");
  for (const auto& [name, values, units] : {std::tuple{"/pressure", &fields.pressure, "Pa"},
                                            std::tuple{"/gap", &fields.gap, "m"}}) {
    const Handle field = writer.write(group + name, plane, values->data(), units);
    writer.tie(field, group + name, y, 0);
    writer.tie(field, group + name, x, 1);
  }
  if (fields.edge.empty()) return;
  const Handle point = writer.write_numbers(group + "/edge_point", fields.edge.size());
  for (const auto& [name, along] : {std::pair{"/edge_x", 0U}, std::pair{"/edge_y", 1U}}) {
    std::vector<double> places;
    for (const auto& at : fields.edge) places.push_back(at[along]);
    writer.tie(writer.write(group + name, places, "m"), group + name, point, 0);
  }
}

}  // namespace

void write_contact_file(const std::string& path, Overwrite overwrite,
                        const std::vector<ContactColumn>& columns,
                        const std::vector<ContactFields>& fields, const Attributes& attributes) {
  Attributes all{{"kind", std::string("sliding contacts")}};
  all.insert(all.end(), attributes.begin(), attributes.end());
  write_hdf5_file(path, overwrite, all, [&](const Hdf5Writer& writer) {
    std::optional<Handle> speed;
    for (const ContactColumn& column : columns) {
      const std::string dataset = "/rows/" + column.name;
      Handle written = writer.write(dataset, column.values, column.units);
      if (column.name == "speed") {
        writer.make_scale(written, dataset);
        speed = std::move(written);
      } else if (speed) {
        writer.tie(written, dataset, *speed, 0);
      }
    }
    for (std::size_t k = 0; k < fields.size(); ++k)
      write_fields(writer, fmt::format("/contacts/{:03}", k), fields[k]);
    if (!fields.empty()) {
      writer.make_default_plot("/contacts/000/pressure", {"/contacts/000/y", "/contacts/000/x"});
    }
  });
}

}  // namespace stridor
