#include "libchar/scene/recorded_signal.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/log/read.hpp"

namespace libchar {

void read_recorded_signal(SignalSpec& signal,
                          const std::string& place,
                          const ArraySimulation& simulation,
                          Findings& warnings) {
  if (signal.kind != "recording") return;
  const auto refusal = [&]() { return usage_error("E0721", place).got(signal.file); };
  ReadOptions reading;
  reading.hash = false;
  if (!signal.channel.empty()) reading.channels = {signal.channel};
  Recording log = read_recording(signal.file, reading);
  if (log.samples.size() != 1)
    throw refusal()
        .says("the recording holds {} channels", log.samples.size())
        .hint("name one: channel=NAME");
  const double rate = log.info.time.rate_hz;
  if (rate > 0 && std::abs(rate / simulation.rate_hz - 1) > 1e-4)
    throw refusal()
        .says("the recording has {} Hz, and the simulation runs at {} Hz",
              brief_text(rate, 6),
              brief_text(simulation.rate_hz, 6))
        .hint("`rate_hz` " + shortest(rounded(rate, 6)));
  signal.samples = std::move(log.samples[0]);
  if (signal.samples.empty()) throw refusal().says("the recording holds no sample");
  if (signal.samples.size() < simulation.samples)
    warnings.add("recorded_signal_short",
                 "a recorded signal ends before the simulation; its last sample is held",
                 place);
}

}  // namespace libchar
