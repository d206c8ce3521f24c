#pragma once
// A replay for a terminal: ranking, what was skipped and why, verdict.

#include <string>
#include <vector>

#include "libchar/core/document/json.hpp"
#include "libchar/replay/fuse.hpp"
#include "libchar/replay/report/replay_report.hpp"
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
Json fuse_json(const FuseResult& result, const std::vector<std::string>& command,
               const std::vector<std::string>& files);

// report.html of a replay.

/// One self-contained page: no network, opens from disk, prints. It carries the document of
/// replay_json but for the time that the whole replay took. `next`: commands to go on with.
std::string replay_html(const ReplayView& view, const std::vector<std::string>& next = {});
/// The same with a view made for it alone.
std::string replay_html(const ReplayResult& result);

// report.json of a replay; the keys of docs/json.md, which may grow and never change.

/// What report.json says, as `read_replay_report` reads it back; its head is left empty.
ReplayReport replay_report(const ReplayView& view);

/// {"format":"replay-report","version":1,…}. What a clock or the heap measured is at
/// "ns_per_sample", "learning_s" and "peak_bytes" of each algorithm and under "measured".
Json replay_json(const ReplayView& view);
/// The same with a view made for it alone.
Json replay_json(const ReplayResult& result);

/// Every fusion algorithm with what it needs and its options, as an array (docs/json.md).
Json algorithms_json();

/// What a clock or the heap measured, and what follows from it.
inline constexpr const char* kMeasuredKeys[] = {"measured",   "verdict_with_costs", "ns_per_sample",
                                                "learning_s", "peak_bytes",         "on_front"};

}  // namespace libchar
