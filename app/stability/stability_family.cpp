#include "app/stability/stability_family.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

#include "analysis/counted_spectra.hpp"
#include "app/stability/found_spectrum.hpp"
#include "app/stability/key_range.hpp"
#include "app/stability/verdict.hpp"
#include "core/blas.hpp"
#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "solvers/eigenvalues/full_spectrum.hpp"
#include "solvers/eigenvalues/residual_modes.hpp"
#include "solvers/integrators/retained_modes.hpp"

namespace stridor {

PencilFamily StabilityFamily::along(std::size_t key, std::vector<double> values, double from,
                                    double to) {
  PencilFamily along;
  values[key] = from;
  along.kinks = kinks(key, values, from, to);
  along.place = [this, key, values](double value, Pencil& placed) mutable {
    if (stop_requested()) throw Interrupted("nothing has been written");
    values[key] = value;
    placed = pencil(values);
    if (report_) report_(value);
  };
  return along;
}

SpectrumFamily StabilityFamily::spectra(std::size_t key, const std::vector<double>& values,
                                        const LocusOptions& options,
                                        std::optional<std::pair<double, double>> range) {
  SpectrumFamily family = counted_spectra(
      [this, key, at = values](double value) mutable {
        at[key] = value;
        return sparse_system(at);
      },
      options.window, std::move(range));
  for (auto* spectrum : {&family.at, &family.near}) {
    *spectrum = [this, found_at = std::move(*spectrum)](double value) {
      if (stop_requested()) throw Interrupted("nothing has been written");
      SampledSpectrum found = found_at(value);
      if (report_) report_(value);
      return found;
    };
  }
  family.around = [this, found_around = std::move(family.around)](double value,
                                                                  std::complex<double> place) {
    if (stop_requested()) throw Interrupted("nothing has been written");
    SampledSpectrum found = found_around(value, place);
    if (report_) report_(value);
    return found;
  };
  return family;
}

BodyStabilityFamily::BodyStabilityFamily(const LoadedScene& loaded, std::vector<NumericKey> keys,
                                         ContactGeometry geometry)
    : family_(loaded, std::move(keys)),
      time_(loaded.scene.time),
      terms_(kept_terms(loaded.scene)),
      geometry_(geometry),
      start_key_(start_key(loaded.scene.model)) {}

std::string BodyStabilityFamily::values_text(std::span<const double> values) const {
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i)
    text += (i > 0 ? ", " : "") + value_text(family_.keys()[i], values[i]);
  return text;
}

SlidingState BodyStabilityFamily::at(const SceneFamily::Member& member,
                                     std::span<const double> values) {
  const BlasGuard guard;
  SlidingState state = sliding_state_of(member, geometry_, terms_, values_text(values));
  // Once for all values: it takes much longer than a pencil, and a branch must not change its
  // modes.
  if (!asked_) asked_ = asked_frequency(member.model->system, time_);
  if (std::isfinite(*asked_) && has_contacts(state.pencil))
    state.pencil = with_residual_modes(state.pencil, *asked_);
  return state;
}

double BodyStabilityFamily::trusted_frequency(std::span<const double> values) {
  const BlasGuard guard;
  const Model& model = *family_.at(values).model;
  if (model.sparse) return std::numeric_limits<double>::infinity();
  const System& system = model.system;
  if (!asked_) asked_ = asked_frequency(system, time_);
  return std::min(*asked_ / (2.0 * std::numbers::pi), stridor::trusted_frequency(system));
}

SpectrumMethod BodyStabilityFamily::method(std::span<const double> values) {
  const BlasGuard guard;
  const Model& model = *family_.at(values).model;
  if (model.sparse) return SpectrumMethod::counted;
  // Bodies that spin couple their modes, of which there are few: all eigenvalues cost less than to
  // follow some.
  const bool is_sampled = model.system.contacts.empty() || model.system.has_faces();
  if (!is_sampled) return SpectrumMethod::followed;
  constexpr Eigen::Index many_modes = 300;  // half a second for all eigenvalues of one value
  Eigen::Index num_modes = 0;
  for (const SystemBody& body : model.system.bodies) num_modes += body.modal.size();
  if (num_modes < many_modes) return SpectrumMethod::sampled;
  const auto& contacts = model.system.contacts;
  const bool all_give_way =
      std::all_of(contacts.begin(), contacts.end(), [](const ContactPoint& contact) {
        return contact.compliance() > 0.0 || contact.substrate;
      });
  return all_give_way ? SpectrumMethod::from_neighbours : SpectrumMethod::sampled;
}

SparseSystem BodyStabilityFamily::sparse_system(std::span<const double> values) {
  const SceneFamily::Member member = family_.at(values);
  if (member.model->sparse) return *member.model->sparse;
  const BlasGuard guard;
  return modal_system(at(member, values).pencil);
}

/// Places at which a contact passes a master node, if the place is what varies: positions of the
/// only contact, displacements of the drive. Of the latter those in the undeformed geometry, which
/// deformation shifts.
std::vector<double> BodyStabilityFamily::kinks(std::size_t key, const std::vector<double>& values,
                                               double from, double to) {
  std::vector<double> found;
  const std::string& path = family_.keys()[key].path;
  const bool is_driven = path == drive_displacement_name;
  if (!is_driven && (!start_key_ || path != *start_key_)) return found;
  const BlasGuard guard;
  const System& system = family_.at(values).model->system;
  if (is_driven) {
    if (geometry_ == ContactGeometry::deformed) return found;
    found = kinks_along_drive(system);
    std::erase_if(found, [&](double place) { return place <= from || place >= to; });
    return found;
  }
  const MasterSurface& surface =
      system.surfaces[static_cast<std::size_t>(system.contacts.front().surface)];
  std::copy_if(surface.arc_length.begin(), surface.arc_length.end(), std::back_inserter(found),
               [&](double node) { return node > from && node < to; });
  return found;
}

double trusted_along(StabilityFamily& family, const std::vector<double>& range) {
  return std::min(family.trusted_frequency(std::array{range.front()}),
                  family.trusted_frequency(std::array{range.back()}));
}

}  // namespace stridor
