#pragma once
// SQLite reading one file and nothing else: no locks, no journals, nothing beside it is looked at,
// and of a file that was cut only pages that are whole.

#include <string>

struct sqlite3;

namespace libchar {

/// Opens `path` read-only; sqlite3_close closes it. Throws Error(input) when it is no file, or SQLite does not take it.
sqlite3* open_sqlite(const std::string& path);

}  // namespace libchar
