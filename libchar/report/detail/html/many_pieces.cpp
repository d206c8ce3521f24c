#include "libchar/report/detail/html/many_pieces.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "libchar/core/text/readable.hpp"
#include "libchar/log/recording_json.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/html/html_page.hpp"
#include "libchar/report/detail/html/html_tables.hpp"

namespace libchar {
Table channels_table(const char* recordings) {
  Table out(fmt::format("{}|channel|{}", recordings, kHeadlines));
  out.whole_numbers = true;
  return out;
}

Cell report_cell(const std::string& name, const std::string& folder) {
  Cell out(name);
  if (!folder.empty()) out.address = folder + "/report.html";
  return out;
}

void add_channels(Table& table, const DeviceRecord& record, const std::string& name) {
  for (const RecordedChannel& channel : record.channels) {
    std::vector<Cell> row = {report_cell(name, record.report), channel.name};
    for (Cell& cell : headline_cells(channel)) row.push_back(std::move(cell));
    table.add(std::move(row));
  }
}

std::string many_provenance(std::span<const Characterization> recordings,
                            const std::vector<std::string>& command) {
  std::string out = "<section id=\"provenance\">\n<h2>Where it comes from</h2>\n";
  Table files("file|samples|rate, Hz|SHA-256");
  for (const Characterization& one : recordings)
    files.add({one.log.file,
               count_text(one.log.samples),
               one.log.time.rate_hz > 0 ? brief_text(one.log.time.rate_hz, 6) : "unknown",
               digest_cell(one.log)});
  if (!recordings.empty()) out += html_table(files);
  if (!command.empty())
    out += "<p>Command: <code>" + html_text(command_line(command)) + "</code></p>\n";
  if (!recordings.empty()) out += settings_details(json_of(recordings[0].settings));
  return out + "</section>\n";
}

Json many_head(const std::string& format,
               std::span<const Characterization> recordings,
               const std::vector<std::string>& command) {
  std::vector<const LogInfo*> logs;
  for (const Characterization& one : recordings) logs.push_back(&one.log);
  Json out = document_head(format, command, logs);
  if (!recordings.empty()) out["config"] = json_of(recordings[0].settings);
  return out;
}

}  // namespace libchar
