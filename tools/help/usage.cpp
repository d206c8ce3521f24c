#include "help/usage.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace sensorchar {

std::string typed(const std::string& verb) {
  std::string words = verb;
  if (const std::size_t hyphen = words.find('-'); hyphen != std::string::npos) words[hyphen] = ' ';
  return words;
}

std::string synopsis(const ProgramUsage& program, const VerbUsage& verb) {
  std::string line = fmt::format("{} {} [OPTION…]", program.name, typed(verb.name));
  for (const OptionUsage& argument : verb.arguments) {
    std::string word = argument.name;
    if (argument.repeatable && !word.ends_with("…")) word += "…";
    line += argument.required ? " " + word : " [" + word + "]";
  }
  return line;
}

std::string flags_and_value(const OptionUsage& option) {
  std::string text = fmt::format("{}", fmt::join(option.flags, ", "));
  if (!option.name.empty()) text += (text.empty() ? "" : " ") + option.name;
  return text;
}

std::vector<std::string> groups_of(const VerbUsage& verb) {
  std::vector<std::string> groups = {""};
  for (const OptionUsage& option : verb.options)
    if (std::find(groups.begin(), groups.end(), option.group) == groups.end()) groups.push_back(option.group);
  return groups;
}

}  // namespace sensorchar
