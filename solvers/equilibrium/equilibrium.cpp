#include "solvers/equilibrium/equilibrium.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "solvers/equilibrium/equilibrium_equations.hpp"

namespace stridor {
namespace {

class Search {
 public:
  /// @param target where a contact is to stand; the displacement of the drive is sought then, from
  ///               that in `state`
  Search(const System& system, const EquilibriumState& state,
         const EquilibriumParameters& parameters, std::optional<Target> target = {})
      : system_(system),
        parameters_(parameters),
        answer_(begun(system, state)),
        equations_(system, answer_.state, target),
        unknowns_(equations_.first_unknowns()) {}

  Equilibrium run() {
    answer_.status = find();
    if (answer_.status == EquilibriumStatus::converged) answer_.failure.clear();
    finish();
    return std::move(answer_);
  }

 private:
  /// @throws std::invalid_argument as find_equilibrium()
  static Equilibrium begun(const System& system, const EquilibriumState& state) {
    if (!(state.friction_factor >= 0.0))
      throw std::invalid_argument("find_equilibrium: the friction factor is negative");
    if (!state.drives.empty() && state.drives.size() != system.drives.size()) {
      throw std::invalid_argument(
          fmt::format("find_equilibrium: the state is of {} drives, the system has {}",
                      state.drives.size(), system.drives.size()));
    }
    Equilibrium answer;
    answer.state = state;
    if (state.geometry == ContactGeometry::undeformed)
      answer.state.terms.friction_damping = answer.state.terms.geometric = false;
    return answer;
  }

  EquilibriumStatus find() {
    for (SoughtContact& contact : equations_.contacts) {
      if (contact.has_two_tangents()) {
        if (!stand_on_facets(contact, answer_.state.drive_displacement)) return lose(contact);
        continue;
      }
      if (equations_.is_target(contact)) {
        prescribe(contact, answer_.state.drive_displacement);
        continue;
      }
      SegmentSearch search;
      SegmentSearch::Step step = SegmentSearch::Step::moved;
      while (step == SegmentSearch::Step::moved) {
        prescribe(contact, answer_.state.drive_displacement);
        step = search.look(*contact.surface, contact.result.positions.prescribed.xi,
                           contact.result.segment);
        if (step == SegmentSearch::Step::lost) return lose(contact);
      }
    }
    for (int pass = 0; pass < parameters_.max_passes; ++pass) {
      equations_.gather();
      if (!iterate()) return EquilibriumStatus::not_converged;
      bool has_moved = false;
      for (SoughtContact& contact : equations_.contacts) {
        if (equations_.is_target(contact)) continue;
        if (contact.has_two_tangents()) {
          const FacetSearch::Step step = look_for_facet(contact, answer_.state.geometry);
          if (step == FacetSearch::Step::lost) return lose(contact);
          has_moved = has_moved || step == FacetSearch::Step::moved;
          continue;
        }
        switch (contact.search.look(*contact.surface, contact.result.projection.xi,
                                    contact.result.segment)) {
          case SegmentSearch::Step::lost:
            return lose(contact);
          case SegmentSearch::Step::moved:
            has_moved = true;
            break;
          case SegmentSearch::Step::stay:
            break;
        }
      }
      if (!has_moved && !switch_contacts()) return EquilibriumStatus::converged;
    }
    answer_.failure = fmt::format("segments or open contacts still change after {} passes",
                                  parameters_.max_passes);
    return EquilibriumStatus::not_converged;
  }

  EquilibriumStatus lose(const SoughtContact& contact) {
    if (contact.has_two_tangents()) {
      answer_.failure = fmt::format("{}: the slave point stands beyond the edge of the surface {}",
                                    contact.point->name, system_.master_name(*contact.point));
      return EquilibriumStatus::master_lost;
    }
    answer_.failure =
        fmt::format("{}: the slave point stands beyond the end of the surface {} ({:.6g} m long)",
                    contact.point->name, contact.surface->name, contact.surface->arc_length.back());
    return EquilibriumStatus::master_lost;
  }

  /// Newton's method for the present segments and open contacts. Goes one step further than the
  /// tolerance asks for, which is cheap and takes the error down to rounding.
  /// @returns false where it does not converge; `failure` says how
  bool iterate() {
    constexpr double smallest_fraction = 1e-4;
    constexpr double good_reduction = 0.01;  // by a step with a derivative that is factored already
    EquilibriumEquations::Values present = equations_.evaluate(unknowns_);
    for (int iteration = 0; iteration < parameters_.max_iterations; ++iteration) {
      const bool is_converged = present.residual <= parameters_.tolerance;
      Eigen::VectorXd step = equations_.newton_step(present, unknowns_);
      ++answer_.iterations;
      double fraction = 1.0;
      EquilibriumEquations::Values next = equations_.evaluate(unknowns_ - step);
      const bool is_poor = equations_.was_step_approximate() && !is_converged &&
                           !(next.residual < good_reduction * present.residual);
      if (is_poor) {
        equations_.forget_factor();
        step = equations_.newton_step(present, unknowns_);
        next = equations_.evaluate(unknowns_ - step);
      }
      while (!(next.residual < present.residual) && !is_converged && fraction > smallest_fraction) {
        fraction *= 0.5;
        next = equations_.evaluate(unknowns_ - fraction * step);
      }
      const bool has_improved = next.residual < present.residual;
      if (has_improved) {
        unknowns_ -= fraction * step;
        present = std::move(next);
      } else {
        equations_.evaluate(unknowns_);
      }
      answer_.residual = present.residual;
      if (is_converged) return true;
      if (!has_improved) break;
    }
    answer_.failure = fmt::format("the residual stays at {:.3g} after {} Newton steps",
                                  answer_.residual, answer_.iterations);
    return false;
  }

