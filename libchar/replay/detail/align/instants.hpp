#pragma once
// The instants that are fused: sensors and truth side by side, a column an instant, in blocks.
// Every pass gives the same columns in the same blocks.

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libchar/core/process/progress.hpp"
#include "libchar/replay/detail/align/aligned_pass.hpp"
#include "libchar/replay/detail/align/reference_track.hpp"
#include "libchar/replay/detail/plan/preparation.hpp"
#include "libchar/replay/detail/scene_source.hpp"

namespace libchar {

struct InstantsInfo {
  double rate_hz = 0;        ///< of the instants
  std::int64_t count = 0;    ///< in the whole recording
  double start_s = 0;        ///< of instant 0, seconds from the recording's first sample
  std::size_t averaged = 1;  ///< samples in an instant (a slow reference)
  bool has_reference = false;
  bool slow_reference = false;                        ///< it has less than half as many values as there are samples
  bool slow_samples = false;                          ///< and they stand for the instants of their stamps
  std::string reference_use;                          ///< how truth and samples are matched, a phrase
  std::vector<std::string> units;                     ///< of the sensors, as fused
  std::vector<std::string> input_names, input_units;  ///< of the true inputs, as scored
  std::vector<LogInfo> logs;
  double output_scale = 1;  ///< estimates and truth times this are in `input_units` (tilt: rad inside)
};

class Instants {
 public:
  /// Throws Error(input) when the scene does not fit its files.
  Instants(const Scene& scene, Progress& progress, OfCopies copies = OfCopies::missing);
  const InstantsInfo& info() const { return info_; }
  const SceneSource& source() const { return source_; }

  /// Instants [from, to) in blocks of `size` columns, the last one shorter; aligned when there is an alignment.
  void pass(std::int64_t from, std::int64_t to, std::size_t size, Progress& progress, const InstantsBlock& block) const;
  /// The same as recorded; below the sensors the rows of their further axes, axis by axis.
  void pass_recorded(std::int64_t from, std::int64_t to, std::size_t size, Progress& progress,
                     const InstantsBlock& block) const;
  /// A sensor's samples are multiplied by it (deg/s to rad/s for a tilt), beside the scene's scale.
  double factor(std::size_t sensor) const { return factors_[sensor]; }
  /// From here on what the filter of the scene began with has died away; 0 without one.
  std::int64_t settled() const { return preparation_.filter ? preparation_.filter->settling : 0; }
  /// Variance of white noise behind that filter, over its variance in front; 1 without one.
  double noise_gain() const { return preparation_.filter ? preparation_.filter->noise_gain : 1; }
  /// Subtracted from every sample of a sensor from now on, behind the filter.
  void set_offsets(std::vector<double> offsets) { offsets_ = std::move(offsets); }
  /// What is taken out of the sensors from now on; it must live as long.
  void set_alignment(const SceneAlignment* alignment) { alignment_ = alignment; }
  /// The truth of an instant is the reference so much earlier, from now on. Reads the reference
  /// into memory when it is not there yet.
  void set_lag(double lag_s, Progress& progress);
  /// Subtracted from the one true input from now on; as fused (a tilt in rad).
  void set_reference_offset(double offset) { reference_offset_ = offset; }
  /// The sensors lag the reference by this.
  double lag_s() const { return lag_s_; }
  double reference_offset() const { return reference_offset_; }
  /// The first instant at or after a time in seconds from the recording's first sample.
  std::int64_t instant_at(double time_s) const;

 private:
  void read_slow_reference(Progress& progress);
  std::vector<double> common_level(Progress& progress) const;
  void take_means_over_intervals(double start_s);
  [[noreturn]] void refuse_apart(double length_s) const;
  void note_partial_intervals(double length_s);
  void prepare(Progress& progress);
  void convert_tilt();
  class Columns;

  const Scene* scene_;
  SceneSource source_;
  std::optional<ReferenceTrack> track_;
  InstantsInfo info_;
  std::vector<double> offsets_, factors_;  // a sensor each
  double truth_factor_ = 1, lag_s_ = 0, reference_offset_ = 0;
  Preparation preparation_;
  std::size_t sensors_, inputs_, rows_ = 0;  // rows: with the further axes
  const SceneAlignment* alignment_ = nullptr;
};

}  // namespace libchar
