#pragma once
// The main job: one pass over a log, curves, fit, and everything a report needs to show.
//
//   Characterization imu = characterize("imu.csv", options);     // of a file, whatever its size
//   Characterization imu = characterize(recording, options);     // of samples in memory

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/noise_type.hpp"
#include "libchar/core/document/entry.hpp"
#include "libchar/core/numeric/halving.hpp"
#include "libchar/core/process/progress.hpp"
#include "libchar/core/process/work.hpp"
#include "libchar/fit/fit_options.hpp"
#include "libchar/fit/fit_result.hpp"
#include "libchar/fit/signs/digital.hpp"
#include "libchar/fit/signs/motion.hpp"
#include "libchar/log/quality.hpp"
#include "libchar/log/read.hpp"
#include "libchar/log/recording.hpp"
#include "libchar/spectrum/spectrum.hpp"
#include "libchar/spectrum/welch.hpp"

namespace libchar {

/// How the samples of a channel are to be understood.
enum class SampleKind {
  rate,       ///< the quantity itself (angular rate, acceleration, fractional frequency…)
  phase,      ///< its integral (angle, clock phase): differenced once, a point fewer
  frequency,  ///< a frequency in its unit around `nominal_frequency`: y = (f - nominal) / nominal
};

template <>
inline constexpr auto enum_table<SampleKind> = enum_words<SampleKind, "rate phase frequency">;

/// What is to be computed; nothing else is.
struct Wanted {
  bool quality = true;  ///< and the trace
  bool allan = true;    ///< needs the mixture of a fit for its intervals: one of white noise is made when `fit` is off
  bool spectrum = true;
  bool fit = true;
  bool lines = true;  ///< of the spectrum
};

/// Only rest is analysed.
struct StillOptions {
  bool search = false;                ///< the longest stretch in which no channel moves (motion.hpp)
  std::optional<Interval> stretch_s;  ///< this stretch, in seconds after the first sample
};

struct CharacterizeOptions {
  ReadOptions reading;
  StillOptions still;
  Wanted wanted;
  SampleKind data = SampleKind::rate;
  double nominal_frequency = 0;  ///< for SampleKind::frequency; 0 = values are fractional already
  double unwrap = 0;             ///< the values start again after this much, in their unit; 0: they do not
  /// Runs of this many equal values and longer are missing; so are the samples inside of straight lines of this many
  /// samples and longer. 0: they count.
  std::uint64_t frozen = 0, interpolated = 0;
  /// name of the channel that is the temperature: what it does to the others is taken out before their noise is fitted
  std::string temperature;
  AllanOptions allan;
  std::vector<DeviationType> more_types;  ///< in addition to `allan.type`, of the same samples
  WelchOptions spectrum;
  /// length of a segment where spectrum.segment is 0; 0 = a quarter of a record of at most a leaf
  /// (2^20 samples), 2^16 samples of a longer one
  double segment_s = 0;
  bool quarter_segments = false;                  ///< a quarter of a longer record too
  SegmentAverage average = SegmentAverage::mean;  ///< of the segments
  /// the spectrum in at most so many bins, even on a logarithmic axis of frequency; 0: as Welch gives it
  std::uint64_t spectrum_bins = 400;
  FitOptions fit;
  /// Limit of the samples kept at a time; a leaf of one channel is kept in any case. A log of many channels is read
  /// several times instead. What needs all samples of a log longer than a leaf (a deviation other than oadev at
  /// octaves, a temperature) is refused beyond the limit. Changes no result.
  std::uint64_t memory_bytes = std::uint64_t{1} << 30U;
  /// where `allan` asks for octaves, of a record of at most a leaf: ten averaging times per decade as well, for plots
  bool ten_a_decade = false;
  bool full_overlap = false;  ///< every term of the overlapping Allan deviation whatever the record's length
};

/// What was analysed of a log.
struct Stretch {
  double from_s = 0, to_s = 0;      ///< after the first sample
  bool found = false;               ///< as the longest still one; else as requested
  bool whole = false;               ///< it is all of the log
  std::vector<std::string> moving;  ///< channels that move outside
  std::string sentence;
};

struct ChannelVerification;
struct LimitReport;

struct ChannelResult {
  Channel channel;
  ChannelQuality quality;
  Trace trace;             ///< of the samples as they are in the log
  std::string trace_unit;  ///< of those
  Motion motion;           ///< stretches in which the sensor was moved, where that was looked for
  AllanCurve allan;        ///< with intervals for the fitted mixture; no points when the record is too short
  std::vector<AllanCurve> more_allan;  ///< of `more_types`; no points where a record is too short
  Spectrum spectrum;                   ///< in `spectrum_bins`
  std::vector<SpectralLine> lines;
  std::optional<NoiseFit> fit;
  std::vector<NoiseType> noise_types;  ///< by averaging time; of phase and frequency
  EventSeries means;                   ///< few, over all of the record; empty once the log's thermometers were asked
  DigitalFaults digital;               ///< rails, held values, a staircase
  /// Why something is absent, motion, what the converter did. `judge` (judgement.hpp) adds those of quality and fit.
  std::vector<Finding> findings;
  std::shared_ptr<const ChannelVerification> verification;  ///< when it was asked for (verification.hpp)
};

struct Characterization {
  LogInfo log;
  std::vector<ChannelResult> channels;
  std::optional<Stretch> still;                          ///< where `still` was asked for
  std::vector<Entry> settings;                           ///< effective settings, for provenance (settings.hpp)
  std::vector<std::string> command;                      ///< as typed
  std::vector<std::string> next;                         ///< commands to go on with: for the page
  std::shared_ptr<const TemperatureRecord> temperature;  ///< that was asked for, sample by sample
  std::shared_ptr<const LimitReport> limits;             ///< when they were asked for (limits.hpp)
  WorkDone work{};                                       ///< that it took
  double seconds = 0;  ///< measured; kept apart from everything else in the outputs, NaN: left out
};

/// Throws what `characterize` would refuse of these options by the log's head alone: for a plan, whose tasks
/// run later and elsewhere.
void check_characterization(const std::string& path, const CharacterizeOptions& options);

/// Reads the log once (several times where its channels together are more than `memory_bytes`) and
/// computes what the report shows. Throws Error(input) about the log, Error(usage) about options
/// that do not fit it; what the numbers of a channel do not allow is among its `findings`.
Characterization characterize(const std::string& path, const CharacterizeOptions& options = {},
                              Progress& progress = no_progress());

/// The same of samples in memory: a recording that was read, or arrays of the caller's
/// (recording_view.hpp), which are not copied. Of `options.reading` only the
/// threads count. Throws Error(usage) unless each channel has a column, and all are of one length.
Characterization characterize(const RecordingView& recording, const CharacterizeOptions& options = {},
                              Progress& progress = no_progress());
Characterization characterize(const Recording& recording, const CharacterizeOptions& options = {},
                              Progress& progress = no_progress());

/// What of these options needs every sample of a log of more than a leaf ("the deviation mdev"); empty: nothing does.
std::string what_needs_all_samples(const CharacterizeOptions& options);

/// Which channel `wanted` (a name that it has in the end, a place c0, c1…, a pattern) makes the
/// temperature; none: no channel. Throws Error(usage) for a pattern that several match.
std::optional<std::size_t> temperature_channel(const LogInfo& log, const std::string& wanted);

}  // namespace libchar
