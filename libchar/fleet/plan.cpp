#include "libchar/fleet/plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <utility>

#include "libchar/characterize/log_thermometer.hpp"
#include "libchar/core/document/document.hpp"
#include "libchar/core/document/schema.hpp"
#include "libchar/core/file/file_owner.hpp"
#include "libchar/core/file/file_text.hpp"
#include "libchar/core/file/sha256.hpp"
#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/parallel/parallel.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/fleet/detail/log_seen.hpp"
#include "libchar/fleet/detail/result_store.hpp"
#include "libchar/log/channel_names.hpp"
#include "libchar/log/quality.hpp"
#include "libchar/model/noise_limits.hpp"

namespace libchar {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPlanFormat = "fleet-plan";
constexpr const char* kPlanFile = "plan.jsonl";

struct LookedAt {
  LogInfo head;
  std::vector<std::string> in_log;  ///< what the log calls the channels, where they are to be units
  std::string sha256, problem;
  std::optional<Problem> wrong_option = {};  ///< why it cannot be read, where that is no fault of the log
};

/// Other formats know it only once they are read.
bool is_without_rate(const LogInfo& head, const ReadOptions& options) {
  const bool tells_in_head = head.format == "csv" || head.format == "npy";
  return tells_in_head && head.time.column.empty() && !options.rate_hz;
}

/// What the log calls its channels, by which they are chosen; it is asked again only where they have new names.
std::vector<std::string> own_names(const LogInfo& head, const FleetDevice& device, const ReadOptions& reading) {
  if (!reading.names.empty()) return names_in_log(device.log, reading);
  std::vector<std::string> names;
  for (const Channel& channel : head.channels) names.push_back(channel.name);
  return names;
}

LookedAt look_at(const FleetDevice& device, const CharacterizeOptions& options, bool by_channel) {
  LookedAt out;
  try {
    if (read_once(device.log))
      throw input_error("E0103", device.log)
          .says("is not a regular file; logs of a fleet are read by workers, and again")
          .hint("copy it to a file first");
    check_characterization(device.log, options);
    out.head = read_log_head(device.log, options.reading);
    if (by_channel) out.in_log = own_names(out.head, device, options.reading);
    if (is_without_rate(out.head, options.reading)) known_rate_hz(out.head);
    out.sha256 = device.sha256.empty() ? digest_of_log(device.log) : device.sha256;
  } catch (const Error& error) {
    Problem problem = error.problem();
    if (problem.kind == ErrorKind::usage) out.wrong_option = problem;
    // The sentence that holds these has a hint of its own.
    if (!problem.hint.empty()) problem.what += fmt::format(" ({})", std::exchange(problem.hint, ""));
    out.problem = one_line(problem);
  }
  return out;
}

std::vector<LookedAt> look_at_all(const Manifest& manifest, bool by_channel, Progress& progress) {
  constexpr std::size_t kAtOnce = 64;
  std::vector<LookedAt> out(manifest.devices.size());
  for (std::size_t first = 0; first < out.size(); first += kAtOnce) {
    progress.update(static_cast<double>(first) / static_cast<double>(out.size()), "looking into the logs");
    parallel::for_each(first, std::min(out.size(), first + kAtOnce), [&](std::size_t d) {
      const FleetDevice& device = manifest.devices[d];
      out[d] = look_at(device, manifest.options[device.options], by_channel);
    });
  }
  return out;
}

std::string hint_of_unreadable(const Manifest& manifest, bool any_left) {
  const std::string mend = manifest.file.empty() ? "name logs that can be read" : "mend the manifest";
  return any_left ? mend + ", or plan the others with `skip_unreadable`" : mend;
}

/// All of them are refused even where they may be skipped: nothing would be left.
void refuse_unreadable(const Manifest& manifest, const std::vector<LookedAt>& logs, bool skip) {
  constexpr std::size_t kNamed = 5;
  std::vector<std::string> said;
  std::size_t count = 0;
  for (std::size_t d = 0; d < logs.size(); ++d) {
    if (logs[d].problem.empty()) continue;
    if (count++ >= kNamed) continue;
    const std::string& where = manifest.devices[d].where;
    said.push_back(manifest.file.empty() ? logs[d].problem : fmt::format("{}: {}", where, logs[d].problem));
  }
  const bool any_left = count < logs.size();
  if (count == 0 || (skip && any_left)) return;
  // Options of the command line are for all logs: as characterize says it.
  if (manifest.file.empty())
    for (const LookedAt& log : logs)
      if (log.wrong_option) throw Error(*log.wrong_option);
  throw input_error("E0782", manifest.file)
      .says("{} of {} logs cannot be read: {}{}", count, logs.size(), fmt::join(said, "; "),
            count > kNamed ? "; …" : "")
      .hint(hint_of_unreadable(manifest, any_left));
}

/// What a file of limits refuses, with the entry that names it.
[[noreturn]] void refuse_limits(const FleetDevice& device, Problem problem) {
  const std::string hint = std::exchange(problem.hint, "");
  throw Refusal(problem.kind, problem.code, device.where).says("limits: " + one_line(problem)).hint(hint);
}

/// Before hours of work, not behind them. By path.
std::map<std::string, NoiseLimits> read_limits(const Manifest& manifest) {
  std::map<std::string, NoiseLimits> files;
  for (const FleetDevice& one : manifest.devices) {
    if (one.limits.empty() || files.contains(one.limits)) continue;
    try {
      files.emplace(one.limits, read_limits_file(one.limits));
    } catch (const Error& error) {
      refuse_limits(one, error.problem());
    }
  }
  return files;
}

/// Limits are those of a type, and name channels that any of its devices may have: as they are held
/// against the lot in the end.
void check_limits(const Manifest& manifest, const std::vector<LookedAt>& logs,
                  const std::map<std::string, NoiseLimits>& limits) {
  std::map<std::string, std::vector<NamedChannel>> channels;
  std::map<std::string, std::size_t> first;  // entry that names the limits of a type
  std::set<std::pair<std::string, std::string>> known;
  std::set<std::string> unsure;
  for (std::size_t d = 0; d < logs.size(); ++d) {
    const FleetDevice& one = manifest.devices[d];
    if (!one.limits.empty()) first.emplace(one.type, d);
    // Of increments and phases the values have other units than the samples.
    if (manifest.options[one.options].data != SampleKind::rate) unsure.insert(one.type);
    for (const Channel& channel : logs[d].head.channels)
      if (known.emplace(one.type, channel.name).second) channels[one.type].push_back({channel.name, channel.unit});
  }
  for (const auto& [type, of_type] : channels) {
    // Limits of devices without a type are those of all types that have none.
    const auto at = first.contains(type) ? first.find(type) : first.find("");
    if (at == first.end() || unsure.contains(type)) continue;
    const FleetDevice& one = manifest.devices[at->second];
    try {
      limits_for(limits.at(one.limits), of_type);
    } catch (const Error& error) {
      refuse_limits(one, error.problem());
    }
  }
}

/// Nothing is counted twice.
void refuse_same_logs(const Manifest& manifest, const std::vector<LookedAt>& logs) {
  std::map<std::pair<std::string, std::size_t>, std::size_t> first;
  for (std::size_t d = 0; d < logs.size(); ++d) {
    if (!logs[d].problem.empty()) continue;
    const std::size_t options = manifest.devices[d].options;
    const auto [at, fresh] = first.emplace(std::pair{logs[d].sha256, options}, d);
    if (fresh) continue;
    const FleetDevice &one = manifest.devices[at->second], &other = manifest.devices[d];
    const bool taken = one.sha256.empty() && other.sha256.empty();
    throw input_error("E0783", manifest.devices[d].where)
        .says("the logs of {} and {} {}", printable(one.device), printable(other.device),
              taken ? "are the same, byte by byte" : "have one digest, as it is stated")
        .got(manifest.devices[d].log)
        .hint("leave one of them out: it would count twice");
  }
}

/// The same without reading them: of one path.
void refuse_same_paths(const Manifest& manifest) {
  std::map<std::pair<std::string_view, std::size_t>, const FleetDevice*> first;
  for (const FleetDevice& one : manifest.devices) {
    const auto [at, fresh] = first.emplace(std::pair{std::string_view(one.log), one.options}, &one);
    if (fresh) continue;
    throw input_error("E0783", one.where)
        .says("the logs of {} and {} are the same, byte by byte", printable(at->second->device), printable(one.device))
        .got(one.log)
        .hint("leave one of them out: it would count twice");
  }
}

/// Of lists for each channel a unit of one channel has its own entry; the thermometer's would stand nowhere.
void check_by_channel(const Manifest& manifest) {
  for (const CharacterizeOptions& one : manifest.options)
    if (!one.temperature.empty() && (!one.reading.names.empty() || one.reading.units.size() > 1))
      throw usage_error("E0702")
          .says("with `temperature` and lists of `names` or `units` no unit can be of one channel")
          .got(one.temperature)
          .hint("leave `by_channel` out, or give units by name with `channel_unit`");
}

/// Which channels are a unit: each alone; the thermometer, which all of them read, with the one
/// beside it, so that it is there once.
std::vector<std::vector<std::size_t>> channel_groups(std::size_t channels, std::optional<std::size_t> thermometer) {
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t c = 0; c < channels; ++c) {
    const bool with_last = !groups.empty() && (c == thermometer || (c == 1 && thermometer == 0U));
    if (with_last)
      groups.back().push_back(c);
    else
      groups.push_back({c});
  }
  return groups;
}

