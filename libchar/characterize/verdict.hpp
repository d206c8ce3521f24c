#pragma once
// The report in sentences: what was found, how far it can be trusted, what to look at.

#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"

namespace libchar {

/// One paragraph for the whole recording.
std::string verdict_of(const Characterization& result);

/// Title of a term: "white noise", "bias instability"…
std::string term_title(Term term);

/// What a fit found, in sentences with numbers in `unit`.
std::vector<std::string> findings(const NoiseFit& fit, const std::string& unit);

/// What asks for a look before the numbers of this channel are used; empty when nothing does.
std::vector<std::string> cautions(const ChannelResult& channel);

/// How well the model explains the channel, by the p-value of the fit.
std::string goodness_sentence(const Goodness& goodness);

}  // namespace libchar
