// report.html: one page that carries its data, scripts and styles, and asks for nothing from
// anywhere.
//
// The page holds no time: the same characterization gives the same bytes.

#include "libchar/report/html/html_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/report/detail/assets.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/html/html_channel.hpp"
#include "libchar/report/detail/html/html_page.hpp"
#include "libchar/report/detail/html/html_plots.hpp"
#include "libchar/report/detail/html/html_tables.hpp"
#include "libchar/report/detail/html/limits_pieces.hpp"
#include "libchar/report/detail/json_pieces.hpp"
#include "libchar/report/detail/tables/coefficients.hpp"
#include "libchar/report/json/json_report.hpp"

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
                       brief_text(log.time.rate_hz, 6),
                       log.time.from_stamps ? " (from the stamps)" : " (stated)",
                       html_text(duration_text(view.duration_s)));
  }
  if (log.time.gaps > 0) {
    out += fmt::format(" · <b>{}</b> {}, <b>{}</b> {} missing",
                       count_text(log.time.gaps),
                       log.time.gaps == 1 ? "gap" : "gaps",
                       count_text(log.time.missing_samples),
                       log.time.missing_samples == 1 ? "sample" : "samples");
  } else {
    out += " · no gaps";
  }
  return out + "</p>\n";
}

std::string channel_link(const ChannelView& c, std::size_t i) {
  const std::string name = html_text(c.result->channel.name);
  return c.in_detail ? fmt::format("<a href=\"#channel-{}\">{}</a>", i, name)
                     : "<b>" + name + "</b>";
}

void add_channel(Table& table, const ChannelView& view, std::size_t index, double rate_hz) {
  const ChannelResult& c = *view.result;
  Cell name(c.channel.name);
  name.unit = view.shown_unit;
  if (view.in_detail) name.anchor = fmt::format("channel-{}", index);
  std::vector<Cell> row = {std::move(name)};
  for (const Term term : {Term::white, Term::flicker, Term::walk})
    row.push_back(headline_cell(c.fit ? (*c.fit)[term] : Coefficient{}, term, view.unit));
  Cell& lowest = row.emplace_back("–");
  if (const AllanPoint* point = view.allan_minimum) {
    lowest = Cell::number(point->deviation, 3);
    lowest.unit = "at " + duration_text(point->tau_s);
  }
  const bool white = c.fit && (*c.fit)[Term::white].value;
  row.emplace_back(white ? value_text((*c.fit)[Term::white], std::sqrt(rate_hz)) : "–");
  row.emplace_back(c.fit ? probability_text(c.fit->goodness.p) : "no fit");
  const Rating rating = view.judgement.rating;
  row.push_back(
      Cell::word(fmt::format("{} {}", rating_sign(rating), rating_word(rating)), tint_of(rating)));
  table.add(std::move(row));
}

std::string overview_table(const CharacterizationView& view) {
  Table out(
      "channel|N (angle random walk, white noise)|B (bias instability)|K (random walk)|Allan "
      "minimum|"
      "sample sd N·√f|goodness of fit|verdict");
  out.note =
      "In brackets: 95 % intervals. ≤: not detected, upper 95 % limit. ?: undetermined, the record "
      "cannot tell this term from another or contradicts it; or the noise terms do not describe "
      "the recording.";
  for (std::size_t i = 0; i < view.channels.size(); ++i)
    add_channel(
        out, view.channels[i], i, view.result->log.rate_hz_of(view.channels[i].result->channel));
  return html_table(out, {.css = "overview cards", .cards = true});
}

// The sensor first: a sentence a channel, with its colour.
std::string sentences(const CharacterizationView& view) {
  std::string out = "<ul class=\"sensors\">\n";
  for (std::size_t i = 0; i < view.channels.size(); ++i) {
    const ChannelView& c = view.channels[i];
    out += fmt::format("<li class=\"{}\">{} {} {}</li>\n",
                       name_of(c.judgement.rating),
                       rating_badge(c.judgement.rating),
                       channel_link(c, i),
                       html_text(c.summary));
  }
  return out + "</ul>\n";
}

// Traces of more channels than these stand with each channel.
constexpr std::size_t kTracesInGroup = 6;

