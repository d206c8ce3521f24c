#pragma once
// Quantities as sentences and tables show them: a frequency in the unit that fits, a value with its uncertainty, a unit
// by its usual symbol. Digits: core/text/readable.hpp.

#include <string>

namespace libchar::detail {

/// "25 Hz", "16.7 mHz", "46 µHz", "12.5 kHz".
std::string frequency_text(double hz, int digits = 3);

/// A value with the half width of its interval, to two digits of that: "-18.0 ± 9.5", "0.00310 ± 0.00062".
std::string plus_minus_text(double value, double half_width);

/// A known unit by its usual symbol ("°C" of "degC"), another as it is written.
std::string usual_unit(const std::string& unit);

}  // namespace libchar::detail
