#include "libchar/fusion/registry.hpp"

#include <array>
#include <string>
#include <vector>

#include "libchar/core/error.hpp"
#include "libchar/core/spelling.hpp"
#include "libchar/fusion/detail/algorithm_list.hpp"

namespace libchar::fusion {

std::span<const Entry> algorithms() {
  static const std::array kAlgorithms{
#define LIBCHAR_ROW(NAME) NAME##_algorithm(),
      LIBCHAR_MORE_ALGORITHMS(LIBCHAR_ROW) LIBCHAR_ALGORITHMS(LIBCHAR_ROW)
#undef LIBCHAR_ROW
  };
  return kAlgorithms;
}

const Entry* find_algorithm(std::string_view name) {
  for (const Entry& candidate : algorithms())
    if (candidate.description->name == name) return &candidate;
  return nullptr;
}

const Entry& algorithm(std::string_view name) {
  if (const Entry* found = find_algorithm(name)) return *found;
  std::vector<std::string> names;
  names.reserve(algorithms().size());
  for (const Entry& candidate : algorithms()) names.emplace_back(candidate.description->name);
  const auto near = nearest(name, names);
  throw Error({ErrorKind::usage,
               "E0853",
               "",
               "no fusion algorithm has this name",
               std::string(name),
               near ? "did you mean " + *near + "?" : "`algorithms` names them"});
}

}  // namespace libchar::fusion
