#pragma once
// Runs again what a document of results says it was made by, into another folder, and compares.

#include <string>
#include <vector>

#include "libchar/core/document/json_difference.hpp"
#include "session.hpp"

namespace sensorchar {

struct Rerun {
  std::string document, again;  ///< the document, and the one of the second run
  std::vector<libchar::JsonDifference>
      differences;  ///< measured times, the command and the files' digests apart
  /// tables, models: name and whether the bytes are the same
  std::vector<std::pair<std::string, bool>> files;
  bool same_program = false;
  /// everything is the same, or the numbers of the document agree to `kSameDigits`
  bool holds() const;
};

/// Digits that another build, processor or version of a library is allowed (docs/reliability.md).
inline constexpr double kSameDigits = 1e-8;

/// `document` was written by characterize or replay; its inputs are where its command says, from
/// `inputs_in` ("": from here). Runs with the words of that command, but into `folder`; nothing
/// else is written. Throws Error(usage) where the command does anything else, and what the run
/// throws.
Rerun rerun(Session& session,
            const std::string& document,
            const std::string& folder,
            const std::string& inputs_in);

}  // namespace sensorchar
