// report.html: one page that carries its data, scripts and styles, and asks for nothing from
// anywhere.
//
// The page holds no time: the same characterization gives the same bytes.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/characterize/model_curve.hpp"
#include "libchar/characterize/verdict.hpp"
#include "libchar/core/readable.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/core/version.hpp"
#include "libchar/report/detail/assets.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/html_page.hpp"
#include "libchar/report/detail/html_parts.hpp"
#include "libchar/report/json_pieces.hpp"
#include "libchar/report/outputs.hpp"

namespace libchar {
namespace {

std::string facts(const Characterization& result) {
  const LogInfo& log = result.log;
  const double duration_s =
      log.time.rate_hz > 0 ? static_cast<double>(log.samples) / log.time.rate_hz : 0;
  std::string out = "<p class=\"facts\">";
  out += fmt::format("<b>{}</b> {} · <b>{}</b> samples a channel",
                     result.channels.size(),
                     result.channels.size() == 1 ? "channel" : "channels",
                     people_count(log.samples));
  if (log.time.rate_hz > 0) {
    out += fmt::format(" at <b>{}</b> Hz{} · <b>{}</b>",
                       significant(log.time.rate_hz, 6),
                       log.time.from_stamps ? " (from the stamps)" : " (stated)",
                       html_text(people_seconds(duration_s)));
  }
  if (log.time.gaps > 0) {
    out += fmt::format(" · <b>{}</b> gaps, <b>{}</b> samples missing",
                       people_count(log.time.gaps),
                       people_count(log.time.missing_samples));
  } else {
    out += " · no gaps";
  }
  return out + "</p>\n";
}

// The coefficient in the first of the field's units, or in its own.
std::string overview_cell(const ChannelResult& c, Term term) {
  if (!c.fit) return "<td>–</td>";
  const Coefficient& k = (*c.fit)[term];
  if (!k.value && !k.upper95) return "<td>–</td>";
  const auto key = kTermNames[static_cast<std::size_t>(term)].key;
  const auto habits = habitual_units(key, c.channel.unit);
  // The field has no shorter way to say it than the coefficient itself when its first habit is only
  // a factor of ours.
  const bool known = habits.size() > 1;
  const double factor = known ? habits[0].factor : 1;
  const std::string unit = known ? habits[0].symbol : term_unit(key, c.channel.unit);
  const std::string mark = k.status == Status::undetermined ? "<span class=\"dim\"> ?</span>" : "";
  const std::string whole = people_coefficient(k, factor);
  const std::string interval =
      k.value ? "<span class=\"ci\">" + html_text(whole.substr(whole.find('['))) + "</span>" : "";
  return fmt::format("<td class=\"n{}\">{} <span class=\"dim\">{}</span>{}{}</td>",
                     k.value ? "" : " limit",
                     html_text(people_value(k, factor)),
                     html_text(unit),
                     mark,
                     interval);
}

std::string overview_row(const ChannelResult& c, std::size_t index, double rate_hz) {
  const auto look = cautions(c);
  const std::string unit = c.channel.unit.empty() ? "U" : c.channel.unit;
  std::string out = fmt::format(
      "<tr><th scope=\"row\"><a href=\"#channel-{}\">{}</a> <span class=\"dim\">{}</span></th>",
      index,
      html_text(c.channel.name),
      html_text(unit));
  for (const Term term : {Term::white, Term::flicker, Term::walk}) out += overview_cell(c, term);
  const AllanPoint* lowest = allan_minimum(c.allan);
  out += lowest == nullptr ? "<td>–</td>"
                           : fmt::format("<td class=\"n\">{} <span class=\"dim\">at {}</span></td>",
                                         html_text(people(lowest->deviation, 3)),
                                         html_text(people_seconds(lowest->tau_s)));
  const bool white = c.fit && (*c.fit)[Term::white].value;
  out += white ? "<td class=\"n\">" +
                     html_text(people_value((*c.fit)[Term::white], std::sqrt(rate_hz))) + "</td>"
               : "<td>–</td>";
  out += c.fit ? "<td class=\"n\">" + html_text(people_probability(c.fit->goodness.p)) + "</td>"
               : "<td>no fit</td>";
  out +=
      look.empty()
          ? "<td><span class=\"chip detected\">clear</span></td>"
          : fmt::format("<td><a class=\"chip unsure\" href=\"#channel-{}\">{} to look at</a></td>",
                        index,
                        look.size());
  return out + "</tr>\n";
}

std::string overview(const Characterization& result) {
  std::string out = "<section id=\"overview\">\n<p class=\"verdict\">" +
                    html_text(verdict_of(result)) + "</p>\n" + facts(result) +
                    "<div class=\"wide\"><table class=\"overview\">\n" +
                    table_head({"Channel",
                                "White noise Q",
                                "Bias instability B",
                                "Random walk K",
                                "Allan minimum",
                                "Sample sd Q·√f",
                                "Fit",
                                "Cautions"});
  for (std::size_t i = 0; i < result.channels.size(); ++i)
    out += overview_row(result.channels[i], i, result.log.time.rate_hz);
  return out +
         "</tbody></table></div>\n<p class=\"note\">In brackets: 95 % intervals. ≤: not detected, "
         "upper 95 % limit. ?: undetermined, the record cannot tell this term from another or "
         "contradicts it. "
         "All else stands with each channel.</p>\n</section>\n";
}

std::string time_base(const LogInfo& log) {
  const TimeBase& t = log.time;
  std::string out = "<h3>Time base</h3>\n<table class=\"facts\"><tbody>\n";
  out += table_row({"Rate", t.rate_hz > 0 ? significant(t.rate_hz, 9) + " Hz" : "unknown"});
  out += table_row({"Where from",
                    t.from_stamps ? "stamps in " + t.column + " (" + t.unit +
                                        (t.unit_guessed ? ", guessed)" : ")")
                                  : "stated by the user or the file"});
  if (t.from_stamps) {
    out += table_row(
        {"Jitter",
         people_seconds(t.jitter_s) + " (robust standard deviation of stamp against grid)"});
    out += table_row({"Largest deviation", people_seconds(t.max_deviation_s)});
  }
  out += table_row(
      {"Gaps",
       t.gaps == 0
           ? "none"
           : fmt::format("{}, {} samples", people_count(t.gaps), people_count(t.missing_samples))});
  return out + "</tbody></table>\n";
}

std::string provenance(const Characterization& result) {
  const LogInfo& log = result.log;
  std::string out =
      "<section id=\"provenance\">\n<h2>Where it comes from</h2>\n<div "
      "class=\"halves\">\n<div>\n<h3>Input</h3>\n<table class=\"facts\"><tbody>\n";
  out += table_row({"File", log.file});
  out += table_row({"Format", log.format});
  out +=
      table_row({"Size", people_count(log.bytes) + " bytes, " + people_count(log.rows) + " rows"});
  out += "<tr><th scope=\"row\">SHA-256</th><td class=\"hash\">" +
         html_text(log.sha256.empty() ? "not computed" : log.sha256) + "</td></tr>\n";
  out += table_row({"Tool", "sensorchar " + std::string(version())});
  out += "<tr><th scope=\"row\">Command</th><td><code>" + html_text(command_line(result.command)) +
         "</code></td></tr>\n</tbody></table>\n";
  if (!log.dialect.empty())
    out += "<h4>How the file was understood</h4>\n" + bullet_list(log.dialect, "plain");
  if (!log.guesses.empty())
    out += "<h4>Guessed, not read</h4>\n" + bullet_list(log.guesses, "cautions");
  out += "</div>\n<div>\n" + time_base(log) + warnings_part(log.warnings) + "</div>\n</div>\n";
  out += settings_details(result.settings);
  return out + "</section>\n";
}

// In tables and on axes a unit stands in its usual spelling ("m/s²" for "m/s^2"); the data keep
// what the log says.
ChannelResult in_usual_spelling(ChannelResult channel) {
  const auto unit = find_unit(channel.channel.unit);
  if (unit && unit->symbol != "1") channel.channel.unit = unit->symbol;
  return channel;
}

std::string page_of(const Characterization& result, const std::string& data) {
  std::string body = overview(result);
  for (std::size_t i = 0; i < result.channels.size(); ++i)
    body += channel_section(result.channels[i], result.log, i);
  body += provenance(result);
  return html_page(
      {"Sensor noise", result.log.file, std::string(page_js()), std::string(page_css())},
      body,
      data);
}

}  // namespace

std::string html_report(const Characterization& result) {
  return html_report(result, json_without_times(result));
}

std::string html_report(const Characterization& result, const Json& without_times) {
  Characterization shown = result;
  for (ChannelResult& channel : shown.channels) channel = in_usual_spelling(std::move(channel));
  return page_of(shown, json_in_script(without_times));
}

}  // namespace libchar