class UnitMaker {
 public:
  UnitMaker(const FleetPlanOptions& options, const CostModel& cost, FleetPlan& plan)
      : options_(options), cost_(cost), plan_(plan) {}

  void add(const LookedAt& log, FleetUnit unit) {
    // A thermometer is asked what the slow part of every channel owes to it.
    const bool together = unit.options->temperature.empty() && detail::has_thermometer(log.head);
    if (!options_.by_channel || together) return add_log(log, unit);
    const std::vector<Channel>& channels = log.head.channels;
    const std::string& wanted = unit.options->temperature;
    const auto thermometer = wanted.empty() ? std::nullopt : temperature_channel(log.head, wanted);
    const auto groups = channel_groups(channels.size(), thermometer);
    if (groups.size() < 2) return add_log(log, unit);
    const std::string settings = settings_id(*unit.options);
    for (const std::vector<std::size_t>& group : groups) {
      FleetUnit one = unit;
      CharacterizeOptions of_group = *unit.options;
      of_group.reading = options_of_channels(of_group.reading, channels, log.in_log, group);
      if (thermometer) of_group.temperature = channels[*thermometer].name;  // a place is another
      one.options = shared_.of(of_group);
      if (settings_id(of_group) != settings) one.settings = settings;
      add_log(log, one);
    }
  }

