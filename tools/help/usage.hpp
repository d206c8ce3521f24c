#pragma once
// The command line of the program: its verbs with their arguments and options, as they are parsed. Help, man pages and
// completions are made of it (help_page.hpp, man_page.hpp, completion.hpp), so that none of them can lag behind.

#include <string>
#include <vector>

#include "verb.hpp"

namespace sensorchar {

enum class ValueKind { none, text, words, file, folder };

struct OptionUsage {
  std::vector<std::string> flags;  ///< "-c", "--channel"; none: an argument by its place
  std::string name;                ///< what stands for the value, "" for a flag
  ValueKind kind = ValueKind::none;
  std::vector<std::string> words;  ///< the values that are known beforehand
  bool comma_list = false;         ///< one value may list several
  bool required = false, repeatable = false;
  std::string group;                  ///< heading in the help, "" for the verb's own
  std::string help;                   ///< what it does, unit, default
  std::string only;                   ///< where it has an effect ("with --curve"), "" everywhere
  std::vector<std::string> excludes;  ///< flags that it does not go with
};

struct VerbUsage {
  std::string name, what;
  std::vector<OptionUsage> arguments, options;
  std::vector<Example> examples;
};

struct ProgramUsage {
  std::string name, what, version, released, footer;
  std::vector<OptionUsage> options;  ///< before the verb
  std::vector<VerbUsage> verbs;
};

/// As it is typed: "fleet plan" for the verb "fleet-plan".
std::string typed(const std::string& verb);

/// "sensorchar fit [OPTION…] LOG|CURVE"
std::string synopsis(const ProgramUsage& program, const VerbUsage& verb);

/// "-o, --output FILE"
std::string flags_and_value(const OptionUsage& option);

/// The headings of a verb's options in their order, "" first.
std::vector<std::string> groups_of(const VerbUsage& verb);

}  // namespace sensorchar
