// Bodies and their reductions, kept for the next system that needs the same ones.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "models/model.hpp"
#include "substructures/bodies/body_parameters.hpp"

namespace stridor {

/// Makes bodies from their parameters and reduces them, each once.
///
/// Equal bodies are found by the resolved keys of a body, all of them but the damping,
/// which is proportional and leaves meshes, shapes and frequencies alone, and the speed at which a mesh
/// spins, in whose powers its terms are kept; for a reduction also by
/// the DoFs kept and watched. The least recently used entry is forgotten first.
class BodyCache {
 public:
  /// @param capacity bodies, and reductions, kept at most; > 0
  /// @throws std::invalid_argument if `capacity` is 0
  explicit BodyCache(std::size_t capacity = 16);

  /// Matrices of a body with its supports, whatever its type.
  /// @throws as BodyParameters::make()
  BodyMatrices matrices(const BodyParameters& parameters);

  struct Reduction {
    ReducedBody reduced;
    ModalBody modal;
  };

  /// A body and what of it is kept.
  struct Wanted {
    const BodyParameters* parameters = nullptr;
    const BodyMatrices* body = nullptr;  ///< its matrices
    /// Arguments of make_craig_bampton(); of a body of which every unknown is kept, `watched` alone.
    bool is_whole = false;
    std::span<const int> interface{};
    Eigen::Index num_modes = 0;
    std::span<const int> watched{};
    std::optional<int> interface_modes{};  ///< of with_interface_modes(); nothing: all DoFs
  };
  /// Craig-Bampton reduction of a body, or all of it (make_whole()), and its modes.
  /// @throws as make_craig_bampton(), make_whole() and make_modal()
  Reduction reduce(const Wanted& wanted);
  /// Computes those that are missing, on as many threads as the machine has; reduce() then finds
  /// them. One that fails is left to reduce(), which says why.
  /// @throws Interrupted where a stop was requested
  void prepare(std::span<const Wanted> wanted);

  /// Bodies as they were read last, by name, so that a file is read once.
  std::map<std::string, std::shared_ptr<const BodyParameters>> read;

  /// Reductions computed so far, those forgotten included.
  std::int64_t num_reductions() const { return num_reductions_; }

 private:
  /// Its content stays where it was made: sparse matrices are copied when they are moved.
  template <class Content>
  struct Entry {
    std::string key;
    std::shared_ptr<const Content> content;
    std::int64_t last_use = 0;
  };
  template <class Content>
  using Store = std::vector<Entry<Content>>;

  template <class Content>
  const Content* find(Store<Content>& store, const std::string& key);
  template <class Content>
  const Content& keep(Store<Content>& store, std::string key,
                      std::shared_ptr<const Content> content);

  std::size_t capacity_;
  std::int64_t num_uses_ = 0;
  std::int64_t num_reductions_ = 0;
  Store<BodyMatrices> bodies_;
  Store<Reduction> reductions_;
};

}  // namespace stridor
