#pragma once
// Values of a scene file that are no single number or text: how the rows of its keys read and write them.

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/document/document.hpp"
#include "libchar/core/document/entry.hpp"
#include "libchar/core/document/schema.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/scene/scene.hpp"
#include "libchar/scene/scene_file.hpp"
#include "libchar/simulate/signal.hpp"

namespace libchar {

/// [from, to]; `end` stands for the end of the recording.
std::optional<TimeWindow> window_of(const MapReader& at, std::string_view key);
void write_window(std::string_view key, const std::optional<TimeWindow>& window, std::vector<Entry>& out);

/// A number, or the word for finding it out.
struct OrEstimate {
  double value = 0;
  bool estimate = false;
};
/// `expected` in the words of its refusal ("a number of seconds").
OrEstimate number_or_estimate(const MapReader& at, std::string_view key, const std::string& expected);
/// Nothing of zero.
void write_or_estimate(std::string_view key, const OrEstimate& said, std::vector<Entry>& out);

/// A word that needs no quotes.
Entry word_entry(std::string_view key, std::string word);

// What the readers of a scene's blocks share: refusals, names, files.

// ---- refusals ----

/// "WHERE: error CODE: KEY: …"
Refusal scene_refusal(const char* code, const MapReader& at, std::string_view key);

/// The same about a value that stands in a list.
Refusal scene_refusal_at(const char* code, const MapReader& at, const Document& node, const std::string& path);

/// A scalar: a name, a path, a number.
bool is_scalar(const Document& node);

/// Names go into logs, reports and terminals: no zero byte, a warning about what cannot be printed.
void check_scene_text(const MapReader& at, const Document& node, const std::string& path, Scene& scene);

/// The word at `key`, one of `names`; else E0738 with the nearest of them.
std::size_t index_of_name(const MapReader& at, std::string_view key, const std::string& name,
                          const std::vector<std::string>& names, const std::string& what);

/// From 1 to 1024.
void check_oversampling(const MapReader& at, std::uint64_t oversampling);

// ---- files ----

/// The path behind `key`, checked, and noted in `scene.files`.
std::string scene_file_of(const MapReader& at, std::string_view key, const SceneFolder& folder, Scene& scene,
                          SceneFolder::Kind folders = SceneFolder::Kind::none);

/// A path, or a map with a path and how to read the file.
std::string scene_recording_of(const MapReader& at, std::string_view key, const SceneFolder& folder,
                               ReadOptions& reading, Scene& scene);

// The block `simulate` of a scene file.

// The description of a true signal in a scene or beside it.

/// One signal: a map {kind, …} with the keys of its kind; a bare word is a kind, a bare number a
/// constant. `earlier` names the signals that stand before it (`of` may be such a name or an index
/// from 0). Samples of kind recording are left unread.
SignalSpec read_signal(const Document& node, const std::string& file, const std::string& path,
                       const std::vector<std::string>& earlier = {});

/// The block `simulate`, without sensors and faults.
ArraySimulation scene_simulation_of(const MapReader& top, const SceneFolder& folder, Scene& scene);

// The block `sensors` of a scene file.

/// Where the sensors of a scene stand in its file, and which has which name.
struct SensorIndex {
  struct Place {
    const Document* node;
    std::string path;  ///< "sensors[3]"
  };
  std::vector<Place> places;  ///< of scene.sensors
  std::map<std::string, std::size_t> by_name;
};

/// The block `sensors`, into `scene.sensors`.
SensorIndex read_scene_sensors(const MapReader& top, const SceneFolder& folder, Scene& scene);

/// The sensor that `key` names.
std::size_t sensor_index(const MapReader& at, std::string_view key, const Scene& scene, const SensorIndex& index);

}  // namespace libchar
