#pragma once
// A channel in one sentence: what its noise is, how far that can be used, and what spoils it.

#include <string>

#include "libchar/characterize/judgement.hpp"

namespace libchar {

/// The terms, then what speaks against them; without a fit, why there is none.
std::string summary_sentence(const ChannelResult& channel,
                             const Judgement& judgement,
                             const std::string& unit);

}  // namespace libchar
