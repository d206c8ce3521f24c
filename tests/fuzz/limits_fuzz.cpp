// Any bytes as limits of a data sheet: JSON when the first byte is odd, YAML else; and what they say of three channels.

#include <cmath>

#include "libchar/model/noise_limits.hpp"
#include "tests/fuzz/fuzz_support.hpp"

using namespace libchar;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
  const std::vector<NamedChannel> channels = {{"gyro_x", "deg/s"}, {"accel_x", "m/s^2"}, {"c2", ""}};
  try {
    const NoiseLimits limits = parse_limits(text, data[0] % 2 == 1 ? "l.json" : "l.yaml");
    for (const ChannelLimit& limit : limits_for(limits, channels)) {
      fuzz::expect(limit.channel < channels.size(), "a channel that is none");
      fuzz::expect(std::isfinite(limit.most) && limit.most >= 0, "a limit that is no number");
    }
  } catch (const Error& error) {
    fuzz::said(error);
  }
  return 0;
}
