#pragma once
// The judgement of limits for a terminal.

#include <string>

#include "libchar/characterize/limits.hpp"

namespace libchar {

std::string limits_text(const LimitReport& report, bool colours = false);

}  // namespace libchar
