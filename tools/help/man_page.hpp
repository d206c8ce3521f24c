#pragma once
// Pages for man(1), of what is known of the command line (usage.hpp).

#include <string>

#include "help/usage.hpp"

namespace sensorchar {

/// sensorchar(1): the verbs, exit codes, environment.
std::string program_man_page(const ProgramUsage& program);
/// sensorchar-VERB(1)
std::string verb_man_page(const ProgramUsage& program, const VerbUsage& verb);

}  // namespace sensorchar
