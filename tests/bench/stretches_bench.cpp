// One long log in stretches: a log to try it with, one stretch by one machine, and the merge.
// Memory and time: /usr/bin/time -v.
// Usage: stretches_bench make SAMPLES LOG.f32 [HOLES]        white noise and a walk at
//                                                            1000 Hz; one sample of HOLES is missing
//        stretches_bench take LOG STATE FIRST_LEAF END_LEAF   STATE.0, STATE.1 …: a file for each channel
//        stretches_bench divide LOG FOLDER STRETCHES         all of them, one after the other
//        stretches_bench merge STATE…                        what was found, and a digest of its bits
//        stretches_bench plain LOG [STATE…]                  streamed; and how far what was merged is from that
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "libchar/characterize/stretches.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/file/sha256.hpp"
#include "libchar/core/file/whole_file.hpp"
#include "libchar/log/channel_names.hpp"

namespace {

using namespace libchar;

void make(std::uint64_t samples, const std::string& path, std::uint64_t holes) {
  std::mt19937_64 generator(5);
  std::normal_distribution<float> normal;
  double walk = 0;
  std::ofstream out(path, std::ios::binary);
  std::vector<float> block(1U << 16U);
  for (std::uint64_t done = 0; done < samples; done += block.size()) {
    const std::uint64_t count = std::min<std::uint64_t>(block.size(), samples - done);
    for (std::uint64_t i = 0; i < count; ++i) {
      if (i % 64 == 0) walk += 1.6e-4 * static_cast<double>(normal(generator));
      block[i] = static_cast<float>(0.3 + walk) + 0.05F * normal(generator);
      if (holes > 0 && generator() % holes == 0) block[i] = std::numeric_limits<float>::quiet_NaN();
    }
    out.write(reinterpret_cast<const char*>(block.data()), static_cast<std::streamsize>(count * sizeof(float)));
  }
  std::ofstream(path + ".json") << R"({"dtype": "f32", "endian": "little", "rate_hz": 1000,
 "channels": [{"name": "gyro", "unit": "deg/s"}]})";
}

void take(const std::string& path, const std::string& state, StretchRange range) {
  std::size_t channel = 0;
  characterize_stretch(path, {}, range, path, [&](const std::string& bytes) {
    write_whole_file(fmt::format("{}.{}", state, channel++), bytes, true);
  });
}

Characterization merged(const std::vector<std::string>& files) {
  std::vector<NamedState> states;
  for (const std::string& file : files) states.push_back(state_in_file(file));
  return characterize_from_stretches(states, {});
}

/// All numbers of a result, with their bits.
std::string digest_of(const Characterization& found) {
  Sha256 digest;
  const auto add = [&](double value) { digest.update({reinterpret_cast<const char*>(&value), sizeof value}); };
  for (const ChannelResult& channel : found.channels) {
    for (const AllanPoint& point : channel.allan.points) add(point.deviation);
    for (const double value : channel.spectrum.value) add(value);
    for (const double value : channel.trace.low) add(value);
    if (channel.fit)
      for (const double theta : channel.fit->theta) add(theta);
    add(channel.quality.mean);
    add(channel.quality.standard_deviation);
    add(channel.quality.difference_kurtosis);
  }
  return digest.finish();
}

double apart(double a, double b) { return a == b ? 0 : std::abs(a - b) / std::max(std::abs(a), std::abs(b)); }

void compare(const Characterization& one, const Characterization& other) {
  for (std::size_t c = 0; c < one.channels.size(); ++c) {
    const ChannelResult &x = one.channels[c], &y = other.channels[c];
    double allan = 0, spectrum = 0, fit = 0;
    for (std::size_t i = 0; i < x.allan.points.size(); ++i)
      allan = std::max(allan, apart(x.allan.points[i].deviation, y.allan.points[i].deviation));
    for (std::size_t k = 0; k < x.spectrum.value.size(); ++k)
      spectrum = std::max(spectrum, apart(x.spectrum.value[k], y.spectrum.value[k]));
    if (x.fit && y.fit)
      for (std::size_t t = 0; t < x.fit->theta.size(); ++t)
        fit = std::max(fit, apart(x.fit->theta[t], y.fit->theta[t]));
    fmt::print("{}: Allan {:.1e} of {} points, spectrum {:.1e}, fit {:.1e}, mean {:.1e}, sd {:.1e}\n", x.channel.name,
               allan, x.allan.points.size(), spectrum, fit, apart(x.quality.mean, y.quality.mean),
               apart(x.quality.standard_deviation, y.quality.standard_deviation));
  }
}

int run(const std::vector<std::string>& words) {
  const std::string& what = words.at(0);
  const std::vector<std::string> rest(words.begin() + 1, words.end());
  if (what == "make") make(std::stoull(rest.at(0)), rest.at(1), rest.size() > 2 ? std::stoull(rest[2]) : 0);
  if (what == "take") take(rest.at(0), rest.at(1), {std::stoull(rest.at(2)), std::stoull(rest.at(3))});
  if (what == "divide") {
    const std::uint64_t leaves = leaves_of(read_log_head(rest.at(0), {}).rows);
    const std::uint64_t stretches = std::stoull(rest.at(2));
    for (std::uint64_t s = 0; s < stretches; ++s)
      take(rest[0], fmt::format("{}/{:03}.state", rest.at(1), s),
           {s * leaves / stretches, (s + 1) * leaves / stretches});
  }
  if (what == "merge") {
    const Characterization found = merged(rest);
    for (const ChannelResult& channel : found.channels)
      fmt::print("{}: {} samples, mean {:.17g}, sd {:.17g}, {} Allan deviations\n", channel.channel.name,
                 channel.quality.samples, channel.quality.mean, channel.quality.standard_deviation,
                 channel.allan.points.size());
    fmt::print("digest {}\n", digest_of(found));
  }
  if (what == "plain") {
    CharacterizeOptions options;
    options.memory_bytes = 1U << 20U;
    const Characterization whole = characterize(rest.at(0), options);
    fmt::print("digest {}\n", digest_of(whole));
    if (rest.size() > 1) compare(merged({rest.begin() + 1, rest.end()}), whole);
  }
  return 0;
}

}  // namespace

int main(int count, char** words) {
  try {
    return run({words + 1, words + count});
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
