#pragma once
// Runs of one sensor, pooled: what is written, shown and printed of them.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "libchar/characterize/compare/runs.hpp"
#include "libchar/characterize/limits.hpp"
#include "libchar/core/document/json.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/text/text_table.hpp"

namespace libchar {

/// Runs with what was found of them; `folders` hold the report of each run, relative to the folder of the page ("": none).
struct RunsReport {
  std::span<const Characterization> runs;
  const PooledRuns* pooled = nullptr;
  const LimitReport* limits = nullptr;  ///< of the pooled coefficients; null: none were given
  std::vector<std::string> folders;
  std::vector<std::string> command;
};

/// runs.html, runs.json and CHANNEL.sensor.yaml of the pooled coefficients.
std::vector<OutputFile> runs_files(const RunsReport& report, const std::filesystem::path& folder);
Json runs_json(const RunsReport& report);
std::string runs_html(const RunsReport& report);
std::string runs_text(const RunsReport& report, const TextLook& look = {});

}  // namespace libchar
