// sensorchar inspect LOG…: what is in a log, what was guessed, what was repaired, and what to type
// next.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "libchar/core/text.hpp"
#include "libchar/core/text_table.hpp"
#include "libchar/log/inspection.hpp"
#include "reading_options.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

struct InspectVerb {
  std::vector<std::string> logs;
  libchar::ReadOptions reading;
  bool json = false;
};

// Enough digits to see a thousandth of the noise beside a large offset.
std::string beside_noise(double value, double noise) {
  const double ratio = noise > 0 ? std::abs(value) / noise : 1;
  return libchar::significant(
      value, std::clamp(static_cast<int>(std::ceil(std::log10(std::max(ratio, 1.0)))) + 4, 5, 16));
}

std::vector<std::string> channel_row(const libchar::Channel& channel,
                                     const libchar::ChannelQuality& q) {
  const double noise = q.standard_deviation;
  const bool constant = q.samples > 1 && q.minimum == q.maximum;
  return {libchar::printable(channel.name, 40),
          channel.unit.empty() ? "-" : libchar::printable(channel.unit, 20),
          std::to_string(q.missing),
          beside_noise(q.mean, noise),
          constant        ? "constant"
          : q.samples < 2 ? "-"
                          : libchar::significant(noise, 4),
          beside_noise(q.minimum, noise),
          beside_noise(q.maximum, noise),
          q.resolution ? libchar::significant(*q.resolution, 4) : "-",
          std::to_string(q.saturated),
          q.samples < 3 || constant ? "-" : libchar::significant(q.difference_kurtosis, 3)};
}

std::string channel_table(const libchar::Inspection& inspection) {
  std::vector<std::vector<std::string>> rows = {{"channel",
                                                 "unit",
                                                 "missing",
                                                 "mean",
                                                 "sd",
                                                 "min",
                                                 "max",
                                                 "LSB",
                                                 "saturated",
                                                 "kurtosis of differences"}};
  for (std::size_t c = 0; c < inspection.quality.size(); ++c)
    rows.push_back(channel_row(inspection.info.channels[c], inspection.quality[c]));
  return libchar::text_table(rows);
}

std::string next_command(const InspectVerb& verb, const libchar::LogInfo& info) {
  const std::string flags = reading_flags(verb.reading, info);
  const std::string log = shell_word(info.file);
  if (info.time.rate_hz <= 0 && !info.time.column.empty())
    return fmt::format("  next: {} with a time stamp {} no sampling rate; two rows would\n",
                       info.rows == 1 ? "one row" : fmt::format("{} rows", info.rows),
                       info.rows == 1 ? "gives" : "give");
  if (info.time.rate_hz <= 0)
    return fmt::format(
        "  next: say the sampling rate, such as sensorchar inspect {}{} --rate 200Hz\n",
        log,
        flags);
  const std::string folder = std::filesystem::path(info.file).stem().string();
  return fmt::format("  next: sensorchar characterize {}{} -o {}\n",
                     log,
                     flags,
                     shell_word((folder.empty() || folder == "-" ? "log" : folder) + "-report"));
}

std::string inspection_text(const InspectVerb& verb, const libchar::Inspection& inspection) {
  const libchar::LogInfo& info = inspection.info;
  std::string text = libchar::summary_line(info) + "\n";
  std::string dialect = info.format;
  for (const std::string& fact : info.dialect)
    dialect += (dialect == info.format ? ": " : "; ") + libchar::printable(fact);
  text += "  read as " + dialect + "\n";
  for (const std::string& guess : info.guesses)
    text += "  guessed: " + libchar::printable(guess) + "\n";
  const std::string front = libchar::printable(info.file) + ": warning: ";
  for (const libchar::Warning& warning : info.warnings.list())
    text += "  warning: " + libchar::one_line(warning, info.file).substr(front.size()) + "\n";
  text += channel_table(inspection);
  for (std::size_t c = 0; c < inspection.quality.size(); ++c)
    for (const std::string& suggestion : inspection.quality[c].suggestions)
      text += fmt::format("  {}: {}\n",
                          libchar::printable(info.channels[c].name, 40),
                          libchar::printable(suggestion));
  return text + next_command(verb, info);
}

void run_inspect(Session& session, const InspectVerb& verb) {
  std::vector<libchar::Inspection> inspections;
  for (const std::string& log : verb.logs) {
    inspections.push_back(libchar::inspect(log, verb.reading, session.terminal));
    session.terminal.clear();
    const libchar::LogInfo& info = inspections.back().info;
    if (!info.warnings.empty()) session.warned_files.push_back(info.file);
    if (!verb.json)
      print_text((inspections.size() > 1 ? "\n" : "") + inspection_text(verb, inspections.back()));
  }
  if (!verb.json) return;
  std::vector<const libchar::LogInfo*> inputs;
  for (const libchar::Inspection& inspection : inspections) inputs.push_back(&inspection.info);
  libchar::Json document = document_head(session, "inspect", inputs);
  document["recordings"] = libchar::inspection_json(inspections)["recordings"];
  print(libchar::dump_json(document));
}

std::function<void()> inspect_options(VerbOptions& options, Session& session) {
  const auto verb = std::make_shared<InspectVerb>();
  options.add_texts("LOG", verb->logs, "logs to look at; - reads CSV from standard input")
      .required();
  options.add_flag("--json", verb->json, "one JSON document on stdout instead of text");
  add_reading_options(options, session, verb->reading);
  return [&session, verb] { run_inspect(session, *verb); };
}

}  // namespace

VerbEntry verb_inspect() {
  return {
      1, "inspect", "What is in a log: channels, rate, gaps, repairs, resolution", inspect_options};
}

}  // namespace sensorchar
