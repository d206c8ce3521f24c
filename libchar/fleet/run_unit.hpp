#pragma once
// One unit of a fleet, by one worker.

#include <filesystem>
#include <string>

#include "libchar/core/document/enum_table.hpp"
#include "libchar/core/finding.hpp"
#include "libchar/core/process/progress.hpp"
#include "libchar/fleet/unit.hpp"

namespace libchar {

enum class UnitOutcome {
  done,           ///< its result is there now
  already_there,  ///< it was there before, or another worker was first
  no_result,      ///< its result is there, and says why the log could not be characterized
};
template <>
inline constexpr auto enum_table<UnitOutcome> =
    enum_words<UnitOutcome, "done already_there no_result">;

struct UnitRun {
  UnitOutcome outcome = UnitOutcome::done;
  std::string problem{};  ///< of no_result: why
  Findings warnings{};    ///< of a log that was read to its end
};

/// Computes what is missing of the unit and publishes it in `fleet`/results, whole or not at all.
/// What the log's content does not allow is a result too. Throws Error(input) where the log was
/// changed after it was planned, Error(again) for what may be otherwise the next time: a log that
/// cannot be opened, parts of a join that are not there yet, a full disk.
UnitRun run_unit(const FleetUnit& unit,
                 const std::filesystem::path& fleet,
                 Progress& progress = no_progress());

}  // namespace libchar
