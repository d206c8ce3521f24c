#pragma once
// report.json of a replay.

#include "libchar/core/json.hpp"
#include "libchar/replay/replay_result.hpp"

namespace libchar {

/// {"format":"replay-report","version":1,…} (keys of design.md 6.3, which may grow and never
/// change; all of them in docs/replay.md).
Json replay_json(const ReplayResult& result);

/// The same without what differs from run to run: ns_per_sample, learning_s, peak_bytes, the fronts
/// that follow from them, "measured" and the command.
Json replay_json_without_times(const ReplayResult& result);

}  // namespace libchar
