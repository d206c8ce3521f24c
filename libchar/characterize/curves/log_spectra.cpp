#include "libchar/characterize/curves/log_spectra.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "libchar/characterize/detail/channel_stage.hpp"
#include "libchar/characterize/detail/leaf.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/parallel/parallel.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/gravity.hpp"
#include "libchar/log/quality.hpp"
#include "libchar/spectrum/spectrum.hpp"
#include "libchar/spectrum/welch_sums.hpp"

namespace libchar {
namespace {

WelchOptions welch_options(const LogSpectraOptions& options) {
  WelchOptions welch = options.spectrum;
  welch.threads = options.reading.threads;
  return welch;
}

bool segment_given(const LogSpectraOptions& options) {
  return options.spectrum.segment != 0 || options.segment_s > 0;
}

// A channel that gives no spectrum is named and left out; the others are still of use.
template <typename Make>
void try_channel(LogSpectra& result,
                 const Channel& channel,
                 const std::vector<Finding>& findings,
                 const Make& make) {
  const std::string name = printable(channel.name) + ": ";
  try {
    result.channels.push_back({channel, make(), {}, findings});
    for (const std::string& note : result.channels.back().spectrum.notes)
      result.notes.push_back(name + note);
  } catch (const Error& error) {
    if (error.problem().kind != ErrorKind::numeric) throw;
    result.notes.push_back(name + error.problem().what);
  }
}

/// What the samples of each channel say about themselves, the worst first.
std::vector<std::vector<Finding>> findings_of(const std::vector<Channel>& channels,
                                              std::vector<ChannelQuality> qualities) {
  judge_gravity(channels, [&](std::size_t c) -> ChannelQuality& { return qualities[c]; });
  std::vector<std::vector<Finding>> findings;
  for (ChannelQuality& quality : qualities)
    findings.push_back(worst_first(std::move(quality.findings)));
  return findings;
}

/// Samples are kept only as long as they may be all of a record whose segments are a quarter of it.
class SpectraSink : public BlockSink {
 public:
  explicit SpectraSink(const LogSpectraOptions& options)
      : welch_(welch_options(options)),
        segment_s_(options.segment_s),
        all_(!options.reading.from_s && !options.reading.to_s) {}
  void begin(const LogInfo& so_far) override {
    if (welch_.segment == 0 && segment_s_ > 0)
      welch_.segment = segment_samples(segment_s_, so_far.time.rate_hz);
    meters_.resize(so_far.channels.size());
    kept_.resize(so_far.channels.size());
    arena_.limit_to(threads_beside_reading(so_far, welch_.threads));
    if (welch_.segment != 0 || (all_ && so_far.samples > kLeafSamples)) stream();
  }
  void block(const SampleBlock& samples) override {
    rows_ += samples.rows;
    arena_.run([&] {
      parallel::for_each(0, meters_.size(), [&](std::size_t c) {
        const std::span<const double> more{samples.channels[c], samples.rows};
        meters_[c].push(more);
        if (is_whole())
          kept_[c].insert(kept_[c].end(), more.begin(), more.end());
        else
          streams_[c].push(more);
      });
    });
    if (is_whole() && rows_ > kLeafSamples) stream();
  }
  bool is_whole() const { return streams_.empty(); }
  std::vector<std::vector<double>> kept() { return std::move(kept_); }
  const std::vector<WelchStream>& streams() const { return streams_; }
  std::vector<ChannelQuality> qualities() const {
    std::vector<ChannelQuality> out;
    for (const QualityMeter& meter : meters_) out.push_back(meter.finish());
    return out;
  }

 private:
  void stream() {
    for (std::vector<double>& samples : kept_) {
      streams_.emplace_back(streamed_spectrum(welch_), &workspace_).push(samples);
      samples = std::vector<double>();  // `{}` would keep the memory
    }
  }

