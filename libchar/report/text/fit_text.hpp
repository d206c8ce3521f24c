#pragma once
// A fit in text, for a terminal.

#include <string>

#include "libchar/core/text/text_table.hpp"
#include "libchar/fit/fit_result.hpp"
#include "libchar/log/recording.hpp"

namespace libchar {

/// One channel's noise coefficients as a table, with what was done to the data and what to think of the fit.
/// `width`: characters in a line that its table is fitted to; 0: any.
std::string fit_text(const Channel& channel, const NoiseFit& fit, const TextLook& look = {});

}  // namespace libchar
