#pragma once
// report.json of a replay; the keys of docs/json.md, which may grow and never change.

#include "libchar/core/document/json.hpp"
#include "libchar/replay/report/replay_report.hpp"

namespace libchar {

/// What report.json says, as `read_replay_report` reads it back; its head is left empty.
ReplayReport replay_report(const ReplayView& view);

/// {"format":"replay-report","version":1,…}. What a clock or the heap measured stands at
/// "ns_per_sample", "learning_s" and "peak_bytes" of each algorithm and under "measured".
Json replay_json(const ReplayView& view);
/// The same with a view made for it alone.
Json replay_json(const ReplayResult& result);

/// Every fusion algorithm with what it needs and its options, as an array (docs/json.md).
Json algorithms_json();

/// What a clock or the heap measured, and what follows from it.
inline constexpr const char* kMeasuredKeys[] = {
    "measured", "verdict_with_costs", "ns_per_sample", "learning_s", "peak_bytes", "on_front"};

}  // namespace libchar
