#include "libchar/characterize/curves/log_spectra.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "libchar/characterize/detail/longest_segment.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/gravity.hpp"
#include "libchar/log/quality.hpp"
#include "libchar/spectrum/log_spectrum.hpp"
#include "libchar/spectrum/welch_stream.hpp"

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

// One segment a channel in memory, however long the log is.
class SpectraSink : public BlockSink {
 public:
  explicit SpectraSink(const LogSpectraOptions& options)
      : welch_(welch_options(options)), segment_s_(options.segment_s) {}
  void begin(const LogInfo& so_far) override {
    if (welch_.segment == 0) welch_.segment = segment_samples(segment_s_, so_far.time.rate_hz);
    for (std::size_t c = 0; c < so_far.channels.size(); ++c)
      streams_.emplace_back(welch_, &workspace_);
    meters_.resize(streams_.size());
  }
  void block(const SampleBlock& samples) override {
    for (std::size_t c = 0; c < streams_.size(); ++c) {
      streams_[c].push({samples.channels[c], samples.rows});
      meters_[c].push({samples.channels[c], samples.rows});
    }
  }
  const std::vector<WelchStream>& streams() const { return streams_; }
  std::vector<ChannelQuality> qualities() const {
    std::vector<ChannelQuality> out;
    for (const QualityMeter& meter : meters_) out.push_back(meter.finish());
    return out;
  }

 private:
  WelchOptions welch_;
  double segment_s_;
  WelchWorkspace workspace_;
  std::vector<WelchStream> streams_;
  std::vector<QualityMeter> meters_;
};

LogSpectra streamed(const std::string& path, const LogSpectraOptions& options, Progress& progress) {
  SpectraSink sink(options);
  LogSpectra result;
  result.log = read_log(path, options.reading, sink, progress);
  known_rate_hz(result.log);
  const auto findings = findings_of(result.log.channels, sink.qualities());
  for (std::size_t c = 0; c < sink.streams().size(); ++c)
    try_channel(result, result.log.channels[c], findings[c], [&] {
      return sink.streams()[c].finish(result.log.time.rate_hz);
    });
  return result;
}

std::vector<std::vector<Finding>> findings_in(const RecordingView& recording) {
  std::vector<ChannelQuality> qualities;
  for (const auto& samples : recording.samples) {
    QualityMeter meter;
    meter.push(samples);
    qualities.push_back(meter.finish());
  }
  return findings_of(recording.info.channels, std::move(qualities));
}

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

// Segments of a quarter of the record: the record has to be there first. Where one channel needs
// shorter segments than another, all get the shortest, so that they share one frequency axis.
LogSpectra whole(const RecordingView& recording, const LogSpectraOptions& options) {
  known_rate_hz(recording.info);
  WelchOptions welch = welch_options(options);
  if (welch.segment == 0 && options.segment_s > 0)
    welch.segment = segment_samples(options.segment_s, recording.info.time.rate_hz);
  const auto findings = findings_in(recording);
  LogSpectra result = spectra_of(recording, findings, welch, options.average);
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
  if (segment_given(options) && options.average == SegmentAverage::mean)
    return finished(streamed(path, options, progress), options);
  const Recording recording = read_recording(path, options.reading, progress);
  return finished(whole(view_of(recording), options), options);
}

LogSpectra log_spectra(const RecordingView& recording, const LogSpectraOptions& options) {
  return finished(whole(recording, options), options);
}

}  // namespace libchar
