#pragma once
// Where two documents differ, and by how many digits their numbers agree.

#include <limits>
#include <string>
#include <vector>

#include "libchar/core/document/json.hpp"

namespace libchar {

struct JsonDifference {
  std::string at;        ///< "/fit/0/terms/1/value"
  std::string was, now;  ///< short
  /// of numbers: |now - was| over the larger; infinite for anything else, and for what is missing on a side
  double relative = std::numeric_limits<double>::infinity();
};

/// Differences in order of the first document; members named in `ignored` are skipped at every depth.
std::vector<JsonDifference> json_differences(const Json& was,
                                             const Json& now,
                                             const std::vector<std::string>& ignored = {});

}  // namespace libchar
