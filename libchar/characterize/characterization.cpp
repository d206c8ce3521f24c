// The main job as a table of contents: read → per channel its leaves → curves → fit → intervals.
#include "libchar/characterize/characterization.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <set>
#include <utility>

#include "libchar/characterize/detail/channel_stage.hpp"
#include "libchar/characterize/detail/rest_doubt.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/fit/record/mean_meter.hpp"
#include "libchar/log/channel_names.hpp"

namespace libchar {
namespace {

// The stretch of a log that is analysed where only rest is wanted: as the caller says, or the
// longest in which no channel moves.

constexpr std::uint64_t kFewestSamples = 64;  ///< of a series
constexpr double kMostMissingAtRest = 0.01;   ///< share: filled gaps are stiller than any sensor

/// Sees a whole log and says which stretch of it is still.
class StillSearch final : public BlockSink {
 public:
  void begin(const LogInfo& so_far) override { means_.assign(so_far.channels.size(), {}); }
  void block(const SampleBlock& samples) override {
    for (std::size_t c = 0; c < means_.size(); ++c) means_[c].push({samples.channels[c], samples.rows});
  }
  /// Throws Error(numeric) where the log moves throughout, or cannot be searched.
  Stretch finish(const LogInfo& log) const {
    if (!(log.time.rate_hz > 0))
      throw numeric_error("E0705", log.file)
          .says("the rate is not known: no still stretch can be searched")
          .hint("give `rate_hz`");
    const Interval all{0, static_cast<double>(log.samples) / log.time.rate_hz};
    Interval still = all;
    Stretch out;
    std::set<std::string> restless;
    // What is left may show what the whole of it hid.
    for (int round = 0; round < kMostRounds; ++round) {
      std::vector<Interval> left_out;
      std::size_t tested = 0;
      for (std::size_t c = 0; c < means_.size(); ++c) {
        const Motion motion = motion_in(still, means_[c], log.time.rate_hz);
        tested += motion.tested;
        if (round == 0 && motion.whole)
          throw numeric_error("E0705", log.file)
              .says("the channel {} moves throughout: the log has no still stretch", log.channels[c].name)
              .hint("name the stretch with `still` FROM..TO, or choose other `channels`");
        for (const auto* stretches : {&motion.moving_s, &motion.louder_s})
          for (const Interval& s : *stretches) left_out.push_back({still.low + s.low, still.low + s.high});
        if (!motion.moving_s.empty() || !motion.louder_s.empty()) restless.insert(log.channels[c].name);
      }
      if (round == 0 && tested == 0) refuse_untested(log);
      if (left_out.empty()) break;
      still = detail::longest_between(std::move(left_out), still);
    }
    for (const Channel& channel : log.channels)
      if (restless.contains(channel.name)) out.moving.push_back(channel.name);
    out.from_s = still.low;
    out.to_s = still.high;
    out.found = true;
    out.whole = still.low <= 0 && still.high >= all.high;
    return out;
  }

