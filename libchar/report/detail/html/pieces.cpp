
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/recording_json.hpp"
#include "libchar/replay/view/words.hpp"
#include "libchar/report/detail/html/html_tables.hpp"
#include "libchar/report/text/characterization_text.hpp"

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

std::string many_provenance(std::span<const Characterization> recordings, const std::vector<std::string>& command) {
  std::string out = "<section id=\"provenance\">\n<h2>Where it comes from</h2>\n";
  Table files("file|samples|rate, Hz|SHA-256");
  for (const Characterization& one : recordings)
    files.add({one.log.file, count_text(one.log.samples),
               one.log.time.rate_hz > 0 ? brief_text(one.log.time.rate_hz, 6) : "unknown", digest_cell(one.log)});
  if (!recordings.empty()) out += html_table(files);
  if (!command.empty()) out += "<p>Command: <code>" + html_text(command_line(command)) + "</code></p>\n";
  if (!recordings.empty()) out += settings_details(json_of(recordings[0].settings));
  return out + "</section>\n";
}

Json many_head(const std::string& format, std::span<const Characterization> recordings,
               const std::vector<std::string>& command) {
  std::vector<const LogInfo*> logs;
  for (const Characterization& one : recordings) logs.push_back(&one.log);
  Json out = document_head(format, command, logs);
  if (!recordings.empty()) out["config"] = json_of(recordings[0].settings);
  return out;
}

namespace {

std::string_view limit_words(LimitStatus status) {
  switch (status) {
    case LimitStatus::pass:
      return "pass";
    case LimitStatus::fail:
      return "fail";
    case LimitStatus::not_decided:
      return "not decided";
  }
  return "";
}

Tint limit_tint(LimitStatus status) {
  return status == LimitStatus::pass ? Tint::good : status == LimitStatus::fail ? Tint::bad : Tint::doubtful;
}

Table judgements(const LimitReport& report) {
  Table out("|");
  for (const LimitJudgement& j : report.judgements)
    out.add({Cell::word(limit_words(j.status), limit_tint(j.status)), j.sentence});
  return out;
}

}  // namespace

std::string limits_section(const LimitReport& report) {
  return "<section id=\"limits\">\n<h2>Limits" +
         (report.sensor.empty() ? std::string() : " of " + html_text(report.sensor)) + "</h2>\n<p>" +
         html_prose(report.verdict) + "</p>\n" + html_table(judgements(report)) + "<p class=\"note\">From " +
         html_text(report.file) +
         ". A term passes or fails if its whole 95 % interval is within or above the limit. A term exactly at the "
         "limit passes or fails by chance in at most 2.5 % of recordings each. It passes in 5 % if only an upper "
         "limit is known.</p>\n</section>\n";
}

std::string limits_text(const LimitReport& report, const TextLook& look) {
  return fmt::format("\nlimits{}: {}\n", report.sensor.empty() ? "" : " of " + printable(report.sensor),
                     printable(report.verdict)) +
         terminal_table(judgements(report), look);
}

namespace {

/// More sensors than these fill a terminal.
constexpr std::size_t kMostTextRows = 16;

}  // namespace

std::string alignment_text(const ReplayView& view, const TextLook& look) {
  const ReplayResult& r = *view.result;
  if (!r.alignment) return "";
  const AlignmentWords words = alignment_words(r, *r.alignment);
  std::string out = "\n" + printable(fmt::format("{}", fmt::join(words.sentences, " "))) + "\n";
  if (r.sensors.size() > kMostTextRows) return out;
  return out + "\n" + terminal_table(words.learnt, look, "") + "\n" + terminal_table(words.budget, look, "");
}

std::string alignment_markdown(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  if (!r.alignment) return "";
  const AlignmentWords words = alignment_words(r, *r.alignment);
  return "\n## Alignment\n\n" + markdown_text(fmt::format("{}", fmt::join(words.sentences, " "))) + "\n\n" +
         table_text(words.learnt) + "\n" + table_text(words.budget);
}

std::string alignment_html(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  if (!r.alignment) return "";
  const AlignmentWords words = alignment_words(r, *r.alignment);
  std::string out = "<section class=\"part\" id=\"alignment\">\n<h2>Alignment</h2>\n";
  for (const std::string& sentence : words.sentences) out += "<p>" + html_prose(sentence) + "</p>\n";
  return out + "<div class=\"copy-place\" data-copy=\"alignment\"></div>\n" + html_table(words.learnt) +
         html_table(words.budget) +
         "<p class=\"note\">Shares are of each sensor’s mean square error over the evaluation, with 95 % intervals; "
         "last row: change of the fused error without that part. Jitter: the part of the aligned error that grows with "
         "the square of the input’s slope.</p>\n</section>\n";
}

}  // namespace libchar
