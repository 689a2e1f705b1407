// What of two scenes decides about the motion of their bodies.
#pragma once

#include <string>

namespace stridor {

/// A resolved scene and its scene_hash(), as files hold them.
struct SceneInFile {
  std::string hash;
  std::string resolved;
};

/// Whether bodies, contacts, drives and terms of two scenes are the same, so that the eigenvalues of
/// one are those of the other: they may differ in time stepping, initial state, what is recorded,
/// measured, drawn and expected. Scenes of equal text and different hash name files that have
/// changed; of others the files are not compared.
bool has_same_mechanics(const SceneInFile& one, const SceneInFile& other);

}  // namespace stridor