 private:
  void add_log(const LookedAt& log, const FleetUnit& unit) {
    if (unit.bytes <= options_.split_bytes) return add_unit(log, unit);
    const std::string why_not = why_not_divided(log.head, *unit.options);
    if (why_not.empty()) return add_stretches(log, unit);
    plan_.undivided[why_not].insert(unit.device);
    add_unit(log, unit);
  }

  void add_unit(const LookedAt& log, FleetUnit unit) {
    unit.id = unit_id(unit);
    unit.cost = cost_.of(unit, log.head);
    plan_.units.push_back(std::move(unit));
  }

  void add_stretches(const LookedAt& log, const FleetUnit& unit) {
    const std::uint64_t leaves = leaves_of(log.head.rows);
    const std::uint64_t stretches = std::clamp<std::uint64_t>(unit.bytes / options_.stretch_bytes, 1, leaves);
    FleetUnit join = unit;
    join.kind = UnitKind::join;
    for (std::uint64_t k = 0; k < stretches; ++k) {
      FleetUnit one = unit;
      one.kind = UnitKind::stretch;
      one.stretch = {leaves * k / stretches, leaves * (k + 1) / stretches};
      add_unit(log, one);
      join.parts.push_back(plan_.units.back().id);
    }
    add_unit(log, join);
  }

