#pragma once
// One run of the program, and what every verb does with it.

#include <functional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "libchar/core/document/json.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/process/work.hpp"
#include "libchar/log/recording.hpp"
#include "terminal.hpp"

namespace sensorchar {

struct Session {
  std::vector<std::string> command;  ///< argv as given
  std::set<std::string> flags;       ///< that the verb has: hints name no others
  Terminal terminal;
  bool wrote = false;                     ///< something has its name already, should the rest fail
  bool strict = false;                    ///< warnings end the run with exit code 3
  libchar::WorkMeter work;                ///< from the beginning
  std::vector<std::string> warned_files;  ///< files that had warnings, in order
};

/// On stderr, as at the end of a run: for runs that go on.
void say_error(Session& session, const libchar::Error& error);
/// Says the warnings of one input on stderr and remembers them for --strict.
void report_warnings(Session& session, const libchar::LogInfo& info);
/// What is known of a channel, at most five lines, the worst first.
void report_findings(Session& session, const std::string& channel, const std::vector<libchar::Finding>& findings);
/// Of a document: all about the recording and of the channels that fit one of the patterns (none: all).
void report_findings(Session& session, const std::string& document, std::span<const libchar::Finding> findings,
                     const std::vector<std::string>& channels);
void report_warnings(Session& session, const libchar::Findings& warnings, const std::string& file);

/// With --strict nothing is written of an input that has warnings: throws where one was said.
void refuse_strict(const Session& session);

/// {"format":FORMAT,"version":1,"tool":{name,version},"command":[…],"input":[{path,sha256,bytes}…],
/// "findings":[{file,code,severity,sentence,count,…}],"measured":{"work":{…}}}: the head of every --json
/// document; the verb adds its own keys behind.
libchar::Json document_head(const Session& session, const std::string& format,
                            const std::vector<const libchar::LogInfo*>& inputs);

/// Texts in addition to results in files; nothing when quiet.
void print_beside(const Session& session, const std::string& text);

/// What memory that is refused is answered with: what this verb can do about it.
void set_memory_hint(const Session& session);

/// Where a verb's one document goes, and as what.
struct DocumentOutput {
  std::string path;  ///< "" is stdout
  bool json = false, force = false;
};

/// The keys of `json` after the head of a document of this format, or `csv`; the log's warnings are said before.
void write_document(Session& session, const libchar::LogInfo& log, const std::string& format, const libchar::Json& json,
                    const std::string& csv, const DocumentOutput& output);

/// Standard output takes one document: throws where `place` is "-" and what goes there is `what`,
/// with what to give instead.
void refuse_standard_output(const char* flag, const std::string& place,
                            const char* what = "the results are several files", const char* hint = "name a folder");

/// The report on a log that was written: on stdout, or, where the log itself may be there, as a
/// note; nothing when quiet.
void print_summary(Session& session, const std::string& output, const std::string& text);

/// A file that cannot be written is refused before the work is done: it is an input, exists
/// already, or its folder cannot be written. An empty path is stdout.
void foresee_output(const std::string& path, const std::vector<std::string>& inputs, bool force);

/// Throws Error(output) where one of the paths is another one's file, or would lie in a folder that another one is.
void refuse_one_name(const std::vector<std::string>& paths);

/// Runs `work` and turns whatever happened into one message and an exit code: 0 ok, 1 internal, 2
/// usage, 3 input, 4 numeric, 5 output, 6 a failed check, 128 + signal when stopped.
int exit_code_of(Session& session, const std::function<void()>& work);

/// A call that is refused memory or a thread ends with exit code 75 instead of 4 from here on: an
/// engine may try it again, or elsewhere.
void try_again_where_refused();

/// For std::set_terminate: an exception that could go nowhere (memory refused to a destructor)
/// still ends in a sentence and an exit code.
[[noreturn]] void end_in_a_sentence();

/// Where memory was refused and a library aborts in its own way, the program ends as above.
void end_aborts_in_a_sentence();

}  // namespace sensorchar
