#pragma once
// Runs again the command that a document of results was made by, into another folder, and compares.

#include <string>
#include <vector>

#include "libchar/core/document/json.hpp"
#include "session.hpp"

namespace sensorchar {

struct Rerun {
  std::string document, again;                       ///< the document, and the one of the second run
  std::vector<libchar::JsonDifference> differences;  ///< measured times, the command and the files' digests apart
  /// tables, models: name and whether the bytes are the same
  std::vector<std::pair<std::string, bool>> files;
  bool same_program = false;
  /// everything is the same, or the numbers of the document agree to `kSameDigits`
  bool holds() const;
};

/// Digits that another build, processor or version of a library is allowed (docs/reliability.md).
inline constexpr double kSameDigits = 1e-8;

struct RerunOptions {
  std::string document;     ///< that characterize or replay wrote
  std::string folder;       ///< of the second run
  std::string inputs_in;    ///< where its inputs are looked for ("": from here)
  bool allow_read = false;  ///< its command may read from other places than there and next to it
};

/// Runs with the words of the document's command as its verb understands them, but into `folder`; nothing else
/// is written. Throws
/// Error(usage) where the command does anything else or reads elsewhere, and what the run throws.
Rerun rerun(Session& session, const RerunOptions& options);

}  // namespace sensorchar