  const FleetPlanOptions& options_;
  const CostModel& cost_;
  FleetPlan& plan_;
  OptionsTable shared_;
};

Json device_json(const PlannedDevice& one) {
  Json out = {{"device", one.device}, {"log", one.log}};
  if (!one.type.empty()) out["type"] = one.type;
  if (!one.batch.empty()) out["batch"] = one.batch;
  if (one.temperature_c) out["temperature_c"] = *one.temperature_c;
  if (!one.limits.empty()) out["limits"] = one.limits;
  if (!one.sha256.empty()) out["sha256"] = one.sha256;
  if (!one.problem.empty()) out["problem"] = one.problem;
  return out;
}

PlannedDevice parse_device(const Document& document, const std::string& path) {
  const MapReader at(document, path, "",
                     {"device", "log", "type", "batch", "temperature_c", "limits", "sha256", "problem"});
  PlannedDevice out;
  out.device = at.text("device");
  out.log = at.text("log");
  out.type = at.text_or("type", "");
  out.batch = at.text_or("batch", "");
  out.temperature_c = at.maybe_number("temperature_c");
  out.limits = at.text_or("limits", "");
  out.sha256 = at.text_or("sha256", "");
  out.problem = at.text_or("problem", "");
  return out;
}

Refusal plan_refusal(const fs::path& file) {
  return input_error("E0784", file.string()).hint("make a plan with: sensorchar fleet plan MANIFEST -o DIR");
}

/// One after the other: the text of a plan of a hundred thousand units is larger than the plan.
/// What stands behind the last end of line is a line too.
void for_lines_of(const std::string& path, const std::function<void(std::string_view)>& take) {
  constexpr std::size_t kPieceOfPlan = std::size_t{1} << 20U;
  std::string begun;
  for_pieces_of_file(path, kPieceOfPlan, [&](std::string_view piece) {
    for (std::size_t end = piece.find('\n'); end != std::string_view::npos; end = piece.find('\n')) {
      begun.append(piece.substr(0, end));
      take(begun);
      begun.clear();
      piece.remove_prefix(end + 1);
    }
    begun.append(piece);
  });
  if (!begun.empty()) take(begun);
}

/// A plan line by line: its head, the devices, the units.
class PlanReader {
 public:
  explicit PlanReader(const fs::path& file) : file_(file), path_(file.string()) {}

  void take(std::string_view line) {
    if (!head_) return take_head(line);
    digest_.update(line);
    digest_.update("\n");
    if (wrong_) return;
    try {
      take_entry(line);
    } catch (const Error& error) {
      wrong_ = error.problem();
    }
  }

  FleetPlan finish() {
    const bool all = plan_.devices.size() == devices_ && plan_.units.size() == units_;
    if (!head_ || (!all && !wrong_)) throw plan_refusal(file_).says("the plan is cut");
    // Which device a unit is of stands nowhere else.
    if (digest_.finish() != sha256_)
      throw plan_refusal(file_).says("the plan was changed after it was made: its digest is another one");
    if (wrong_) throw Error(*wrong_);  // as it was written: by another version of the program
    for (const FleetUnit& unit : plan_.units)
      if (unit.device >= devices_) throw plan_refusal(file_).says("a unit is of no device of the plan");
    return std::move(plan_);
  }

 private:
  void take_head(std::string_view line) {
    const Document head = parsed_head(line);
    check_format(head, path_, kPlanFormat, 1);
    const MapReader at(head, path_, "", {"format", "version", "devices", "units", "sha256"});
    sha256_ = at.text("sha256");
    devices_ = at.count("devices");
    units_ = at.count("units");
    head_ = true;
  }

