#include "session.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <new>
#include <nlohmann/json.hpp>
#include <system_error>

#include "colour.hpp"
#include "heap_meter.hpp"
#include "help/flag_names.hpp"
#include "help/marked_line.hpp"
#include "libchar/characterize/compare/reported_characterization.hpp"
#include "libchar/core/file/file_owner.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/file/unfinished_files.hpp"
#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/pattern.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/fit/curve/curve_table.hpp"
#include "libchar/log/recording_json.hpp"
#include "reading_options.hpp"

namespace sensorchar {
namespace {

using libchar::Error;
using libchar::ErrorKind;

int exit_code(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::usage:
      return 2;
    case ErrorKind::input:
      return 3;
    case ErrorKind::numeric:
      return 4;
    case ErrorKind::output:
      return 5;
    case ErrorKind::check:
      return 6;
    case ErrorKind::again:
      return 75;  // EX_TEMPFAIL of sysexits.h
  }
  return 1;
}

}  // namespace

void report_warnings(Session& session, const libchar::LogInfo& info) {
  report_warnings(session, info.warnings, info.file);
}

void report_warnings(Session& session, const libchar::Findings& warnings, const std::string& file) {
  if (warnings.empty()) return;
  session.terminal.warn(warnings, file);
  session.warned_files.push_back(file);
}

void report_findings(Session& session, const std::string& channel, const std::vector<libchar::Finding>& findings) {
  if (findings.empty()) return;
  const std::string text = libchar::printable(channel) + ":\n" + libchar::findings_text(findings);
  session.terminal.note(text.substr(0, text.size() - 1));
}

void report_findings(Session& session, const std::string& document, std::span<const libchar::Finding> findings,
                     const std::vector<std::string>& channels) {
  std::vector<libchar::Finding> said;
  for (libchar::Finding one : findings) {
    const auto fits = [&](const std::string& pattern) { return libchar::matches(pattern, one.subject); };
    if (one.subject != libchar::detail::kOfRecording && !channels.empty() &&
        std::none_of(channels.begin(), channels.end(), fits))
      continue;
    one.sentence = one.subject + ": " + one.sentence;
    said.push_back(std::move(one));
  }
  report_findings(session, document, said);
}

void refuse_strict(const Session& session) {
  if (!session.strict || session.warned_files.empty()) return;
  throw libchar::input_error("E0206", session.warned_files.front())
      .says("has warnings, and --strict was given")
      .hint("leave out --strict to accept what the warnings say");
}

libchar::Json document_head(const Session& session, const std::string& format,
                            const std::vector<const libchar::LogInfo*>& inputs) {
  libchar::Json document = libchar::document_head(format, session.command, inputs);
  document["measured"] = {{"work", libchar::work_json(session.work.done())}};
  return document;
}

void write_document(Session& session, const libchar::LogInfo& log, const std::string& format, const libchar::Json& json,
                    const std::string& csv, const DocumentOutput& output) {
  report_warnings(session, log);
  std::string text = csv;
  if (output.json) {
    libchar::Json document = document_head(session, format, {&log});
    document.update(json);
    text = libchar::dump_json(document);
  }
  if (output.path.empty()) return print(text);
  refuse_strict(session);
  libchar::write_whole_file(output.path, text, output.force);
}

void print_beside(const Session& session, const std::string& text) {
  if (!session.terminal.quiet()) print_text(text);
}

void print_summary(Session& session, const std::string& output, const std::string& text) {
  if (session.terminal.quiet()) return;
  if (!libchar::writes_through(output)) return print_text(text);
  session.terminal.note(text.substr(0, text.find_last_not_of('\n') + 1));
}

void refuse_standard_output(const char* flag, const std::string& place, const char* what, const char* hint) {
  if (place != "-") return;
  throw libchar::usage_error("E0205", flag)
      .says(std::string("standard output takes one document, and ") + what)
      .hint(hint);
}

void foresee_output(const std::string& path, const std::vector<std::string>& inputs, bool force) {
  if (path.empty()) return;
  for (const std::string& input : inputs) libchar::refuse_same_file(input, path);
  libchar::check_output(path, force);
}

void refuse_one_name(const std::vector<std::string>& paths) {
  namespace fs = std::filesystem;
  const auto place = [](const std::string& path) {
    std::error_code ignored;
    return fs::weakly_canonical(fs::absolute(path), ignored);
  };
  for (const std::string& a : paths)
    for (const std::string& b : paths) {
      if (&a == &b || a == "-" || b == "-") continue;
      const fs::path inner = place(a), outer = place(b);
      const auto apart = std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end());
      if (apart.first != outer.end() || libchar::writes_through(b)) continue;
      throw libchar::output_error("E0505", a)
          .says(inner == outer ? "two outputs are one file" : "would lie in a folder that is another output")
          .got(b)
          .hint("give each a name of its own");
    }
}

