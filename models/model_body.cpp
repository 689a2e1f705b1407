#include "models/model_body.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/activity.hpp"
#include "core/suggestion.hpp"
#include "coupling/system/contact_parameters.hpp"
#include "models/model.hpp"

namespace stridor {
namespace {

bool is_same_sum(const DofSum& a, const DofSum& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const DofWeight& left, const DofWeight& right) {
                      return left.dof == right.dof && left.weight == right.weight;
                    });
}

bool is_one_dof(const DofSum& sum) {
  return sum.empty() || (sum.size() == 1 && sum.front().weight == 1.0);
}

/// The DoFs of which a reduction is to give rows, and the weights of these in the rows of a body.
struct WatchedDofs {
  std::vector<int> dofs;
  std::optional<Eigen::MatrixXd> weights;  ///< absent where each row is one of the DoFs
};

WatchedDofs watched_dofs(const ModelBody& body) {
  WatchedDofs watched;
  if (std::all_of(body.rows.begin(), body.rows.end(), is_one_dof)) {
    for (const DofSum& row : body.rows)
      watched.dofs.push_back(row.empty() ? BodyMatrices::held : row.front().dof);
    return watched;
  }
  for (const DofSum& row : body.rows)
    for (const DofWeight& dof : row) watched.dofs.push_back(dof.dof);
  std::sort(watched.dofs.begin(), watched.dofs.end());
  watched.dofs.erase(std::unique(watched.dofs.begin(), watched.dofs.end()), watched.dofs.end());
  watched.weights =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(body.rows.size()),
                            static_cast<Eigen::Index>(watched.dofs.size()));
  for (std::size_t r = 0; r < body.rows.size(); ++r) {
    for (const DofWeight& dof : body.rows[r]) {
      const auto place = std::lower_bound(watched.dofs.begin(), watched.dofs.end(), dof.dof);
      (*watched.weights)(static_cast<Eigen::Index>(r), place - watched.dofs.begin()) += dof.weight;
    }
  }
  return watched;
}

/// Number of fixed-interface modes asked for; for a body of which nothing is to be reduced, all
/// unknowns become interface.
int modes_of(ModelBody& body) {
  if (const std::optional<int> asked = body.parameters->num_modes()) {
    for (const int dof : body.matrices.kept) body.keep(dof);
    return *asked;
  }
  if (body.matrices.num_dofs() > largest_dense_size && !body.matrices.is_modal) {
    throw ConfigError(Refusal::cannot_reduce, body.key() + ".reduction",
                      fmt::format("missing: {} unknowns are too many to keep them all (up to {}); "
                                  "give fixed_interface_modes",
                                  body.matrices.num_dofs(), largest_dense_size));
  }
  for (int dof = 0; dof < body.matrices.num_dofs(); ++dof) body.keep(dof);
  return 0;
}

}  // namespace

int ModelBody::row_of(const DofSum& displacement) {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const DofSum& row) {
    return is_same_sum(row, displacement);
  });
  if (found != rows.end()) return static_cast<int>(found - rows.begin());
  rows.push_back(displacement);
  return static_cast<int>(rows.size()) - 1;
}

PointRows ModelBody::rows_of(int node) {
  PointRows of_node{row_of(matrices.displacement(node, 0)), row_of(matrices.displacement(node, 1))};
  const DofSum across = matrices.displacement(node, 2);
  if (!across.empty()) of_node.z = row_of(across);
  return of_node;
}

void ModelBody::keep(int dof) {
  if (dof != BodyMatrices::held &&
      std::find(interface.begin(), interface.end(), dof) == interface.end())
    interface.push_back(dof);
}

void ModelBody::keep_node(int node) {
  for (const std::size_t direction : {0, 1, 2})
    for (const DofWeight& dof : matrices.displacement(node, direction)) keep(dof.dof);
}

std::vector<ModelBody> make_bodies(const Substructures& substructures, BodyCache& cache) {
  std::vector<ModelBody> bodies;
  for (const auto& [name, substructure] : substructures) {
    if (name == rigid_master || name == half_space_master) {
      throw ConfigError(Refusal::doubled_name, "substructures." + name,
                        fmt::format("'{}' is the name of a master; give the body another", name));
    }
    ModelBody body;
    body.name = name;
    body.parameters = &*substructure;
    const Activity assembling(fmt::format("assembling '{}'", name));
    try {
      body.matrices = cache.matrices(*substructure);
    } catch (const ConfigError& error) {
      const Problem& problem = error.problems().front();
      throw ConfigError(problem.refusal, body.key() + "." + problem.key, problem.message);
    }
    bodies.push_back(std::move(body));
  }
  return bodies;
}

namespace {

Eigen::Index num_interior_of(const ModelBody& body) {
  return body.matrices.num_dofs() - static_cast<Eigen::Index>(body.interface.size());
}

BodyCache::Wanted wanted_of(const ModelBody& body, int num_modes, const WatchedDofs& watched) {
  return {body.parameters, &body.matrices,  body.is_whole(),
          body.interface,  num_modes,       watched.dofs,
          body.parameters->interface_modes()};
}

}  // namespace

