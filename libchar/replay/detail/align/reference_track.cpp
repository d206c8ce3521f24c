#include "libchar/replay/detail/align/reference_track.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "libchar/core/refusal.hpp"
#include "libchar/core/units.hpp"

namespace libchar {
namespace {

// A time within this share of a sample is the sample's own: rounding must not ask for a neighbour.
constexpr double kOnSample = 1e-6;

}  // namespace

double ReferenceTrack::at(std::size_t channel, double time_s) const {
  const std::vector<double>& track = values[channel];
  const double place = (time_s - start_s) * rate_hz;
  const double below = std::floor(place + kOnSample);
  if (!(below >= 0) || below >= static_cast<double>(track.size())) return kMissing;
  const auto k = static_cast<std::size_t>(below);
  const double rest = place - below;
  if (rest <= kOnSample) return track[k];
  return k + 1 < track.size() ? between(track[k], track[k + 1], rest, period) : kMissing;
}

double ReferenceTrack::curved(std::size_t channel, double time_s) const {
  const std::vector<double>& y = values[channel];
  const double place = (time_s - start_s) * rate_hz, below = std::floor(place + kOnSample);
  if (period > 0 || !(below >= 1) || below + 2 >= static_cast<double>(y.size())) return at(channel, time_s);
  const auto k = static_cast<std::size_t>(below);
  const double f = place - below;
  const double value = -f * (f - 1) * (f - 2) / 6 * y[k - 1] + (f + 1) * (f - 1) * (f - 2) / 2 * y[k] -
                       (f + 1) * f * (f - 2) / 2 * y[k + 1] + (f + 1) * f * (f - 1) / 6 * y[k + 2];
  return std::isfinite(value) && f > kOnSample ? value : at(channel, time_s);
}

double between(double a, double b, double share, double period) {
  double step = b - a;
  if (period > 0) step -= period * std::round(step / period);
  return a + share * step;
}

double full_turn(const std::string& unit) {
  const auto known = find_unit(unit);
  return 2 * std::numbers::pi / (known && known->quantity == Quantity::angle ? known->to_si : 1);
}

ReferenceTrack read_reference(const Scene& scene, const SceneSource& source, Progress& progress) {
  const SceneReference& reference = *scene.reference;
  ReferenceTrack track;
  if (!reference.recording) {
    track.rate_hz = source.info().rate_hz;
    track.units = source.info().reference_units;
    track.values = source.reference_columns(progress);
    if (scene.tilt) track.period = full_turn(track.units[0]);
    return track;
  }
  ReadOptions reading = reference.reading;
  if (reading.names.empty()) reading.channels = reference.channels;
  Recording read;
  try {
    read = read_recording(*reference.recording, reading, progress);
  } catch (const Error& error) {
    throw of_scene(error, *reference.recording);
  }
  track.rate_hz = read.info.time.rate_hz;
  if (!(track.rate_hz > 0))
    throw input_error("E0901", scene.file)
        .says("the reference {} states no sampling rate", read.info.file)
        .hint("reference: {recording: {file: …, rate_hz: …}}");
  for (const std::string& channel : reference.channels) {
    const std::size_t column = column_of(read.info, channel, scene.file, "reference");
    track.values.push_back(read.samples[column]);
    track.units.push_back(read.info.channels[column].unit);
  }
  if (scene.tilt) track.period = full_turn(track.units[0]);
  // Both clocks count from one epoch when both have stamps; else the logs begin together.
  const LogInfo& recording = source.info().logs.at(0);
  if (read.info.time.start_ns && recording.time.start_ns)
    track.start_s = static_cast<double>(*read.info.time.start_ns - *recording.time.start_ns) * 1e-9;
  track.log = std::move(read.info);
  return track;
}

}  // namespace libchar
