// A locus as a file, with the times at which a run of its scene passes its windows.
#pragma once

#include <string>
#include <vector>

#include "app/stability/stability.hpp"
#include "io/results/locus_file.hpp"

namespace stridor {

/// Windows of a locus; where its key moves the bodies along their way, with the times at which a run
/// of the scene passes them and the growth in them.
std::vector<TimedWindow> timed_windows(const Locus& locus, const NumericKey& key,
                                       const StabilityScene& scene, StabilityFamily& family);

/// Scene, options, key and command of a locus, which its file holds.
struct LocusSource {
  const StabilityScene& scene;
  const StabilityOptions& options;
  const NumericKey& key;
  const std::string& command_line;
  double trusted;  ///< up to where the bodies resolve, Hz
};

/// Writes a file of the kind `locus`. @throws FileError as write_locus_file()
void write_locus(const std::string& path, const Locus& locus,
                 const std::vector<TimedWindow>& windows, const LocusSource& source);

}  // namespace stridor
