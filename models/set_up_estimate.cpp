#include "models/set_up_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"

// Largest resident sizes measured beyond the 28 MB of a small scene, and what the formulas say:
//
//   beam of 8000 x 1 elements, 202 interface unknowns, 20 modes    292 MB    347 MB
//   beam of 200 x 200 elements, otherwise the same               1183 MB   1644 MB
//   boundary elements, 512 x 512 cells                              74 MB     94 MB

namespace stridor {
namespace {

constexpr double number = dense_entry_bytes;
constexpr double sparse_entry = sparse_entry_bytes;

/// "3.2e+06", "1,200": numbers of things, short.
std::string count_text(double count) {
  return count < 1e5 ? fmt::format("{:.0f}", count) : fmt::format("{:.3g}", count);
}

std::string duration_text(double seconds) {
  if (seconds < 90.0) return fmt::format("{:.0f} s", seconds);
  if (seconds < 5400.0) return fmt::format("{:.0f} min", seconds / 60.0);
  if (seconds < 172800.0) return fmt::format("{:.0f} h", seconds / 3600.0);
  return fmt::format("{:.0f} days", seconds / 86400.0);
}

void append(SetUpEstimate& whole, const SetUpEstimate& part) {
  whole.parts.insert(whole.parts.end(), part.parts.begin(), part.parts.end());
  whole.operations += part.operations;
}

/// Nodes of a body that the contacts of a scene keep.
double num_interface_nodes(const ModelParameters& model, const std::string& name,
                           const BodyParameters& body) {
  const std::string prefix = name + ".";
  double nodes = 0.0;
  for (const auto& [pair_name, pair] : model.pairs()) {
    if (pair.master.starts_with(prefix))
      nodes += body.num_master_nodes(pair.master.substr(prefix.size()));
    for (const std::string& slave : pair.slave)
      if (slave.starts_with(prefix)) nodes += body.num_slave_nodes(slave.substr(prefix.size()));
  }
  return nodes;
}

}  // namespace

double SetUpEstimate::bytes() const {
  double sum = 0.0;
  for (const MemoryPart& part : parts) sum += part.bytes;
  return sum;
}

double SetUpEstimate::seconds() const {
  constexpr double operations_per_second = 4e9;
  return operations / operations_per_second;
}

SetUpEstimate estimate_reduction(const ReductionSize& size, const std::string& key,
                                 const SizeKey& of_size) {
  const double n = size.unknowns;
  const double nb = size.interface;
  const double m = size.modes;
  const double reduced = nb + m;
  SetUpEstimate estimate;
  const SizeKey of_modes{".reduction.fixed_interface_modes", "keep fewer modes"};
  const auto add = [&](const SizeKey& cause, std::string what, double bytes) {
    estimate.parts.push_back({key + cause.key, std::move(what), cause.remedy, bytes});
  };
  // Kept by the cache, by the body, and split into inside and interface.
  constexpr double copies = 3.0;
  add(of_size, fmt::format("mass and stiffness of {} unknowns", count_text(n + nb)),
      copies * sparse_entry * size.matrix_entries);
  // While the matrices are assembled nothing else is there; after that the factor, and either the
  // Krylov space of the modes, or the modes with the constraint modes.
  constexpr double krylov_room = 240.0;  // see Lanczos in lowest_modes.cpp
  const double krylov_width = m > 0.0 ? std::min(n, 3.0 * m + krylov_room) : 0.0;
  const double krylov = number * n * (krylov_width + 2.0 * m + 24.0);
  const double constraint = number * n * (nb + std::min(nb, 40.0) + 2.0 * m);
  const double factor = 1.3 * number * size.factor_entries;
  if (size.assembly_bytes > factor + std::max(krylov, constraint)) {
    add(of_size, "the element matrices before they are summed", size.assembly_bytes);
  } else {
    add(of_size,
        fmt::format("the factor of the stiffness, {} entries", count_text(size.factor_entries)),
        factor);
    if (krylov > constraint) {
      add(3.0 * m > krylov_room ? of_modes : of_size,
          fmt::format("a Krylov space of {} vectors of {} unknowns for {} modes",
                      count_text(krylov_width), count_text(n), count_text(m)),
          krylov);
    } else {
      add(of_size,
          fmt::format("constraint modes of {} interface unknowns, each of {} unknowns",
                      count_text(nb), count_text(n)),
          constraint);
    }
  }
  // Mass, stiffness, shapes and rows, in the cache and in the system; the eigensolver takes as much
  // again as they are.
  add(nb >= m ? of_size : of_modes,
      fmt::format("dense matrices of the {} reduced unknowns", count_text(reduced)),
      number * reduced * (9.0 * reduced + 4.0 * size.watched));

  const double per_solve = 4.0 * size.factor_entries;
  const double num_solves = nb + (m > 0.0 ? 2.0 * m + 40.0 : 0.0);
  const double entries_per_column = n > 0.0 ? size.factor_entries / n : 0.0;
  estimate.operations = n * entries_per_column * entries_per_column + num_solves * per_solve +
                        4.0 * n * krylov_width * krylov_width + n * nb * (nb + 2.0 * m) +
                        25.0 * reduced * reduced * reduced;
  return estimate;
}

SetUpEstimate estimate_set_up(const ModelParameters& model) {
  SetUpEstimate whole;
  for (const auto& [name, body] : model.substructures) {
    const double nodes = num_interface_nodes(model, name, *body);
    append(whole, estimate_reduction(body->reduction_size(nodes), "substructures." + name,
                                     body->size_key()));
  }
  return whole;
}

SetUpEstimate estimate_set_up(const SlidingContactParameters& contact, const std::string& key) {
  const auto cells = static_cast<double>(contact.grid);
  SetUpEstimate estimate;
  constexpr double numbers_per_cell = 45.0;
  estimate.parts.push_back(
      {key + ".grid",
       fmt::format("fields and influence coefficients of {0:.0f} x {0:.0f} cells", cells),
       "take a coarser grid", number * numbers_per_cell * cells * cells});
  return estimate;
}

void require_memory(const SetUpEstimate& estimate, const MemoryLimit& limit) {
  const double needed = estimate.bytes();
  if (estimate.parts.empty() || needed <= limit.bytes) return;
  const auto largest =
      std::max_element(estimate.parts.begin(), estimate.parts.end(),
                       [](const MemoryPart& a, const MemoryPart& b) { return a.bytes < b.bytes; });
  throw ConfigError(
      Refusal::too_large, largest->key,
      fmt::format("the set-up would take about {} of memory and {} of time, but {} is {}; the most "
                  "of it, {}, is for {}; {}",
                  memory_text(needed), duration_text(estimate.seconds()), limit.source,
                  memory_text(limit.bytes), memory_text(largest->bytes), largest->what,
                  largest->remedy));
}

void require_memory_for(const MemoryPart& results, const MemoryLimit& limit) {
  if (results.bytes <= limit.bytes) return;
  throw ConfigError(Refusal::too_large, results.key,
                    fmt::format("{} would take about {} of memory, but {} is {}; {}", results.what,
                                memory_text(results.bytes), limit.source, memory_text(limit.bytes),
                                results.remedy));
}

}  // namespace stridor
