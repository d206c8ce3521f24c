#pragma once
// The report in sentences: what was found, how far it can be trusted, what to look at.

#include <string>
#include <vector>

#include "libchar/characterize/judgement.hpp"

namespace libchar {

/// One paragraph for the whole recording, `judged` a channel each: as its badges say.
std::string verdict_of(const Characterization& result, const std::vector<Judgement>& judged);
std::string verdict_of(const Characterization& result);

/// What a fit found, in sentences with numbers in `unit`.
std::vector<std::string> findings(const NoiseFit& fit, const std::string& unit);

/// Findings of a fit other than its noise terms: temperature, a filter. The last of `findings`.
std::vector<std::string> findings_beside_terms(const NoiseFit& fit, const std::string& unit);

}  // namespace libchar
