#pragma once
// What is in a log: everything about it, and what its samples say about the instrument.

#include <string>
#include <vector>

#include "libchar/core/document/json.hpp"
#include "libchar/log/quality.hpp"
#include "libchar/log/read.hpp"
#include "libchar/log/recording.hpp"

namespace libchar {

struct Inspection {
  LogInfo info;
  std::vector<ChannelQuality> quality;  ///< one per channel
  std::vector<Trace> traces;            ///< the same, small, where they were asked for
};

/// Reads a log once, in constant memory. Of a log with several topics, without a choice, it lists them (`is_listing`).
Inspection inspect(const std::string& path, const ReadOptions& options = {}, Progress& progress = no_progress(),
                   bool traces = false);

/// Are these topics of a log, to be chosen before it is read?
bool is_listing(const LogInfo& info);

/// `euroc.csv: 6 channels, 200 Hz (jitter 0.8 µs), 2 h, 0 gaps`.
std::string summary_line(const LogInfo& info);

/// {"format":"inspect","version":1,"recordings":[…]} with the keys of docs/json.md.
Json inspection_json(const std::vector<Inspection>& inspections);

}  // namespace libchar
