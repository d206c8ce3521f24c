#pragma once
// How a sensor's filter and its surroundings colour its noise: what multiplies the density of the noise terms.

#include <cstdint>
#include <vector>

#include "libchar/core/document/enum_table.hpp"

namespace libchar {

struct NoiseShape {
  enum class Kind {
    none,
    boxcar,    ///< mean of the last `taps` values; every value repeated `taps` times looks the same
    bartlett,  ///< that twice: triangular weights
    measured,  ///< `ratio` at `frequency_hz`
  };
  Kind kind = Kind::none;
  std::uint64_t taps = 0;            ///< boxcar, bartlett
  std::vector<double> frequency_hz;  ///< measured: rising
  std::vector<double> ratio;         ///< measured: a density over that of the noise terms, > 0
};
template <>
inline constexpr auto enum_table<NoiseShape::Kind> = enum_words<NoiseShape::Kind, "none boxcar bartlett measured">;

/// Power gain at a frequency, 0 < f <= rate/2. boxcar: (sin(pi f m dt) / (m sin(pi f dt)))²; bartlett: its square;
/// measured: that of the nearest point in ln f, 1 from a sixteenth of an octave below the first.
double shape_ratio(const NoiseShape& shape, double frequency_hz, double rate_hz);

}  // namespace libchar
