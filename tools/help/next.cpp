#include "help/next.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>

#include "help/flag_names.hpp"
#include "libchar/characterize/judgement.hpp"
#include "libchar/characterize/model_from_fit.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/file/log_files.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/export/exports.hpp"
#include "libchar/figure/make_figure.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

using Settings = std::map<std::string, std::set<std::string>>;  ///< values of each option

/// Remedies of one finding that exclude each other: only the user knows which is right.
bool are_alternatives(const std::vector<Finding::Help>& ways) {
  return std::any_of(ways.begin(), ways.end(), [&](const Finding::Help& way) {
    return std::any_of(way.options.begin(), way.options.end(), [&](const Finding::Setting& one) {
      const auto differs = [&](const Finding::Setting& other) {
        return other.option == one.option && other.value != one.value;
      };
      return std::any_of(ways.begin(), ways.end(), [&](const Finding::Help& other) {
        return &other != &way && std::any_of(other.options.begin(), other.options.end(), differs);
      });
    });
  });
}

Settings settings_of(const std::vector<Finding>& findings, Severity severity) {
  Settings out;
  for (const Finding& one : findings)
    if (one.severity == severity && !are_alternatives(one.help))
      for (const Finding::Help& help : one.help)
        for (const Finding::Setting& setting : help.options) out[setting.option].insert(setting.value);
  return out;
}

/// What says how the samples of one channel are to be understood says it of all that are read: of that channel alone
/// then, and not in one command with what mends another.
void keep_kinds_apart(Settings& settings, const std::vector<Finding>& findings) {
  constexpr const char* kOfKind[] = {"data", "unwrap", "nominal_frequency"};
  const auto is_of_kind = [&](const std::string& option) {
    return std::find(std::begin(kOfKind), std::end(kOfKind), option) != std::end(kOfKind);
  };
  const bool mixed = std::any_of(settings.begin(), settings.end(),
                                 [&](const auto& one) { return one.first != "channels" && !is_of_kind(one.first); });
  for (const char* option : kOfKind)
    if (mixed) settings.erase(option);
  if (mixed) settings.erase("channels");
  for (const Finding& one : findings)
    for (const Finding::Help& help : one.help)
      for (const Finding::Setting& setting : help.options)
        if (is_of_kind(setting.option) && settings.contains(setting.option) && !one.subject.empty())
          settings["channels"].insert(one.subject);
}

/// Options of a command that mend: those to add, and those given already that get another value.
struct Mending {
  std::string added;
  std::map<std::string, std::string> replaced;
  bool none() const { return added.empty() && replaced.empty(); }
};

/// What was given behind an option; nothing: it was not.
std::optional<std::string> given_value(const std::vector<std::string>& command, const std::string& flag) {
  for (std::size_t i = 0; i < command.size(); ++i) {
    if (command[i] == flag) return i + 1 < command.size() ? command[i + 1] : "";
    if (command[i].starts_with(flag + "=")) return command[i].substr(flag.size() + 1);
  }
  return std::nullopt;
}

/// "--missing=-99,-999": what mends the worst findings, by options of `flags` (all where null). Marks and wraps
/// move a sensor that does not move: whether it does is seen without them.
Mending mending(const std::set<std::string>* flags, const std::vector<std::string>& command,
                const std::vector<Finding>& findings) {
  Settings settings = settings_of(findings, Severity::bad);
  if (settings.empty()) settings = settings_of(findings, Severity::caution);
  if (settings.size() > 1 || has(findings, "moves_throughout")) settings.erase("still");
  keep_kinds_apart(settings, findings);
  Mending out;
  for (const auto& [option, values] : settings) {
    const std::string words = with_flags("`" + option + "`");
    const std::string flag = words.substr(words.rfind(' ') + 1);  // "characterize --frozen" elsewhere
    if (flags != nullptr && !flags->contains(flag)) continue;
    const bool list = option == "missing", again = option == "channel_scale" || option == "channel_unit";
    const std::string joined = fmt::format("{}", fmt::join(values, ","));
    if (const auto given = given_value(command, flag); given && !again) {
      const std::string now = list ? *given + "," + joined : *values.begin();
      if (*given != now) out.replaced[flag] = now;
    } else if (list) {
      out.added += fmt::format(" {}={}", flag, joined);
    } else {
      for (const std::string& value : values) out.added += " " + flag + " " + shell_word(value);
    }
  }
  return out;
}

std::vector<Finding> findings_of(const Characterization& result) {
  std::vector<Finding> out;
  for (const ChannelResult& channel : result.channels)
    for (Finding one : judge(channel).findings) {
      if (result.channels.size() > 1) one.subject = channel.channel.name;
      out.push_back(std::move(one));
    }
  return out;
}

/// The command as it was given, its results replaced.
std::string command_again(const Session& session, const Mending& mend, const std::string& folder) {
  std::string out = "sensorchar";
  bool forced = false, placed = false;
  for (std::size_t i = 1; i < session.command.size(); ++i) {
    const std::string& word = session.command[i];
    forced |= word == "--force";
    placed |= word.starts_with("-o") || word.starts_with("--output");
    const std::string flag = word.substr(0, word.find('='));
    if (const auto other = mend.replaced.find(flag); other != mend.replaced.end()) {
      out += " " + flag + "=" + shell_word(other->second);
      if (flag == word) ++i;
    } else {
      out += " " + shell_word(word);
    }
  }
  out += mend.added;
  if (!placed) out += " -o " + shell_word(folder);
  return forced ? out : out + " --force";
}

