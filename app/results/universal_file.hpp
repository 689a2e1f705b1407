// Universal files that verbs write: options, heads, and points of bodies as nodes.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/terminal/command.hpp"
#include "io/imports/uff_functions.hpp"
#include "io/results/uff_writer.hpp"
#include "io/scene/scene.hpp"

namespace stridor {

/// How the numbers of functions are wanted.
struct UniversalOptions {
  bool is_binary = false;
  bool is_single = false;
  bool is_given() const { return is_binary || is_single; }
  UffNumbers numbers() const;
};

/// --binary and --single.
void add_universal_options(CLI::App& verb, UniversalOptions& options);

/// Whether a name ends in .uff or .unv.
bool is_universal(const std::string& file);

/// Contents with title, program and date alone.
UffContents headed_contents(const std::string& title);

/// The number by which universal files call what has this unit; UffQuantity::general for others.
UffQuantity quantity_in(const std::string& units);

/// Points of bodies as nodes from 1, in the order in which they are asked for.
class PointNodes {
 public:
  /// @param point     "<body>.<point>"
  /// @param direction x (0), y (1) or z (2)
  UffDof dof(const std::string& point, int direction);
  /// The nodes with their places, where the scene puts them.
  /// @param loaded a scene with these points
  /// @throws ConfigError if it has not all of them; also as parameters_with_files()
  std::vector<UffNode> placed(const LoadedScene& loaded) const;

 private:
  std::map<std::string, std::int64_t> numbers_;
};

}  // namespace stridor
