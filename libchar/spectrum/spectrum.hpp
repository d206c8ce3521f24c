#pragma once
// A spectrum: its sides, scaling, bins and their degrees of freedom.

#include <cstdint>
#include <string>
#include <vector>

#include "libchar/spectrum/window.hpp"

namespace libchar {

enum class Sides { one, two };
enum class Scaling { psd, ps, lsd, ls };  ///< U²/Hz, U², U/√Hz, U

template <>
inline constexpr auto enum_table<Sides> = enum_words<Sides, "one two">;
template <>
inline constexpr auto enum_table<Scaling> = enum_words<Scaling, "psd ps lsd ls">;

struct Spectrum {
  Sides sides = Sides::one;
  Scaling scaling = Scaling::psd;
  Window window = Window::hann;
  double rate_hz = 1;
  std::uint64_t segment = 0;   ///< samples per segment as used
  std::uint64_t segments = 0;  ///< averaged (those that touch a missing sample are dropped)
  std::uint64_t dropped = 0;
  double enbw_hz = 0;                ///< equivalent noise bandwidth
  std::vector<double> frequency_hz;  ///< two-sided: from -f_Nyquist (excluded) to +f_Nyquist
  std::vector<double> value;
  /// degrees of freedom per bin (overlap correlation included; half at DC and Nyquist)
  std::vector<double> dof;
  /// Correlation of a bin's power with that 1, 2, … bins away, for white noise: what an average
  /// over bins must account for.
  std::vector<double> neighbour_correlation;
  std::vector<std::string> notes;
};

}  // namespace libchar
