// A scene that is one mass on a half-space, as a family of oscillators that is cheap to compute.
#pragma once

#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/scene/expression.hpp"
#include "io/scene/scene_family.hpp"
#include "solvers/transient/sliding_oscillator.hpp"

namespace stridor {

/// The oscillators of a scene for any values of some of its keys, without reading it again: the
/// expressions that depend on the keys are compiled once, and their values put where they belong.
/// Where they change laws, load or speed alone, the body stays as it is; else it is made anew.
class OscillatorFamily {
 public:
  /// @param keys that vary, at least one
  /// @return null where the scene is of another system (as_oscillator()), or one of the keys moves
  ///         the drive or changes more than single numbers
  static std::unique_ptr<OscillatorFamily> make(const LoadedScene& loaded,
                                                std::vector<NumericKey> keys);
  OscillatorFamily(const OscillatorFamily&) = delete;
  OscillatorFamily& operator=(const OscillatorFamily&) = delete;

  /// @param values at least one per key
  /// @return until the next call; null where the system is no such one
  /// @throws ConfigError naming the values if one is not allowed, or does not fit the others
  /// Cost: where the body stays, some 0.1 µs per expression; else that of make_model()
  const SlidingOscillator* at(std::span<const double> values);

  /// Whether the body stays as it is.
  bool keeps_body() const { return !makes_body_; }

 private:
  /// A number of the scene that varies.
  struct Target {
    const Key* key = nullptr;
    void* object = nullptr;
  };
  /// What gives it its value.
  struct Source {
    std::size_t value = 0;  ///< index of the varied key, where there is no expression
    std::optional<CompiledExpression> expression;

    double of(std::span<const double> values) const {
      return expression ? expression->value() : values[value];
    }
  };
  struct Parameter {
    double* number;
    Source source;
  };
  struct Number {
    Target target;
    Source source;
    bool is_of_drive = false;  ///< else of the laws, or of the body
    double last = std::numeric_limits<double>::quiet_NaN();  ///< that it has been given
  };

  OscillatorFamily(const LoadedScene& loaded, std::vector<NumericKey> keys)
      : loaded_(loaded), keys_(std::move(keys)) {}
  bool add_parameters();
  bool add_numbers();
  bool add_number(const std::string& path, Source source);
  bool find_mass();
  bool assign(std::span<const double> values);
  bool are_laws_sound() const;
  [[noreturn]] void refuse(std::span<const double> values) const;
  void renew_laws();
  ContactParameters& pair();
  const ContactParameters& pair() const;

  LoadedScene loaded_;  ///< its scene is changed in place
  std::vector<NumericKey> keys_;
  std::map<std::string, double> numbers_;  ///< the parameters
  std::vector<std::string> varied_;        ///< names of those that vary, or depend on what does
  std::vector<Parameter> parameters_;      ///< in an order in which they can be computed
  std::vector<Number> changes_;
  bool makes_body_ = false;
  bool are_laws_stale_ = true;  ///< their numbers have changed since the last oscillator
  std::vector<const DriveParameters*> drives_;  ///< of the scene, in the order of System::drives
  // Indices of drives, −1 where there is none.
  int load_drive_ = 0;     ///< that loads the body
  int base_drive_ = -1;    ///< that the body follows
  int master_drive_ = -1;  ///< that the half-space follows
  BodyCache cache_;
  std::optional<SlidingOscillator> oscillator_;
};

}  // namespace stridor
