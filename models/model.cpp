#include "models/model.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/memory.hpp"
#include "models/body_cache.hpp"
#include "models/curve_contact.hpp"
#include "models/face_contact_pair.hpp"
#include "models/initial_motion.hpp"
#include "models/model_drive.hpp"
#include "models/placed_model.hpp"
#include "models/set_up_estimate.hpp"
#include "models/space_contact.hpp"
#include "substructures/bodies/whole_body.hpp"

namespace stridor {
namespace {

/// Puts the parts of a model together, one after the other.
class ModelBuilder {
 public:
  using Observed = std::vector<std::pair<PointName, std::string>>;

  ModelBuilder(const ModelParameters& parameters, BodyCache& cache)
      : parameters_(parameters), cache_(cache), pairs_(parameters.pairs()),
        drives_(parameters.scene_drives()), bodies_(make_bodies(parameters.substructures, cache)) {
    model_.substructures = parameters.substructures;
    resolve();
  }

  Model make(const Observed& observed) {
    place();
    add_scene_points(parameters_.points, bodies_);
    for (const auto& [name, key] : observed) {
      const auto [b, point] = split_name(name.body + "." + name.point, bodies_, key);
      ModelBody& body = bodies_[static_cast<std::size_t>(b)];
      model_.points[name] = {b, body.rows_of(node_at(body, point, key))};
    }
    check_loads(drives_, bodies_);
    finish();
    hold_preloads(preloads_of(resolved_, model_.system), model_.system);
    return std::move(model_);
  }

  PlacedModel make_placed() {
    place();
    add_scene_points(parameters_.points, bodies_);
    check_loads(drives_, bodies_);
    PlacedModel placed;
    for (ModelBody& body : bodies_) {
      placed.loads.push_back(body.parameters == nullptr ? std::vector<BodyLoad>{}
                                                        : loads_of(body, drives_));
    }
    placed.bodies = std::move(bodies_);
    placed.pairs = std::move(resolved_);
    placed.system = std::move(model_.system);
    // `parameters` of the pairs would point into this builder.
    for (ContactPair& pair : placed.pairs) pair.parameters = nullptr;
    return placed;
  }

 private:
  /// Resolves the names of all pairs.
  void resolve() {
    check_drives(drives_, pairs_, bodies_);
    assign_drives(drives_, bodies_);
    const EndlessMasters endless = add_endless_masters(drives_, pairs_, bodies_);
    resolved_.reserve(pairs_.size());
    for (const auto& [name, pair] : pairs_) {
      const auto master = endless.find(mover_of_master(drives_, name));
      resolved_.push_back(resolve_pair(name, parameters_.contact ? name : "contacts." + name, pair,
                                       bodies_, master == endless.end() ? -1 : master->second));
    }
    for (const ContactPair& pair : resolved_) {
      for (const int body : {pair.slave_body, pair.master_body})
        bodies_[static_cast<std::size_t>(body)].is_touched = true;
    }
    System& system = model_.system;
    system.drives.clear();
    for (const SceneDrive& drive : drives_) {
      system.drives.push_back(make_drive(
          drive.parameters,
          pairs_.empty() ? SlidingMode::moving : pairs_.begin()->second.sliding, drive.key));
    }
    if (!pairs_.empty()) check_something_follows(drives_, system.drives, bodies_);
  }

