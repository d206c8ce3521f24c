#pragma once
// What a replay takes its samples from: a scene file, or a recording and what the command line says of it.

#include <optional>
#include <string>
#include <vector>

#include "command_line.hpp"
#include "libchar/scene/scene.hpp"
#include "session.hpp"

namespace sensorchar {

struct ReplaySource {
  std::string path;  ///< of the scene or the recording
  bool allow_outside = false;
  // of a recording
  libchar::ReadOptions reading;
  std::vector<std::string> sensors, reference, models;
  std::string reference_log, models_folder;
  // of either, over what the scene says
  struct Preparation {
    std::string detrend, band;
    std::optional<double> resample_hz, high_pass_hz;
  } prepare;
  std::string learning, evaluation, rest, align, reference_lag, reference_offset;
  std::optional<double> warm_up_s;
  std::vector<std::string> faults;
  bool no_faults = false;
};

/// The argument and the options of a source. Both must live until the verb has run.
void add_replay_source(VerbOptions& options, Session& session, ReplaySource& source);

/// The scene. `scene_file`: where it will be written; empty: nowhere. Throws Error(usage) for
/// options that do not go with what `path` is.
libchar::Scene read_replay_source(const ReplaySource& source, const std::string& scene_file);

}  // namespace sensorchar
