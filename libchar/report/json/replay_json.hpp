#pragma once
// report.json of a replay; the keys of docs/json.md, which may grow and never change.

#include "libchar/core/document/json.hpp"
#include "libchar/replay/view/replay_view.hpp"

namespace libchar {

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

/// The same without those keys, the fronts and the verdict that follow from them, and the command:
/// the same bytes for the same scene and options.
Json replay_json_without_times(const ReplayView& view);
Json replay_json_without_times(const ReplayResult& result);

}  // namespace libchar
