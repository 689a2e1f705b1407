#include "models/reduction_error.hpp"

#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

#include "core/activity.hpp"
#include "core/stop_token.hpp"
#include "models/model_body.hpp"
#include "models/placed_model.hpp"
#include "solvers/eigenvalues/frequency_response.hpp"
#include "solvers/eigenvalues/sparse_pencil.hpp"
#include "substructures/bodies/whole_body.hpp"

namespace stridor {
namespace {

/// Fractions of the frequency up to which a reduction is trusted.
std::vector<double> default_frequencies(const ReducedBody& reduced) {
  const Eigen::Index n = reduced.size();
  if (n == reduced.num_interface)
    throw std::invalid_argument("reduction_error: without modes frequencies must be given");
  // The stiffness of fixed-interface modes is diagonal and ascends.
  const double highest = std::sqrt(reduced.stiffness(n - 1, n - 1)) / (2.0 * std::numbers::pi);
  std::vector<double> frequencies;
  for (const double share : {1.0 / 16.0, 1.0 / 8.0, 0.25, 0.5, 1.0})
    frequencies.push_back(0.5 * share * highest);
  return frequencies;
}

/// The displacements of DoFs per forces on them, of the full body.
Eigen::MatrixXcd full_response(const SparsePencil& pencil, const std::vector<int>& dofs,
                               std::complex<double> s) {
  const auto count = static_cast<Eigen::Index>(dofs.size());
  Eigen::MatrixXcd forces = Eigen::MatrixXcd::Zero(pencil.size(), count);
  for (Eigen::Index i = 0; i < count; ++i) forces(dofs[static_cast<std::size_t>(i)], i) = 1.0;
  const Eigen::MatrixXcd motion = pencil.factorise(s).solve(forces);
  Eigen::MatrixXcd response(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    response.row(i) = motion.row(dofs[static_cast<std::size_t>(i)]);
  return response;
}

/// DoFs of an interface at equal distances of its order.
std::vector<int> compared_dofs(const std::vector<int>& interface) {
  if (interface.size() <= most_compared_dofs) return interface;
  std::vector<int> dofs;
  for (std::size_t i = 0; i < most_compared_dofs; ++i)
    dofs.push_back(interface[i * interface.size() / most_compared_dofs]);
  return dofs;
}

}  // namespace

ReductionError reduction_error(const BodyMatrices& body, std::span<const int> interface,
                               const std::vector<int>& dofs,
                               const BodyCache::Reduction& reduction,
                               const std::vector<double>& frequencies) {
  ReductionError error;
  error.num_unknowns = body.num_dofs();
  error.num_interface = static_cast<Eigen::Index>(interface.size());
  error.num_modes = reduction.reduced.size() - reduction.reduced.num_interface;
  if (reduction.reduced.interface_modes.size() > 0)
    error.num_interface_modes = reduction.reduced.num_interface;
  error.dofs = dofs;
  error.frequencies = frequencies.empty() ? default_frequencies(reduction.reduced) : frequencies;

  System alone;
  SystemBody& only = alone.bodies.emplace_back();
  only.reduced = reduction.reduced;
  only.modal = reduction.modal;
  const Eigen::MatrixXd& rows = only.modal.rows;
  const FrequencyResponse reduced(make_modal_pencil(alone), rows, rows);
  const SparsePencil full(make_sparse(body));
  for (const double frequency : error.frequencies) {
    throw_if_stopped();
    const std::complex<double> s(0.0, 2.0 * std::numbers::pi * frequency);
    const Eigen::MatrixXcd expected = full_response(full, dofs, s);
    error.errors.push_back((reduced.at(s) - expected).norm() / expected.norm());
  }
  return error;
}

std::vector<ReductionError> reduction_errors(const ModelParameters& parameters,
                                             const std::vector<double>& frequencies,
                                             BodyCache& cache) {
  std::vector<ReductionError> errors;
  PlacedModel placed = place_model(parameters, cache);
  for (ModelBody& body : placed.bodies) {
    if (body.parameters == nullptr || !body.parameters->num_modes()) continue;
    for (const int dof : body.matrices.kept) body.keep(dof);
    const bool has_default = *body.parameters->num_modes() > 0;
    if (body.interface.empty() || (frequencies.empty() && !has_default)) continue;
    check_reduction(body, *body.parameters->num_modes());
    const Activity comparing(fmt::format("comparing '{}' with its full model", body.name));
    body.matrices.loss_stiffness.resize(0, 0);
    const std::vector<int> dofs = compared_dofs(body.interface);
    // Not through the cache, whose key does not know of the damping that was left out.
    BodyCache alone(1);
    const BodyCache::Reduction reduction =
        alone.reduce({body.parameters, &body.matrices, false, body.interface,
                      *body.parameters->num_modes(), dofs, body.parameters->interface_modes()});
    errors.push_back(reduction_error(body.matrices, body.interface, dofs, reduction, frequencies));
    errors.back().body = body.name;
  }
  return errors;
}

}  // namespace stridor
