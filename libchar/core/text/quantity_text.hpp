#pragma once
// Numbers and quantities with units as one types them: strict where a slip would go unseen (`-1` is
// not a count, `010` neither eight nor ten, `nan` and `1e400` not numbers). Each throws
// Error(usage) with one sentence that says what would have been right.

#include <cstdint>
#include <limits>
#include <string_view>

#include "libchar/core/numeric/interval.hpp"

namespace libchar {

/// A finite number in [lowest, highest].
double parse_number(std::string_view text, double lowest = -std::numeric_limits<double>::max(),
                    double highest = std::numeric_limits<double>::max());

/// A whole number in [lowest, highest], decimal digits only (`1e6` and `1_000_000` are not counts).
std::uint64_t parse_count(std::string_view text, std::uint64_t lowest = 0,
                          std::uint64_t highest = std::numeric_limits<std::uint64_t>::max());

/// Seconds: "90", "90s", "1.5h", "250ms", "10us", "5min", "2d". A bare number is in seconds. >= 0, of what `lasts` > 0.
double parse_duration_s(std::string_view text, bool lasts = false);

/// Hertz: "200", "200Hz", "1.5kHz", "10MHz". > 0.
double parse_rate_hz(std::string_view text);
/// The same, with the uncertainty if one is stated: "200±0.5Hz", "200Hz+-0.1%".
double parse_rate_hz(std::string_view text, double& uncertainty_hz);

/// What such ends are, each with units of its own ("10s..20min", "100Hz..1.5kHz"), or numbers without.
enum class RangeOf { duration_s, rate_hz, number };

/// FROM..TO, FROM < TO: the one grammar of ranges. An end that is left out is open: 0 (of numbers
/// -infinity) or infinity; `end` says so of the last ("50..", "..50", "50..end"). `where`: the
/// option, for the message.
Interval parse_range(std::string_view text, RangeOf what = RangeOf::duration_s, std::string_view where = "");

/// Bytes: "4096", "64k", "4MiB", "2GB" (k, M, G alone are powers of 1024, like KiB, MiB, GiB; kB,
/// MB, GB of 1000). Not below `lowest`: a bare 10 is rather a forgotten unit.
std::uint64_t parse_bytes(std::string_view text, std::uint64_t lowest = 0);

}  // namespace libchar
