#include <unistd.h>

#include <limits>
#include <new>

#include "libchar/characterize/characterization_view.hpp"
#include "libchar/characterize/settings.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/process/version.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/fleet/detail/log_seen.hpp"
#include "libchar/fleet/detail/result_store.hpp"
#include "libchar/fleet/plan.hpp"
#include "libchar/report/html/html_report.hpp"

namespace libchar {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse_changed(const FleetUnit& unit) {
  throw input_error("E0785", unit.log)
      .says("the log was changed after the fleet was planned")
      .hint("plan the fleet again: units of logs that did not change keep their results");
}

[[noreturn]] void refuse_other_digest(const FleetUnit& unit, const std::string& found) {
  if (!unit.stated) refuse_changed(unit);
  throw input_error("E0785", unit.log)
      .says("the log is not the one that was planned: its digest is not the one that is stated")
      .got(found)
      .hint("state the digest of this log, or none, and plan the fleet again");
}

[[noreturn]] void refuse_absent(const FleetUnit& unit) {
  throw Refusal(ErrorKind::again, "E0786", unit.log)
      .says("the log that was planned cannot be opened now")
      .hint("mount or restore it and run the unit again, or plan the fleet without it");
}

void check_log_is_there(const FleetUnit& unit) {
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(unit.log, error);
  if (error || ::access(unit.log.c_str(), R_OK) != 0) refuse_absent(unit);
  if (bytes != unit.bytes) refuse_changed(unit);
}

std::string seen_log(const FleetUnit& unit) {
  std::optional<std::string> seen = log_as_seen(unit.log);
  if (!seen) refuse_absent(unit);
  return *std::move(seen);
}

/// The same words whoever computes it, and in however many stretches.
void finish_characterization(const FleetUnit& unit, Characterization& result) {
  result.command = {"sensorchar", "fleet", "run"};
  result.settings = settings_of(*unit.options);
  result.seconds = std::numeric_limits<double>::quiet_NaN();
}

Characterization of_log(const FleetUnit& unit, Progress& progress) {
  CharacterizeOptions options = *unit.options;
  options.reading.hash = true;
  Characterization result = characterize(unit.log, options, progress);
  if (result.log.sha256 != unit.sha256) refuse_other_digest(unit, result.log.sha256);
  return result;
}

/// None where one is damaged: that stretch is computed again.
std::vector<std::string> whole_states(const fs::path& fleet, const std::string& part) {
  try {
    return stored_states(fleet, part);
  } catch (const Error&) {
    return {};
  }
}

std::vector<NamedState> states_of(const FleetUnit& unit, const fs::path& fleet) {
  std::vector<NamedState> states;
  std::vector<std::string> missing;
  for (const std::string& part : unit.parts) {
    const std::vector<std::string> files = whole_states(fleet, part);
    // Damaged, or of another file: computed again.
    if (files.empty() || !is_log_seen(fleet, part, unit.log)) {
      missing.push_back(part);
      continue;
    }
    for (const std::string& file : files) states.push_back(state_in_file(file));
  }
  if (!missing.empty())
    throw Refusal(ErrorKind::again, "E0787", unit.log)
        .says("{} of {} stretches of this log are not there yet: {}{}", missing.size(), unit.parts.size(), missing[0],
              missing.size() > 1 ? " …" : "")
        .hint("run them first");
  return states;
}

void check_digest(const FleetUnit& unit) {
  const std::string found = digest_of_log(unit.log);
  if (found != unit.sha256) refuse_other_digest(unit, found);
}

Characterization of_parts(const FleetUnit& unit, const fs::path& fleet, Progress& progress) {
  const std::vector<NamedState> states = states_of(unit, fleet);
  check_digest(unit);  // of the file that the stretches were read from
  Characterization result = characterize_from_stretches(states, *unit.options, progress);
  result.log.sha256 = unit.sha256;
  return result;
}

/// Of the machine it was tried on: a disk that does not answer (E0101, E0104), no memory (E0403).
bool is_of_machine(const Problem& problem) {
  return problem.kind == ErrorKind::output || problem.code == "E0101" || problem.code == "E0104" ||
         problem.code == "E0403";
}

/// What the content may not allow, so that no other try will do.
bool is_of_content(const Problem& problem) {
  return !is_of_machine(problem) && problem.code != "E0785" &&
         (problem.kind == ErrorKind::input || problem.kind == ErrorKind::numeric || problem.kind == ErrorKind::usage);
}

DeviceRecord write_results(const FleetUnit& unit, Characterization& result, const fs::path& folder) {
  finish_characterization(unit, result);
  if (unit.reports) write_outputs(report_files(characterization_view(result), folder), folder, {}, false);
  return record_of(result, unit.options->data);
}

/// A characterization, or what the log's content does not allow.
struct Attempt {
  std::optional<Characterization> result;
  Problem problem;
};

Attempt attempt(const FleetUnit& unit, const fs::path& fleet, Progress& progress) {
  Attempt out;
  try {
    out.result = unit.kind == UnitKind::join ? of_parts(unit, fleet, progress) : of_log(unit, progress);
  } catch (const Error& error) {
    out.problem = error.problem();
    if (!is_of_content(out.problem)) throw;
  }
  return out;
}

/// A problem is the log's when it comes twice, in the same words, and the log is there and the one that was planned.
Attempt confirmed_attempt(const FleetUnit& unit, const fs::path& fleet, Progress& progress) {
  Attempt first = attempt(unit, fleet, progress);
  if (first.result) return first;
  check_log_is_there(unit);
  check_digest(unit);
  Attempt second = attempt(unit, fleet, progress);
  if (second.result || one_line(second.problem) == one_line(first.problem)) return second;
  second.problem.kind = ErrorKind::again;
  throw Error(second.problem);
}

DeviceRecord record_in(const FleetUnit& unit, const fs::path& folder, Attempt found) {
  DeviceRecord record;
  if (found.result) {
    record = write_results(unit, *found.result, folder);
  } else {
    record.problem = one_line(found.problem);
    record.program = version();
  }
  record.settings = settings_id(unit);
  record.log = unit.log;
  record.sha256 = unit.sha256;
  return record;
}

UnitRun compute(const FleetUnit& unit, const fs::path& fleet, Progress& progress) {
  ResultFolder folder(fleet, unit.id);
  const std::string seen = seen_log(unit);
  UnitRun out;
  if (unit.kind == UnitKind::stretch) {
    std::size_t channel = 0;
    const auto write = [&](const std::string& bytes) {
      write_whole_file((folder.path() / state_file(channel++)).string(), bytes);
    };
    characterize_stretch(unit.log, *unit.options, unit.stretch, unit.sha256, write, progress);
  } else {
    Attempt found = confirmed_attempt(unit, fleet, progress);
    if (found.result) out.warnings = found.result->log.warnings;
    const DeviceRecord record = record_in(unit, folder.path(), std::move(found));
    write_record(folder.path(), record);
    out.problem = record.problem.empty() ? why_nothing_fitted(record) : record.problem;
    if (!out.problem.empty()) out.outcome = UnitOutcome::no_result;
  }
  if (needs_log_seen(unit)) write_log_seen(folder.path(), seen);
  if (!folder.publish()) out.outcome = UnitOutcome::already_there;
  return out;
}

/// A result is there, the digest that was stated for it is not that of this log yet: a manifest may
/// take one log for another.
UnitRun confirm(const FleetUnit& unit, const fs::path& fleet) {
  const std::string seen = seen_log(unit);
  check_digest(unit);
  write_log_seen(fleet / "results" / result_folder(unit.id), seen);
  return {UnitOutcome::already_there};
}

}  // namespace

UnitRun run_unit(const FleetUnit& unit, const fs::path& fleet, Progress& progress) {
  const bool there = has_result(fleet, unit.id, unit.kind == UnitKind::stretch);
  if (there && result_counts(fleet, unit)) return {UnitOutcome::already_there};
  check_log_is_there(unit);
  try {
    if (there && unit.kind != UnitKind::stretch) return confirm(unit, fleet);
    return compute(unit, fleet, progress);
  } catch (const Error& error) {
    Problem problem = error.problem();
    if (!is_of_machine(problem)) throw;
    problem.kind = ErrorKind::again;
    throw Error(problem);
  } catch (const std::bad_alloc&) {
    throw Refusal(ErrorKind::again, "E0788", unit.log)
        .says("not enough memory for this unit")
        .hint("give the job more memory");
  }
}

}  // namespace libchar
