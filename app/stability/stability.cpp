#include "app/stability/stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "analysis/counted_spectra.hpp"
#include "analysis/sampled_locus.hpp"
#include "app/stability/eigenvalue_report.hpp"
#include "app/stability/found_spectrum.hpp"
#include "app/stability/growth_of_mass.hpp"
#include "app/terminal/remark.hpp"
#include "core/blas.hpp"
#include "core/errors.hpp"
#include "core/memory.hpp"
#include "core/stop_token.hpp"
#include "models/set_up_estimate.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/eigenvalues/search_failure.hpp"
#include "solvers/eigenvalues/secular_eigenvalues.hpp"
#include "solvers/integrators/retained_modes.hpp"

namespace stridor {
namespace {

/// Displacement of a point of a body, without that of the drive.
Json displacement_json(const System& system, const Equilibrium& equilibrium, int body,
                       const PointRows& rows) {
  const auto b = static_cast<std::size_t>(body);
  const Eigen::MatrixXd& shapes = system.bodies[b].modal.rows;
  const Eigen::VectorXd& modal = equilibrium.displacement[b];
  return {number(shapes.row(rows.x).dot(modal)), number(shapes.row(rows.y).dot(modal))};
}

const char* range_text(LawRange range) {
  switch (range) {
    case LawRange::inside:
      return "inside";
    case LawRange::no_contact:
      return "no contact";
    case LawRange::too_deep:
      return "deeper than the contact law was made for (y/R > 0.3)";
    case LawRange::beyond_data:
      return "at a speed or indentation beyond the data of the contact law";
  }
  return "";
}

/// On the face of a body.
Json face_contact_json(const System& system, const Equilibrium& equilibrium, std::size_t i) {
  const ContactEquilibrium& contact = equilibrium.contacts[i];
  const ContactPoint& point = system.contacts[i];
  const FacePlace& face = *point.face;
  return {{"closed", contact.is_closed},
          {"force", number(contact.force)},
          {"friction_force", number(contact.friction_force)},
          {"friction_across", number(contact.friction_across)},
          {"friction", number(contact.friction)},
          {"velocity", {number(contact.velocity.x()), number(contact.velocity.y())}},
          {"slip_velocity", number(contact.slip_velocity)},
          {"gap", number(contact.gap)},
          {"radius", face.radius},
          {"angle", face.angle},
          {"displacement",
           displacement_json(system, equilibrium, point.slave_body, point.slave_rows)}};
}

Json contact_json(const System& system, const Equilibrium& equilibrium, std::size_t i) {
  const ContactEquilibrium& contact = equilibrium.contacts[i];
  const ContactPoint& point = system.contacts[i];
  if (point.face) return face_contact_json(system, equilibrium, i);
  Json object = {
      {"closed", contact.is_closed},
      {"force", number(contact.force)},
      {"friction_force", number(contact.friction_force)},
      {"friction", number(contact.friction)},
      {"direction", contact.direction},
      {"slip_velocity", number(contact.slip_velocity)},
      {"position", number(contact.position)},
      {"gap", number(contact.gap)},
      {"angle", number(std::atan2(contact.projection.tangent.y(), contact.projection.tangent.x()))},
      {"displacement", displacement_json(system, equilibrium, point.slave_body, point.slave_rows)}};
  if (!point.substrate || !contact.is_closed) return object;
  const SubstrateContact& law = *point.substrate;
  const SubstrateForces forces = law.at(-contact.gap, contact.slip_velocity, contact.direction);
  object["indentation"] = number(-contact.gap / law.indentation_unit);
  object["area"] = number(law.area(-contact.gap, contact.slip_velocity));
  object["damping"] = number(-forces.tangential.by_slip);
  object["law_range"] = range_text(forces.range);
  return object;
}

}  // namespace

SpectrumWindow StabilityOptions::locus_window() const {
  return {count, window().frequency};
}

ContactGeometry StabilityOptions::geometry() const {
  return about == "deformed" ? ContactGeometry::deformed : ContactGeometry::undeformed;
}

EigenvalueMethod StabilityOptions::eigenvalue_method() const {
  return method == "dense" ? EigenvalueMethod::dense : EigenvalueMethod::secular;
}

LocusOptions StabilityOptions::locus_options() const {
  LocusOptions options;
  options.method = method == "dense" ? LocusMethod::dense : LocusMethod::secular;
  options.count = count;
  options.frequency = window().frequency;
  return options;
}

SpectrumWindow StabilityOptions::window() const {
  if (!below) return SpectrumWindow::lowest(count);
  const NumericKey frequency{"--below", "Hz", Range::positive()};
  SpectrumWindow window = SpectrumWindow::below(parse_value(frequency, *below, "--below"));
  if (count_option != nullptr && count_option->count() > 0) window.count = count;
  return window;
}

void add_range_options(CLI::App& verb, RangeOptions& options) {
  verb.add_option(
      "--parameter", options.parameter,
      "Key of the scene that varies, or drive.displacement: how far the drive has moved "
      "the bodies; default: contact.start, or with several pairs drive.displacement");
  verb.add_option("--from", options.from, "Its first value, SI or with a unit")->required();
  verb.add_option("--to", options.to, "Its last value")->required();
  verb.add_option("--points", options.points, "How many values, the ends included")
      ->check(CLI::Range(1, 1000000));
}

void add_stability_options(CLI::App& verb, StabilityOptions& options) {
  verb.add_option("scene", options.scene, "Scene file (YAML)")->required();
  verb.add_option("--about", options.about,
                  "Geometry about which the system is linearised: undeformed, or that of the "
                  "deformed sliding equilibrium; default: undeformed, with contacts on the faces of "
                  "plates deformed")
      ->check(CLI::IsMember({"undeformed", "deformed"}));
  verb.add_option("--method", options.method,
                  "secular (default): zeros of the secular function; dense: all eigenvalues of the "
                  "assembled matrices, as a check")
      ->check(CLI::IsMember({"secular", "dense"}));
  options.count_option =
      verb.add_option("--count", options.count,
                      "How many eigenvalues with positive frequency, lowest first")
          ->check(CLI::Range(1, 100000));
  verb.add_option("--below", options.below,
                  "Only those up to this frequency, Hz or with a unit; eig lists all of them where "
                  "no --count is given");
  add_scene_options(verb, options.common);
  add_json_option(verb, options.common);
}

NumericKey find_stability_key(const Scene& scene, const std::string& path,
                              const std::string& option) {
  if (path == drive_displacement_name) {
    if (scene.model.pairs().empty())
      throw ConfigError(option, "'drive.displacement' moves contacts, and the scene has none");
    return {path, "m", Range::any(), false};
  }
  NumericKey key = find_numeric_key(scene, path, option);
  const std::string section = path.substr(0, path.find('.'));
  const bool is_mechanical =
      is_parameter(key) ||
      (section != "initial" && ModelParameters::schema().find(section) != nullptr);
  if (!is_mechanical)
    throw ConfigError(option, fmt::format("'{}' has no influence on the eigenvalues", path));
  return key;
}

std::vector<double> range_values(const NumericKey& key, const RangeOptions& options,
                                 Spacing spacing) {
  const double from = parse_value(key, options.from, "--from");
  const double to = parse_value(key, options.to, "--to");
  if (from > to) {
    throw ConfigError("--from", fmt::format("'{}' is beyond --to '{}'", options.from, options.to));
  }
  return spaced_values(key, from, to, options.points, spacing);
}

KeyRange make_range(const StabilityScene& scene, const RangeOptions& options) {
  std::string path = options.parameter;
  if (path.empty()) {
    const auto key = scene.default_key();
    if (!key) throw ConfigError("--parameter", "the scene has no path; name a key");
    path = *key;
  }
  KeyRange range{scene.find_key(path, "--parameter"), {}};
  range.values = range_values(range.key, options, Spacing::linear);
  return range;
}

SlidingState sliding_state_of(const SceneFamily::Member& member, ContactGeometry geometry,
                              const KeptTerms& terms, const std::string& what) {
  const System& system = member.model->system;
  const std::string where = what.empty() ? "" : " at " + what;
  SlidingState state;
  state.leading_drive = system.leading_drive();
  try {
    EquilibriumState asked = stridor::sliding_state(system, member.drive_displacement, geometry);
    asked.terms = contact_terms(terms);
    state.equilibrium = geometry == ContactGeometry::deformed && member.position
                            ? find_equilibrium_at(system, 0, *member.position, asked)
                            : find_equilibrium(system, asked);
  } catch (const NumericalError& error) {
    throw NumericalError(fmt::format("no sliding equilibrium{}: {}", where, error.what()));
  }
  if (state.equilibrium.status != EquilibriumStatus::converged) {
    throw NumericalError(
        fmt::format("no sliding equilibrium{}: {}", where, state.equilibrium.failure));
  }
  const auto& contacts = state.equilibrium.contacts;
  if (!contacts.empty() &&
      std::none_of(contacts.begin(), contacts.end(),
                   [](const ContactEquilibrium& contact) { return contact.is_closed; })) {
    throw NumericalError(fmt::format("every contact is open in equilibrium{}", where));
  }
  state.pencil = linearise(system, state.equilibrium, contact_terms(terms));
  if (!terms.structural_damping) drop_structural_damping(state.pencil);
  if (!terms.friction_damping) drop_contact_damping(state.pencil);
  state.is_on_the_way = member.is_on_the_way;
  return state;
}

Pencil retained(const Pencil& pencil, const System& system,
                const std::optional<TimeParameters>& time) {
  if (!time || !time->retain) return pencil;
  return with_residual_modes(pencil, asked_frequency(system, time));
}

double asked_frequency(const System& system, const std::optional<TimeParameters>& time) {
  return time ? asked_frequency(system, *time) : std::numeric_limits<double>::infinity();
}

std::string printed_units(const NumericKey& key) {
  std::string above;
  std::string below;
  for (std::size_t begin = 0; begin < key.unit.size();) {
    const std::size_t end = std::min(key.unit.find(' ', begin), key.unit.size());
    std::string factor = key.unit.substr(begin, end - begin);
    begin = end + 1;
    const std::size_t digits = factor.find_first_of("-0123456789");
    std::string power = digits == std::string::npos ? "1" : factor.substr(digits);
    factor.erase(std::min(digits, factor.size()));
    const bool is_below = power.front() == '-';
    if (is_below) power.erase(0, 1);
    if (power != "1") factor += '^' + power;
    std::string& list = is_below ? below : above;
    list += (list.empty() ? "" : " ") + factor;
  }
  if (above.empty()) above = "1";
  return below.empty() ? above : above + '/' + below;
}

std::string value_text(const NumericKey& key, double value) {
  return fmt::format("{} = {:.9g}{}", key.path, value,
                     key.unit.empty() ? "" : " " + printed_units(key));
}

namespace {

/// Up to how many eigenvalues the dense method steps in where another fails: about a minute.
constexpr Eigen::Index most_dense = 2000;

}  // namespace

LowestEigenvalues find_lowest(const Pencil& pencil, EigenvalueMethod method,
                              const SpectrumWindow& window) {
  const BlasGuard guard;
  LowestEigenvalues found;
  if (method == EigenvalueMethod::secular) {
    try {
      found.eigenvalues = secular_eigenvalues(pencil, window);
      // Pairs that lie close together leave more of the equations than others: of a small system all
      // eigenvalues cost no more than a search.
      constexpr Eigen::Index small = 200;
      const bool is_sure =
          std::none_of(found.eigenvalues.begin(), found.eigenvalues.end(), is_doubtful);
      if (is_sure || pencil.num_eigenvalues() > small) return found;
    } catch (const NumericalError& error) {
      if (pencil.num_eigenvalues() > most_dense) {
        throw NumericalError(
            fmt::format("{} (--method dense; taken without being asked for up to {} eigenvalues, "
                        "here there are "
                        "{}), or keep fewer modes (time.retain)",
                        error.what(), most_dense, pencil.num_eigenvalues()));
      }
      found.remark = fmt::format(
          "the search for zeros of the secular function did not converge: all {} eigenvalues by "
          "the dense method, as for any up to {}; fewer modes (time.retain) are faster",
          pencil.num_eigenvalues(), most_dense);
    }
  }
  found.method = EigenvalueMethod::dense;
  found.eigenvalues = dense_eigenvalues(pencil);
  keep_window(found.eigenvalues, window);
  return found;
}

std::vector<Eigenvalue> lowest_eigenvalues(const Pencil& pencil, EigenvalueMethod method,
                                           const SpectrumWindow& window) {
  return find_lowest(pencil, method, window).eigenvalues;
}

void keep_window(std::vector<Eigenvalue>& all, const SpectrumWindow& window) {
  const auto first = std::find_if(all.begin(), all.end(),
                                  [](const Eigenvalue& one) { return one.s.imag() > 0.0; });
  auto last = std::find_if(
      first, all.end(), [&](const Eigenvalue& one) { return one.frequency() > window.frequency; });
  if (window.count)
    last = std::min(last, first + std::min<std::ptrdiff_t>(*window.count, last - first));
  all.erase(last, all.end());
}

double verdict_limit(std::span<const std::complex<double>> eigenvalues,
                     const SpectrumWindow& window, double trusted) {
  const auto num_vibrating = std::count_if(eigenvalues.begin(), eigenvalues.end(),
                                           [](const auto& s) { return s.imag() > 0.0; });
  double highest = std::min(trusted, window.frequency);
  if (window.count && num_vibrating >= *window.count)
    highest = std::min(highest, eigenvalues.back().imag() / (2.0 * std::numbers::pi));
  return highest;
}

std::string window_text(double highest) {
  if (!std::isfinite(highest)) return "the verdict holds at all frequencies";
  return fmt::format("the verdict holds between 0 and {:.6g} Hz", highest);
}

std::string limit_text(double highest, double trusted) {
  if (!std::isfinite(highest)) return "";
  return highest < trusted
             ? " (nothing above was asked for)"
             : " (what the bodies resolve, by a rule of thumb: half the frequency of the highest "
               "mode kept, of a plate that of the lowest mode left out)";
}

std::string reach_text(const Locus& locus) {
  const bool is_resolved = locus.unresolved == 0.0 && locus.unverified.empty();
  return is_resolved ? "everywhere" : "at all values looked at";
}

void print_resolution(const Locus& locus, const NumericKey& key) {
  if (locus.unresolved > 0.0) {
    fmt::print(
        "a window narrower than {:.3g}{} may have been missed: there eigenvalues could not be told "
        "apart from one value looked at to the next; ask for more --points or a shorter range\n",
        locus.unresolved, key.unit.empty() ? "" : " " + printed_units(key));
  }
  if (!locus.unverified.empty()) {
    fmt::print(
        "at {} value(s) it could not be verified that no eigenvalue is missing, the first "
        "is {:.9g}; compare with --method dense\n",
        locus.unverified.size(), locus.unverified.front());
  }
}

double verdict_limit(const Locus& locus, const SpectrumWindow& window, double trusted) {
  double highest = trusted;
  for (const auto& eigenvalues : locus.eigenvalues)
    highest = std::min(highest, verdict_limit(eigenvalues, window, trusted));
  return highest;
}

std::optional<std::string> StabilityScene::default_key() const {
  const ModelParameters& model = loaded_.scene.model;
  const auto pairs = model.pairs();
  const bool moves = std::any_of(pairs.begin(), pairs.end(), [&](const auto& pair) {
    return !is_face(model, pair.second.master);
  });
  if (!moves) return std::nullopt;
  return start_key(model).value_or(drive_displacement_name);
}

std::unique_ptr<GrowthField> StabilityScene::growth_field(
    const std::vector<NumericKey>& keys) const {
  return make_growth_field(loaded_, keys);
}

std::string StabilityScene::about_text(const StabilityOptions& options) const {
  if (loaded_.scene.model.pairs().empty()) return "";
  return fmt::format(" about the {} geometry", options.about);
}

void make_choices(StabilityOptions& options, const Scene& scene) {
  if (options.method.empty()) options.method = "secular";
  if (options.about.empty())
    options.about = has_face_contacts(scene.model) ? "deformed" : "undeformed";
}

StabilityScene load_stability_scene(StabilityOptions& options) {
  StabilityScene scene(load_scene(options.scene, options.common.sets));
  make_choices(options, scene.loaded().scene);
  return scene;
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

SlidingState BodyStabilityFamily::at(std::span<const double> values) {
  const BlasGuard guard;
  const SceneFamily::Member member = family_.at(values);
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
  return is_sampled ? SpectrumMethod::sampled : SpectrumMethod::followed;
}

SparseSystem BodyStabilityFamily::sparse_system(std::span<const double> values) {
  return *family_.at(values).model->sparse;
}

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
                                        const LocusOptions& options) {
  SpectrumFamily family = counted_spectra(
      [this, key, at = values](double value) mutable {
        at[key] = value;
        return sparse_system(at);
      },
      {options.count, options.frequency});
  for (auto* spectrum : {&family.at, &family.near, &family.glimpse}) {
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

namespace {

/// The locus along whole numbers.
Locus locus_at(const PencilFamily& family, const std::vector<double>& range,
               const LocusOptions& options) {
  Locus locus;
  locus.values = range;
  Pencil pencil;
  const EigenvalueMethod method =
      options.method == LocusMethod::dense ? EigenvalueMethod::dense : EigenvalueMethod::secular;
  bool was_growing = false;
  for (const double value : range) {
    family.place(value, pencil);
    locus.eigenvalues.emplace_back();
    const Eigenvalue* fastest = nullptr;
    const std::vector<Eigenvalue> eigenvalues =
        lowest_eigenvalues(pencil, method, {options.count, options.frequency});
    for (const Eigenvalue& one : eigenvalues) {
      locus.eigenvalues.back().push_back(one.s);
      if (is_growing(one) && (fastest == nullptr || one.growth() > fastest->growth()))
        fastest = &one;
    }
    if (fastest != nullptr) {
      if (!was_growing) locus.unstable.push_back({value, value, 0.0, 0.0, 0.0, value, 0});
      UnstableWindow& window = locus.unstable.back();
      window.to = value;
      if (fastest->growth() > window.growth_max) {
        window.growth_max = fastest->growth();
        window.frequency = fastest->frequency();
        window.value_max = value;
      }
    }
    const bool is_change = !locus.eigenvalues.empty() && locus.eigenvalues.size() > 1 &&
                           was_growing != (fastest != nullptr);
    if (is_change) {
      locus.crossings.push_back({value, locus.unstable.back().frequency, was_growing ? -1 : 1, 0});
    }
    was_growing = fastest != nullptr;
  }
  return locus;
}

/// The branches along a range, by the dense method where the search for zeros of the secular
/// function fails.
/// @throws NumericalError as trace_locus()
Locus trace(const PencilFamily& family, const NumericKey& varied, const std::vector<double>& range,
            const LocusOptions& options) {
  try {
    return trace_locus(family, range, options);
  } catch (const SearchFailure& error) {
    if (options.method == LocusMethod::dense) throw;
    Pencil first;
    family.place(range.front(), first);
    if (first.num_eigenvalues() > most_dense) throw;
    print_remark(
        "the search for zeros of the secular function did not converge at {}: all {} eigenvalues "
        "by the dense method; fewer modes (time.retain) are faster\n",
        value_text(varied, range.front()), first.num_eigenvalues());
  }
  LocusOptions dense = options;
  dense.method = LocusMethod::dense;
  return trace_locus(family, range, dense);
}

}  // namespace

Locus locus_along(StabilityFamily& family, const NumericKey& varied, std::size_t key,
                  const std::vector<double>& values, const std::vector<double>& range,
                  const LocusOptions& options, SearchFor wanted) {
  // An end that is not allowed is named as it was given, before anything is computed in between.
  std::vector<double> ends = values;
  ends[key] = range.front();
  const SpectrumMethod method = family.method(ends);
  double trusted = std::numeric_limits<double>::infinity();
  Eigen::Index num_wanted = 0;
  for (const double end : {range.front(), range.back()}) {
    ends[key] = end;
    if (method != SpectrumMethod::counted)
      num_wanted = std::max(num_wanted, family.pencil(ends).num_eigenvalues() / 2);
    trusted = std::min(trusted, family.trusted_frequency(ends));
  }
  if (method == SpectrumMethod::counted) num_wanted = options.count;
  num_wanted = std::min<Eigen::Index>(num_wanted, options.count);
  // Measured: tracks, results and their JSON.
  constexpr double bytes_per_eigenvalue = 500.0;
  const auto num_values = static_cast<double>(range.size());
  require_memory_for(
      {"--points", fmt::format("{} eigenvalues at {} values", num_wanted, range.size()),
       "ask for fewer", bytes_per_eigenvalue * num_values * static_cast<double>(num_wanted)},
      memory_limit());
  LocusOptions within = options;
  within.trusted = trusted;
  if (method == SpectrumMethod::counted)
    return sample_locus(family.spectra(key, values, within), range, within, sparing_effort);
  const PencilFamily pencils = family.along(key, values, range.front(), range.back());
  if (varied.is_integer) {
    LocusOptions wholes = options;
    if (method == SpectrumMethod::sampled) wholes.method = LocusMethod::dense;
    return locus_at(pencils, range, wholes);
  }
  if (method == SpectrumMethod::followed) return trace(pencils, varied, range, options);
  return sample_locus(pencils, range, within,
                      wanted == SearchFor::stability ? stability_effort : SamplingEffort{});
}

std::vector<StabilityChange> stability_changes(const Locus& locus) {
  // Between two crossings the number of growing eigenvalues is that of the windows there.
  const auto num_growing = [&](double value) {
    return std::count_if(locus.unstable.begin(), locus.unstable.end(), [&](const auto& window) {
      return window.from < value && value < window.to;
    });
  };
  std::vector<StabilityChange> changes;
  for (std::size_t i = 0; i < locus.crossings.size(); ++i) {
    const Crossing& crossing = locus.crossings[i];
    const double before = i == 0 ? locus.values.front() : locus.crossings[i - 1].value;
    const double after =
        i + 1 == locus.crossings.size() ? locus.values.back() : locus.crossings[i + 1].value;
    const bool was_stable = num_growing(0.5 * (before + crossing.value)) == 0;
    const bool is_stable = num_growing(0.5 * (crossing.value + after)) == 0;
    if (was_stable != is_stable)
      changes.push_back({crossing.value, crossing.frequency, was_stable});
  }
  return changes;
}

bool is_growing(const Eigenvalue& eigenvalue) {
  constexpr double rounding = 1e-10;
  return eigenvalue.growth() > rounding * std::abs(eigenvalue.s);
}

double trusted_frequency(const System& system) {
  double lowest = std::numeric_limits<double>::infinity();
  double omitted = lowest;  // of bodies that are modes as they are
  for (const SystemBody& body : system.bodies) {
    omitted = std::min(omitted, body.lowest_omitted / (2.0 * std::numbers::pi));
    const Eigen::Index n = body.reduced.size();
    if (n == body.reduced.num_interface) continue;
    // The stiffness of fixed-interface modes is diagonal and ascends.
    const double omega = std::sqrt(body.reduced.stiffness(n - 1, n - 1));
    lowest = std::min(lowest, omega / (2.0 * std::numbers::pi));
  }
  return std::min(0.5 * lowest, omitted);
}

Json eigenvalues_json(const std::vector<Eigenvalue>& eigenvalues) {
  Json list = Json::array();
  for (const Eigenvalue& one : eigenvalues) list.push_back({one.s.real(), one.s.imag()});
  return list;
}

Json equilibrium_json(const Model& model, const Equilibrium& equilibrium) {
  const System& system = model.system;
  Json object;
  if (system.contacts.size() == 1) {
    object = contact_json(system, equilibrium, 0);
  } else {
    for (std::size_t i = 0; i < system.contacts.size(); ++i)
      object["contacts"][system.contacts[i].name] = contact_json(system, equilibrium, i);
  }
  object["drive_displacement"] = number(equilibrium.state.drive_displacement);
  object["residual"] = number(equilibrium.residual);
  object["points"] = Json::object();
  for (const auto& [name, point] : model.points) {
    object["points"][name.body + "." + name.point] =
        displacement_json(system, equilibrium, point.body, point.rows);
  }
  return object;
}

}  // namespace stridor
