#pragma once
// A verb is one file tools/verbs/NAME.cpp that defines
//     VerbEntry verb_NAME();
// with `-` in NAME written `_`. Nothing else is needed: the table of all verbs is made from the
// names of the files (tools/CMakeLists.txt).

#include <functional>
#include <string>
#include <vector>

#include "command_line.hpp"
#include "session.hpp"

namespace sensorchar {

/// A command that works, and what it is for ("an Allan curve of one channel").
struct Example {
  std::string what, command;
};

struct VerbEntry {
  int place;  ///< order of the verbs in the help
  std::string name;
  std::string what;  ///< the line in the help
  /// Adds the verb's options, and returns what runs when it is chosen.
  std::function<std::function<void()>(VerbOptions&, Session&)> add_options;
  std::vector<Example> examples = {};  ///< at least two, for the help and the man page
};

/// All verbs, in the order of the help.
std::vector<VerbEntry> verbs();

}  // namespace sensorchar