  /// Places the slaves on their masters. A body that carries others is placed before them; chains
  /// are placed in order.
  void place() {
    std::vector<const ContactPair*> waiting;
    waiting.reserve(resolved_.size());
    for (const ContactPair& pair : resolved_) waiting.push_back(&pair);
    const auto is_waiting_slave = [&](int body) {
      return std::any_of(waiting.begin(), waiting.end(), [&](const ContactPair* pair) {
        return pair->slave_body == body && !bodies_[static_cast<std::size_t>(body)].is_placed;
      });
    };
    while (!waiting.empty()) {
      const auto ready =
          std::find_if(waiting.begin(), waiting.end(), [&](const ContactPair* pair) {
            return !is_waiting_slave(pair->master_body);
          });
      if (ready == waiting.end()) {
        throw ConfigError(Refusal::wrong_value, waiting.front()->key_of("master"),
                          "the pairs form a circle: no body of it can be placed first");
      }
      const ContactPair& pair = **ready;
      const PairDrive drive =
          drive_of_pair(drives_, bodies_, pair.slave_body, pair.master_body);
      if (pair.is_on_face) {
        add_face_contacts(pair, drive, bodies_, model_.system);
      } else if (pair.is_in_space) {
        add_space_contacts(pair, drive, bodies_, model_.system);
      } else {
        add_curve_contacts(pair, drive, bodies_, model_.system);
      }
      waiting.erase(ready);
    }
    refuse_shared_nodes(resolved_);
  }

  /// Reduces the bodies and sets them moving.
  void finish() {
    const InitialMotion displacement(parameters_.initial.displacement, "initial.displacement",
                                     bodies_);
    const InitialMotion velocity(parameters_.initial.velocity, "initial.velocity", bodies_);
    const bool is_sparse = pairs_.empty() && is_large(bodies_);
    System& system = model_.system;
    std::vector<SparseSystem> blocks;
    std::vector<std::vector<BodyLoad>> loads;
    std::vector<ModelBody*> reduced;
    for (ModelBody& body : bodies_) {
      loads.push_back(body.parameters == nullptr ? std::vector<BodyLoad>{}
                                                 : loads_of(body, drives_));
      if (body.parameters != nullptr && !(is_sparse && body.is_whole())) reduced.push_back(&body);
    }
    prepare_bodies(reduced, cache_);
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      ModelBody& body = bodies_[b];
      if (body.parameters == nullptr) {
        system.bodies.push_back(make_rigid_body(body));
        model_.placements.emplace_back();
        continue;
      }
      SystemBody finished;
      finished.name = body.name;
      finished.drive = body.drive;
      finished.loads = std::move(loads[b]);
      finished.lowest_omitted = body.matrices.lowest_omitted;
      if (is_sparse && body.is_whole()) {
        if (body.matrices.loss_stiffness.size() > 0) {
          throw ConfigError(Refusal::cannot_reduce, body.key() + ".reduction",
                            fmt::format("missing: structural damping (loss factors) goes with the "
                                        "modes of a reduction; give '{}' fixed_interface_modes",
                                        body.name));
        }
        blocks.push_back(make_sparse(body.matrices));
        continue;
      }
      BodyCache::Reduction reduction = reduce_body(body, cache_);
      finished.reduced = std::move(reduction.reduced);
      finished.modal = std::move(reduction.modal);
      if (body.is_touched && !body.matrices.is_modal) check_coupled(finished, body.key());
      const auto number = static_cast<int>(system.bodies.size());
      finished.initial_displacement = displacement.of(number, body, finished);
      finished.initial_velocity = velocity.of(number, body, finished);
      system.bodies.push_back(std::move(finished));
      model_.placements.push_back({body.place, body.interface, body.is_mirrored});
    }
    if (is_sparse) make_model_sparse(std::move(blocks));
  }

  void make_model_sparse(std::vector<SparseSystem> blocks) {
    for (const SystemBody& body : model_.system.bodies) blocks.push_back(make_sparse(body.modal));
    model_.sparse = block_diagonal(std::move(blocks));
    model_.system = {};
    model_.points.clear();
    model_.placements.clear();
  }

  const ModelParameters& parameters_;
  BodyCache& cache_;
  std::map<std::string, ContactParameters> pairs_;
  std::vector<SceneDrive> drives_;
  std::vector<ModelBody> bodies_;
  std::vector<ContactPair> resolved_;
  Model model_;
};

}  // namespace

