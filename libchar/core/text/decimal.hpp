#pragma once
// Decimals that read back to the same double. Those that people read are made by core/readable.hpp.

#include <optional>
#include <string>
#include <string_view>

namespace libchar {

/// Shortest decimal that reads back to the same double (`0.1`, `1e-05`, `nan`, `inf`).
std::string shortest(double value);

/// As `shortest`, with a decimal point always present (`200.0`, `1.0e-05`): YAML 1.1 readers take `1e-05` for a string.
std::string shortest_yaml(double value);

/// To this many significant digits; what is not finite as it is.
double rounded(double value, int digits);

/// The whole text as one finite double (std::from_chars rules: no leading '+' or blanks, no locale), else nothing.
std::optional<double> parse_double(std::string_view text);

}  // namespace libchar
