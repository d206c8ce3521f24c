#include "verbs.hpp"
namespace sensorchar { void add_convert(CLI::App& app, Session& session) { add_verb(app, session, "convert", "between log formats", [] {}); } }
