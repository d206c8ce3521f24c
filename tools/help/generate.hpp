#pragma once
// `sensorchar help [VERB]` and `sensorchar --generate man|bash|zsh|fish|json|schema [NAME]`.

#include <optional>
#include <string>
#include <vector>

#include "help/usage.hpp"

namespace sensorchar {

/// What was asked for, when `command` (argv) is one of these; else nothing. `width` is what help is
/// wrapped to. Throws Error(usage).
std::optional<std::string> generated(const ProgramUsage& program, const std::vector<std::string>& command,
                                     std::size_t width);

}  // namespace sensorchar
