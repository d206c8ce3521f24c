#pragma once
// Completion of the command line in bash, zsh and fish, of what is known of it (usage.hpp).

#include <string>

#include "help/usage.hpp"

namespace sensorchar {

std::string bash_completion(const ProgramUsage& program);
std::string zsh_completion(const ProgramUsage& program);
std::string fish_completion(const ProgramUsage& program);

}  // namespace sensorchar
