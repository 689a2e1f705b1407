#include "app/results/body_report.hpp"

#include <fmt/format.h>

namespace stridor {

Json matrix_bodies_json(const Model& model) {
  Json bodies = Json::object();
  for (const SystemBody& body : model.system.bodies) {
    const auto found = model.substructures.find(body.name);
    if (found == model.substructures.end() || found->second->own_damping() != nullptr) continue;
    if (body.modal.coupled.is_empty()) {
      bodies[body.name] = {{"damping", "proportional"},
                           {"alpha", number(body.modal.damping.alpha)},
                           {"beta", number(body.modal.damping.beta)}};
    } else {
      bodies[body.name] = {{"damping", "coupled"}, {"modes", body.modal.size()}};
    }
  }
  return bodies;
}

void print_matrix_bodies(const Json& bodies) {
  for (const auto& [name, body] : bodies.items()) {
    if (body["damping"] == "proportional") {
      fmt::print("{}: damping is proportional, alpha {:.6g} 1/s, beta {:.6g} s\n", name,
                 body["alpha"].get<double>(), body["beta"].get<double>());
    } else {
      fmt::print(
          "{}: damping that is not proportional, gyroscopic or circulatory terms couple its {} "
          "modes\n",
          name, body["modes"].get<int>());
    }
  }
}

}  // namespace stridor
