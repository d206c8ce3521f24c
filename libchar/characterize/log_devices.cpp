#include "libchar/characterize/log_devices.hpp"

#include <cmath>

#include "libchar/core/refusal.hpp"

namespace libchar {
namespace {

/// The samples as rates or phases, with the options and units for them.
struct Prepared {
  Recording recording;
  AllanOptions allan;
  double dt_s = 0;
};

Prepared prepared(const std::string& path, const LogAllanOptions& options, Progress& progress) {
  Prepared out{read_recording(path, options.reading, progress), options.allan, 0};
  LogInfo& log = out.recording.info;
  out.dt_s = 1 / known_rate_hz(out.recording.info);
  out.allan.threads = options.reading.threads;
  const double nominal = options.nominal_frequency;
  if (options.data == SampleKind::phase) out.allan.data = DataKind::phase;
  if (options.data == SampleKind::frequency && nominal != 0)
    for (auto& samples : out.recording.samples)
      for (double& f : samples) f = (f - nominal) / nominal;
  for (std::size_t c = 0; c < log.channels.size() && options.data == SampleKind::phase; ++c)
    for (double& phase : out.recording.samples[c]) phase *= detail::differenced_unit(log.channels[c].unit).factor;
  for (Channel& channel : log.channels) {
    if (options.data == SampleKind::phase) channel.unit = detail::differenced_unit(channel.unit).unit;
    if (options.data == SampleKind::frequency && nominal != 0) channel.unit = "1";
  }
  return out;
}

void check_units(const std::vector<Channel>& channels) {
  for (const Channel& channel : channels)
    if (channel.unit != channels[0].unit)
      throw usage_error("E0870")
          .says("the devices of a cornered hat must be in one unit; " + channels[0].name + " is in " + channels[0].unit)
          .got(channel.name + " in " + channel.unit)
          .hint("choose the `channels` that measure the same");
}

/// "a - b", "b - c", "c - a" name three devices; other names are of differences.
std::vector<Channel> devices_of(const std::vector<Channel>& differences) {
  std::vector<Channel> out;
  for (std::size_t i = 0; i < 3; ++i) {
    Channel device = differences[i];
    device.name = "in " + differences[i].name + " and " + differences[(i + 2) % 3].name;
    out.push_back(device);
  }
  return out;
}

}  // namespace

LogHat log_cornered_hat(const std::string& path, const LogAllanOptions& options, bool differences, Progress& progress) {
  const Prepared input = prepared(path, options, progress);
  LogHat out;
  out.log = input.recording.info;
  out.channels = out.log.channels;
  check_units(out.channels);
  const auto& samples = input.recording.samples;
  out.hat = differences ? cornered_hat_of_differences(samples, input.dt_s, input.allan)
                        : cornered_hat(samples, input.dt_s, input.allan);
  if (differences) out.channels = devices_of(out.channels);
  return out;
}

LogDynamic log_dynamic_deviation(const std::string& path, const LogAllanOptions& options, const DynamicTimes& times,
                                 Progress& progress) {
  const Prepared input = prepared(path, options, progress);
  const auto samples_of = [&](double seconds) {
    const double samples = std::round(seconds / input.dt_s);
    return static_cast<std::uint64_t>(std::min(samples, 1e15));
  };
  DynamicOptions dynamic;
  dynamic.window = samples_of(times.window_s);
  if (times.step_s > 0) dynamic.step = std::max<std::uint64_t>(1, samples_of(times.step_s));
  LogDynamic out;
  out.log = input.recording.info;
  for (std::size_t c = 0; c < input.recording.samples.size(); ++c) {
    out.channels.push_back(out.log.channels[c]);
    out.deviations.push_back(dynamic_deviation(input.recording.channel(c), input.dt_s, dynamic, input.allan));
  }
  return out;
}

}  // namespace libchar