/// The folder of a device's own report, which its record names from the folder of the lot.
std::string report_of(const std::string& folder, const DeviceRecord& record) {
  return shell_word((std::filesystem::path(folder) / record.report).lexically_normal().string());
}

/// Do the models make a file for a target as they are?
bool exports_to(const Characterization& result, const char* target) {
  std::vector<SensorModel> models;
  for (const ChannelResult& c : result.channels)
    if (c.fit) models.push_back(sensor_model_from(c, result.log));
  try {
    export_models(find_export_target(target), models, {});
    return true;
  } catch (const Error&) {
    return false;
  }
}

/// " -c gyro_x,gyro_y": curves in unlike units share no axis, and no figure has room for more than so many.
std::string alike_flag(const Characterization& result, const std::string& unit) {
  std::string names;
  std::size_t alike = 0;
  for (const ChannelResult& c : result.channels) {
    if (c.channel.unit != unit) continue;
    if (++alike <= detail::kMostCurves) names += (alike == 1 ? "" : ",") + c.channel.name;
  }
  const bool all = alike == result.channels.size() && alike <= detail::kMostCurves;
  return all ? "" : " -c " + shell_word(names);
}

}  // namespace

std::string default_folder(const std::string& input, const std::string& kind) {
  const std::string stem = stem_of_log(input);
  return (stem.empty() || stem == "-" || stem == "." || stem == ".." ? "log" : stem) + "-" + kind;
}

std::string mending_flags(const std::vector<Finding>& findings) { return mending(nullptr, {}, findings).added; }

std::string mended_command(const Session& session, const std::vector<Finding>& findings, const std::string& folder) {
  const Mending mend = mending(&session.flags, session.command, findings);
  return mend.none() ? "" : command_again(session, mend, folder);
}

std::vector<std::string> next_steps(const Session& session, const Characterization& result, const std::string& folder) {
  const TimeBase& time = result.log.time;
  if (!(time.rate_hz > 0))
    return {command_again(
        session,
        {time.candidate.empty() ? " --rate RATE" : " --time-column " + libchar::shell_word(time.candidate), {}},
        folder)};
  const std::vector<Finding> findings = findings_of(result);
  std::vector<std::string> out;
  // What is said of samples that were read in the wrong way mends nothing.
  if (result.log.warnings.find("implausible_magnitude") == nullptr)
    if (std::string mended = mended_command(session, findings, folder); !mended.empty())
      out.push_back(std::move(mended));
  const auto usable = std::find_if(result.channels.begin(), result.channels.end(),
                                   [](const auto& c) { return c.fit && worst_of(judge(c).findings) != Severity::bad; });
  if (usable != result.channels.end()) {
    const std::string words = shell_word(folder);
    if (exports_to(result, "kalibr")) out.push_back("sensorchar model " + words + " --to kalibr");
    out.push_back("sensorchar plot " + words + alike_flag(result, usable->channel.unit) + " -o " +
                  shell_word(folder + ".svg"));
  }
  const std::vector<Finding> worst = worst_first(findings);
  if (!out.empty() && !worst.empty() && worst.front().severity != Severity::note)
    out.push_back("sensorchar explain " + worst.front().code);
  return out;
}

std::vector<std::string> next_steps(const std::string& folder, std::span<const DeviceRecord> records,
                                    const FleetLot& lot) {
  std::vector<std::string> out;
  std::vector<std::size_t> order;  // outliers first
  for (const WorstDevice& one : lot.worst) order.push_back(one.recording);
  order.insert(order.end(), lot.order.begin(), lot.order.end());
  const auto compared =
      std::find_if(order.begin(), order.end(), [&](std::size_t r) { return !records[r].report.empty(); });
  const auto other = std::find_if(compared, order.end(), [&](std::size_t r) {
    return r != *compared && !records[r].report.empty() && records[r].type == records[*compared].type;
  });
  if (other != order.end())
    out.push_back("sensorchar compare " + report_of(folder, records[*compared]) + " " +
                  report_of(folder, records[*other]));
  out.push_back("sensorchar verify " + shell_word(folder));
  return out;
}

std::vector<std::string> bench_again(const Session& session, const std::string& folder) {
  std::string out = "sensorchar";
  for (std::size_t i = 1; i < session.command.size(); ++i) {
    const std::string& word = session.command[i];
    if (word == "-o" || word == "--output" || word == "--against") ++i;
    if (word.starts_with("-o") || word.starts_with("--output") || word.starts_with("--against") || word == "--force")
      continue;
    out += " " + shell_word(word);
  }
  const std::filesystem::path place(folder);
  return {out + " --against " + shell_word((place / "bench.json").string()) + " -o " + shell_word(folder + "-again")};
}

void say_next(const Session& session, const std::string& command) {
  if (!command.empty()) print_beside(session, "next: " + command + "\n");
}

}  // namespace sensorchar
