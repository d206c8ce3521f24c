#pragma once
// Checks on two characterizations, such as a build server asks for: "white_noise+5%", "gyro_x:bias_instability+20%".

#include <string>
#include <string_view>
#include <vector>

#include "libchar/characterize/compare/characterization_comparison.hpp"
#include "libchar/core/file/growth_check.hpp"

namespace libchar {

/// Metrics: the keys of the terms; labels are of channels. Throws Error(usage).
GrowthCheck parse_characterization_check(std::string_view text);

/// One sentence for each term that fails: in B it is larger than allowed by its whole 95 % interval of the ratio (or above the limit
/// of A by its whole interval), or A knows it and B does not. Throws Error(usage) when `label` is in neither report, and
/// Error(check) when A has no such term: a check that cannot fail.
std::vector<std::string> failures(const CharacterizationComparison& comparison,
                                  const GrowthCheck& check);

}  // namespace libchar
