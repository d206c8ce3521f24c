#include "verbs.hpp"
namespace sensorchar { void add_inspect(CLI::App& app, Session& session) { add_verb(app, session, "inspect", "what is in a log", [] {}); } }
