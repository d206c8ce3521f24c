#pragma once
// The judgement of limits for a terminal.

#include <string>

#include "libchar/characterize/limits.hpp"
#include "libchar/core/text/text_table.hpp"

namespace libchar {

std::string limits_text(const LimitReport& report, const TextLook& look = {});

}  // namespace libchar
