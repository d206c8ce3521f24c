#include "libchar/characterize/detail/slow_channels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "libchar/core/text/readable.hpp"
#include "libchar/log/channel_names.hpp"

namespace libchar {
namespace {

/// Nothing that is said of the channel in the table's grid is about the sensor.
void doubt(const Channel& channel, ChannelResult& result) {
  Finding slow =
      finding("slow_channel",
              fmt::format("The channel has a value in one of {} rows: in the grid of the "
                          "table most of its samples are missing, and its rate is wrong.",
                          channel.every),
              "in a table of faster rows it has no rate of its own");
  slow.severity = Severity::bad;
  slow.help.push_back({"Read it alone.", {{"channels", channel.name}}});
  result.findings.push_back(std::move(slow));
}

}  // namespace

void read_slow_channels_alone(const std::string& path,
                              const CharacterizeOptions& options,
                              Characterization& result,
                              Progress& progress) {
  std::vector<std::size_t> slow;
  for (std::size_t c = 0; c < result.log.channels.size(); ++c)
    if (result.log.channels[c].every > 1) slow.push_back(c);
  if (slow.empty() || result.channels.size() != result.log.channels.size()) return;
  if (read_once(path) || !options.temperature.empty() || result.channels.size() == 1) {
    for (const std::size_t c : slow) doubt(result.log.channels[c], result.channels[c]);
    return;
  }
  const std::vector<std::string> in_log = names_in_log(path, options.reading);
  CharacterizeOptions alone = options;
  result.log.warnings.remove("slow_channel");
  for (const std::size_t c : slow) {
    alone.reading = options_of_channels(options.reading, result.log.channels, in_log, {c});
    alone.reading.hash = false;
    Characterization own = characterize(path, alone, progress);
    Channel& channel = result.log.channels[c];
    channel.rate_hz = own.log.time.rate_hz;
    result.channels[c] = std::move(own.channels.at(0));
    result.channels[c].channel.rate_hz = channel.rate_hz;
    result.log.warnings.add(
        "own_grid",
        "channels slower than the rows of their table, each analysed on a grid of its own",
        fmt::format("channel {} at {} Hz", channel.name, brief_text(channel.rate_hz, 6)));
  }
}

}  // namespace libchar