namespace {

constexpr const char* kNoMemory = "E0403";
constexpr const char* kNoThread = "E0419";

const char* g_memory_hint = "close other programs, or use a machine with more";
int g_refused_exit = exit_code(ErrorKind::numeric);

// Said without taking memory: there is none.
int refuse_for_memory() noexcept {
  for (const std::string_view part : {std::string_view("sensorchar: error "), std::string_view(kNoMemory),
                                      std::string_view(": not enough memory for this input; hint: "),
                                      std::string_view(g_memory_hint), std::string_view("\n")})
    if (::write(STDERR_FILENO, part.data(), part.size()) < 0) break;
  return g_refused_exit;
}

/// The C++ library's way and that of the pool of threads.
bool is_of_threads(const std::exception& error) {
  const auto* system = dynamic_cast<const std::system_error*>(&error);
  return (system != nullptr && system->code() == std::errc::resource_unavailable_try_again) ||
         std::string_view(error.what()).find("pthread_create") != std::string_view::npos;
}

/// Where the file that cannot be read as a log is a table of a curve: the verb that fits it. `plot` and `compare` read
/// such tables themselves.
libchar::Problem with_curve_hint(const Session& session, libchar::Problem problem) {
  const bool of_content = problem.kind == ErrorKind::input || problem.kind == ErrorKind::numeric;
  const bool known = std::any_of(session.command.begin(), session.command.end(), [](const auto& w) {
    return w.starts_with("--curve") || w == "plot" || w == "compare";
  });
  if (!of_content || known) return problem;
  for (const std::string& word : session.command) {
    if (problem.where != word && !problem.where.starts_with(word + ":")) continue;
    if (const std::string curve = libchar::curve_in_header(word); !curve.empty())
      problem.hint =
          fmt::format("this is a table of a curve: sensorchar fit {} --curve {}", libchar::shell_word(word), curve);
  }
  return problem;
}

/// Where results of two runs could mix: folders on file systems that have no locks.
void say_unlocked(Session& session) {
  for (const std::string& folder : libchar::detail::folders_without_locks())
    session.terminal.note(
        fmt::format("note: {}: this file system has no locks. Let no other run write there at the same time. Temporary "
                    "files that killed runs left there stay.",
                    libchar::printable(folder)));
}

std::string error_line(const Session& session, const Error& error) {
  const libchar::Problem problem = with_flags(with_curve_hint(session, error.problem()), session.flags);
  const std::string line = libchar::one_line(problem, colours(STDERR_FILENO));
  return ::isatty(STDERR_FILENO) == 1 ? line + marked_line(error.problem()) : line;
}

int said_exit_code(Session& session, const std::function<void()>& work) {
  const auto fail = [&](std::string_view line, int code) {
    work_is_done();
    session.terminal.clear();
    say(line);
    return code;
  };
  const auto stopped = [&](int number) {
    return fail(session.wrote ? "sensorchar: stopped; what had been written before is whole and stays"
                              : "sensorchar: stopped; no output was written",
                128 + number);
  };
  try {
    work();
    work_is_done();
    say_unlocked(session);
    refuse_strict(session);
    return 0;
  } catch (const Error& error) {
    // An error after a signal is its consequence: the input of a pipe ended early.
    if (stop_signal() != 0) return stopped(stop_signal());
    return fail(error_line(session, error), exit_code(error.problem().kind));
  } catch (const libchar::Cancelled& cancelled) {
    return stopped(cancelled.signal);
  } catch (const StdoutClosed&) {
    return 0;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::filesystem::filesystem_error& error) {
    if (error.code() == std::errc::not_enough_memory) throw;
    return fail(libchar::one_line({ErrorKind::input, "E0101", error.path1().string(),
                                   "cannot look at it: " + error.code().message(), "", ""}),
                3);
  } catch (const std::exception& error) {
    if (is_of_threads(error))
      return fail(fmt::format("sensorchar: error {}: the system gives no further thread; hint: raise the limit of "
                              "processes (ulimit -u), or end others",
                              kNoThread),
                  g_refused_exit);
    return fail(fmt::format("sensorchar: internal error: {}; please report this with the command line",
                            libchar::printable(error.what())),
                1);
  }
}

}  // namespace

void say_error(Session& session, const Error& error) {
  session.terminal.clear();
  say(error_line(session, error));
}

void set_memory_hint(const Session& session) {
  if (session.flags.count("--channel") + session.flags.count("--from") == 2)
    g_memory_hint = "read less of it with --channel, --from and --to";
  else if (session.flags.count("--duration") > 0)
    g_memory_hint = "make it shorter with --duration";
}

void try_again_where_refused() { g_refused_exit = exit_code(ErrorKind::again); }

void end_in_a_sentence() {
  constexpr std::string_view kDefect =
      "sensorchar: internal error: terminated; please report this with the command line\n";
  // What cannot be unwound is not always an exception that can still be asked.
  libchar::discard_unfinished();
  if (memory_was_refused()) ::_exit(refuse_for_memory());
  [[maybe_unused]] const auto ignored = ::write(STDERR_FILENO, kDefect.data(), kDefect.size());
  ::_exit(1);
}

void end_aborts_in_a_sentence() {
  std::signal(SIGABRT, [](int) {
    if (memory_was_refused()) ::_exit(refuse_for_memory());
    std::signal(SIGABRT, SIG_DFL);
    std::raise(SIGABRT);
  });
}

int exit_code_of(Session& session, const std::function<void()>& work) {
  try {
    return said_exit_code(session, work);
  } catch (const std::exception&) {  // bad_alloc, at work or in saying what else went wrong
    return refuse_for_memory();
  }
}

}  // namespace sensorchar