  Document parsed_head(std::string_view line) const {
    try {
      return parse_json_document(line, path_);
    } catch (const Error&) {
      throw plan_refusal(file_).says("its first line is cut, or that of no plan");
    }
  }

  void take_entry(std::string_view line) {
    if (plan_.devices.size() < devices_)
      plan_.devices.push_back(parse_device(parse_json_document(line, path_), path_));
    else if (plan_.units.size() < units_)
      plan_.units.push_back(parse_unit(line, path_, shared_));
  }

  const fs::path& file_;
  std::string path_;
  bool head_ = false;
  std::uint64_t devices_ = 0, units_ = 0;
  std::string sha256_;
  Sha256 digest_;                 ///< of all lines behind the head
  std::optional<Problem> wrong_;  ///< the first, told once the digest is known
  FleetPlan plan_;
  OptionsTable shared_;
};

/// Whole or not there for whoever reads it now, after a power cut perhaps neither: flushing thousands of files takes
/// longer than all else of planning, and whoever reads a task sees whether it is torn.
void write_task(const fs::path& file, const std::string& text) {
  const std::string temporary = detail::temporary_name(file.string(), 0);
  std::ofstream out(temporary, std::ios::binary);
  out << text;
  out.close();
  if (!out || ::rename(temporary.c_str(), file.c_str()) != 0) {
    const int number = errno;
    ::unlink(temporary.c_str());
    refuse_unwritable(file, number);
  }
}

/// The unit whose task file this is by its name, where its folder has a plan that has it.
std::optional<FleetUnit> unit_of_plan(const std::string& file) {
  const fs::path path = fs::absolute(file), folder = path.parent_path().parent_path();
  std::error_code ignored;
  if (!fs::exists(folder / kPlanFile, ignored)) return std::nullopt;
  FleetPlan plan = read_plan(folder);
  for (std::size_t k = 0; k < plan.units.size(); ++k)
    if (folder / task_file(k) == path) return std::move(plan.units[k]);
  return std::nullopt;
}

}  // namespace

FleetPlan plan_fleet(const Manifest& manifest, const FleetPlanOptions& options, Progress& progress) {
  const auto limits = read_limits(manifest);
  if (options.by_channel) check_by_channel(manifest);
  refuse_same_paths(manifest);
  const std::vector<LookedAt> logs = look_at_all(manifest, options.by_channel, progress);
  refuse_unreadable(manifest, logs, options.skip_unreadable);
  check_limits(manifest, logs, limits);
  refuse_same_logs(manifest, logs);
  progress.update(-1, "measuring this machine");
  const CostModel cost = measured_cost();
  FleetPlan plan;
  UnitMaker units(options, cost, plan);
  OptionsTable shared;
  std::vector<SharedOptions> settings;
  for (const CharacterizeOptions& one : manifest.options) settings.push_back(shared.of(one));
  for (std::size_t d = 0; d < logs.size(); ++d) {
    const FleetDevice& one = manifest.devices[d];
    plan.devices.push_back(
        {one.device, one.type, one.batch, one.limits, one.log, logs[d].sha256, one.temperature_c, logs[d].problem});
    if (!logs[d].problem.empty()) continue;
    if (!logs[d].head.warnings.empty()) plan.warned.emplace_back(one.log, logs[d].head.warnings);
    FleetUnit unit;
    unit.device = d;
    unit.log = one.log;
    unit.sha256 = logs[d].sha256;
    unit.stated = !one.sha256.empty();
    unit.bytes = logs[d].head.bytes;
    unit.options = settings[one.options];
    unit.reports = options.reports;
    units.add(logs[d], unit);
  }
  return plan;
}

std::string task_file(std::size_t unit) { return fmt::format("tasks/{:06}.json", unit + 1); }

