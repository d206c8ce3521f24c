#pragma once
#include "command_line.hpp"
#include "libchar/log/read.hpp"
#include "session.hpp"

namespace sensorchar {

/// Adds every flag that says how a log is to be read (--channel, --from, --to, --rate,
/// --time-column, …, --strict). `options` and `session` must live until the verb has run.
void add_reading_options(VerbOptions& verb, Session& session, libchar::ReadOptions& options);

/// The same without --channel, for verbs that give channels a part each, and without --format for one whose own it is.
void add_reading_options_without_channel(VerbOptions& verb, Session& session, libchar::ReadOptions& options,
                                         bool with_format = true);

/// The flags that read this log the same way again, what was guessed of it pinned (" --time-column t --time-unit us").
std::string reading_flags(const libchar::ReadOptions& options, const libchar::LogInfo& info);

}  // namespace sensorchar
