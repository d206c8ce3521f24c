#include "command.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <new>
#include <nlohmann/json.hpp>
#include <sstream>

#include "libchar/core/error.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/version.hpp"
#include "libchar/log/recording_json.hpp"
#include "numbers.hpp"

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
  }
  return 1;
}

// An option whose text goes through `read`; a refusal names the option.
CLI::Option* add_text(CLI::App& verb,
                      const std::string& flags,
                      const std::string& help,
                      const std::string& type,
                      std::function<void(const std::string&)> read) {
  const std::string name = flags.substr(flags.rfind(',') + 1);
  return verb
      .add_option_function<std::string>(
          flags,
          [read = std::move(read), name](const std::string& text) {
            try {
              read(text);
            } catch (const Error& error) {
              libchar::Problem problem = error.problem();
              if (problem.where.empty()) problem.where = name;
              throw Error(problem);
            }
          },
          help)
      ->type_name(type);
}

// The chosen verb, else the program itself.
const CLI::App& chosen(const CLI::App& app) {
  const auto verbs = app.get_subcommands();
  return verbs.empty() ? app : *verbs.front();
}

std::string full_name(const CLI::App& app) {
  const CLI::App& verb = chosen(app);
  return &verb == &app ? app.get_name() : app.get_name() + " " + verb.get_name();
}

