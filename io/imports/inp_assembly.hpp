// Parts, instances and the assembly of Abaqus input.
#pragma once

#include <string>
#include <string_view>

#include "io/imports/inp_lines.hpp"
#include "io/imports/inp_sets.hpp"

namespace stridor {

/// Follows *PART, *INSTANCE and *ASSEMBLY, of which one part with one instance at its own place is
/// accepted: then numbers of nodes mean the same everywhere.
class InpAssembly {
 public:
  struct Name {
    std::string_view text;
    bool is_prefixed = false;  ///< with the name of the instance, which `text` is without
  };

  /// @return whether the keyword is one of these
  /// @throws ConfigError if there is a second part or instance
  bool enter(const InpKeyword& keyword);
  /// The data lines of *INSTANCE.
  /// @throws ConfigError if the instance is moved or turned
  void check_position(InpFields& fields, const TextPlace& line) const;
  /// @throws ConfigError if the keyword's INSTANCE= is another one
  void check_instance(const InpKeyword& keyword) const;
  /// A name or number without "INSTANCE." before it.
  Name resolved(const InpField& field) const;

  InpScope scope() const {
    return is_in_assembly_ && !is_in_instance_ ? InpScope::assembly : InpScope::part;
  }
  /// In the assembly, where nodes are none of the part's.
  bool is_between_instances() const { return is_in_assembly_ && !is_in_instance_; }
  const std::string& instance() const { return instance_.empty() ? part_ : instance_; }

 private:
  void enter_part(const InpKeyword& keyword);
  void enter_instance(const InpKeyword& keyword);

  std::string part_, instance_;
  bool is_in_assembly_ = false;
  bool is_in_instance_ = false;
};

}  // namespace stridor
