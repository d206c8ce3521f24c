#pragma once
// The scene of a recording that somebody describes in a few words instead of in a file.

#include <string>
#include <utility>
#include <vector>

#include "libchar/log/read.hpp"
#include "libchar/scene/scene.hpp"

namespace libchar {

/// Channels of one recording that measure one quantity.
struct SensorRecording {
  std::string file;                    ///< of the recording; read several times
  ReadOptions reading;                 ///< `channels` stays empty
  std::vector<std::string> sensors;    ///< names, positions c0, c1… or patterns (channel_names)
  std::vector<std::string> reference;  ///< the same; several: their mean; empty: no reference
  std::string reference_file;          ///< a log of the reference's own; empty: `file`
  std::vector<std::pair<std::string, std::string>> models;  ///< a sensor, and its model's file
  std::string models_folder;  ///< holds CHANNEL.sensor.yaml of each sensor (a characterization)
  std::string scene_file;     ///< path of the scene; empty: none
};

/// A scene as read_scene_file returns it, with every sensor by its own name. Throws Error(usage) for
/// channels that are not there, that are named twice, or that are in different units (E0749), Error(input)
/// for files that cannot be read.
Scene scene_from_recording(const SensorRecording& recording);

}  // namespace libchar
