#include "libchar/characterize/curves/log_pair_spectra.hpp"

#include <utility>

#include "libchar/characterize/detail/leaf.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/log/quality.hpp"

namespace libchar {
namespace {

WelchOptions segments_of(const CharacterizeOptions& options, double rate_hz) {
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
                                    const CharacterizeOptions& options,
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
                                 const CharacterizeOptions& options,
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
