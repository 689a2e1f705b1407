// The keys of a substructure, whatever its type.
#pragma once

#include <concepts>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/schema.hpp"
#include "substructures/bodies/body_files.hpp"
#include "substructures/bodies/import_facts.hpp"
#include "substructures/elements/mesh.hpp"
#include "substructures/matrices/body_matrices.hpp"
#include "substructures/reduction/reduction_size.hpp"

namespace stridor {

/// Terms of the equations of a body that may be left out, to see what they do.
struct BodyTerms {
  bool rotation = true;  ///< what the spin of a body brings: gyroscopic and centrifugal terms
  bool damping = true;   ///< of a body that spins, besides that of RayleighDamping
  bool operator==(const BodyTerms&) const = default;
};

/// A substructure as a scene describes it: the keys of one type of body, and what the rest of the
/// program asks of them. A new type derives from BodyParametersOf and is registered in
/// body_types.cpp; nothing else names it.
class BodyParameters {
 public:
  virtual ~BodyParameters() = default;

  /// The word by which scenes call the type.
  virtual const char* type() const = 0;
  virtual const Schema& keys() const = 0;
  /// The struct that keys() describes.
  virtual const void* object() const = 0;
  virtual std::unique_ptr<BodyParameters> clone() const = 0;

  /// Terms that make() keeps.
  const BodyTerms& terms() const { return terms_; }
  void keep_terms(const BodyTerms& terms) { terms_ = terms; }

  /// The files that it names.
  virtual std::vector<NamedFile> files() { return {}; }
  /// Takes up what its files hold, before make().
  /// @throws ConfigError, with key paths below that of the body or the place in a file; FileError
  virtual void read(const BodyFiles& /*files*/) {}
  /// Takes up what a body has read that names the same files.
  /// @return whether `other` is such a body
  virtual bool take_contents(const BodyParameters& /*other*/) { return false; }

  /// Matrices, points and surfaces with the supports applied.
  /// @throws ConfigError with key paths below that of the body
  virtual BodyMatrices make() const = 0;

  /// Proportional damping that is among the keys and leaves mesh, shapes and frequencies alone;
  /// null where it is found in the matrices.
  virtual RayleighDamping* own_damping() { return nullptr; }
  const RayleighDamping* own_damping() const {
    return const_cast<BodyParameters*>(this)->own_damping();
  }
  /// Speed of a body whose spin is BodyMatrices::spin, rad/s; null for others.
  virtual double* own_spin() { return nullptr; }
  const double* own_spin() const { return const_cast<BodyParameters*>(this)->own_spin(); }
  /// Fixed-interface modes that its reduction keeps; nothing where every unknown is kept.
  virtual std::optional<int> num_modes() const { return std::nullopt; }
  /// Distance of the nodes kept of a master surface, m; nothing: every node.
  virtual std::optional<double> interface_spacing() const { return std::nullopt; }
  /// Modes in which the interface of its reduction moves; nothing: in all of its DoFs.
  virtual std::optional<int> interface_modes() const { return std::nullopt; }
  /// Whether the nodes fill the body, so that the side of a surface on which it lies can be told.
  virtual bool is_filled() const { return false; }
  /// Whether it has a face of this name (BodyMatrices::faces).
  virtual bool has_face(const std::string& /*name*/) const { return false; }
  /// Whether it is a body in space: its surfaces are BodyMatrices::facets.
  virtual bool is_spatial() const { return false; }
  /// Elements to draw; none for a body without mesh.
  virtual std::vector<DrawnElement> elements() const { return {}; }

  /// Nodes of a surface or point that contacts keep, of a slave and of a master; 1 for a name that
  /// the body does not have.
  virtual double num_slave_nodes(const std::string& /*name*/) const { return 1.0; }
  virtual double num_master_nodes(const std::string& name) const { return num_slave_nodes(name); }
  /// Size of its reduction with so many nodes kept.
  virtual ReductionSize reduction_size(double /*interface_nodes*/) const { return {}; }
  virtual SizeKey size_key() const { return {}; }

  /// What is worth a second look though it is allowed, with key paths below that of the body.
  virtual std::vector<Problem> warnings() const { return {}; }

  /// What its files turned out to hold; nothing of a body without files.
  virtual std::optional<ImportFacts> import_facts() const { return std::nullopt; }

 protected:
  BodyParameters() = default;
  BodyParameters(const BodyParameters&) = default;
  BodyParameters& operator=(const BodyParameters&) = default;

 private:
  BodyTerms terms_;
};

/// What follows from the static members `type_name` and `schema()` of a type of body.
template <class Parameters>
class BodyParametersOf : public BodyParameters {
 public:
  const char* type() const override { return Parameters::type_name; }
  const Schema& keys() const override { return Parameters::schema(); }
  const void* object() const override { return static_cast<const Parameters*>(this); }
  std::unique_ptr<BodyParameters> clone() const override {
    return std::make_unique<Parameters>(static_cast<const Parameters&>(*this));
  }
};

/// Keys of a body of any type, copied with what they hold.
class Substructure {
 public:
  Substructure() = default;
  template <std::derived_from<BodyParameters> Parameters>
  Substructure(Parameters parameters)  // NOLINT(google-explicit-constructor): a body is one
      : body_(std::make_unique<Parameters>(std::move(parameters))) {}
  Substructure(const Substructure& other) : body_(other.body_ ? other.body_->clone() : nullptr) {}
  Substructure(Substructure&&) noexcept = default;
  Substructure& operator=(const Substructure& other) { return *this = Substructure(other); }
  Substructure& operator=(Substructure&&) noexcept = default;
  ~Substructure() = default;

  BodyParameters& operator*() { return *body_; }
  const BodyParameters& operator*() const { return *body_; }
  BodyParameters* operator->() { return body_.get(); }
  const BodyParameters* operator->() const { return body_.get(); }

  /// The keys as those of one type. @throws std::bad_cast if the body is of another
  template <std::derived_from<BodyParameters> Parameters>
  Parameters& get() {
    return dynamic_cast<Parameters&>(*body_);
  }
  template <std::derived_from<BodyParameters> Parameters>
  const Parameters& get() const {
    return dynamic_cast<const Parameters&>(*body_);
  }

  // For SchemaOf::named_types().
  struct Type {
    std::string name;
    const Schema& (*schema)();
    void* (*emplace)(Substructure&);  ///< makes it of this type; returns the struct of its keys
  };
  /// All types that scenes can name.
  static const std::vector<Type>& types();
  /// Index into types().
  std::size_t type_index() const;
  const void* object() const { return body_->object(); }

 private:
  std::unique_ptr<BodyParameters> body_;
};

using Substructures = std::map<std::string, Substructure>;

/// A type of body for Substructure::types().
template <std::derived_from<BodyParameters> Parameters>
Substructure::Type body_type() {
  return {Parameters::type_name, []() -> const Schema& { return Parameters::schema(); },
          [](Substructure& slot) -> void* {
            slot = Parameters();
            return &slot.get<Parameters>();
          }};
}

}  // namespace stridor
