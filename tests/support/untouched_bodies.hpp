// Bodies of scenes in which nothing is touched.
#pragma once

#include <fstream>
#include <string>

#include "tests/support/temporary_folder.hpp"

namespace stridor::test {

/// The scene of a folder, with this text.
inline std::string scene_of(const TemporaryFolder& folder, const std::string& text) {
  const std::string path = (folder / "scene.yaml").string();
  std::ofstream(path) << "format: 2\n" << text;
  return path;
}

/// Two coordinates that a circulatory force lets flutter.
inline const char* const flutter_body =
    "  oscillator: {type: matrices, mass: [[1, 0], [0, 1]], stiffness: [[1, 0], [0, 1.4]], "
    "terms: [{role: circulatory, matrix: [[0, 1], [-1, 0]], factor: 0.3}], points: {a: {at: [0, "
    "0], x: 1, y: 2}}}\n";

/// A mass on a spring and a damper in y, free along x.
inline const char* const weight_body =
    "  weight: {type: lumped, masses: {m: {mass: 2}}, springs: {s: {at: m, direction: 90 deg, "
    "stiffness: 800, damping: 4}}}\n";

}  // namespace stridor::test
