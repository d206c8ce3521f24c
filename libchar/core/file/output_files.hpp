#pragma once
// The files of one job: all of them or none.

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/document/json.hpp"
#include "libchar/core/file/whole_file.hpp"

namespace libchar {

struct OutputFile {
  std::string path, text;
};

/// Makes the folder and finds out whether these files can be written, before hours of work. Throws as `write_outputs`.
void check_outputs(const std::vector<std::string>& paths, const std::filesystem::path& folder,
                   const std::vector<std::string>& inputs, bool force);

/// The same where nothing is made yet: files of a folder that does not exist cannot be in the way. For results whose
/// other names are known only once they are there.
void foresee_outputs(const std::vector<std::string>& paths, const std::filesystem::path& folder,
                     const std::vector<std::string>& inputs, bool force);

/// Makes the folder and writes all files before the first gets its name: a full disk leaves none of them. A journal in
/// the folder states first what is to be done, so that the next run finishes what a killed one began. The folder is
/// locked meanwhile: sets of two runs never mix. With `force`, removes the files that a replaced document (.json) lists
/// ("files") and the new one does not. Throws Error(output) when one exists and `force` is false, when one is of
/// `inputs`, or when another run keeps writing there. `streamed` are files of the set that were written piece by piece,
/// in the same folder. Returns the names that were removed.
std::vector<std::string> write_outputs(const std::vector<OutputFile>& outputs, const std::filesystem::path& folder,
                                       const std::vector<std::string>& inputs, bool force,
                                       const std::vector<WholeFile*>& streamed = {});

/// Gives files that were written piece by piece their names together, as `write_outputs` does; those of another folder
/// than the first file's follow as a set of their own. Throws Error(output).
void commit_together(const std::vector<WholeFile*>& files);

/// Throws Error(output) where the output is the input or a part of it: an input is never overwritten. Parts are the
/// files of a rosbag2 recording and the sidecar of an array. Of a folder of results they are the files that its
/// documents name; of a fleet its plan, tasks and results.
void refuse_same_file(const std::string& input, const std::string& output);

/// A file that was written piece by piece, and what went into it.
struct WrittenFile {
  std::string path, sha256;
};
namespace detail {
WrittenFile as_written(const OutputFile& file);
}

/// Into a document among them: "files", their names in the folder (what a later run may remove), and "files_sha256",
/// the digest of each but the documents themselves (what `check_results` looks at).
void name_files(Json& document, const std::vector<OutputFile>& outputs);
void name_files(Json& document, const std::vector<WrittenFile>& outputs);

/// The names that a document in a file gives so, in their order; empty if it is not such a document.
/// Throws Error(input) where it cannot be read.
namespace detail {
std::vector<std::string> named_files(const std::string& document_file);
}

/// Throws Error(output) where a run was interrupted while the folder's files got their names: some may be older than
/// others. Of a file, where it is one of them.
void refuse_interrupted(const std::filesystem::path& folder_or_file);

// File names from names that a log brought along.

/// A file name for a channel: letters of any script, digits, '.', '_' and '-' are kept; blanks, other ASCII, controls
/// and bytes that are not UTF-8 become '_'; never empty, never starting with '.', at most 100 bytes of whole
/// characters.
std::string file_name_for(std::string_view channel);

/// The same, with _2, _3… behind it when an earlier name differs by nothing or by capitals only (some file systems do
/// not tell those apart). `taken` remembers the names given, in small letters.
std::string unused_file_name_for(std::string_view channel, std::set<std::string>& taken);

}  // namespace libchar
