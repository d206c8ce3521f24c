#pragma once
// What every verb shares. A verb is one file tools/VERB.cpp with a function add_VERB, listed in
// main.cpp.

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "libchar/core/json.hpp"
#include "libchar/log/recording.hpp"
#include "terminal.hpp"

namespace sensorchar {

/// One run of the program.
struct Session {
  std::vector<std::string> command;  ///< argv as given
  Terminal terminal;
  bool strict = false;                    ///< warnings end the run with exit code 3
  std::vector<std::string> warned_files;  ///< files that had warnings, in order
};

/// Adds the subcommand `name` with the flags that every verb has (--quiet), and runs `run` when it
/// was chosen.
CLI::App* add_verb(CLI::App& app,
                   Session& session,
                   const std::string& name,
                   const std::string& what,
                   std::function<void()> run);

// Options with our own reading of numbers (numbers.hpp); the unit stands in the help. Defaults must
// stand in `help`.
CLI::Option* add_number(CLI::App& verb,
                        const std::string& flags,
                        std::optional<double>& value,
                        const std::string& help,
                        double lowest = -std::numeric_limits<double>::max(),
                        double highest = std::numeric_limits<double>::max());
CLI::Option* add_number(CLI::App& verb,
                        const std::string& flags,
                        double& value,
                        const std::string& help,
                        double lowest = -std::numeric_limits<double>::max(),
                        double highest = std::numeric_limits<double>::max());
CLI::Option* add_count(CLI::App& verb,
                       const std::string& flags,
                       std::uint64_t& value,
                       const std::string& help,
                       std::uint64_t lowest = 0,
                       std::uint64_t highest = std::numeric_limits<std::uint64_t>::max());
CLI::Option* add_duration(CLI::App& verb,
                          const std::string& flags,
                          std::optional<double>& seconds,
                          const std::string& help);
CLI::Option* add_rate(CLI::App& verb,
                      const std::string& flags,
                      std::optional<double>& hertz,
                      const std::string& help);
CLI::Option* add_bytes(CLI::App& verb,
                       const std::string& flags,
                       std::uint64_t& bytes,
                       const std::string& help);
/// One of a few words; a wrong one is refused with the nearest right one.
CLI::Option* add_choice(CLI::App& verb,
                        const std::string& flags,
                        std::string& value,
                        std::vector<std::string> words,
                        const std::string& help);

/// Says the warnings of one input on stderr and remembers them for --strict.
void report_warnings(Session& session, const libchar::LogInfo& info);

/// {"format":FORMAT,"version":1,"tool":{name,version},"command":[…],"input":[{path,sha256,bytes}…],"warnings":[{code,message,
/// count,where}…]}: the head of every --json document; the verb adds its own keys behind.
libchar::Json document_head(const Session& session,
                            const std::string& format,
                            const std::vector<const libchar::LogInfo*>& inputs);

/// Parses the command line, runs the verb and turns whatever happened into one message and an exit
/// code (docs/errors.md).
int run(CLI::App& app, Session& session);

}  // namespace sensorchar