namespace {

void check_drive_sections(const ModelParameters& model, std::vector<Problem>& problems) {
  const auto refuse = [&](Refusal refusal, const std::string& key, const char* text) {
    problems.push_back({refusal, key, text});
  };
  if (model.drive && !model.drives.empty())
    refuse(Refusal::contradiction, "drives",
           "give either `drive` (one) or `drives` (several), not both");
  for (const auto& [name, drive] : model.drives) {
    const bool does = !drive.velocity.is_zero() || !drive.load.is_zero() ||
                      !drive.displacement.is_zero() || !drive.moves.empty() ||
                      !drive.load_on.empty() || !drive.displaces.empty();
    if (!does)
      refuse(Refusal::wrong_value, "drives." + name,
             "does nothing: give velocity, load or displacement");
  }
}

}  // namespace

const Schema& ModelParameters::schema() {
  static const Schema keys =
      SchemaOf<ModelParameters>("model")
          .named_types("substructures", &ModelParameters::substructures, "type",
                       {.doc = "The bodies, by name; may be absent where only `contact` evaluates "
                               "the normal laws.",
                        .optional = true})
          .section("contact", &ModelParameters::contact,
                   {.doc = "The contact pair, where there is one only.", .optional = true})
          .named_sections("contacts", &ModelParameters::contacts,
                          {.doc = "Several contact pairs, by name.", .optional = true})
          .section("drive", &ModelParameters::drive,
                   {.doc = "What moves and loads bodies, where it is one; default: nothing does.",
                    .optional = true})
          .named_sections("drives", &ModelParameters::drives,
                          {.doc = "Several drives, by name.", .optional = true})
          .named_sections("points", &ModelParameters::points,
                          {.doc = "Points on bodies of any type, by name, besides those of the "
                                  "bodies; they are recorded and loaded as `<of>.<name>`.",
                           .optional = true})
          .section("initial", &ModelParameters::initial,
                   {.doc = "State at the start of a run.", .optional = true})
          .check([](const ModelParameters& model, std::vector<Problem>& problems) {
            if (model.substructures.empty() && model.pairs().empty())
              problems.push_back(
                  {Refusal::missing, "substructures", "is missing: there is nothing to move"});
            if (model.contact && !model.contacts.empty()) {
              problems.push_back(
                  {Refusal::contradiction, "contacts",
                   "give either `contact` (one pair) or `contacts` (several), not both"});
            }
            check_drive_sections(model, problems);
            const auto pairs = model.pairs();
            for (const auto& [name, pair] : pairs) {
              if (pair.sliding != pairs.begin()->second.sliding) {
                problems.push_back({Refusal::wrong_value, "contacts." + name + ".sliding",
                                    "must be the same for all pairs: one drive may move several"});
              }
            }
          });
  return keys;
}

std::map<std::string, ContactParameters> ModelParameters::pairs() const {
  if (contact) return {{"contact", *contact}};
  return contacts;
}

std::vector<SceneDrive> ModelParameters::scene_drives() const {
  if (drives.empty()) return {{"drive", "", drive.value_or(DriveParameters{}), true}};
  std::vector<SceneDrive> all;
  for (const auto& [name, parameters] : drives)
    all.push_back({"drives." + name, name, parameters, drives.size() == 1});
  return all;
}

void require_modes(const Model& model) {
  if (!model.sparse) return;
  for (const auto& [name, body] : model.substructures) {
    if (body->num_modes()) continue;
    throw ConfigError(Refusal::cannot_reduce, "substructures." + name + ".reduction",
                      fmt::format("missing: the bodies have {} unknowns, too many to keep them all "
                                  "in a run (up to {}); give fixed_interface_modes",
                                  model.sparse->size(), largest_dense_size));
  }
}

Model make_model(const ModelParameters& parameters,
                 const std::vector<std::pair<PointName, std::string>>& observed) {
  BodyCache cache;
  return make_model(parameters, observed, cache);
}

PlacedModel place_model(const ModelParameters& parameters, BodyCache& cache) {
  return ModelBuilder(parameters, cache).make_placed();
}

Model make_model(const ModelParameters& parameters,
                 const std::vector<std::pair<PointName, std::string>>& observed, BodyCache& cache) {
  require_memory(estimate_set_up(parameters), memory_limit());
  return ModelBuilder(parameters, cache).make(observed);
}

}  // namespace stridor
