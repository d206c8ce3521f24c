#pragma once
// --help and `help VERB`: what is known of the command line (usage.hpp), wrapped to a width.

#include <string>

#include "usage.hpp"

namespace sensorchar {

std::string program_help(const ProgramUsage& program, std::size_t width);
std::string verb_help(const ProgramUsage& program, const VerbUsage& verb, std::size_t width);

}  // namespace sensorchar
