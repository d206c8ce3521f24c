#pragma once
// report.html of a replay.

#include <string>

#include "libchar/replay/view/replay_view.hpp"

namespace libchar {

/// One self-contained page: no network, opens from disk, prints. It carries the document of
/// replay_json but for the time that the whole replay took.
std::string replay_html(const ReplayView& view);
/// The same with a view made for it alone.
std::string replay_html(const ReplayResult& result);

}  // namespace libchar
