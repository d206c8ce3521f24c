#pragma once
// Numbers as people read them: few digits, powers of ten written out, times in the unit one would
// say.

#include <string>
#include <string_view>

#include "libchar/core/coefficient.hpp"

namespace libchar {

/// "0.00498", "1.23×10⁻⁵": `digits` significant digits.
std::string people(double value, int digits = 4);

/// Significant digits worth printing of a value with this relative uncertainty: two digits of the
/// uncertainty, 2…6.
int digits_for(double relative_uncertainty);

/// "12.5 ms", "3.2 s", "41 min", "5.6 h", "12 d".
std::string people_seconds(double seconds);

/// "0.0123 [0.0121, 0.0125]", or "≤ 0.001 (95 %)" when not detected, or "–"; each number multiplied
/// by `factor`.
std::string people_coefficient(const Coefficient& coefficient, double factor = 1);
/// The value, or the upper limit with "≤" in front, or "–".
std::string people_value(const Coefficient& coefficient, double factor = 1);

/// "12 345": thin spaces between groups of three digits.
std::string people_count(std::uint64_t count);

/// "p = 0.42", "p < 0.0001".
std::string people_probability(double p);

}  // namespace libchar
