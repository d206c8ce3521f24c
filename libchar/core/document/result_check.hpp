#pragma once
// Are results what their document says, and are its inputs still those that it was made from?

#include <string>
#include <vector>

#include "libchar/core/document/json.hpp"

namespace libchar {

enum class FileState {
  same,     ///< the digest is that of the document
  changed,  ///< another one
  missing,  ///< cannot be found or read
  there,    ///< the document has no digest of it (the document itself, streamed estimates, results of older versions)
  unknown,  ///< not a file (standard input)
};

/// "same", "changed"…
std::string_view state_word(FileState state);

struct CheckedFile {
  std::string path;
  bool input = false;
  FileState state = FileState::there;
};

/// One document of results (report.json, runs.json, lot.json).
struct ResultCheck {
  std::string document, version, build;  ///< of the program that wrote it; "" where it does not say
  std::vector<CheckedFile> files;
  bool holds() const;  ///< nothing changed, nothing missing
};

/// One of them, which may be larger than a document that people write; discarded if it is not JSON. Throws Error(input)
/// where it cannot be read.
Json result_document(const std::string& path);

namespace detail {
/// All documents in a folder that name files of theirs, or the one document. Throws Error(input) where there is none,
/// or one cannot be read, and Error(output) where a run was interrupted there.
std::vector<std::string> result_documents(const std::string& folder_or_document);
}  // namespace detail

/// The files of each of the `detail::result_documents`. Paths of inputs are those of the document, below `inputs_in`
/// where they are relative ("": as they are).
std::vector<ResultCheck> check_results(const std::string& folder_or_document, const std::string& inputs_in = "");

}  // namespace libchar
