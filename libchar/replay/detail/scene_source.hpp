#pragma once
// The samples of a scene on their own grid of time, wherever they come from: a recording that is
// read again for each pass (a short text is parsed once and kept), or a simulation that is made again.
// Memory does not grow with the length.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libchar/core/error.hpp"
#include "libchar/core/finding.hpp"
#include "libchar/core/process/progress.hpp"
#include "libchar/log/recording.hpp"
#include "libchar/replay/detail/copied_sensors.hpp"
#include "libchar/scene/scene.hpp"

namespace libchar {

// Where the sensors of an array have samples, and which of them stands still where the others move.

struct ChannelQuality;

/// Where a channel has samples.
struct Presence {
  std::uint64_t first = 0, last = 0, samples = 0;  ///< grid points; samples 0: nowhere
  std::uint64_t still_from = 0, still = 0;         ///< its longest run of one value
  std::uint64_t next_still = 0;                    ///< the longest but that
  std::uint64_t run_from = 0, run = 0;             ///< of the last value
  double value = 0;                                ///< the last one
  struct Run {
    std::uint64_t from = 0, count = 0;
  };
  static constexpr std::size_t kMostRuns = 1 << 17;
  std::vector<Run> runs;  ///< of one value, of detail::kFrozenRun samples and more; so many at most

  /// Consecutive samples, the first of them at a grid point.
  void push(std::uint64_t at, std::span<const double> values);
};

/// One of three or more that stands still for long as neither another nor itself ever does: a noise never gives one
/// value so often, and a quantity that rests between coarse steps does so for all.
bool is_frozen(std::span<const Presence> presence, std::size_t i, std::uint64_t samples);

/// What a sensor that repeats another one is: missing, or as it is recorded (for a method that needs every sensor).
enum class OfCopies { missing, recorded };

struct SourceInfo {
  double rate_hz = 0;
  std::uint64_t samples = 0;
  std::vector<std::string> units;            ///< of the sensors, as the channels say
  std::vector<std::string> reference_units;  ///< of the reference channels in this source
  std::size_t further_axes = 0;              ///< that each sensor names beside its own
  std::vector<LogInfo> logs;                 ///< the recording; empty for a simulation
  std::vector<Presence> presence;            ///< of the sensors; empty for a simulation
  /// of the sensors, then of the references in this source: where they stand still, and are missing
  std::vector<std::vector<Presence::Run>> frozen;
  struct Copy {
    std::size_t original;
    Likeness how;
  };
  std::vector<std::optional<Copy>> copies;  ///< of the sensors: the earlier one that each repeats
  bool copies_missing = false;              ///< they are left out
  Findings samples_say;                     ///< what makes the samples of sensors doubtful
  bool kept = false;                        ///< in memory, not read again for each pass
};

inline constexpr const char* kFrozenMissing = "sensors that are frozen while the others move: missing there";
/// Which of the sensors that are used repeat another one.
void say_copies(
    const SourceInfo& source, const Scene& scene, Findings& to,
    const std::function<bool(std::size_t)>& used = [](std::size_t) { return true; });
/// "NAME from 120 to 240 s", "NAME in 12 stretches of 8 to 50 samples, 3.1 % of the recording".
std::string frozen_words(const std::string& name, const std::vector<Presence::Run>& runs, const SourceInfo& source);

/// Of a recording or a reference (`role`) that the scene names. Throws Error(input).
std::size_t column_of(const LogInfo& log, const std::string& channel, const std::string& scene, const char* role);

/// What a scene asks of a file is the scene's mistake, not one of the command line.
Error of_scene(const Error& error, const std::string& file);

/// Consecutive samples: the sensors (scaled, faults injected), then the reference channels that stand in the same
/// recording, then axis by axis the further axes of all sensors (as recorded). Valid during the call.
using SourceBlock = std::function<void(std::uint64_t first, std::span<const std::span<const double>>)>;

class SceneSource {
 public:
  /// Reads a recording once, for its length and rate. Throws Error(input) when a channel of the
  /// scene is not in the recording or no rate is known.
  SceneSource(const Scene& scene, Progress& progress, OfCopies copies);
  const SourceInfo& info() const { return info_; }
  /// Samples 0 to `until` (not included).
  void stream(std::uint64_t until, const SourceBlock& block, Progress& progress) const;
  /// The reference channels that stand in this source, whole.
  std::vector<std::vector<double>> reference_columns(Progress& progress) const;
  /// The faults that are injected here or were simulated: what the scene knows.
  const std::vector<SensorFault>& known_faults() const { return known_faults_; }

 private:
  void want_channels();
  void describe_simulation();
  void scan(Progress& progress);
  void read_even(Progress& progress);
  /// What is odd about the samples of a channel, of all but the further axes.
  void say_of(std::size_t k, const ChannelQuality& quality, const std::vector<Presence::Run>& runs);
  void note_copies(const CopiedSensors& copies);
  void hide_frozen();
  bool hides_frozen() const;
  void stream_kept(std::uint64_t until, const SourceBlock& block) const;
  void stream_recording(std::uint64_t until, const SourceBlock& block, Progress& progress) const;
  void stream_simulation(std::uint64_t until, const SourceBlock& block, Progress& progress) const;

  const Scene* scene_;
  ArraySimulation simulation_;
  ReadOptions reading_;
  std::vector<std::string> wanted_;        // channels of the recording, sensors first
  std::size_t own_ = 0;                    // of `wanted_`: without the further axes
  std::vector<std::size_t> columns_;       // of the source, for each of `wanted_`
  std::vector<std::vector<double>> kept_;  // a short text or a resampled recording, by column
  SourceInfo info_;
  std::vector<SensorFault> known_faults_, injected_;
};

}  // namespace libchar
