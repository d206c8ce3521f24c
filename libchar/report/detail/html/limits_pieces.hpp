#pragma once
// The judgement of limits as each output shows it.

#include <string>

#include "libchar/characterize/limits.hpp"

namespace libchar {

/// A section of the page.
std::string limits_section(const LimitReport& report);

}  // namespace libchar