std::optional<ReplacedPlan> plan_in(const fs::path& folder) {
  const fs::path file = folder / kPlanFile;
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return std::nullopt;
  constexpr std::size_t kMostHead = 4096;
  const std::string text = file_text(file.string(), kMostHead);
  // Damaged ones are replaced as others are; beside tasks it was one.
  const std::string begin = fmt::format(R"({{"format":"{}")", kPlanFormat);
  if (!text.starts_with(begin) && !fs::exists(folder / task_file(0), ignored))
    throw input_error("E0784", file.string())
        .says("this file is not a plan of a fleet, and would be overwritten")
        .hint("move it away, or plan into another folder");
  ReplacedPlan out;
  try {
    const Document head = parse_json_document(text.substr(0, text.find('\n')), file.string());
    if (const DocumentEntry* devices = head.find("devices"))
      out.devices = static_cast<std::uint64_t>(devices->value.number);
  } catch (const Error&) {
    out.damaged = true;
  }
  return out;
}

std::size_t results_of_others(const FleetPlan& plan, const fs::path& folder) {
  std::set<std::string_view> ids;
  for (const FleetUnit& unit : plan.units) ids.insert(unit.id);
  const std::vector<std::string> there = published(folder);
  return static_cast<std::size_t>(
      std::count_if(there.begin(), there.end(), [&](const std::string& id) { return !ids.contains(id); }));
}

void write_plan(const FleetPlan& plan, const fs::path& folder) {
  plan_in(folder);  // refuses what is none
  make_fleet_folder(folder / "tasks");
  // One plan at a time: no tasks of one beside the plan of another.
  const detail::FolderLock lock(folder / "tasks");
  std::string text;
  for (const PlannedDevice& one : plan.devices) text += with_valid_text(device_json(one)).dump() + "\n";
  std::vector<std::string> lines(plan.units.size());
  parallel::for_each(0, lines.size(), [&](std::size_t k) {
    lines[k] = unit_text(plan.units[k]) + "\n";
    write_task(folder / task_file(k), lines[k]);
  });
  for (const std::string& line : lines) text += line;
  Sha256 digest;
  digest.update(text);
  const Json head = {{"format", kPlanFormat},
                     {"version", 1},
                     {"devices", plan.devices.size()},
                     {"units", plan.units.size()},
                     {"sha256", digest.finish()}};
  // Tasks of an earlier, longer plan are none of this one.
  std::error_code error;
  for (std::size_t k = plan.units.size(); fs::remove(folder / task_file(k), error); ++k) {
  }
  if (lock.held()) detail::remove_litter((folder / "tasks").string());
  sync_folder((folder / "tasks").string());
  write_whole_file((folder / kPlanFile).string(), head.dump() + "\n" + text, true);
}

FleetUnit read_task(const std::string& file) {
  constexpr std::size_t kMostTask = std::size_t{16} << 20U;
  std::error_code ignored;
  const bool there = fs::exists(file, ignored);
  const std::string text = there ? file_text(file, kMostTask) : "";
  if (!text.ends_with("}\n"))
    if (auto unit = unit_of_plan(file)) return *std::move(unit);
  return parse_unit(there ? text : file_text(file, kMostTask), file);
}

fs::path fleet_of_task(const std::string& file) {
  const fs::path folder = fs::absolute(file).parent_path().parent_path();
  std::error_code ignored;
  if (!fs::exists(folder / kPlanFile, ignored))
    throw plan_refusal(file).says("this task is in the folder of no fleet: there is no plan next to it");
  return folder;
}

FleetPlan read_plan(const fs::path& folder) {
  const fs::path file = folder / kPlanFile;
  std::error_code ignored;
  if (!fs::exists(file, ignored)) throw plan_refusal(file).says("there is no plan in this folder");
  PlanReader reader(file);
  for_lines_of(file.string(), [&](std::string_view line) { reader.take(line); });
  return reader.finish();
}

}  // namespace libchar
