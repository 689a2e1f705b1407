// Bodies and their reductions, kept for the next system that needs the same ones.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "models/model.hpp"
#include "substructures/bodies/matrix_body.hpp"

namespace stridor {

/// Makes bodies from their parameters and reduces them, each once.
///
/// Equal bodies are found by the resolved keys of a body, all of them but the damping,
/// which is proportional and leaves meshes, shapes and frequencies alone; for a reduction also by
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

  /// Craig-Bampton reduction of a body and its modes; arguments as of make_craig_bampton().
  /// @param parameters of the body
  /// @param body       its matrices
  /// @throws as make_craig_bampton() and make_modal()
  Reduction reduce(const BodyParameters& parameters, const BodyMatrices& body,
                   std::span<const int> interface, Eigen::Index num_modes,
                   std::span<const int> watched);

  /// A body of which every unknown is kept (make_whole()) and its modes.
  /// @throws as make_whole() and make_modal()
  Reduction keep_whole(const BodyParameters& parameters, const BodyMatrices& body,
                       std::span<const int> watched);

  /// Matrices that were read for a body, and what it then named.
  struct ReadMatrices {
    MatrixBodyParameters named;
    std::shared_ptr<const NamedMatrices> matrices;
  };
  /// Those read last for each body, by its name, so that a file is read once.
  std::map<std::string, ReadMatrices> read;

  /// Reductions computed so far, those forgotten included.
  std::int64_t num_reductions() const { return num_reductions_; }

 private:
  template <class Content>
  struct Entry {
    std::string key;
    Content content;
    std::int64_t last_use = 0;
  };
  template <class Content>
  using Store = std::vector<Entry<Content>>;

  template <class Make>
  Reduction reduction(const std::string& key, const BodyMatrices& body, const Make& make);
  template <class Content>
  Content* find(Store<Content>& store, const std::string& key);
  template <class Content>
  Content& keep(Store<Content>& store, std::string key, Content content);

  std::size_t capacity_;
  std::int64_t num_uses_ = 0;
  std::int64_t num_reductions_ = 0;
  Store<BodyMatrices> bodies_;
  Store<Reduction> reductions_;
};

}  // namespace stridor
