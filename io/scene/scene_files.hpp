// The files that a scene names, and the check that they are unchanged since a run began.
#pragma once

#include <string>
#include <vector>

#include "io/scene/scene.hpp"

namespace stridor {

/// A file that a scene names, with a digest of its contents.
struct SceneFile {
  std::string key;     ///< that names it, e.g. "substructures.plate.mass"
  std::string path;    ///< from the root
  std::string digest;  ///< 16 hexadecimal digits (FNV-1a)
};

/// Matrices, and the run file of the initial state. @throws FileError if one cannot be read
std::vector<SceneFile> scene_files(const LoadedScene& loaded);

/// 16 hexadecimal digits that change with any key of the resolved scene and with anything in the
/// files that it names (FNV-1a).
std::string scene_hash(const std::string& resolved, const std::vector<SceneFile>& files);

/// The digests that a run file keeps: a line for the text of the scene as given, and one for every
/// file.
std::string scene_digests(const std::string& text, const std::vector<SceneFile>& files);

/// A scene as a run file keeps it.
struct KeptScene {
  const std::string& text;      ///< as given
  const std::string& resolved;  ///< with all defaults and settings
  const std::string& digests;   ///< scene_digests()
  const std::string& hash;      ///< scene_hash()
};

/// Checks that a run would go on with the scene with which it began: the scene in its file by its
/// hash and digests, and the files that the scene names where they still exist. (One that is gone
/// is refused where it is needed; the initial state is in the checkpoints, too.)
/// @param run_file that keeps it
/// @throws FileError with all that differs
void check_unchanged(const KeptScene& scene, const std::string& run_file);

}  // namespace stridor
