#pragma once
// Numbers as people read them, the only place that says how many digits: a page, a terminal, a sentence.
//
// With an interval: as many digits as it supports (`digits_for`, core/term_cells.hpp). In a
// sentence: `brief_text`, two or three digits. Times and sizes in the unit that fits. Never
// `1e-05`. What is read back is written by core/decimal.hpp.

#include <cstdint>
#include <optional>
#include <string>

#include "libchar/core/coefficient.hpp"
#include "libchar/core/numeric/interval.hpp"

namespace libchar {

/// "0.00498", "1.20×10⁻⁵": `digits` significant digits, zeros at the end included; "–" for NaN and infinity.
std::string number_text(double value, int digits = 4);

/// An end of the interval of `of`, with the same power of ten: "10.03×10⁻⁵" to 9.97×10⁻⁵; "no end" for infinity.
std::string end_text(double end, double of, int digits);

/// As `number_text` without zeros at the end: "200", "0.05", "1.2×10⁻⁵".
std::string brief_text(double value, int digits = 3);

/// "10⁻⁵".
std::string power_of_ten(int exponent);

/// Significant digits worth printing of a value with this relative uncertainty: two digits of the uncertainty, 2…6.
int digits_for(double relative_uncertainty);

/// "12.5 ms", "3.2 s", "41 min", "5.6 h", "12 d".
std::string duration_text(double seconds, int digits = 3);

/// "12 %"; "–" for NaN.
std::string percent_text(double share, int digits = 2);

/// How much larger than the best possible: "0.12 %", "85.0 %", from twice on "262 ×" as large; "–" for NaN.
std::string excess_text(double share);

/// "0.0121 … 0.0125", "0.2 … no end"; "–" when it is not known.
std::string interval_text(const Interval& interval, int digits = 4, double factor = 1);

/// "0.0123 [0.0121, 0.0125]", or "≤ 0.001 (95 %)" when not detected, or "–"; each number multiplied by `factor`.
std::string coefficient_text(const Coefficient& coefficient, double factor = 1);
/// The value, or the upper limit with "≤" in front, or "–".
std::string value_text(const Coefficient& coefficient, double factor = 1);

/// A place in a record, in seconds from its start, without an exponent: `2153.67`, `1290550`.
std::string place_text(double seconds);

/// Of a value by its 95 % interval; three where it has none.
int digits_of(double value, const Interval& ci95);
int digits_of(const Coefficient& coefficient);

/// "12 345": thin spaces between groups of three digits.
std::string count_text(std::uint64_t count);

/// "p = 0.42", "p < 0.0001". Of `simulations` that none was as extreme in: "p ≤ 0.005", which is all that they can say.
std::string probability_text(double p, int simulations = 0);

/// "17.1 MB"; "–" where nothing was measured.
std::string bytes_text(const std::optional<std::uint64_t>& bytes);
/// "0.0331 rad/s": four digits; "–" for NaN.
std::string error_text(double value, const std::string& unit);

}  // namespace libchar
