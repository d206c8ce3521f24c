#pragma once
// The verbs, one file tools/VERB.cpp each, in the order of the help.

#include <CLI/CLI.hpp>

#include "command.hpp"

namespace sensorchar {

void add_inspect(CLI::App& app, Session& session);
void add_characterize(CLI::App& app, Session& session);
void add_allan(CLI::App& app, Session& session);
void add_psd(CLI::App& app, Session& session);
void add_fit(CLI::App& app, Session& session);
void add_model(CLI::App& app, Session& session);
void add_simulate(CLI::App& app, Session& session);
void add_replay(CLI::App& app, Session& session);
void add_compare(CLI::App& app, Session& session);
void add_convert(CLI::App& app, Session& session);

/// The table of verbs.
inline void add_verbs(CLI::App& app, Session& session) {
  add_inspect(app, session);
  add_characterize(app, session);
  add_allan(app, session);
  add_psd(app, session);
  add_fit(app, session);
  add_model(app, session);
  add_simulate(app, session);
  add_replay(app, session);
  add_compare(app, session);
  add_convert(app, session);
}

}  // namespace sensorchar
