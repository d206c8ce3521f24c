#pragma once
// Checks on characterizations, such as a build server asks for: "white_noise+5%", "gyro_x:bias_instability+20%".

#include <string>
#include <string_view>
#include <vector>

#include "libchar/characterize/compare/characterization_comparison.hpp"
#include "libchar/core/file/growth_check.hpp"

namespace libchar {

/// Metrics: the keys of the terms; labels are of channels. Throws Error(usage).
GrowthCheck parse_characterization_check(std::string_view text);

/// One sentence for each term that fails: in a later side it is larger than in the first by more than allowed by
/// the whole 95 % interval of their ratio (or above the limit of the first by its whole interval), or the first
/// knows it and the other does not. Throws Error(usage) when `label` is in no side, and Error(check) when the
/// first has no such term: a check that cannot fail.
std::vector<std::string> failures(const CharacterizationComparison& comparison,
                                  const GrowthCheck& check);

}  // namespace libchar
