#pragma once
// The report in sentences: what was found, how far it can be trusted, what to look at.

#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"

namespace libchar {

/// One paragraph for the whole recording.
std::string verdict_of(const Characterization& result);

/// Below this the residuals are not what the model leads one to expect in one record of a thousand.
inline constexpr double kDoubtful = 1e-3;

/// Of all samples, those that are missing.
double missing_share(const ChannelQuality& quality);

/// Title of a term: "White noise", "Bias instability"…; summary.hpp has the field's names.
std::string term_title(Term term);

/// What a fit found, in sentences with numbers in `unit`.
std::vector<std::string> findings(const NoiseFit& fit, const std::string& unit);

/// What a fit found beside its noise terms: temperature, a filter. The last of `findings`.
std::vector<std::string> findings_beside_terms(const NoiseFit& fit, const std::string& unit);

/// What asks for a look before the numbers of this channel are used; empty when nothing does.
std::vector<std::string> cautions(const ChannelResult& channel);

/// How well the model explains the channel, by the p-value of the fit.
std::string goodness_sentence(const Goodness& goodness);

}  // namespace libchar
