#include "libchar/characterize/curves/log_spectra.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "libchar/characterize/detail/leaf.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/quality.hpp"

namespace libchar {
namespace {

CharacterizeOptions spectra_alone(const CharacterizeOptions& options) {
  CharacterizeOptions out = options;
  const bool lines = options.wanted.lines;
  out.wanted = {.quality = false, .allan = false, .spectrum = true, .fit = false, .lines = lines};
  out.spectrum.threads = options.reading.threads;
  return out;
}

/// The shortest segment of channels that share a rate and not a segment; 0: there is none.
std::uint64_t shared_segment(const Characterization& found) {
  std::uint64_t shortest = 0;
  bool differ = false;
  for (const ChannelResult& c : found.channels) {
    if (c.spectrum.value.empty() || c.channel.rate_hz > 0) continue;
    differ = differ || (shortest > 0 && c.spectrum.segment != shortest);
    if (shortest == 0 || c.spectrum.segment < shortest) shortest = c.spectrum.segment;
  }
  return differ ? shortest : 0;
}

/// A note of every channel is said once.
void add_notes(const std::vector<ChannelResult>& channels, std::vector<std::string>& notes) {
  for (const ChannelResult& c : channels)
    for (const std::string& note : c.spectrum.notes) {
      const bool all = std::all_of(channels.begin(), channels.end(), [&](const ChannelResult& one) {
        return std::count(one.spectrum.notes.begin(), one.spectrum.notes.end(), note) > 0;
      });
      if (!all) notes.push_back(printable(c.channel.name) + ": " + note);
      if (all && &c == &channels.front()) notes.push_back(note);
    }
}

/// `wanted`: samples of a segment that was asked for; 0: none was.
LogSpectra spectra_of(Characterization found, std::uint64_t wanted) {
  LogSpectra out;
  if (found.still) out.notes.push_back(found.still->sentence);
  const bool longer = wanted > found.log.samples;
  if (longer)
    out.notes.push_back(
        fmt::format("a segment of {} samples is longer than the record of {}", wanted, found.log.samples));
  for (ChannelResult& c : found.channels) {
    if (!c.spectrum.value.empty()) {
      if (longer) continue;
      out.channels.push_back(std::move(c));
      continue;
    }
    for (const Finding& one : c.findings)
      if (one.code == "not_computed" || one.code == "no_fit")
        out.notes.push_back(printable(c.channel.name) + ": " + one.sentence);
  }
  if (out.channels.empty())
    throw numeric_error("E0715", found.log.file)
        .says("no channel gives a spectrum" + (out.notes.empty() ? "" : ": " + out.notes.front()))
        .hint(longer ? "try a shorter `segment`" : "");
  add_notes(out.channels, out.notes);
  out.log = std::move(found.log);
  return out;
}

/// Where one channel needs shorter segments than another, all get the shortest, so that they share one axis.
template <typename Characterize>
LogSpectra on_one_axis(const CharacterizeOptions& options, const Characterize& characterize) {
  CharacterizeOptions asked = spectra_alone(options);
  Characterization found = characterize(asked);
  const double rate_hz = known_rate_hz(found.log);
  const std::uint64_t wanted = asked.spectrum.segment != 0 || !(asked.segment_s > 0)
                                   ? asked.spectrum.segment
                                   : segment_samples(asked.segment_s, rate_hz);
  const std::uint64_t segment = wanted > found.log.samples ? 0 : shared_segment(found);
  if (segment == 0) return spectra_of(std::move(found), wanted);
  asked.spectrum.segment = segment;
  LogSpectra out = spectra_of(characterize(asked), 0);
  out.notes.push_back(
      fmt::format("all channels: segments of {} samples, the shortest that one of them needs", segment));
  return out;
}

}  // namespace

LogSpectra log_spectra(const std::string& path, const CharacterizeOptions& options, Progress& progress) {
  return on_one_axis(options, [&](const CharacterizeOptions& asked) { return characterize(path, asked, progress); });
}

LogSpectra log_spectra(const RecordingView& recording, const CharacterizeOptions& options) {
  return on_one_axis(options, [&](const CharacterizeOptions& asked) { return characterize(recording, asked); });
}

namespace {

WelchOptions segments_of(const CharacterizeOptions& options, double rate_hz) {
  WelchOptions welch = options.spectrum;
  welch.threads = options.reading.threads;
  if (welch.segment == 0 && options.segment_s > 0) welch.segment = segment_samples(options.segment_s, rate_hz);
  return welch;
}

}  // namespace

LogCrossSpectrum log_cross_spectrum(const std::string& path, const std::string& first, const std::string& second,
                                    const CharacterizeOptions& options, Progress& progress) {
  ReadOptions reading = options.reading;
  if (first == second) throw usage_error("E0873").says("a cross spectrum is of two channels").got(first + " twice");
  reading.channels = {first, second};
  Recording recording = read_recording(path, reading, progress);
  // They come in the order of the log.
  const bool turned = recording.info.channels[0].name == second || recording.info.channels[1].name == first;
  const std::size_t x = turned ? 1 : 0, y = turned ? 0 : 1;
  const double rate_hz = known_rate_hz(recording.info);
  LogCrossSpectrum out;
  out.first = recording.info.channels[x];
  out.second = recording.info.channels[y];
  WelchOptions welch = segments_of(options, rate_hz);
  const bool in_leaves = welch.segment == 0 && !options.quarter_segments && recording.channel(x).size() > kLeafSamples;
  if (in_leaves) welch = streamed_spectrum(welch);
  out.cross = cross_spectrum(recording.channel(x), recording.channel(y), rate_hz, welch);
  if (in_leaves) out.cross.notes.insert(out.cross.notes.begin(), streamed_segment_note());
  out.log = std::move(recording.info);
  return out;
}

LogSpectrograms log_spectrograms(const std::string& path, const CharacterizeOptions& options, Progress& progress) {
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
