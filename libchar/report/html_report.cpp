// report.html: one page that carries its data, scripts and styles, and asks for nothing from
// anywhere.
//
// The page holds no time: the same characterization gives the same bytes.

#include "libchar/report/html_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libchar/core/readable.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/core/version.hpp"
#include "libchar/report/detail/assets.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/html_channel.hpp"
#include "libchar/report/detail/html_page.hpp"
#include "libchar/report/detail/html_tables.hpp"
#include "libchar/report/detail/json_pieces.hpp"
#include "libchar/report/detail/limits_pieces.hpp"
#include "libchar/report/json_report.hpp"

namespace libchar {
namespace {

std::string facts(const CharacterizationView& view) {
  const Characterization& result = *view.result;
  const LogInfo& log = result.log;
  std::string out = "<p class=\"facts\">";
  out += fmt::format("<b>{}</b> {} · <b>{}</b> samples a channel",
                     result.channels.size(),
                     result.channels.size() == 1 ? "channel" : "channels",
                     count_text(log.samples));
  if (log.time.rate_hz > 0) {
    out += fmt::format(" at <b>{}</b> Hz{} · <b>{}</b>",
                       significant(log.time.rate_hz, 6),
                       log.time.from_stamps ? " (from the stamps)" : " (stated)",
                       html_text(duration_text(view.duration_s)));
  }
  if (log.time.gaps > 0) {
    out += fmt::format(" · <b>{}</b> gaps, <b>{}</b> samples missing",
                       count_text(log.time.gaps),
                       count_text(log.time.missing_samples));
  } else {
    out += " · no gaps";
  }
  return out + "</p>\n";
}

// The coefficient in the first of the field's units, or in its own.
std::string overview_cell(const ChannelView& view, Term term) {
  const ChannelResult& c = *view.result;
  if (!c.fit) return "<td>–</td>";
  const Coefficient& k = (*c.fit)[term];
  if (!k.value && !k.upper95) return "<td>–</td>";
  const auto key = kTermNames[static_cast<std::size_t>(term)].key;
  const auto habits = habitual_units(key, view.unit);
  // The field has no shorter way to say it than the coefficient itself when its first habit is only
  // a factor of ours.
  const bool known = habits.size() > 1;
  const double factor = known ? habits[0].factor : 1;
  const std::string unit = known ? habits[0].symbol : term_unit(key, view.unit);
  const std::string mark = k.status == Status::undetermined || k.status == Status::misfit
                               ? "<span class=\"dim\"> ?</span>"
                               : "";
  const std::string whole = coefficient_text(k, factor);
  const std::string interval =
      k.value ? "<span class=\"ci\">" + html_text(whole.substr(whole.find('['))) + "</span>" : "";
  return fmt::format("<td class=\"n{}\">{} <span class=\"dim\">{}</span>{}{}</td>",
                     k.value ? "" : " limit",
                     html_text(value_text(k, factor)),
                     html_text(unit),
                     mark,
                     interval);
}

std::string overview_row(const ChannelView& view, std::size_t index, double rate_hz) {
  const ChannelResult& c = *view.result;
  const std::string unit = view.unit.empty() ? "U" : view.unit;
  std::string out = fmt::format(
      "<tr><th scope=\"row\"><a href=\"#channel-{}\">{}</a> <span class=\"dim\">{}</span></th>",
      index,
      html_text(c.channel.name),
      html_text(unit));
  for (const Term term : {Term::white, Term::flicker, Term::walk}) out += overview_cell(view, term);
  const AllanPoint* lowest = view.allan_minimum;
  out += lowest == nullptr ? "<td>–</td>"
                           : fmt::format("<td class=\"n\">{} <span class=\"dim\">at {}</span></td>",
                                         html_text(number_text(lowest->deviation, 3)),
                                         html_text(duration_text(lowest->tau_s)));
  const bool white = c.fit && (*c.fit)[Term::white].value;
  out += white ? "<td class=\"n\">" +
                     html_text(value_text((*c.fit)[Term::white], std::sqrt(rate_hz))) + "</td>"
               : "<td>–</td>";
  out += c.fit ? "<td class=\"n\">" + html_text(probability_text(c.fit->goodness.p)) + "</td>"
               : "<td>no fit</td>";
  out +=
      view.cautions.empty()
          ? "<td><span class=\"chip detected\">clear</span></td>"
          : fmt::format("<td><a class=\"chip unsure\" href=\"#channel-{}\">{} to look at</a></td>",
                        index,
                        view.cautions.size());
  return out + "</tr>\n";
}

std::string overview(const CharacterizationView& view) {
  std::string out = "<section id=\"overview\">\n<p class=\"verdict\">" + html_text(view.verdict) +
                    "</p>\n" + facts(view) + "<div class=\"wide\"><table class=\"overview\">\n" +
                    table_head({"Channel",
                                "White noise Q",
                                "Bias instability B",
                                "Random walk K",
                                "Allan minimum",
                                "Sample sd Q·√f",
                                "Fit",
                                "Cautions"});
  for (std::size_t i = 0; i < view.channels.size(); ++i)
    out += overview_row(view.channels[i], i, view.result->log.time.rate_hz);
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
         duration_text(t.jitter_s) + " (robust standard deviation of stamp against grid)"});
    out += table_row({"Largest deviation", duration_text(t.max_deviation_s)});
  }
  out += table_row(
      {"Gaps",
       t.gaps == 0
           ? "none"
           : fmt::format("{}, {} samples", count_text(t.gaps), count_text(t.missing_samples))});
  return out + "</tbody></table>\n";
}

std::string provenance(const Characterization& result) {
  const LogInfo& log = result.log;
  std::string out =
      "<section id=\"provenance\">\n<h2>Where it comes from</h2>\n<div "
      "class=\"two-columns\">\n<div>\n<h3>Input</h3>\n<table class=\"facts\"><tbody>\n";
  out += table_row({"File", log.file});
  out += table_row({"Format", log.format});
  out += table_row({"Size", count_text(log.bytes) + " bytes, " + count_text(log.rows) + " rows"});
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
  out += settings_details(json_of(result.settings));
  return out + "</section>\n";
}

}  // namespace

std::string html_report(const CharacterizationView& view, const Json& without_times) {
  const Characterization& result = *view.result;
  std::string body = overview(view);
  if (result.limits) body += limits_section(*result.limits);
  for (std::size_t i = 0; i < view.channels.size(); ++i)
    body += channel_section(view.channels[i], result.log, i);
  body += provenance(result);
  return html_page(
      {"Sensor noise", result.log.file, std::string(page_js()), std::string(page_css())},
      body,
      json_in_script(without_times));
}

std::string html_report(const Characterization& result) {
  const CharacterizationView view = characterization_view(result);
  return html_report(view, json_without_times(view));
}

}  // namespace libchar
