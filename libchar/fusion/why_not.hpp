#pragma once
// Who can run on what is known of an array.

#include <string>

#include "libchar/fusion/algorithm.hpp"

namespace libchar::fusion {

/// Empty: the algorithm can run on this. Else what a report prints behind its name: "needs the sampling rate".
std::string why_not(const Description& description, const Array& array);

}  // namespace libchar::fusion