 private:
  static constexpr int kMostRounds = 4;
  [[noreturn]] static void refuse_untested(const LogInfo& log) {
    throw numeric_error("E0705", log.file)
        .says(
            "no channel can be searched for a still stretch: they are short (2048 samples are needed), have many "
            "missing samples, or mostly repeat their values")
        .hint("name the stretch with `still` FROM..TO");
  }
  /// On the clock of the stretch.
  static Motion motion_in(const Interval& still, const MeanMeter& means, double rate_hz) {
    const auto samples = static_cast<double>(means.samples());
    const double count = (still.high - still.low) * rate_hz;
    if (count < kFewestSamples * static_cast<double>(means.per_mean()) ||
        static_cast<double>(means.missing()) > kMostMissingAtRest * samples)
      return {};
    return find_motion(means.series(rate_hz, still));
  }
  std::vector<MeanMeter> means_;
};

/// The stretch that `options` ask for is read: of a window in the options, Error(usage); ends that
/// are none, Error(usage).
void check_still(const StillOptions& still, const ReadOptions& reading) {
  if (!still.search && !still.stretch_s) return;
  if (reading.from_s || reading.to_s)
    throw usage_error("E0704").says("`still` chooses the stretch: it does not go with `from_s` and `to_s`");
  if (!still.stretch_s) return;
  const Interval& s = *still.stretch_s;
  if (!(s.low >= 0) || !(s.low < s.high))
    throw usage_error("E0704")
        .says("the still stretch does not go from a time to a later one")
        .got("{} to {} s", brief_text(s.low, 6), brief_text(s.high, 6));
}

/// Whether a channel says of what was analysed that it moves or changes, too weakly for the search.
bool any_restless(std::span<const ChannelResult> channels) {
  return std::any_of(channels.begin(), channels.end(), [](const ChannelResult& channel) {
    return !channel.motion.moving_s.empty() || !channel.motion.changes.empty() ||
           (channel.fit && has(channel.fit->findings, "not_stationary"));
  });
}

/// "Only the stretch from 38.6 to 186 s was analysed, the longest in which nothing moves."
std::string stretch_sentence(const Stretch& stretch, std::span<const ChannelResult> channels) {
  if (stretch.whole)
    return any_restless(channels) ? "No part of the recording is loud enough to be left out: all of it was analysed."
                                  : "Nothing moves in the recording: all of it was analysed.";
  std::string text =
      fmt::format("Only the stretch from {} to {} s was analysed, {}", brief_text(stretch.from_s, 6),
                  brief_text(stretch.to_s, 6), stretch.found ? "the longest in which nothing moves" : "as requested");
  if (stretch.moving.empty()) return text + ".";
  const std::size_t shown = std::min<std::size_t>(stretch.moving.size(), 6);
  text += " (moving or louder outside: ";
  for (std::size_t i = 0; i < shown; ++i) text += (i == 0 ? "" : ", ") + stretch.moving[i];
  return text + (shown < stretch.moving.size() ? ", …)." : ").");
}

// A channel that is slower than the rows of its table has a clock of its own: blanks between its samples are
// no missing samples.

/// Nothing that is said of the channel in the table's grid is about the sensor.
void doubt(const Channel& channel, bool alone, ChannelResult& result) {
  if (!channel.own_clock.empty()) {
    Finding own = finding("own_stamps", fmt::format("The stamps of the channel are in the column {}: at those of the "
                                                    "table its rate is wrong.",
                                                    channel.own_clock));
    if (alone)
      own.help.push_back(
          {"Read it by its own stamps.", {{"time_column", channel.own_clock}, {"channels", channel.name}}});
    result.findings.push_back(std::move(own));
    return;
  }
  Finding slow = finding("slow_channel",
                         fmt::format("The channel has a value in one of {} rows: in the grid of the table most of its "
                                     "samples are missing, and its rate is wrong.",
                                     brief_text(channel.every, 3)),
                         "in a table of faster rows it has no rate of its own");
  slow.severity = Severity::bad;
  if (alone) slow.help.push_back({"Read it alone.", {{"channels", channel.name}}});
  result.findings.push_back(std::move(slow));
}

/// Reads the slow channels of a log again, each alone on its own grid, and puts what they give in the place
/// of what they gave in the grid of the table. Where the log cannot be read twice, or a temperature binds the
/// channels together, a finding says so.
void read_slow_channels_alone(const std::string& path, const CharacterizeOptions& options, Characterization& result,
                              Progress& progress) {
  std::vector<std::size_t> slow;
  for (std::size_t c = 0; c < result.log.channels.size(); ++c)
    if (result.log.channels[c].every > 1 || !result.log.channels[c].own_clock.empty()) slow.push_back(c);
  if (slow.empty() || result.channels.size() != result.log.channels.size()) return;
  if (read_once(path) || !options.temperature.empty() || result.channels.size() == 1) {
    const bool alone = options.temperature.empty() && result.channels.size() > 1;
    for (const char* code : {"slow_channel", "own_stamps"})
      if (!alone && result.log.warnings.find(code) != nullptr) result.log.warnings.add(code, "", {}, 0).help.clear();
    for (const std::size_t c : slow) doubt(result.log.channels[c], alone, result.channels[c]);
    return;
  }
  const std::vector<std::string> in_log = names_in_log(path, options.reading);
  CharacterizeOptions alone = options;
  for (const char* code : {"slow_channel", "own_stamps"}) result.log.warnings.remove(code);
  for (const std::size_t c : slow) {
    alone.reading = options_of_channels(options.reading, result.log.channels, in_log, {c});
    alone.reading.hash = false;
    Channel& channel = result.log.channels[c];
    if (!channel.own_clock.empty()) alone.reading.time_column = channel.own_clock;
    Characterization own = characterize(path, alone, progress);
    channel.rate_hz = own.log.time.rate_hz;
    result.channels[c] = std::move(own.channels.at(0));
    result.channels[c].channel.rate_hz = channel.rate_hz;
    result.log.warnings.add("own_grid",
                            "channels with a clock of their own in the table, each analysed on its own grid",
                            fmt::format("channel {} at {}", channel.name, detail::frequency_text(channel.rate_hz, 6)));
  }
}

constexpr std::uint64_t kBlockOfMemory = std::uint64_t{1} << 16U;  // rows

/// Where the samples come from.
struct Source {
  std::function<LogInfo(BlockSink& sink)> read;
  std::function<void(BlockSink& sink)> read_again;  ///< none: what was read is gone
};

Characterization characterize_source(const Source& source, const CharacterizeOptions& options, Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const WorkMeter work;
  CharacterizeWorkspace workspace;
  Characterization result;
  for (std::size_t next = 0; next == 0 || next < result.log.channels.size();) {
    ChannelStages stages(options, workspace, next, !source.read_again);
    if (next == 0)
      result.log = source.read(stages);
    else
      source.read_again(stages);
    for (ChannelResult& channel : stages.finish(result.log, progress)) result.channels.push_back(std::move(channel));
    result.temperature = stages.temperature();
    if (stages.end() == next) break;
    next = stages.end();
  }
  if (options.data == SampleKind::rate) detail::doubt_together(result.channels);
  result.work = work.done();
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

/// What is read: the temperature too, where channels were chosen and it is not among them.
ReadOptions with_temperature(const CharacterizeOptions& options) {
  ReadOptions reading = options.reading;
  const auto& channels = reading.channels;
  if (options.temperature.empty() || channels.empty() ||
      std::find(channels.begin(), channels.end(), options.temperature) != channels.end())
    return reading;
  if (!reading.names.empty() || reading.units.size() > 1)
    throw usage_error("E0702")
        .says("with `names` or `units` for each channel, `channels` must hold the temperature")
        .got(options.temperature)
        .hint("add it to `channels`, and its name and unit");
  reading.channels.push_back(options.temperature);
  return reading;
}

/// It was read for the others only.
void drop_temperature(Characterization& result) {
  const auto is_temperature = [&](const Channel& channel) { return channel.name == result.temperature->name; };
  std::erase_if(result.channels, [&](const ChannelResult& c) { return is_temperature(c.channel); });
  std::erase_if(result.log.channels, is_temperature);
}

void check_columns(const RecordingView& recording) {
  if (recording.info.channels.size() != recording.samples.size())
    throw usage_error("E0706").says("a recording has {} columns of samples for {} channels", recording.samples.size(),
                                    recording.info.channels.size());
  for (const auto& column : recording.samples)
    if (column.size() != recording.samples[0].size())
      throw usage_error("E0706").says("the columns of a recording have different lengths");
}

LogInfo push_recording(const RecordingView& recording, BlockSink& sink, Progress& progress) {
  LogInfo log = recording.info;
  log.samples = recording.samples.empty() ? 0 : recording.samples[0].size();
  sink.begin(log);
  SampleBlock block;
  for (; block.first < log.samples; block.first += block.rows) {
    progress.update(static_cast<double>(block.first) / static_cast<double>(log.samples), "reading");
    block.rows = detail::in_memory(std::min<std::uint64_t>(kBlockOfMemory, log.samples - block.first));
    block.channels.clear();
    for (const auto& column : recording.samples) block.channels.push_back(column.data() + block.first);
    sink.block(block);
  }
  return log;
}

/// The window of `still`, and what is said of it.
Stretch still_stretch(const CharacterizeOptions& options, const std::function<LogInfo(BlockSink& sink)>& read) {
  StillSearch search;
  Stretch stretch;
  if (options.still.search) {
    const LogInfo log = read(search);
    stretch = search.finish(log);
  } else {
    stretch.from_s = options.still.stretch_s->low;
    stretch.to_s = options.still.stretch_s->high;
  }
  return stretch;
}

/// The log does reach to the end of the stretch, but for a sample.
void check_reached(const Stretch& stretch, const LogInfo& log) {
  const double rate_hz = log.time.rate_hz;
  const double end_s = stretch.from_s + static_cast<double>(log.samples) / rate_hz;
  if (!(rate_hz > 0) || stretch.found || stretch.to_s <= end_s + 1.5 / rate_hz) return;
  throw usage_error("E0704", log.file)
      .says("the still stretch ends after the log")
      .got("{} s, the log ends at {} s", brief_text(stretch.to_s, 6), brief_text(end_s, 6));
}

bool wants_still(const StillOptions& still) { return still.search || still.stretch_s; }

void note_stretch(Stretch stretch, Characterization& result) {
  if (std::isinf(stretch.to_s))  // open: to the end of the log
    stretch.to_s = stretch.from_s + static_cast<double>(result.log.samples) / result.log.time.rate_hz;
  check_reached(stretch, result.log);
  stretch.sentence = stretch_sentence(stretch, result.channels);
  if (!stretch.whole) result.log.stretch_s = Interval{stretch.from_s, stretch.to_s};
  result.still = std::move(stretch);
}

/// Samples of a recording between two times.
RecordingView between(const RecordingView& recording, const Stretch& stretch) {
  RecordingView part{recording.info, {}};
  const double rate_hz = recording.info.time.rate_hz;
  if (!(rate_hz > 0)) throw usage_error("E0704").says("the rate is not known: there are no times");
  for (const auto& column : recording.samples) {
    const auto at = [&](double time_s) {
      return static_cast<std::size_t>(std::min(static_cast<double>(column.size()), std::round(time_s * rate_hz)));
    };
    const std::size_t first = at(stretch.from_s);
    part.samples.push_back(column.subspan(first, std::max(first, at(stretch.to_s)) - first));
  }
  return part;
}

}  // namespace

void check_characterization(const std::string& path, const CharacterizeOptions& options) {
  check_still(options.still, options.reading);
  CharacterizeOptions asked = options;
  asked.reading = with_temperature(options);
  LogInfo head = read_log_head(path, asked.reading);
  head.bytes = 0;                                     // nothing is kept of it
  if (!(head.time.rate_hz > 0)) asked.segment_s = 0;  // a table tells its rate when it is read
  CharacterizeWorkspace workspace;
  ChannelStages(asked, workspace, 0, false).begin(head);
  if (asked.wanted.spectrum)
    refuse_longer_segment(path, asked.reading, asked.spectrum.segment, asked.segment_s, no_progress());
}

Characterization characterize(const std::string& path, const CharacterizeOptions& options, Progress& progress) {
  check_still(options.still, options.reading);
  ReadOptions chosen = with_temperature(options);
  std::optional<Stretch> stretch;
  if (options.still.search && read_once(path))
    throw usage_error("E0704", path)
        .says("a still stretch is searched in a first reading, and this can be read only once")
        .hint("save it to a file, or name the stretch");
  if (wants_still(options.still)) {
    stretch = still_stretch(options, [&](BlockSink& sink) {
      ReadOptions reading = chosen;
      reading.hash = false;
      return read_log(path, reading, sink, progress);
    });
    if (!stretch->whole) {
      chosen.from_s = stretch->from_s;
      if (std::isfinite(stretch->to_s)) chosen.to_s = stretch->to_s;
    }
  }
  if (options.wanted.spectrum)
    refuse_longer_segment(path, chosen, options.spectrum.segment, options.segment_s, progress);
  Source source;
  source.read = [&](BlockSink& sink) { return read_log(path, chosen, sink, progress); };
  if (!read_once(path))
    source.read_again = [&](BlockSink& sink) {
      ReadOptions reading = chosen;
      reading.hash = false;
      read_log(path, reading, sink, progress);
    };
  Characterization result = characterize_source(source, options, progress);
  if (chosen.channels.size() > options.reading.channels.size()) drop_temperature(result);
  CharacterizeOptions as_read = options;
  as_read.reading = chosen;
  as_read.still = {};
  read_slow_channels_alone(path, as_read, result, progress);
  if (stretch) note_stretch(std::move(*stretch), result);
  return result;
}

Characterization characterize(const Recording& recording, const CharacterizeOptions& options, Progress& progress) {
  return characterize(view_of(recording), options, progress);
}

Characterization characterize(const RecordingView& recording, const CharacterizeOptions& options, Progress& progress) {
  check_columns(recording);
  check_still(options.still, {});
  std::optional<Stretch> stretch;
  if (wants_still(options.still))
    stretch = still_stretch(options, [&](BlockSink& sink) { return push_recording(recording, sink, progress); });
  const RecordingView part = stretch ? between(recording, *stretch) : RecordingView{};
  const RecordingView& used = stretch ? part : recording;
  Source source;
  source.read = [&](BlockSink& sink) { return push_recording(used, sink, progress); };
  source.read_again = [&](BlockSink& sink) { push_recording(used, sink, progress); };
  Characterization result = characterize_source(source, options, progress);
  if (stretch) note_stretch(std::move(*stretch), result);
  return result;
}

}  // namespace libchar
