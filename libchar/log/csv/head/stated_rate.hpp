#pragma once
// What the lines around a table say of its sampling.

#include <optional>
#include <string_view>

namespace libchar::csv {

/// "// Update Rate: 100.0Hz", "OutputRate:,60Hz", "Sample Rate;1000", "Sample Interval,1.6e-09", "Delta_X<tab>0.001": the sampling
/// rate in Hz that a line states; nothing when it states none that can be.
std::optional<double> stated_rate_hz(std::string_view line);

/// Seconds in one count of the stamps: "tscale,0.001" of Gyroflow's .gcsv.
std::optional<double> stated_tick_s(std::string_view line);

}  // namespace libchar::csv
