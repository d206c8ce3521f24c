#pragma once
#include <CLI/CLI.hpp>

#include "command.hpp"
#include "libchar/log/read.hpp"

namespace sensorchar {

/// Adds every flag that says how a log is to be read (--channel, --from, --to, --rate, --time-column, …, --strict). `options`
/// and `session` must live until the verb has run.
void add_reading_options(CLI::App& verb, Session& session, libchar::ReadOptions& options);

/// The flags that pin what was guessed of a log ("--time-column t --time-unit us --rate 200Hz"), quoted for a shell.
std::string pinned_options(const libchar::LogInfo& info);

/// A word quoted for a POSIX shell when it has to be.
std::string shell_word(std::string_view word);

}  // namespace sensorchar
