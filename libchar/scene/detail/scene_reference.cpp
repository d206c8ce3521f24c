// The blocks `reference` and `tilt` of a scene file, and the rows h that they go with.

#include "libchar/scene/detail/scene_reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "libchar/core/text/text.hpp"
#include "libchar/scene/detail/scene_fields.hpp"
#include "libchar/scene/detail/scene_parts.hpp"
#include "libchar/scene/detail/scene_sensors.hpp"

namespace libchar {
namespace {

void read_options(const MapReader& at,
                  const SceneFolder& folder,
                  SceneReference& reference,
                  Scene& scene) {
  for (const std::string& key : keys_of(reference_fields()))
    if (scene.simulate && key != "channels" && at.has(key))
      at.refuse(key, "a simulation knows its truth: name truth signals only");
  if (at.has("lag_s") && at.has("delay"))
    refuse_scene("E0735", at, "delay", "lag_s says the same", "give one of them");
  read_fields(reference_fields(), at, reference);
  if (at.has("recording"))
    reference.recording = scene_recording_of(at, "recording", folder, reference.reading, scene);
}

void read_reference(const MapReader& top, const SceneFolder& folder, Scene& scene) {
  if (!top.has("reference")) {
    // What was simulated is known.
    if (scene.simulate) scene.reference.emplace().channels = scene.simulate->truth_names;
    return;
  }
  SceneReference reference;
  const Document& node = top.require("reference");
  std::optional<MapReader> map;
  if (node.kind == Document::Kind::map) map = top.map("reference", keys_of(reference_fields()));
  const MapReader& at = map ? *map : top;
  const char* key = map ? "channels" : "reference";
  reference.channels = at.texts(key);
  if (reference.channels.empty()) refuse_scene("E0736", at, key, "expected the name of a channel");
  const Document& names = at.require(key);
  for (const Document& name : is_scalar(names) ? std::vector<Document>{names} : names.list)
    check_scene_text(top, name, at.path_of(key), scene);
  if (std::set<std::string>(reference.channels.begin(), reference.channels.end()).size() !=
      reference.channels.size())
    refuse_scene("E0737", at, key, "a channel stands twice");
  if (map) read_options(at, folder, reference, scene);
  if (scene.simulate)
    for (const std::string& channel : reference.channels)
      index_of_name(at, key, channel, scene.simulate->truth_names, "a truth signal");
  scene.reference = std::move(reference);
}

void read_tilt(const MapReader& top, const SensorIndex& index, Scene& scene) {
  const MapReader at = top.map("tilt", keys_of(tilt_fields()));
  const auto sensor = [&](const char* key) { return sensor_index(at, key, scene, index); };
  const SceneTilt tilt{sensor("gyroscope"), sensor("accelerometer_x"), sensor("accelerometer_z")};
  if (tilt.gyroscope == tilt.accelerometer_x || tilt.gyroscope == tilt.accelerometer_z ||
      tilt.accelerometer_x == tilt.accelerometer_z)
    refuse_scene("E0747", top, "tilt", "three different sensors make a tilt");
  if (scene.reference && !scene.reference->mean && scene.reference->channels.size() != 1)
    refuse_scene("E0747",
                 top,
                 "reference",
                 "the reference of a tilt is one channel: the angle",
                 "reference: [NAME]");
  scene.tilt = tilt;
}

// Every sensor weighs the same true inputs.
void check_rows(const MapReader& top, const SensorIndex& index, const Scene& scene) {
  if (scene.tilt && !scene.simulate) return;
  std::size_t inputs = scene.sensors[0].h.size();
  if (scene.simulate)
    inputs = scene.simulate->truth.size();
  else if (scene.reference)
    inputs = scene.reference->mean ? 1 : scene.reference->channels.size();
  for (std::size_t i = 0; i < scene.sensors.size(); ++i) {
    const std::vector<double>& h = scene.sensors[i].h;
    const std::string name = printable(scene.sensors[i].name, 40);
    if (h.size() != inputs)
      refuse_scene_value("E0741",
                         top,
                         *index.places[i].node,
                         index.places[i].path,
                         fmt::format("the row h of sensor {} has {}, and there {} {}",
                                     name,
                                     plural(h.size(), "weight"),
                                     inputs == 1 ? "is" : "are",
                                     plural(inputs, "true input")),
                         "give h one weight a truth signal or reference channel");
    const bool blind = std::all_of(h.begin(), h.end(), [](double w) { return w == 0; });
    if (blind && !scene.simulate)
      refuse_scene_value("E0741",
                         top,
                         *index.places[i].node,
                         index.places[i].path,
                         fmt::format("sensor {} sees no input: its row h is zero", name));
  }
}

}  // namespace

void read_scene_reference(const MapReader& top,
                          const SceneFolder& folder,
                          const SensorIndex& index,
                          Scene& scene) {
  read_reference(top, folder, scene);
  if (top.has("tilt")) read_tilt(top, index, scene);
  check_rows(top, index, scene);
}

}  // namespace libchar
