#include "substructures/elements/viscoelastic_material.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numeric>

namespace stridor {

const Schema& ViscoelasticMaterial::schema() {
  static const Schema keys =
      SchemaOf<ViscoelasticMaterial>("viscoelastic_material")
          .real("rubbery_modulus", &ViscoelasticMaterial::rubbery_modulus,
                {.doc = "Young's modulus E_0 at frequency zero.",
                 .unit = "Pa",
                 .range = Range::positive()})
          .real("glassy_modulus", &ViscoelasticMaterial::glassy_modulus,
                {.doc = "Young's modulus at infinite frequency; above `rubbery_modulus`.",
                 .unit = "Pa",
                 .range = Range::positive()})
          .real("poissons_ratio", &ViscoelasticMaterial::poissons_ratio,
                {.doc = "Poisson's ratio, the same at all frequencies; 0.5 is incompressible.",
                 .range = {-1.0, 0.5, true, false}})
          .real_list("creep_times", &ViscoelasticMaterial::creep_times,
                     {.doc = "Creep (retardation) times; the first is the unit of time in which "
                             "results are made dimensionless.",
                      .unit = "s",
                      .range = Range::positive()})
          .real_list("creep_shares", &ViscoelasticMaterial::creep_shares,
                     {.doc = "Parts of the delayed compliance 1/rubbery_modulus − 1/glassy_modulus "
                             "that belong to the creep times; their sum is 1. Not needed for one "
                             "time.",
                      .range = Range::positive(),
                      .optional = true})
          .check([](const ViscoelasticMaterial& material, std::vector<Problem>& problems) {
            if (material.glassy_modulus <= material.rubbery_modulus) {
              problems.push_back({Refusal::wrong_value, "glassy_modulus",
                                  fmt::format("{:g} Pa must be above rubbery_modulus = {:g} Pa",
                                              material.glassy_modulus, material.rubbery_modulus)});
            }
            if (material.creep_times.empty()) {
              problems.push_back({Refusal::missing, "creep_times", "needs one time or more"});
              return;
            }
            const std::vector<double>& shares = material.creep_shares;
            if (shares.empty() && material.creep_times.size() == 1) return;
            if (shares.size() != material.creep_times.size()) {
              problems.push_back({Refusal::wrong_size, "creep_shares",
                                  fmt::format("has {} entries, `creep_times` {}", shares.size(),
                                              material.creep_times.size())});
              return;
            }
            const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
            if (std::abs(sum - 1.0) > 1e-9) {
              problems.push_back({Refusal::wrong_value, "creep_shares",
                                  fmt::format("must sum to 1, is {:.10g}", sum)});
            }
          });
  return keys;
}

double ViscoelasticMaterial::composite_modulus() const {
  return rubbery_modulus / ((1.0 - poissons_ratio) * (1.0 + poissons_ratio));
}

double ViscoelasticMaterial::creep_weight(std::size_t k) const {
  return (1.0 - modulus_ratio()) * (creep_shares.empty() ? 1.0 : creep_shares[k]);
}

std::complex<double> ViscoelasticMaterial::modulus(double omega) const {
  std::complex<double> compliance = modulus_ratio();
  for (std::size_t k = 0; k < creep_times.size(); ++k)
    compliance += creep_weight(k) / std::complex<double>(1.0, omega * creep_times[k]);
  return rubbery_modulus / compliance;
}

}  // namespace stridor
