// sensorchar inspect LOG…: what is in a log, what was guessed, what was repaired, and what to type next.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "help/next.hpp"
#include "libchar/core/text/quantity_text.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/inspection.hpp"
#include "libchar/log/topics/topic_rows.hpp"
#include "libchar/report/text/characterization_text.hpp"
#include "reading_options.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

struct InspectVerb {
  std::vector<std::string> logs;
  libchar::ReadOptions reading;
  bool json = false, preview = false;
};

std::string next_command(const InspectVerb& verb, const libchar::Inspection& inspection) {
  const libchar::LogInfo& info = inspection.info;
  if (std::any_of(verb.logs.begin(), verb.logs.end(), libchar::read_once)) return "";
  std::vector<libchar::Finding> found;
  libchar::ReadOptions reading = verb.reading;
  std::string mark;
  for (std::size_t c = 0; c < inspection.quality.size(); ++c)
    for (const libchar::Finding& one : inspection.quality[c].findings) {
      found.push_back(one);
      if (inspection.quality.size() > 1) found.back().subject = info.channels[c].name;
      for (const libchar::Finding::Help& help : one.help)
        for (const libchar::Finding::Setting& setting : help.options)
          if (setting.option == "missing")
            for (std::istringstream marks(setting.value); std::getline(marks, mark, ',');)
              reading.missing.marks.push_back(libchar::parse_number(mark));
    }
  std::sort(reading.missing.marks.begin(), reading.missing.marks.end());
  reading.missing.marks.erase(std::unique(reading.missing.marks.begin(), reading.missing.marks.end()),
                              reading.missing.marks.end());
  if (!reading.missing.marks.empty())  // seen with them, the rest may be none
    std::erase_if(found, [](const libchar::Finding& one) { return !one.help.empty(); });
  const std::string flags = reading_flags(reading, info);
  const std::string log = libchar::shell_word(info.file);
  if (libchar::is_listing(info))
    return fmt::format("  next: sensorchar inspect {}{} --topic {}\n", log, flags,
                       libchar::shell_word(libchar::likely_topic(info.topics).name));
  if (info.time.rate_hz <= 0 && !info.time.column.empty())
    return fmt::format("  next: {} with a time stamp {} no sampling rate; two rows would\n",
                       info.rows == 1 ? "one row" : fmt::format("{} rows", info.rows),
                       info.rows == 1 ? "gives" : "give");
  if (info.time.rate_hz <= 0)
    return info.time.candidate.empty()
               ? fmt::format("  next: give the sampling rate, RATE: sensorchar inspect {}{} --rate RATE\n", log, flags)
               : fmt::format("  next: sensorchar inspect {}{} --time-column {}\n", log, flags,
                             libchar::shell_word(info.time.candidate));
  const bool hopeless =
      std::all_of(inspection.quality.begin(), inspection.quality.end(), [](const libchar::ChannelQuality& q) {
        return libchar::has(q.findings, "constant") || libchar::has(q.findings, "no_value");
      });
  if (hopeless || info.warnings.find("implausible_magnitude") != nullptr) return "";
  return fmt::format("  next: sensorchar characterize {}{}{} -o {}\n", log, flags, mending_flags(found),
                     libchar::shell_word(default_folder(info.file)));
}

void print_json(Session& session, const std::vector<libchar::Inspection>& inspections) {
  std::vector<const libchar::LogInfo*> inputs;
  inputs.reserve(inspections.size());
  for (const libchar::Inspection& inspection : inspections) inputs.push_back(&inspection.info);
  libchar::Json document = document_head(session, "inspect", inputs);
  document["recordings"] = libchar::inspection_json(inspections)["recordings"];
  print(libchar::dump_json(document));
}

void run_inspect(Session& session, const InspectVerb& verb) {
  std::vector<libchar::Inspection> inspections;
  std::optional<libchar::Error> refused;  // a log that cannot be read does not hide those behind it
  for (const std::string& log : verb.logs) {
    try {
      inspections.push_back(libchar::inspect(log, verb.reading, session.terminal, verb.preview));
    } catch (const libchar::Error& error) {
      if (verb.logs.size() == 1) throw;
      if (refused) say_error(session, *refused);
      refused = error;
      continue;
    }
    session.terminal.clear();
    const libchar::LogInfo& info = inspections.back().info;
    if (verb.json) {  // else they stand among the results
      report_warnings(session, info);
      continue;
    }
    if (!info.warnings.empty()) session.warned_files.push_back(info.file);
    print_text((inspections.size() > 1 ? "\n" : "") + libchar::inspection_text(inspections.back(), table_width()));
    print(next_command(verb, inspections.back()));
  }
  if (verb.json && !inspections.empty()) print_json(session, inspections);
  if (refused) throw libchar::Error(*refused);
}

std::function<void()> inspect_options(VerbOptions& options, Session& session) {
  const auto verb = std::make_shared<InspectVerb>();
  options.add_texts("LOG", verb->logs, "logs to look at; - reads CSV from standard input").required();
  options.add_flag("--json", verb->json, "one JSON document on stdout instead of text");
  options.add_flag("--preview", verb->preview,
                   "small traces of each channel for a viewer, without the digest, which is slow in a browser");
  options.only("with --json", [verb = verb.get()] { return verb->json; }, {"--preview"});
  add_reading_options(options, session, verb->reading);
  return [&session, verb] {
    verb->reading.hash = verb->json && !verb->preview;  // only the document states it
    run_inspect(session, *verb);
  };
}

}  // namespace

VerbEntry verb_inspect() {
  return {1,
          "inspect",
          "Show the contents of a log: channels, rate, gaps, repairs, resolution",
          inspect_options,
          {{"what a log holds", "sensorchar inspect imu.csv"},
           {"a log without stamps, names and units",
            "sensorchar inspect counts.npy --rate 200Hz --names gx,gy,gz --units deg/s"}}};
}

}  // namespace sensorchar
