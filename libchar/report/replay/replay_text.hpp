#pragma once
// A replay for a terminal: ranking, what was skipped and why, verdict.

#include <string>
#include <vector>

#include "libchar/core/document/json.hpp"
#include "libchar/replay/fuse.hpp"
#include "libchar/replay/view/replay_view.hpp"

namespace libchar {

/// Control characters of names are escaped.
/// `width`: characters in a line that its table is fitted to; 0: any.
std::string replay_text(const ReplayView& view, std::size_t width = 0);

/// Every algorithm there is: what it needs, and its options with units and defaults.
std::string algorithms_text();

// report.md of a replay: verdict and tables, for a pull request or a mail.

std::string replay_markdown(const ReplayView& view);
/// The same with a view made for it alone.
std::string replay_markdown(const ReplayResult& result);

// What a fused log came to: for the terminal and as JSON.

/// A few lines; `files` were written.
std::string fuse_text(const FuseResult& result, const std::vector<std::string>& files);

/// The keys of docs/fuse.md. `command`: as typed.
Json fuse_json(const FuseResult& result,
               const std::vector<std::string>& command,
               const std::vector<std::string>& files);

}  // namespace libchar
