#pragma once
// Which power law a clock's noise follows at an averaging time, by the lag-1 autocorrelation, as Stable32 names it.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace libchar {

/// Spectrum of the fractional frequency S_y(f) ~ f^alpha: 2 white phase, 1 flicker phase, 0 white
/// frequency, -1 flicker frequency, -2 random-walk frequency, -3 and -4 beyond.
struct NoiseType {
  std::uint64_t m = 1;
  double tau_s = 0;
  int alpha = 0;
  double estimate = 0;  ///< of alpha, before rounding
};

/// "white phase", "flicker phase", "white frequency", "flicker frequency", "random-walk frequency";
/// "flicker walk of frequency" (-3) and "random run of frequency" (-4).
std::string_view noise_type_name(int alpha);

/// Of phase readings decimated by m; nothing when fewer than 30 of them are left or they do not
/// vary. Readings must be present.
std::optional<NoiseType> lag1_noise_type(std::span<const double> phase, std::uint64_t m, double dt_s);

/// Averaging factors 1, 2, 4… while enough readings are left. At most 1 % of the readings may be
/// missing; these are interpolated, and left out at the ends. Empty otherwise.
std::vector<NoiseType> lag1_noise_types(std::span<const double> phase, double dt_s);

/// "white phase from 1 s to 32 s, flicker phase at 64 s, white frequency from 128 s to 8192 s"; empty without types.
std::string noise_types_text(std::span<const NoiseType> types);

}  // namespace libchar
