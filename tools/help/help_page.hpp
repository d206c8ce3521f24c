#pragma once
// --help and `help VERB`: what is known of the command line (usage.hpp), wrapped to a width.

#include <string>

#include "help/usage.hpp"

namespace sensorchar {

std::string program_help(const ProgramUsage& program, std::size_t width);
/// Of verbs of two words, those with this first one ("fleet"); "" where there are none.
std::string group_help(const ProgramUsage& program, const std::string& first, std::size_t width);
std::string verb_help(const ProgramUsage& program, const VerbUsage& verb, std::size_t width);

}  // namespace sensorchar