  /// Opens unilateral contacts that pull and closes those that penetrate. All at once as long as
  /// that may lead somewhere, then only the worst one, so that it does not go in circles.
  /// @returns whether there was any
  bool switch_contacts() {
    constexpr int free_switches = 10;
    double largest_force = 0.0;
    double largest_length = 0.0;
    for (const SoughtContact& contact : equations_.contacts) {
      largest_force = std::max(largest_force, std::abs(contact.result.force));
      largest_length =
          std::max(largest_length,
                   contact.has_two_tangents()
                       ? std::max(contact.result.ports.cwiseAbs().maxCoeff(), length_of(contact))
                       : contact.result.positions.master.chord().norm());
    }
    SoughtContact* worst = nullptr;
    double worst_violation = 0.0;
    for (SoughtContact& contact : equations_.contacts) {
      if (!contact.is_unilateral) continue;
      const double violation = contact.result.is_closed ? -contact.result.force / largest_force
                                                        : -contact.result.gap / largest_length;
      if (!(violation > 100.0 * parameters_.tolerance)) continue;
      if (num_switches_ < free_switches) toggle(contact);
      if (violation > worst_violation) {
        worst = &contact;
        worst_violation = violation;
      }
    }
    if (worst == nullptr) return false;
    if (num_switches_ >= free_switches) toggle(*worst);
    ++num_switches_;
    for (SoughtContact& contact : equations_.contacts) {
      contact.search = {};
      contact.facet_search = {};
    }
    return true;
  }

  void toggle(SoughtContact& contact) {
    contact.result.is_closed = !contact.result.is_closed;
    unknowns_(equations_.force_index(contact)) = 0.0;
    equations_.forget_factor();  // whether what is left holds all bodies is to be looked at
  }

  /// Displacements of all modes, and the places on the masters.
  void finish() {
    answer_.displacement = equations_.displacements(unknowns_);
    for (SoughtContact& contact : equations_.contacts) {
      ContactEquilibrium& result = contact.result;
      result.position = contact.has_two_tangents()
                            ? position_of(contact)
                            : contact.surface->arc_at(result.segment, result.projection.weights);
      result.positions.roughness = nullptr;  // of a system that the answer may outlive
      answer_.contacts.push_back(result);
    }
  }

  const System& system_;
  EquilibriumParameters parameters_;
  Equilibrium answer_;
  EquilibriumEquations equations_;
  Eigen::VectorXd unknowns_;  ///< displacements of the ports, contact forces, rigid amplitudes
  int num_switches_ = 0;
};

/// Bodies that nothing touches or loads: at rest where they are, even where nothing holds them.
std::optional<Equilibrium> at_rest(const System& system, const EquilibriumState& state) {
  const bool is_loaded =
      std::any_of(system.bodies.begin(), system.bodies.end(), [&](const SystemBody& body) {
        return body.held_load.size() > 0 ||
               std::any_of(body.loads.begin(), body.loads.end(),
                           [&](const BodyLoad& load) { return size_of(load, state) != 0.0; });
      });
  if (!system.contacts.empty() || is_loaded) return std::nullopt;
  Equilibrium rest;
  rest.status = EquilibriumStatus::converged;
  rest.state = state;
  for (const SystemBody& body : system.bodies)
    rest.displacement.push_back(Eigen::VectorXd::Zero(body.modal.size()));
  return rest;
}

}  // namespace

Equilibrium find_equilibrium(const System& system, const EquilibriumState& state,
                             const EquilibriumParameters& parameters) {
  if (std::optional<Equilibrium> rest = at_rest(system, state)) return *std::move(rest);
  return Search(system, state, parameters).run();
}

Equilibrium find_equilibrium_at(const System& system, int contact, double position,
                                const EquilibriumState& state,
                                const EquilibriumParameters& parameters) {
  EquilibriumState start = state;
  start.drive_displacement = drive_displacement_at(system, contact, position);
  const bool is_prescribed =
      state.geometry == ContactGeometry::undeformed ||
      system.contacts[static_cast<std::size_t>(contact)].assumption == ContactAssumption::subs_a;
  if (is_prescribed) return find_equilibrium(system, start, parameters);
  const auto [segment, xi] =
      place_on(system.surfaces[static_cast<std::size_t>(
                   system.contacts[static_cast<std::size_t>(contact)].surface)],
               position);
  return Search(system, start, parameters, Target{contact, segment, xi}).run();
}

}  // namespace stridor
