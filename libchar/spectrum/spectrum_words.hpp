#pragma once
// How tables name the values of spectra: their unit, and their word in a column `curve`.

#include <optional>
#include <string>
#include <string_view>

#include "libchar/spectrum/spectrum.hpp"

namespace libchar {

/// "deg/s", "(deg/s)²/Hz", "(deg/s)/√Hz": unit of the values of a spectrum.
std::string spectrum_unit(Scaling scaling, const std::string& unit);

namespace detail {

struct SpectrumValues {
  Scaling scaling = Scaling::psd;
  std::string unit;  ///< of the channel; "" where it says nothing
};
/// The inverse of `spectrum_unit`, also as others write it: "g^2/Hz", "deg²/s²/Hz", "g/sqrt(Hz)". A text that is not
/// of a density or a square is a channel's unit, as that of an ls is.
SpectrumValues values_of_unit(std::string_view text);

struct SpectrumKind {
  Scaling scaling = Scaling::psd;
  Sides sides = Sides::one;
};
/// "psd_one_sided", "lsd_two_sided".
std::string spectrum_kind_word(SpectrumKind kind);
/// Its inverse; nothing for another word.
std::optional<SpectrumKind> spectrum_kind(std::string_view word);

}  // namespace detail
}  // namespace libchar
