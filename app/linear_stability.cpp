#include "app/linear_stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <numbers>

#include "app/eigenvalue_report.hpp"
#include "core/activity.hpp"
#include "core/errors.hpp"
#include "solvers/dense_eigenvalues.hpp"
#include "solvers/linear_pencil.hpp"
#include "solvers/sparse_spectrum.hpp"

namespace stridor {
namespace {

/// All eigenvalues in a window. A count within a frequency is taken from all below it.
/// @throws NumericalError unless every one was found
SparseSpectrum whole_spectrum(const SparseSystem& system, SpectrumWindow window) {
  if (std::isfinite(window.frequency)) window.count.reset();
  SparseSpectrum spectrum = sparse_spectrum(system, window);
  if (!spectrum.is_complete) {
    throw NumericalError(
        fmt::format("below {:.6g} Hz the argument principle counts {} eigenvalues, and {} were "
                    "found with their conjugates; try another frequency with --below",
                    spectrum.rectangle.height / (2.0 * std::numbers::pi), spectrum.num_counted,
                    spectrum.num_found));
  }
  return spectrum;
}

/// Spectra of large matrices along a key. All eigenvalues take a search; between two values where
/// they are known their eigenvectors say where to look.
class SparseSpectra {
 public:
  using System = std::function<SparseSystem(double value)>;
  SparseSpectra(System system, const LocusOptions& options)
      : system_(std::move(system)), window_{options.count, options.frequency} {}

  SampledSpectrum at(double value) {
    SparseSpectrum spectrum = whole_spectrum(system_(value), window_);
    spectrum.modes.resize(0, 0);
    SampledSpectrum found = sampled(spectrum.eigenvalues);
    constexpr Eigen::Index most_kept = Eigen::Index{1} << 26;  // complex numbers: 1 GB
    kept_ += spectrum.right.size();
    known_.insert_or_assign(value, std::move(spectrum));
    while (kept_ > most_kept && known_.size() > 2) {
      const auto first =
          known_.begin()->first == value ? std::next(known_.begin()) : known_.begin();
      kept_ -= first->second.right.size();
      known_.erase(first);
    }
    return found;
  }

  SampledSpectrum near(double value) {
    constexpr int first_refined = 3;
    const SpectrumBasis* basis = basis_at(value);
    if (basis == nullptr) return at(value);
    const SparseSystem system = system_(value);
    for (int num_refined = first_refined;; num_refined *= 2) {
      const std::vector<Eigenvalue> found = fastest_near(system, *basis, num_refined).eigenvalues;
      // Where all that were refined grow, others may.
      const auto num_growing = std::count_if(found.begin(), found.end(), is_growing);
      if (num_growing < num_refined || static_cast<int>(found.size()) < num_refined)
        return sampled(found);
    }
  }

  SampledSpectrum around(double value, std::complex<double> place) {
    constexpr int num_refined = 4;
    const SpectrumBasis* basis = basis_at(value);
    if (basis == nullptr) return at(value);
    return sampled(closest_near(system_(value), *basis, place, num_refined).eigenvalues);
  }

  SampledSpectrum glimpse(double value) {
    const SpectrumBasis* basis = basis_at(value);
    if (basis == nullptr) return at(value);
    SampledSpectrum found;
    found.eigenvalues = projected_eigenvalues(system_(value), *basis);
    for (const std::complex<double>& s : found.eigenvalues)
      found.rounding.push_back(rounding * std::abs(s));
    return found;
  }

 private:
  static constexpr double rounding = 1e-9;  ///< of |s|, as pairs have converged

  static SampledSpectrum sampled(const std::vector<Eigenvalue>& eigenvalues) {
    SampledSpectrum found;
    for (const Eigenvalue& one : eigenvalues) {
      found.eigenvalues.push_back(one.s);
      found.rounding.push_back(rounding * std::abs(one.s));
    }
    return found;
  }

