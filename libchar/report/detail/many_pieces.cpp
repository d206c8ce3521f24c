#include "libchar/report/detail/many_pieces.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "libchar/core/readable.hpp"
#include "libchar/core/term_cells.hpp"
#include "libchar/core/units.hpp"
#include "libchar/core/version.hpp"
#include "libchar/log/recording_json.hpp"
#include "libchar/report/detail/assets.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/html_page.hpp"
#include "libchar/report/detail/html_tables.hpp"

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

std::vector<std::string> coefficient_cells(const Channel& channel, const NoiseFit* fit) {
  if (fit == nullptr) return {"–", "–", "–", "no fit"};
  std::vector<std::string> cells;
  for (const Term term : {Term::white, Term::flicker, Term::walk})
    cells.push_back(coefficient_cell((*fit)[term], term, channel.unit));
  cells.push_back(probability_text(fit->goodness.p));
  return cells;
}

std::string with_unit(const Coefficient& c, Term term, const std::string& unit) {
  return coefficient_text(c) + " " +
         term_unit(kTermNames[static_cast<std::size_t>(term)].key, unit);
}

std::string recordings_table(std::span<const Characterization> recordings,
                             const std::vector<Recorded>& names) {
  std::vector<std::string> heads = {"Channel", "Recording"};
  for (const std::string& head : coefficient_heads()) heads.push_back(head);
  std::string out = "<div class=\"wide\"><table class=\"many\">\n" + table_head(heads);
  for (std::size_t r = 0; r < recordings.size(); ++r)
    for (const ChannelResult& c : recordings[r].channels) {
      const std::string name = html_text(names[r].name);
      out += "<tr><th scope=\"row\">" + html_text(c.channel.name) + "</th><td>" +
             (names[r].folder.empty() ? name
                                      : fmt::format("<a href=\"{}/report.html\">{}</a>",
                                                    html_attribute(names[r].folder),
                                                    name)) +
             "</td>";
      for (const std::string& cell : coefficient_cells(c.channel, c.fit ? &*c.fit : nullptr))
        out += "<td class=\"n\">" + html_text(cell) + "</td>";
      out += "</tr>\n";
    }
  return out +
         "</tbody></table></div>\n<p class=\"note\">In brackets: 95 % intervals. ≤: not detected, "
         "upper 95 % limit. ?: not to be relied on, the recording's own report says why.</p>\n";
}

std::string many_provenance(std::span<const Characterization> recordings,
                            const std::vector<std::string>& command) {
  std::string out =
      "<section id=\"provenance\">\n<h2>Where it comes from</h2>\n<div class=\"wide\"><table>\n" +
      table_head({"File", "Samples", "Rate, Hz", "SHA-256"});
  for (const Characterization& one : recordings)
    out += fmt::format(
        "<tr><td class=\"text\">{}</td><td>{}</td><td>{}</td><td class=\"hash\">{}</td></tr>\n",
        html_text(one.log.file),
        count_text(one.log.samples),
        one.log.time.rate_hz > 0 ? brief_text(one.log.time.rate_hz, 6) : "unknown",
        html_text(one.log.sha256.empty() ? "not computed" : one.log.sha256));
  out += "</tbody></table></div>\n<p>Command: <code>" + html_text(command_line(command)) +
         "</code></p>\n";
  if (!recordings.empty()) out += settings_details(json_of(recordings[0].settings));
  return out + "</section>\n";
}

Json recordings_json(std::span<const Characterization> recordings,
                     const std::vector<Recorded>& names) {
  Json out = Json::array();
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const LogInfo& log = recordings[r].log;
    out.push_back({{"name", json_text(names[r].name)},
                   {"file", json_text(log.file)},
                   {"samples", log.samples},
                   {"rate_hz", json_number(log.time.rate_hz)},
                   {"report",
                    names[r].folder.empty() ? Json(nullptr)
                                            : Json(json_text(names[r].folder + "/report.json"))}});
  }
  return out;
}

Json many_head(const std::string& format,
               std::span<const Characterization> recordings,
               const std::vector<std::string>& command) {
  std::vector<const LogInfo*> logs;
  for (const Characterization& one : recordings) logs.push_back(&one.log);
  return document_head(format, command, logs);
}

std::string many_page(const std::string& title,
                      const std::string& subject,
                      const std::string& body,
                      const Json& document) {
  return html_page({title,
                    subject,
                    "reportPage.start({}, () => 320);\n",
                    std::string(page_css()) + std::string(many_page_css())},
                   body,
                   json_in_script(document));
}

}  // namespace libchar