void prepare_bodies(std::span<ModelBody* const> bodies, BodyCache& cache) {
  std::vector<WatchedDofs> watched;
  watched.reserve(bodies.size());
  std::vector<BodyCache::Wanted> wanted;
  for (ModelBody* const body : bodies) {
    const int num_modes = modes_of(*body);
    if (num_modes > num_interior_of(*body)) continue;  // reduce_body() says so
    if (body->parameters->interface_modes().value_or(0) > static_cast<int>(body->interface.size()))
      continue;
    watched.push_back(watched_dofs(*body));
    wanted.push_back(wanted_of(*body, num_modes, watched.back()));
  }
  const Activity reducing("reducing the bodies");
  cache.prepare(wanted);
}

void check_reduction(const ModelBody& body, int num_modes) {
  const Eigen::Index num_interior = num_interior_of(body);
  if (num_modes > num_interior) {
    throw ConfigError(Refusal::cannot_reduce, body.key() + ".reduction.fixed_interface_modes",
                      fmt::format("{} modes asked, but '{}' has only {} DoFs besides its "
                                  "interface; take at most that",
                                  num_modes, body.name, num_interior));
  }
  const std::optional<int> asked = body.parameters->interface_modes();
  if (asked && body.is_whole()) {
    throw ConfigError(
        Refusal::cannot_reduce, body.key() + ".interface.modes",
        fmt::format("goes with a reduction: give '{}' reduction.fixed_interface_modes", body.name));
  }
  if (asked && *asked > static_cast<int>(body.interface.size())) {
    throw ConfigError(
        Refusal::cannot_reduce, body.key() + ".interface.modes",
        fmt::format("{} modes asked of the interface of '{}', which has {} DoFs; take "
                    "at most that, or leave the key out for all",
                    *asked, body.name, body.interface.size()));
  }
}

BodyCache::Reduction reduce_body(ModelBody& body, BodyCache& cache) {
  const int num_modes = modes_of(body);
  check_reduction(body, num_modes);
  const Activity reducing(fmt::format("reducing '{}'", body.name));
  const WatchedDofs watched = watched_dofs(body);
  try {
    BodyCache::Reduction made = cache.reduce(wanted_of(body, num_modes, watched));
    if (watched.weights) {
      made.reduced.rows = *watched.weights * made.reduced.rows;
      made.modal.rows = *watched.weights * made.modal.rows;
    }
    return made;
  } catch (const NumericalError& error) {
    throw ConfigError(Refusal::cannot_reduce, body.key(),
                      fmt::format("cannot be reduced: {}. Give it supports or more contact points",
                                  error.what()));
  }
}

bool is_large(const std::vector<ModelBody>& bodies) {
  Eigen::Index size = 0;
  for (const ModelBody& body : bodies)
    if (body.is_whole()) size += body.matrices.num_dofs();
  return size > largest_dense_size;
}

/// Terms that couple modes keep no rigid motion apart, so statics know none.
void check_coupled(const SystemBody& body, const std::string& key) {
  const CoupledTerms& coupled = body.modal.coupled;
  if (coupled.is_empty() || coupled.position.isZero(0.0)) return;
  if ((body.modal.omega.array() > 0.0).all()) return;
  throw ConfigError(Refusal::wrong_matrix, key + ".circulatory",
                    fmt::format("goes with a stiffness that resists every motion; that of '{}' "
                                "leaves some free",
                                body.name));
}

std::pair<int, std::string> split_name(const std::string& name, const std::vector<ModelBody>& bodies,
                                       const std::string& key) {
  const std::size_t dot = name.find('.');
  if (dot == std::string::npos || dot == 0 || dot + 1 == name.size()) {
    throw ConfigError(Refusal::wrong_value, key,
                      fmt::format("'{}' is not of the form <body>.<point or surface>", name));
  }
  const std::string body_name = name.substr(0, dot);
  std::vector<std::string> names;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b].parameters == nullptr) continue;  // the rigid master has no points
    if (bodies[b].name == body_name) return {static_cast<int>(b), name.substr(dot + 1)};
    names.push_back(bodies[b].name);
  }
  throw ConfigError(Refusal::unknown_name, key,
                    fmt::format("there is no substructure '{}'{} (there are: {})", body_name,
                                did_you_mean(body_name, names), listed_names(names)));
}

int node_at(const ModelBody& body, const std::string& point, const std::string& key) {
  const auto node = body.matrices.points.find(point);
  if (node != body.matrices.points.end()) return node->second;
  const auto known = names_in_map(body.matrices.points);
  throw ConfigError(Refusal::unknown_name, key,
                    fmt::format("'{}' has no point '{}'{} (it has: {})", body.name, point,
                                did_you_mean(point, known), listed_names(known)));
}

std::string listed_names(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace stridor