  WelchOptions welch_;
  double segment_s_;
  bool all_;  ///< of the log is read: its length may be known
  std::uint64_t rows_ = 0;
  parallel::Threads arena_;
  WelchWorkspace workspace_;
  std::vector<std::vector<double>> kept_;
  std::vector<WelchStream> streams_;
  std::vector<QualityMeter> meters_;
};

LogSpectra spectra_of(const RecordingView& recording,
                      const std::vector<std::vector<Finding>>& findings,
                      const WelchOptions& welch_options,
                      SegmentAverage average) {
  LogSpectra result;
  result.log = recording.info;
  WelchWorkspace workspace;
  for (std::size_t c = 0; c < recording.samples.size(); ++c)
    try_channel(result, recording.info.channels[c], findings[c], [&] {
      const double rate_hz = recording.info.time.rate_hz;
      return average == SegmentAverage::median
                 ? median_welch(recording.samples[c], rate_hz, welch_options)
                 : welch(recording.samples[c], rate_hz, welch_options, &workspace);
    });
  return result;
}

// Where one channel needs shorter segments than another, all get the shortest, so that they share
// one frequency axis.
LogSpectra whole(const RecordingView& recording,
                 const std::vector<std::vector<Finding>>& findings,
                 const LogSpectraOptions& options) {
  known_rate_hz(recording.info);
  WelchOptions welch = welch_options(options);
  if (welch.segment == 0 && options.segment_s > 0)
    welch.segment = segment_samples(options.segment_s, recording.info.time.rate_hz);
  const bool in_leaves = welch.segment == 0 && !options.quarter_segments &&
                         !recording.samples.empty() &&
                         recording.samples.front().size() > kLeafSamples;
  if (in_leaves) welch = streamed_spectrum(welch);
  LogSpectra result = spectra_of(recording, findings, welch, options.average);
  if (in_leaves) result.notes.insert(result.notes.begin(), streamed_segment_note());
  const auto [shortest, longest] = std::minmax_element(
      result.channels.begin(), result.channels.end(), [](const auto& a, const auto& b) {
        return a.spectrum.segment < b.spectrum.segment;
      });
  if (shortest == longest || shortest->spectrum.segment == longest->spectrum.segment) return result;
  welch.segment = shortest->spectrum.segment;
  std::vector<std::string> notes = std::move(result.notes);
  notes.push_back(fmt::format(
      "all channels: segments of {} samples, the shortest that one of them needs", welch.segment));
  result = spectra_of(recording, findings, welch, options.average);
  result.notes.insert(result.notes.begin(), notes.begin(), notes.end());
  return result;
}

LogSpectra whole(const RecordingView& recording, const LogSpectraOptions& options) {
  std::vector<ChannelQuality> qualities;
  for (const auto& samples : recording.samples) {
    QualityMeter meter;
    meter.push(samples);
    qualities.push_back(meter.finish());
  }
  return whole(recording, findings_of(recording.info.channels, std::move(qualities)), options);
}

LogSpectra streamed(const std::string& path, const LogSpectraOptions& options, Progress& progress) {
  SpectraSink sink(options);
  LogSpectra result;
  result.log = read_log(path, options.reading, sink, progress);
  known_rate_hz(result.log);
  const auto findings = findings_of(result.log.channels, sink.qualities());
  if (sink.is_whole()) {
    const Recording recording{std::move(result.log), sink.kept()};
    return whole(view_of(recording), findings, options);
  }
  if (!segment_given(options)) result.notes.push_back(streamed_segment_note());
  for (std::size_t c = 0; c < sink.streams().size(); ++c)
    try_channel(result, result.log.channels[c], findings[c], [&] {
      return sink.streams()[c].finish(result.log.time.rate_hz);
    });
  return result;
}

LogSpectra finished(LogSpectra result, const LogSpectraOptions& options) {
  if (result.channels.empty())
    throw numeric_error("E0715", result.log.file)
        .says("no channel gives a spectrum" +
              (result.notes.empty() ? "" : ": " + result.notes.front()))
        .hint(segment_given(options) ? "try a shorter `segment`" : "");
  for (ChannelSpectrum& c : result.channels) {
    if (options.lines) c.lines = find_lines(c.spectrum);
    if (options.bins > 0) c.spectrum = log_binned(c.spectrum, detail::in_memory(options.bins));
  }
  return result;
}

}  // namespace

LogSpectra log_spectra(const std::string& path,
                       const LogSpectraOptions& options,
                       Progress& progress) {
  refuse_longer_segment(
      path, options.reading, options.spectrum.segment, options.segment_s, progress);
  if (!options.quarter_segments && options.average == SegmentAverage::mean)
    return finished(streamed(path, options, progress), options);
  const Recording recording = read_recording(path, options.reading, progress);
  return finished(whole(view_of(recording), options), options);
}

LogSpectra log_spectra(const RecordingView& recording, const LogSpectraOptions& options) {
  return finished(whole(recording, options), options);
}

namespace {

WelchOptions segments_of(const LogSpectraOptions& options, double rate_hz) {
  WelchOptions welch = options.spectrum;
  welch.threads = options.reading.threads;
  if (welch.segment == 0 && options.segment_s > 0)
    welch.segment = segment_samples(options.segment_s, rate_hz);
  return welch;
}

}  // namespace

LogCrossSpectrum log_cross_spectrum(const std::string& path,
                                    const std::string& first,
                                    const std::string& second,
                                    const LogSpectraOptions& options,
                                    Progress& progress) {
  ReadOptions reading = options.reading;
  if (first == second)
    throw usage_error("E0873").says("a cross spectrum is of two channels").got(first + " twice");
  reading.channels = {first, second};
  Recording recording = read_recording(path, reading, progress);
  // They come in the order of the log.
  const bool turned =
      recording.info.channels[0].name == second || recording.info.channels[1].name == first;
  const std::size_t x = turned ? 1 : 0, y = turned ? 0 : 1;
  const double rate_hz = known_rate_hz(recording.info);
  LogCrossSpectrum out;
  out.first = recording.info.channels[x];
  out.second = recording.info.channels[y];
  WelchOptions welch = segments_of(options, rate_hz);
  const bool in_leaves =
      welch.segment == 0 && !options.quarter_segments && recording.channel(x).size() > kLeafSamples;
  if (in_leaves) welch = streamed_spectrum(welch);
  out.cross = cross_spectrum(recording.channel(x), recording.channel(y), rate_hz, welch);
  if (in_leaves) out.cross.notes.insert(out.cross.notes.begin(), streamed_segment_note());
  out.log = std::move(recording.info);
  return out;
}

LogSpectrograms log_spectrograms(const std::string& path,
                                 const LogSpectraOptions& options,
                                 Progress& progress) {
  Recording recording = read_recording(path, options.reading, progress);
  const double rate_hz = known_rate_hz(recording.info);
  const WelchOptions welch = segments_of(options, rate_hz);
  LogSpectrograms out;
  for (std::size_t c = 0; c < recording.samples.size(); ++c)
    out.spectrograms.push_back(spectrogram(recording.channel(c), rate_hz, welch));
  out.channels = recording.info.channels;
  out.log = std::move(recording.info);
  return out;
}

}  // namespace libchar
