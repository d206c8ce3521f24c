// The main job as a table of contents: read → per channel its leaves → curves → fit → intervals.
#include "libchar/characterize/characterization.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>

#include "libchar/characterize/detail/channel_stages.hpp"
#include "libchar/characterize/detail/longest_segment.hpp"
#include "libchar/characterize/detail/slow_channels.hpp"
#include "libchar/characterize/detail/still.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/term_cells.hpp"
#include "libchar/log/channel_names.hpp"
#include "libchar/log/gravity.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kBlockOfMemory = std::uint64_t{1} << 16U;  // rows

/// Where the samples come from.
struct Source {
  std::function<LogInfo(BlockSink& sink)> read;
  std::function<void(BlockSink& sink)> read_again;  ///< none: what was read is gone
};

Characterization characterize_source(const Source& source,
                                     const CharacterizeOptions& options,
                                     Progress& progress) {
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
    for (ChannelResult& channel : stages.finish(result.log, progress))
      result.channels.push_back(std::move(channel));
    result.temperature = stages.temperature();
    if (stages.end() == next) break;
    next = stages.end();
  }
  if (options.wanted.quality && options.data == SampleKind::rate) {
    std::vector<Channel> channels;
    for (const ChannelResult& channel : result.channels) channels.push_back(channel.channel);
    judge_gravity(channels,
                  [&](std::size_t c) -> ChannelQuality& { return result.channels[c].quality; });
  }
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
    throw Error({ErrorKind::usage,
                 "E0702",
                 "",
                 "with `names` or `units` for each channel, `channels` must hold the temperature",
                 options.temperature,
                 "add it to `channels`, and its name and unit"});
  reading.channels.push_back(options.temperature);
  return reading;
}

/// It was read for the others only.
void drop_temperature(Characterization& result) {
  const auto is_temperature = [&](const Channel& channel) {
    return channel.name == result.temperature->name;
  };
  std::erase_if(result.channels, [&](const ChannelResult& c) { return is_temperature(c.channel); });
  std::erase_if(result.log.channels, is_temperature);
}

void check_columns(const RecordingView& recording) {
  const auto refuse = [](const std::string& what) {
    throw Error({ErrorKind::usage, "E0706", "", what, "", ""});
  };
  if (recording.info.channels.size() != recording.samples.size())
    refuse(fmt::format("a recording has {} columns of samples for {} channels",
                       recording.samples.size(),
                       recording.info.channels.size()));
  for (const auto& column : recording.samples)
    if (column.size() != recording.samples[0].size())
      refuse("the columns of a recording have different lengths");
}

LogInfo push_recording(const RecordingView& recording, BlockSink& sink, Progress& progress) {
  LogInfo log = recording.info;
  log.samples = recording.samples.empty() ? 0 : recording.samples[0].size();
  log.read_ahead = false;
  sink.begin(log);
  SampleBlock block;
  for (; block.first < log.samples; block.first += block.rows) {
    progress.update(static_cast<double>(block.first) / static_cast<double>(log.samples), "reading");
    block.rows = std::min(kBlockOfMemory, log.samples - block.first);
    block.channels.clear();
    for (const auto& column : recording.samples)
      block.channels.push_back(column.data() + block.first);
    sink.block(block);
  }
  return log;
}

/// The window of `still`, and what is said of it.
Stretch still_stretch(const CharacterizeOptions& options,
                      const std::function<LogInfo(BlockSink& sink)>& read) {
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
  throw Error(
      {ErrorKind::usage,
       "E0704",
       log.file,
       "the still stretch ends after the log",
       fmt::format("{} s, the log ends at {} s", brief_text(stretch.to_s, 6), brief_text(end_s, 6)),
       ""});
}

bool wants_still(const StillOptions& still) {
  return still.search || still.stretch_s;
}

void note_stretch(Stretch stretch, Characterization& result) {
  if (std::isinf(stretch.to_s))  // open: to the end of the log
    stretch.to_s =
        stretch.from_s + static_cast<double>(result.log.samples) / result.log.time.rate_hz;
  check_reached(stretch, result.log);
  stretch.sentence = stretch_sentence(stretch);
  if (!stretch.whole) result.log.stretch_s = Interval{stretch.from_s, stretch.to_s};
  result.still = std::move(stretch);
}

/// Samples of a recording between two times.
RecordingView between(const RecordingView& recording, const Stretch& stretch) {
  RecordingView part{recording.info, {}};
  const double rate_hz = recording.info.time.rate_hz;
  if (!(rate_hz > 0))
    throw Error(
        {ErrorKind::usage, "E0704", "", "the rate is not known: there are no times", "", ""});
  for (const auto& column : recording.samples) {
    const auto at = [&](double time_s) {
      return static_cast<std::size_t>(
          std::min(static_cast<double>(column.size()), std::round(time_s * rate_hz)));
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
    refuse_longer_segment(
        path, asked.reading, asked.spectrum.segment, asked.segment_s, no_progress());
}

Characterization characterize(const std::string& path,
                              const CharacterizeOptions& options,
                              Progress& progress) {
  check_still(options.still, options.reading);
  ReadOptions chosen = with_temperature(options);
  std::optional<Stretch> stretch;
  if (options.still.search && read_once(path))
    throw Error({ErrorKind::usage,
                 "E0704",
                 path,
                 "a still stretch is searched in a first reading, and this can be read only once",
                 "",
                 "save it to a file, or name the stretch"});
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

Characterization characterize(const Recording& recording,
                              const CharacterizeOptions& options,
                              Progress& progress) {
  return characterize(view_of(recording), options, progress);
}

Characterization characterize(const RecordingView& recording,
                              const CharacterizeOptions& options,
                              Progress& progress) {
  check_columns(recording);
  check_still(options.still, {});
  std::optional<Stretch> stretch;
  if (wants_still(options.still))
    stretch = still_stretch(
        options, [&](BlockSink& sink) { return push_recording(recording, sink, progress); });
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