std::string group_part(const CharacterizationView& view, const ChannelGroup& group) {
  std::string out = "<div class=\"plots group\">\n";
  if (view.channels.size() > 1) out += group_plot(view, group);
  if (group.channels.size() <= kTracesInGroup) {
    out += group.channels.size() > 3 ? "<div class=\"traces many\">\n" : "<div class=\"traces\">\n";
    for (const std::size_t i : group.channels)
      if (view.channels[i].in_detail) out += trace_plot(view.channels[i], i, view.result->log);
    out += "</div>\n";
  }
  const std::string title =
      group.title.empty() ? group.unit.empty() ? "Unit not stated" : group.unit : group.title;
  const std::string unit = group.title.empty() ? "" : shown_unit(group.unit);
  return fmt::format(
             "<h2>{} <span class=\"unit\">{}</span></h2>\n", html_text(title), html_text(unit)) +
         out + "</div>\n";
}

bool all_in_detail(const CharacterizationView& view) {
  return std::all_of(
      view.channels.begin(), view.channels.end(), [](const ChannelView& c) { return c.in_detail; });
}

std::string which_in_detail(const CharacterizationView& view) {
  if (all_in_detail(view)) return "";
  return fmt::format(
      "<p class=\"note\">Shown here and drawn: the {} of {} channels that ask for a look most. "
      "Each "
      "has its sentence and its row of the table above; report.json and curves.csv hold all.</p>\n",
      kMostInDetail,
      view.channels.size());
}

// Of what has a part for each channel, only those that the page draws.
Json of_details(const CharacterizationView& view, Json document) {
  for (auto& [key, part] : document.items()) {
    if (!part.is_object() || !part.contains("channels")) continue;
    Json& channels = part["channels"];
    if (!channels.is_array() || channels.size() != view.channels.size()) continue;
    for (std::size_t i = 0; i < view.channels.size(); ++i)
      if (!view.channels[i].in_detail) channels[i] = nullptr;
  }
  return document;
}

constexpr std::size_t kUnfoldedRows = 12;

std::string overview(const CharacterizationView& view) {
  std::string out = fmt::format("<section id=\"overview\">\n<p class=\"verdict {}\">{} ",
                                name_of(view.rating),
                                rating_badge(view.rating)) +
                    html_text(view.verdict) + "</p>\n" + facts(view) + sentences(view);
  for (const ChannelGroup& group : view.groups) out += group_part(view, group);
  out += folded("All coefficients in a table",
                overview_table(view),
                view.channels.size() > 1 && view.channels.size() <= kUnfoldedRows);
  return out + "</section>\n";
}

std::string time_base(const LogInfo& log) {
  const TimeBase& t = log.time;
  Table out("|");
  out.title = "Time base";
  out.add({"Rate", t.rate_hz > 0 ? brief_text(t.rate_hz, 9) + " Hz" : "unknown"});
  out.add({"Where from",
           t.from_stamps
               ? "stamps in " + t.column + " (" + t.unit + (t.unit_guessed ? ", guessed)" : ")")
               : "stated by the user or the file"});
  if (t.from_stamps) {
    out.add({"Jitter",
             duration_text(t.jitter_s) + " (robust standard deviation of stamp against grid)"});
    out.add({"Largest deviation", duration_text(t.max_deviation_s)});
  }
  out.add({"Gaps",
           t.gaps == 0 ? "none" : count_text(t.gaps) + ", " + plural(t.missing_samples, "sample")});
  return html_table(out, {.css = "facts"});
}

std::string provenance(const Characterization& result) {
  const LogInfo& log = result.log;
  Table input("|");
  input.title = "Input";
  add_input_file(input, log);
  add_program(input, result.command);
  std::string out =
      "<section id=\"provenance\">\n<h2>Where it comes from</h2>\n<div "
      "class=\"two-columns\">\n<div>\n" +
      html_table(input, {.css = "facts"});
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
  body += "<section id=\"channels\">\n<h2>Channel by channel</h2>\n" + which_in_detail(view);
  for (const ChannelGroup& group : view.groups)
    for (const std::size_t i : group.channels)
      if (view.channels[i].in_detail)
        body += channel_section(
            view.channels[i],
            result.log,
            i,
            {.open = view.channels.size() == 1, .trace = group.channels.size() > kTracesInGroup});
  body += "</section>\n";
  body += provenance(result);
  return html_page(
      {"Sensor noise",
       result.log.file,
       std::string(page_js()),
       std::string(page_css()),
       true,
       all_in_detail(view)},
      body,
      json_in_script(all_in_detail(view) ? without_times : of_details(view, without_times)));
}

std::string html_report(const Characterization& result) {
  const CharacterizationView view = characterization_view(result);
  return html_report(view, json_without_times(view));
}

}  // namespace libchar