  /// Of the values next to it; null where there are not two, or where it is one of them.
  const SpectrumBasis* basis_at(double value) {
    const auto above = known_.lower_bound(value);
    if (above == known_.end() || above == known_.begin() || above->first == value) return nullptr;
    const auto below = std::prev(above);
    if (std::pair(below->first, above->first) != basis_of_) {
      basis_ = spectrum_basis({&below->second, &above->second});
      basis_of_ = {below->first, above->first};
    }
    return &basis_;
  }

  System system_;
  SpectrumWindow window_;
  std::map<double, SparseSpectrum> known_;
  Eigen::Index kept_ = 0;  ///< complex numbers in known_
  SpectrumBasis basis_;
  std::pair<double, double> basis_of_{0.0, 0.0};
};

class LinearFamily : public StabilityFamily {
 public:
  LinearFamily(LoadedLinearScene loaded, std::vector<NumericKey> keys)
      : loaded_(std::move(loaded)),
        keys_(std::move(keys)),
        is_sparse_(std::holds_alternative<MatrixScene>(loaded_.scene) &&
                   loaded_.model().sparse.has_value()) {}

  Pencil pencil(std::span<const double> values) override { return make_pencil(at(values).dense); }
  double trusted_frequency(std::span<const double> values) override {
    return at(values).highest_frequency;
  }
  bool is_sampled() const override { return true; }
  bool is_sparse() const override { return is_sparse_; }

 private:
  SpectrumFamily sparse_spectra(std::size_t key, const std::vector<double>& values,
                                const LocusOptions& options) override {
    const auto system = [this, key, at_value = values](double value) mutable {
      at_value[key] = value;
      return *at(at_value).sparse;
    };
    const auto spectra = std::make_shared<SparseSpectra>(system, options);
    return {[spectra](double value) { return spectra->at(value); },
            [spectra](double value) { return spectra->near(value); },
            [spectra](double value, std::complex<double> place) {
              return spectra->around(value, place);
            },
            [spectra](double value) { return spectra->glimpse(value); }};
  }

  /// @throws NumericalError naming the values where there is no sliding state
  LinearModel at(std::span<const double> values) const {
    try {
      return loaded_.model(keys_, values);
    } catch (const NumericalError& error) {
      std::string place;
      for (std::size_t i = 0; i < keys_.size(); ++i)
        place += (i > 0 ? ", " : "at ") + value_text(keys_[i], values[i]);
      throw NumericalError(place + ": " + error.what());
    }
  }

