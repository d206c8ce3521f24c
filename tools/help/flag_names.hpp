#pragma once
// The library's messages speak of its options by name in backquotes (`rate_hz`); whoever types
// commands knows them as flags (--rate).

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "libchar/core/error.hpp"

namespace sensorchar {

/// The flags that the verb has, which must live as long as the program.
void set_flags_of_verb(const std::set<std::string>& flags);

/// Options of the library with what they are on the command line: a flag, or one with its value ("--bad-rows drop").
std::vector<std::pair<std::string, std::string>> flags_of_options();

/// The text with every option of the library in backquotes replaced by its flag; what has no flag stays.
std::string with_flags(const std::string& message);

/// The same for everything a problem says itself; what it quotes from the input stays. A hint that names an
/// option whose flag is not among those of the verb (none: not known) is of no use here, and goes.
libchar::Problem with_flags(libchar::Problem problem, const std::set<std::string>& of_verb);

}  // namespace sensorchar