std::vector<std::string> option_names(const CLI::App& verb) {
  std::vector<std::string> names;
  for (const CLI::Option* option : verb.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

// CLI11 only lists what it could not place; the nearest name is what people need.
std::string say_unknown(const CLI::App& app) {
  const std::vector<std::string> rest = app.remaining(true);
  const std::string word = rest.empty() ? "" : rest.front();
  const bool option = word.starts_with('-');
  std::string line =
      option ? fmt::format("unknown option \"{}\"", libchar::printable(word, 40))
             : fmt::format("\"{}\" is one argument too many", libchar::printable(word, 40));
  if (option) {
    if (const auto near =
            libchar::nearest(word.substr(0, word.find('=')), option_names(chosen(app))))
      line += fmt::format("; did you mean {}?", *near);
  }
  return line;
}

// A word in the place of the verb that is none: its nearest verb, or what to do with a file.
void check_verb(const CLI::App& app, const std::vector<std::string>& command) {
  std::vector<std::string> verbs;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    verbs.push_back(verb->get_name());
  if (command.size() < 2)
    throw Error({ErrorKind::usage,
                 "E0203",
                 app.get_name(),
                 fmt::format("which verb? one of {}", fmt::join(verbs, ", ")),
                 "",
                 fmt::format("{} --help", app.get_name())});
  if (command[1].starts_with('-')) {
    static const std::vector<std::string> kOwn = {"--help", "--version", "-h"};
    if (std::find(kOwn.begin(), kOwn.end(), command[1]) != kOwn.end()) return;
    const auto near = libchar::nearest(command[1], kOwn);
    throw Error({ErrorKind::usage,
                 "E0204",
                 app.get_name(),
                 "unknown option in front of the verb",
                 command[1],
                 near ? fmt::format("did you mean {}?", *near) : "options stand behind the verb"});
  }
  if (std::find(verbs.begin(), verbs.end(), command[1]) != verbs.end()) return;
  struct stat status {};
  std::string hint = fmt::format("the verbs are {}", fmt::join(verbs, ", "));
  if (const auto near = libchar::nearest(command[1], verbs))
    hint = fmt::format("did you mean {}?", *near);
  else if (::stat(command[1].c_str(), &status) == 0)
    hint = fmt::format("to see what is in this file: {} inspect FILE", app.get_name());
  throw Error({ErrorKind::usage, "E0203", app.get_name(), "unknown verb", command[1], hint});
}

int parse_and_run(CLI::App& app, const Session& session) {
  try {
    check_verb(app, session.command);
    std::vector<std::string> arguments(session.command.rbegin(), session.command.rend() - 1);
    app.parse(arguments);
    return 0;
  } catch (const CLI::Success& answer) {  // --help, --version
    std::ostringstream out, err;
    app.exit(answer, out, err);
    print(out.str());
    return 0;
  } catch (const CLI::ExtrasError&) {
    throw Error({ErrorKind::usage,
                 "E0204",
                 full_name(app),
                 say_unknown(app),
                 "",
                 fmt::format("{} --help", full_name(app))});
  } catch (const CLI::ParseError& error) {
    throw Error({ErrorKind::usage,
                 "E0205",
                 full_name(app),
                 error.what(),
                 "",
                 fmt::format("{} --help", full_name(app))});
  }
}

}  // namespace

CLI::App* add_verb(CLI::App& app,
                   Session& session,
                   const std::string& name,
                   const std::string& what,
                   std::function<void()> run) {
  CLI::App* verb = app.add_subcommand(name, what);
  verb->get_formatter()->column_width(34);
  verb->add_flag_callback(
      "-q,--quiet",
      [&session] { session.terminal.be_quiet(); },
      "no progress, no warnings, no notes");
  verb->final_callback(std::move(run));
  return verb;
}

CLI::Option* add_number(CLI::App& verb,
                        const std::string& flags,
                        std::optional<double>& value,
                        const std::string& help,
                        double lowest,
                        double highest) {
  return add_text(verb, flags, help, "NUMBER", [&value, lowest, highest](const std::string& text) {
    value = parse_number(text, lowest, highest);
  });
}

CLI::Option* add_number(CLI::App& verb,
                        const std::string& flags,
                        double& value,
                        const std::string& help,
                        double lowest,
                        double highest) {
  return add_text(verb, flags, help, "NUMBER", [&value, lowest, highest](const std::string& text) {
    value = parse_number(text, lowest, highest);
  });
}

CLI::Option* add_count(CLI::App& verb,
                       const std::string& flags,
                       std::uint64_t& value,
                       const std::string& help,
                       std::uint64_t lowest,
                       std::uint64_t highest) {
  return add_text(verb, flags, help, "N", [&value, lowest, highest](const std::string& text) {
    value = parse_count(text, lowest, highest);
  });
}

CLI::Option* add_duration(CLI::App& verb,
                          const std::string& flags,
                          std::optional<double>& seconds,
                          const std::string& help) {
  return add_text(verb, flags, help, "TIME", [&seconds](const std::string& text) {
    seconds = parse_duration_s(text);
  });
}

CLI::Option* add_rate(CLI::App& verb,
                      const std::string& flags,
                      std::optional<double>& hertz,
                      const std::string& help) {
  return add_text(verb, flags, help, "RATE", [&hertz](const std::string& text) {
    hertz = parse_rate_hz(text);
  });
}

CLI::Option* add_bytes(CLI::App& verb,
                       const std::string& flags,
                       std::uint64_t& bytes,
                       const std::string& help) {
  return add_text(
      verb, flags, help, "BYTES", [&bytes](const std::string& text) { bytes = parse_bytes(text); });
}

CLI::Option* add_choice(CLI::App& verb,
                        const std::string& flags,
                        std::string& value,
                        std::vector<std::string> words,
                        const std::string& help) {
  const std::string type = fmt::format("{}", fmt::join(words, "|"));
  return add_text(
      verb, flags, help, type, [&value, words = std::move(words)](const std::string& text) {
        if (std::find(words.begin(), words.end(), text) == words.end()) {
          const auto near = libchar::nearest(text, words);
          throw Error({ErrorKind::usage,
                       "E0202",
                       "",
                       fmt::format("expected one of {}", fmt::join(words, ", ")),
                       text,
                       near ? fmt::format("did you mean {}?", *near) : ""});
        }
        value = text;
      });
}

void report_warnings(Session& session, const libchar::LogInfo& info) {
  if (info.warnings.empty()) return;
  session.terminal.warn(info.warnings, info.file);
  session.warned_files.push_back(info.file);
}

libchar::Json document_head(const Session& session,
                            const std::string& format,
                            const std::vector<const libchar::LogInfo*>& inputs) {
  return libchar::document_head(format, session.command, inputs);
}

int run(CLI::App& app, Session& session) {
  const auto fail = [&](std::string_view line, int code) {
    session.terminal.clear();
    say(line);
    return code;
  };
  try {
    const int code = parse_and_run(app, session);
    if (code == 0 && session.strict && !session.warned_files.empty())
      throw Error({ErrorKind::input,
                   "E0206",
                   session.warned_files.front(),
                   "has warnings, and --strict was given",
                   "",
                   "leave out --strict to accept what the warnings say"});
    return code;
  } catch (const Error& error) {
    // An error after a signal is its consequence: the input of a pipe ended early.
    if (stop_signal() != 0)
      return fail("sensorchar: stopped; no output was written", 128 + stop_signal());
    return fail(error.what(), exit_code(error.problem().kind));
  } catch (const libchar::Cancelled& cancelled) {
    return fail("sensorchar: stopped; no output was written", 128 + cancelled.signal);
  } catch (const StdoutClosed&) {
    return 0;
  } catch (const std::bad_alloc&) {
    return fail(
        "sensorchar: error E0401: not enough memory for this input; hint: read less of it with "
        "--channel, --from and --to",
        4);
  } catch (const std::exception& error) {
    return fail(
        fmt::format("sensorchar: internal error: {}; please report this with the command line",
                    libchar::printable(error.what())),
        1);
  }
}

}  // namespace sensorchar