  LoadedLinearScene loaded_;
  std::vector<NumericKey> keys_;
  bool is_sparse_;
};

/// The contacts of the sliding state about which the system is linearised.
Json equilibrium_json(const DiscModel& model) {
  Json contacts = Json::array();
  for (std::size_t i = 0; i < model.contacts.size(); ++i) {
    const FaceContact& contact = model.contacts[i];
    const FaceContactPoint& point = model.state.contacts[i];
    const Eigen::VectorXd& q = model.state.displacement;
    contacts.push_back({{"side", contact.side},
                        {"closed", point.is_closed},
                        {"force", number(point.force)},
                        {"friction_force", number(model.law.friction * point.force)},
                        {"gap", number(point.gap)},
                        {"slip_velocity", number(point.velocity.norm())},
                        {"pad_displacement",
                         {number(contact.pad_r.dot(q)), number(contact.pad_phi.dot(q)),
                          number(contact.pad_z.dot(q))}}});
  }
  return {{"contacts", contacts}};
}

/// The same in two lines: the forces of the contact points of each pad, along the circumference.
void print_equilibrium(const DiscModel& model) {
  const std::size_t per_pad = model.contacts.size() / 2;
  for (std::size_t pad = 0; pad < 2; ++pad) {
    std::string forces;
    double sum = 0.0;
    for (std::size_t i = pad * per_pad; i < (pad + 1) * per_pad; ++i) {
      const FaceContactPoint& point = model.state.contacts[i];
      forces += point.is_closed ? fmt::format(" {:.6g}", point.force) : std::string(" open");
      sum += point.force;
    }
    fmt::print("{:<24}{:.8g} N{}\n", pad == 0 ? "contact force, upper" : "contact force, lower",
               sum, per_pad > 1 ? ", of its points" + forces : "");
  }
}

/// Results of eig, by either method.
struct FoundSpectrum {
  std::string method;
  std::vector<Eigenvalue> eigenvalues;
  double highest = 0.0;                      ///< up to where the verdict holds, Hz
  std::function<Json(std::size_t)> explain;  ///< quotients and modes of one of them
  Json more = Json::object();                ///< what else is reported
};

/// The modes without friction, damping and rotation that a motion is made of.
Json frictionless_modes_json(const Pencil& pencil, const Eigen::VectorXcd& right) {
  std::vector<Eigenvalue> modes = dense_eigenvalues(frictionless(pencil));
  std::erase_if(modes, [](const Eigenvalue& one) { return !(one.s.imag() > 0.0); });
  const std::vector<Participation> shares = participations(pencil, modes, right);
  Json list = Json::array();
  for (std::size_t i = 0; i < std::min<std::size_t>(2, shares.size()); ++i)
    list.push_back({{"frequency", shares[i].frequency}, {"share", shares[i].share}});
  return list;
}

FoundSpectrum find_dense(const LinearModel& model, const SpectrumWindow& window) {
  const auto pencil = std::make_shared<const Pencil>(make_pencil(model.dense));
  const auto spectrum = std::make_shared<const DenseSpectrum>(dense_spectrum(*pencil));
  FoundSpectrum found{"dense", spectrum->eigenvalues, 0.0, {}, Json::object()};
  keep_window(found.eigenvalues, window);
  std::vector<std::complex<double>> roots;
  for (const Eigenvalue& one : found.eigenvalues) roots.push_back(one.s);
  const bool is_all = roots.size() == spectrum->eigenvalues.size();
  found.highest = is_all ? std::min(window.frequency, model.highest_frequency)
                         : verdict_limit(roots, window, model.highest_frequency);
  found.explain = [=](std::size_t chosen) -> Json {
    const Eigen::VectorXcd right = spectrum->right.col(static_cast<Eigen::Index>(chosen));
    const std::complex<double> s = spectrum->eigenvalues[chosen].s;
    return {{"quotients", quotients_json(mode_quotients(*pencil, s, right))},
            {"frictionless_modes", frictionless_modes_json(*pencil, right)}};
  };
  return found;
}

/// @throws NumericalError unless every eigenvalue in the window was found
FoundSpectrum find_sparse(const SparseSystem& system, const SpectrumWindow& asked) {
  const auto spectrum = std::make_shared<const SparseSpectrum>(whole_spectrum(system, asked));
  const double height = spectrum->rectangle.height / (2.0 * std::numbers::pi);
  FoundSpectrum found{"sparse", spectrum->eigenvalues, 0.0, {}, Json::object()};
  keep_window(found.eigenvalues, asked);
  std::vector<std::complex<double>> roots;
  for (const Eigenvalue& one : found.eigenvalues) roots.push_back(one.s);
  found.highest = verdict_limit(roots, asked, height);
  found.more["backward_errors"] = Json::array();
  for (std::size_t i = 0; i < roots.size(); ++i)
    found.more["backward_errors"].push_back(number(spectrum->backward_errors[i]));
  found.more["window_growth"] = {number(spectrum->rectangle.left()),
                                 number(spectrum->rectangle.right())};
  found.more["counted"] = spectrum->num_counted;
  found.explain = [=](std::size_t chosen) -> Json {
    const Eigen::VectorXcd right = spectrum->right.col(static_cast<Eigen::Index>(chosen));
    const ModeQuotients seen = mode_quotients(system, spectrum->eigenvalues[chosen].s, right);
    Json modes = Json::array();
    for (const Participation& one :
         participations(system, spectrum->omega, spectrum->modes, right)) {
      if (modes.size() < 2) modes.push_back({{"frequency", one.frequency}, {"share", one.share}});
    }
    return {{"quotients", quotients_json(seen)}, {"frictionless_modes", modes}};
  };
  return found;
}

void print_linear_explanation(const Json& explanation) {
  fmt::print("\nmode {} at {:.6g} Hz, growth {:.6g} 1/s\n", explanation["mode"].get<int>(),
             explanation["frequency"].get<double>(), explanation["growth"].get<double>());
  print_quotients(explanation["quotients"]);
  for (const Json& one : explanation["frictionless_modes"]) {
    fmt::print("  {:.1f} % of it is the mode of {:.6g} Hz of the symmetric system\n",
               100.0 * one["share"].get<double>(), one["frequency"].get<double>());
  }
}

}  // namespace

std::unique_ptr<StabilityFamily> LinearStabilityScene::family(std::vector<NumericKey> keys,
                                                              ContactGeometry) const {
  return std::make_unique<LinearFamily>(loaded_, std::move(keys));
}

ExitCode eig_of_linear_scene(const StabilityOptions& options, bool explain,
                             const std::optional<int>& mode) {
  const LoadedLinearScene loaded = load_linear_scene(options.scene, options.common.sets);
  std::optional<Activity> solving(std::in_place, "state of sliding and eigenvalues");
  const LinearModel model = loaded.model();
  const SpectrumWindow window = options.window();
  const FoundSpectrum found =
      model.sparse ? find_sparse(*model.sparse, window) : find_dense(model, window);
  solving.reset();
  const std::vector<Eigenvalue>& eigenvalues = found.eigenvalues;
  const double highest = found.highest;
  const bool is_stable = std::none_of(
      eigenvalues.begin(), eigenvalues.end(),
      [&](const Eigenvalue& one) { return one.frequency() <= highest && is_growing(one); });

  Json object = {{"about", options.about},
                 {"method", found.method},
                 {"equilibrium", Json::object()},
                 {"eigenvalues", eigenvalues_json(eigenvalues)},
                 {"residuals", Json::array()},
                 {"stable", is_stable},
                 {"doubtful", doubtful_json(eigenvalues)},
                 {"window", {0.0, number(highest)}}};
  object.update(found.more);
  if (model.disc) object["equilibrium"] = equilibrium_json(*model.disc);
  for (const Eigenvalue& one : eigenvalues) object["residuals"].push_back(number(one.residual));
  if (explain) {
    const std::size_t num_real = num_real_of(eigenvalues);
    // The one to explain is among those over which the verdict is.
    std::vector<Eigenvalue> choice = eigenvalues;
    if (!mode) std::erase_if(choice, [&](const auto& one) { return one.frequency() > highest; });
    const std::size_t chosen = chosen_mode(choice, num_real, mode);
    const Eigenvalue& one = eigenvalues[chosen];
    object["explanation"] = {
        {"mode", chosen - num_real + 1}, {"frequency", one.frequency()}, {"growth", one.growth()}};
    object["explanation"].update(found.explain(chosen));
  }
  if (options.common.json) {
    print_json(object);
    return ExitCode::done;
  }
  if (model.disc) print_equilibrium(*model.disc);
  print_eigenvalues(eigenvalues, model.highest_frequency);
  if (!std::isfinite(highest)) {
    fmt::print("{} at all frequencies\n", is_stable ? "stable" : "unstable");
  } else {
    fmt::print("{} between 0 and {:.6g} Hz\n", is_stable ? "stable" : "unstable", highest);
  }
  if (model.sparse) {
    fmt::print("{} eigenvalues with their conjugates, as the argument principle counts\n",
               found.more["counted"].get<int>());
  }
  if (explain) print_linear_explanation(object["explanation"]);
  return ExitCode::done;
}

}  // namespace stridor
