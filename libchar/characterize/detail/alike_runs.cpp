#include "libchar/characterize/detail/alike_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/characterize/compare/runs.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/text/readable.hpp"

namespace libchar {
namespace {

constexpr double kOtherRate = 0.01;  ///< relative: clocks of one kind of sensor differ by less

[[noreturn]] void refuse_run(const Characterization& run,
                             const std::string& what,
                             const std::string& hint = "") {
  throw Error({ErrorKind::input, "E0761", run.log.file, what, "", hint});
}

void check_channels(const Characterization& first, const Characterization& run) {
  for (const ChannelResult& c : first.channels) {
    const ChannelResult* const other = find_channel(run, c.channel.name);
    if (other == nullptr)
      refuse_run(
          run,
          fmt::format("has no channel {}, which {} has: runs of one sensor have the same channels",
                      c.channel.name,
                      first.log.file),
          "`channels` takes those that all have");
    if (other->channel.unit != c.channel.unit)
      refuse_run(
          run,
          fmt::format("channel {} is in {}, and in {} in {}: runs of one sensor have one unit",
                      c.channel.name,
                      other->channel.unit.empty() ? "no unit" : other->channel.unit,
                      c.channel.unit.empty() ? "no unit" : c.channel.unit,
                      first.log.file),
          "`units` says it where a log does not");
  }
  for (const ChannelResult& c : run.channels)
    if (find_channel(first, c.channel.name) == nullptr)
      refuse_run(
          run,
          fmt::format(
              "has a channel {}, which {} has not: runs of one sensor have the same channels",
              c.channel.name,
              first.log.file),
          "`channels` takes those that all have");
}

}  // namespace

const ChannelResult* find_channel(const Characterization& result, const std::string& name) {
  for (const ChannelResult& c : result.channels)
    if (c.channel.name == name) return &c;
  return nullptr;
}

void refuse_same_recording(std::span<const Characterization> runs) {
  for (std::size_t i = 0; i < runs.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (!runs[i].log.sha256.empty() && runs[i].log.sha256 == runs[j].log.sha256)
        throw Error({ErrorKind::input,
                     "E0762",
                     runs[i].log.file,
                     fmt::format("is the same recording as {}: taken twice it would count as two",
                                 runs[j].log.file),
                     "",
                     "leave one of them out"});
}

void check_runs(std::span<const Characterization> runs) {
  if (runs.size() < 2)
    throw Error({ErrorKind::usage,
                 "E0205",
                 "",
                 "one recording is not several runs",
                 "",
                 "name two at least"});
  refuse_same_recording(runs);
  const Characterization& first = runs[0];
  for (const Characterization& run : runs) {
    check_channels(first, run);
    const double rate = run.log.time.rate_hz, other = first.log.time.rate_hz;
    if (std::abs(rate - other) > kOtherRate * other)
      refuse_run(
          run,
          fmt::format("is sampled at {} Hz, and {} at {} Hz: runs of one sensor have one rate",
                      brief_text(rate, 6),
                      first.log.file,
                      brief_text(other, 6)));
    if (std::none_of(run.channels.begin(), run.channels.end(), [](const ChannelResult& c) {
          return c.fit.has_value();
        }))
      refuse_run(
          run,
          run.channels.empty() || run.channels[0].findings.empty()
              ? "no channel of this run could be fitted"
              : "no channel of this run could be fitted: " + run.channels[0].findings[0].sentence,
          "leave this run out");
  }
}

}  // namespace libchar
