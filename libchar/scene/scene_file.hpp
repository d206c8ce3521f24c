#pragma once
// Reading a scene file.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libchar/core/document/json.hpp"
#include "libchar/log/read.hpp"
#include "libchar/scene/scene.hpp"

namespace libchar {

struct SceneReadOptions {
  bool allow_outside = false;  ///< files outside the scene's folder may be named
  /// The scene is to make its log again: the log may be gone, and logs of its true inputs are read.
  bool again = false;
};

/// Reads `format: scene`, `version: 1`, YAML or JSON (docs/scenes.md). Paths are relative to the scene's folder and
/// stay inside it. Throws Error(input) with place, key and the nearest valid key.
Scene read_scene_file(const std::string& path, const SceneReadOptions& options = {});

/// Is this meant as a scene? By its suffix (.yaml, .yml, .json), or a line `format: scene` among
/// its first bytes. Else it is a log. Reads no more than 4 KiB; false for what cannot be opened.
bool looks_like_scene(const std::string& path);

/// Does this file say `format: scene`? Else it is something else that simulates, such as a model.
bool is_scene_file(const std::string& path);

/// The same from text that stands for a file at `path`.
Scene parse_scene(std::string_view text, const std::string& path, const SceneReadOptions& options = {});

// Whether the filter, the trend and the offset of a scene go together.

/// Why this scene cannot be prepared as it says, a sentence; empty: it can. The rate is not known here.
std::string why_not_prepared(const Scene& scene);

// A scene as YAML.

// The JSON Schema of a scene.

Json scene_schema();

/// The scene as YAML; paths relative to the folder of `scene.file`; models inline.
std::string scene_yaml(const Scene& scene);

// Files that a scene names: next to it or below it, regular, and only read.

struct SceneFolder {
  /// What may be a folder: nothing, a log ("CSV files of a phone"), anything.
  enum class Kind { none, logs, any };
  std::string scene;           ///< path of the scene file
  bool allow_outside = false;  ///< files elsewhere may be named
  bool may_be_absent = false;  ///< a file that is not there yet is only checked for where it would be
};

/// The path of a file named in a scene under `key` ("reference.recording"). Throws Error(input) at `where`
/// ("FILE:LINE:COL") for a path that leaves the scene's folder (by "..", absolute, or over a link). Throws it as well
/// for one that names the scene itself or its folder, or is neither an existing regular file nor a folder that is
/// allowed. Nothing is opened.
std::string resolve_scene_file(const std::string& named, const SceneFolder& folder, const std::string& where,
                               const std::string& key, SceneFolder::Kind folders = SceneFolder::Kind::none);

/// `file` relative to the folder of `scene`, as the scene would name it; absolute when it is
/// elsewhere. Throws Error(output) for a name that is not UTF-8, which YAML does not allow.
std::string path_for_scene(const std::string& file, const std::string& scene);

/// Throws Error(output) when an output would overwrite the scene or a file that it names, or two outputs are one.
void refuse_scene_outputs(const Scene& scene, const std::vector<std::string>& outputs);

// The scene of a recording that somebody describes in a few words instead of in a file.

/// Channels of one recording that measure one quantity.
struct SensorRecording {
  std::string file;                                         ///< of the recording; read several times
  ReadOptions reading;                                      ///< `channels` stays empty
  std::vector<std::string> sensors;                         ///< names, positions c0, c1… or patterns (channel_names)
  std::vector<std::string> reference;                       ///< the same; several: their mean; empty: no reference
  std::string reference_file;                               ///< a log of the reference's own; empty: `file`
  std::vector<std::pair<std::string, std::string>> models;  ///< a sensor, and its model's file
  std::string models_folder;  ///< holds CHANNEL.sensor.yaml of each sensor (a characterization)
  std::string scene_file;     ///< path of the scene; empty: none
};

/// A scene as read_scene_file returns it, with every sensor by its own name. Throws Error(usage) for channels that are
/// not there, that are named twice, or that are in different units (E0749), Error(input) for files that cannot be read.
Scene scene_from_recording(const SensorRecording& recording);

}  // namespace libchar
