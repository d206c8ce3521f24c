#pragma once
// Numbers as a page or a terminal shows them: few digits, powers of ten written out, times in the unit
// that fits.

#include <cstdint>
#include <optional>
#include <string>

#include "libchar/core/coefficient.hpp"

namespace libchar {

/// "0.00498", "1.23×10⁻⁵": `digits` significant digits.
std::string number_text(double value, int digits = 4);

/// `digits` significant digits without powers of ten written out ("0.0123", "1.23e-05"); "–" for NaN and infinity.
std::string significant_or_dash(double value, int digits);

/// Significant digits worth printing of a value with this relative uncertainty: two digits of the
/// uncertainty, 2…6.
int digits_for(double relative_uncertainty);

/// "12.5 ms", "3.2 s", "41 min", "5.6 h", "12 d".
std::string duration_text(double seconds);

/// "0.0123 [0.0121, 0.0125]", or "≤ 0.001 (95 %)" when not detected, or "–"; each number multiplied
/// by `factor`.
std::string coefficient_text(const Coefficient& coefficient, double factor = 1);
/// The value, or the upper limit with "≤" in front, or "–".
std::string value_text(const Coefficient& coefficient, double factor = 1);

/// A place in a record, in seconds from its start, without an exponent: "2153.67", "1290550".
std::string place_text(double seconds);

/// "12 345": thin spaces between groups of three digits.
std::string count_text(std::uint64_t count);

/// "p = 0.42", "p < 0.0001". Of `simulations` that none was as extreme in: "p ≤ 0.005", which is all that they can say.
std::string probability_text(double p, int simulations = 0);

/// "82 ns", "3.4 µs"; "17.1 MB"; "–" where nothing was measured.
std::string nanoseconds_text(double ns);
std::string bytes_text(const std::optional<std::uint64_t>& bytes);
/// "0.0331 rad/s": four digits; "–" for NaN.
std::string error_text(double value, const std::string& unit);

}  // namespace libchar
