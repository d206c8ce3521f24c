#pragma once
#include <string>

#include "libchar/log/inspection.hpp"

namespace libchar {

/// What is in a log, in text, for a terminal: how it was read, what was guessed and repaired, and a
/// line a channel.
std::string inspection_text(const Inspection& inspection, std::size_t width = 0);

}  // namespace libchar
