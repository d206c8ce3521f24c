#include "libchar/report/detail/html/many_pieces.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/term_cells.hpp"
#include "libchar/core/units.hpp"
#include "libchar/log/recording_json.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/html/html_page.hpp"
#include "libchar/report/detail/html/html_tables.hpp"

namespace libchar {
namespace {

std::string coefficient_cell(const Coefficient& c, Term term, const std::string& unit) {
  if (!c.value && !c.upper95) return "–";
  const TermCells cells = term_cells(c, term, unit);
  const ShownValue& shown = headline(cells);
  return shown.value + (shown.low.empty() ? " " : " " + interval_brackets(shown) + " ") +
         shown.unit + (doubted(c.status) ? " ?" : "");
}

}  // namespace

std::vector<std::string> coefficient_heads() {
  return {"N, white noise", "B, bias instability", "K, random walk", "Fit"};
}

std::vector<std::string> coefficient_cells(const Channel& channel, const NoiseFit& fit) {
  std::vector<std::string> cells;
  for (const Term term : {Term::white, Term::flicker, Term::walk})
    cells.push_back(coefficient_cell(fit[term], term, channel.unit));
  cells.push_back(probability_text(fit.goodness.p));
  return cells;
}

std::vector<ChannelRow> channel_rows(const DeviceRecord& record, const std::string& name) {
  std::vector<ChannelRow> out;
  for (const RecordedChannel& channel : record.channels) {
    ChannelRow& row = out.emplace_back(ChannelRow{name, record.report, channel.name, {}});
    if (!channel.fitted) {
      row.cells = {"–", "–", "–", "no fit"};
      continue;
    }
    for (const Term term : {Term::white, Term::flicker, Term::walk}) {
      const RecordedValue* value = channel.find(quantity_of(term));
      row.cells.push_back(coefficient_cell(
          value == nullptr ? Coefficient{} : coefficient_of(*value), term, channel.unit));
    }
    row.cells.push_back(probability_text(channel.p));
  }
  return out;
}

std::string report_link(const std::string& name, const std::string& folder) {
  return folder.empty()
             ? html_text(name)
             : fmt::format(
                   "<a href=\"{}/report.html\">{}</a>", html_address(folder), html_text(name));
}

std::string channels_table(const std::string& recordings, const std::vector<ChannelRow>& rows) {
  std::vector<std::string> heads = {recordings, "Channel"};
  for (const std::string& head : coefficient_heads()) heads.push_back(head);
  std::string out = "<div class=\"wide\"><table class=\"many\">\n" + table_head(heads);
  for (const ChannelRow& row : rows) {
    out += "<tr><th scope=\"row\">" + report_link(row.recording, row.report) + "</th><td>" +
           html_text(row.channel) + "</td>";
    for (const std::string& cell : row.cells) out += "<td class=\"n\">" + html_text(cell) + "</td>";
    out += "</tr>\n";
  }
  return out +
         "</tbody></table></div>\n<p class=\"note\">In brackets: 95 % intervals. ≤: not detected, "
         "upper 95 % limit. ?: not to be relied on, the recording's own report says why.</p>\n";
}

SvgCurve allan_svg(const AllanCurve& allan, double factor) {
  SvgCurve out;
  for (const AllanPoint& point : allan.points) {
    if (!point.reliable) continue;
    out.x.push_back(point.tau_s);
    out.y.push_back(factor * point.deviation);
  }
  return out;
}

std::string many_provenance(std::span<const Characterization> recordings,
                            const std::vector<std::string>& command) {
  std::string out = "<section id=\"provenance\">\n<h2>Where it comes from</h2>\n";
  if (!recordings.empty())
    out += "<div class=\"wide\"><table>\n" + table_head({"File", "Samples", "Rate, Hz", "SHA-256"});
  for (const Characterization& one : recordings)
    out += fmt::format(
        "<tr><td class=\"text\">{}</td><td>{}</td><td>{}</td><td class=\"hash\">{}</td></tr>\n",
        html_text(one.log.file),
        count_text(one.log.samples),
        one.log.time.rate_hz > 0 ? brief_text(one.log.time.rate_hz, 6) : "unknown",
        html_text(one.log.sha256.empty() ? "not computed" : one.log.sha256));
  if (!recordings.empty()) out += "</tbody></table></div>\n";
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
