// report.html: one page that carries its data, scripts and styles, and asks for nothing from anywhere.
//
// The page holds no time: the same characterization gives the same bytes.

#include "libchar/report/html/html_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libchar/characterize/compare/verification.hpp"
#include "libchar/characterize/judgement.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/report/detail/assets.hpp"
#include "libchar/report/detail/html/html_tables.hpp"
#include "libchar/report/detail/tables/coefficients.hpp"

namespace libchar {
namespace {

// One channel's section of the page. Every text that reaches the page goes through escape.cpp.

struct ChannelLayout {
  bool open = false;   ///< not folded
  bool trace = false;  ///< the record in time stands here, and not above
};

std::string agreement_chip(bool agrees) {
  return agrees ? html_chip("agrees", Tint::good) : html_chip("disagrees", Tint::bad);
}

/// What follows from the coefficients: name, number, what it is.
void add_derived_rows(Table& table, const ChannelView& view, double rate_hz) {
  const ChannelResult& c = *view.result;
  const auto add = [&](const char* name, Cell value, const std::string& unit, std::string what) {
    value.unit = unit;
    table.add({name, std::move(value), "", "", std::move(what)}, Table::Kind::derived);
  };
  const Coefficient& white = (*c.fit)[Term::white];
  if (white.value)
    add("Noise of a single sample", value_text(white, std::sqrt(rate_hz)), view.shown_unit,
        fmt::format("N·√f: the standard deviation from white noise alone at f = {}; that of the samples of this "
                    "recording is {} {}",
                    detail::frequency_text(rate_hz, 6), number_text(c.quality.standard_deviation, 4), view.shown_unit));
  if (const AllanPoint* lowest = view.allan_minimum)
    add("Minimum of the Allan curve", Cell::number(lowest->deviation), view.shown_unit,
        fmt::format("at τ = {}: the best that averaging can reach; it is not B", duration_text(lowest->tau_s)));
  if (c.fit->bandwidth_hz) {
    const double corner = *c.fit->bandwidth_hz;
    const auto& ci = c.fit->bandwidth_ci95;
    add("Bandwidth", ci ? Cell::number(corner, *ci, digits_of(corner, *ci)) : Cell::number(corner), "Hz",
        "corner of the first-order low-pass that the fit needed");
  }
}

std::string numbers_table(const ChannelView& view, double rate_hz) {
  const NoiseFit& fit = *view.result->fit;
  Table out = coefficients_table(fit, view.unit);
  out.title = "Noise coefficients";
  add_derived_rows(out, view, rate_hz);
  std::string html = html_table(out, {.css = "numbers cards", .cards = true});
  if (const Table laws = power_laws_table(fit, view.unit); !laws.rows.empty()) html += html_table(laws);
  html +=
      "<p class=\"note\">Letters as in IEEE 952. N and K are roots of two-sided densities; a data sheet's noise "
      "density is one-sided, √2·N. <i>Best possible</i> is the Cramér–Rao bound for this record length";
  if (!fit.band.whole) html += ", were its whole spectrum described by the noise terms";
  return html + ".</p>\n";
}

std::string unit_of(Term term, const ChannelView& view) {
  return shown_term_unit(kTermNames[static_cast<std::size_t>(term)].key, view.unit);
}

std::string second_opinion_table(const ChannelView& view) {
  const NoiseFit& fit = *view.result->fit;
  Table out("term|spectral fit|Allan fit|± sd|unit|apart by");
  for (const OtherOpinion& other : view.other_opinions)
    out.add({term_title(other.term, view.unit), value_text(fit[other.term]), Cell::number(other.value),
             Cell::number(other.sd, 2), unit_of(other.term, view),
             other.apart ? number_text(*other.apart, 2) + " sd" : "–"});
  // The badge above says that much already.
  const std::string& sentence = fit.second_opinion->sentence;
  return html_table(out) + (fit.second_opinion->agrees ? "" : "<p>" + html_text(sentence) + "</p>\n");
}

std::string trust(const ChannelView& view, std::size_t index) {
  const ChannelResult& c = *view.result;
  const NoiseFit& fit = *c.fit;
  std::string out = "<div class=\"two-columns\">\n<div>\n";
  if (!fit.residuals.empty()) {
    out += plot_figure(
        "residuals", index,
        {"Residuals of the fit", "residual", "sd",
         "Each point: measured minus model in one bin, in standard deviations. They should scatter evenly, 95 % within "
         "the grey band; triangles at the edge lie beyond it. Bins outside the fitted band are not shown."},
        c.channel.name);
  }
  out += "</div>\n<div>\n<p>" + html_text(view.goodness) + "</p>\n";
  out += "<p class=\"note\">Method: " + html_text(fit.search.method) + "; " + std::to_string(fit.search.iterations) +
         (fit.search.converged ? " iterations, converged.</p>\n" : " iterations, <b>not converged</b>.</p>\n");
  if (!fit.remedies.empty()) {
    Table remedies("remedy|because|what was done|count");
    remedies.title = "What was done to the data before the fit";
    for (const Remedy& r : fit.remedies) remedies.add({r.kind, r.alarm, r.action, count_text(r.count)});
    out += html_table(remedies);
  }
  if (fit.second_opinion)
    out += "<h3>Second opinion: fit of the Allan curve " + agreement_chip(fit.second_opinion->agrees) + "</h3>\n" +
           second_opinion_table(view);
  return out + "</div>\n</div>\n";
}

std::string trust_summary(const NoiseFit& fit) {
  std::string out =
      "Can it be trusted? <span class=\"dim\">goodness of fit " + html_text(probability_text(fit.goodness.p));
  if (fit.second_opinion) out += fit.second_opinion->agrees ? "; the Allan fit agrees" : "; the Allan fit disagrees";
  return out + "</span>";
}

std::string verification_section(const ChannelView& view) {
  const ChannelVerification& v = *view.result->verification;
  Table out("term|model|fit of the simulated record|unit|");
  for (const TermVerification& t : v.terms)
    out.add({term_title(t.term, view.unit), value_text(t.model), coefficient_text(t.simulated), unit_of(t.term, view),
             t.agrees ? Cell::word("agrees", Tint::good) : Cell::word("disagrees", Tint::bad)});
  return folded("Simulated from the model " + agreement_chip(v.agrees),
                bullet_list(v.sentences, "plain") + html_table(out));
}

std::string lines_table(const ChannelView& view) {
  const ChannelResult& c = *view.result;
  if (c.lines.empty()) return "";
  Table out("frequency|amplitude (peak)|above the floor|width");
  out.title = "Spectral lines";
  for (const SpectralLine& line : c.lines)
    out.add({detail::frequency_text(line.frequency_hz, 5), number_text(line.amplitude, 3) + " " + view.unit,
             "×" + number_text(line.excess, 3), detail::frequency_text(line.width_hz, 2)});
  return html_table(out);
}

/// What the samples say: name and value.
Table quality_table(const ChannelView& view) {
  const ChannelQuality& q = view.result->quality;
  const std::string unit = " " + view.shown_unit;
  const double missing = static_cast<double>(q.missing) / static_cast<double>(q.samples + q.missing);
  const bool constant = q.samples > 0 && q.minimum == q.maximum;
  Table out("|");
  out.add({"Samples", count_text(q.samples)});
  out.add({"Missing", q.missing == 0 ? "none" : fmt::format("{} ({})", count_text(q.missing), percent_text(missing))});
  out.add({"Mean", number_text(q.mean, 6) + unit});
  out.add({"Standard deviation", constant ? "constant" : number_text(q.standard_deviation, 4) + unit});
  if (q.samples > 0) out.add({"Range", number_text(q.minimum, 5) + " … " + number_text(q.maximum, 5) + unit});
  out.add({"Resolution (LSB)", q.resolution ? number_text(*q.resolution, 4) + unit : "no grid of values found"});
  out.add({"Distinct values", q.distinct_values >= 4096 ? "4096 or more" : count_text(q.distinct_values)});
  out.add({"Saturated samples", q.saturated == 0 ? "none" : count_text(q.saturated)});
  out.add({"Longest run of one value", plural(q.longest_stuck, "sample")});
  if (!constant)
    out.add({"Kurtosis of differences", number_text(q.difference_kurtosis, 3) + " (3 is Gaussian, more means spikes)"});
  if (q.float32 && !constant)
    out.add({"Number format", "32-bit floats, in steps of " + number_text(q.float32_step, 2) + unit});
  return out;
}

std::string consumers(const ChannelView& view, double rate_hz) {
  if (view.consumers.empty()) return "";
  Table out("for|name there|formula|value|unit");
  out.note =
      "f = " + detail::frequency_text(rate_hz, 6) + ". ≤ marks an upper 95 % limit of a term that was not detected.";
  const std::string* before = nullptr;
  for (const ConsumerNumber& row : view.consumers) {
    const bool repeated = before != nullptr && *before == row.consumer;
    out.add({repeated ? "" : row.consumer, row.key, row.formula, row.value, row.unit});
    before = &row.consumer;
  }
  return folded("Which number goes where", html_table(out));
}

std::string curve_points(const ChannelView& view) {
  const ChannelResult& c = *view.result;
  if (c.allan.points.empty()) return "";
  const std::string& unit = view.shown_unit;
  Table out("τ, s|deviation|68 % interval|95 % interval|degrees of freedom|terms|");
  if (!unit.empty()) out.columns[1].head += ", " + unit;
  constexpr std::size_t kMostRows = 200;
  const std::size_t stride = (c.allan.points.size() + kMostRows - 1) / kMostRows;
  if (stride > 1) out.note = fmt::format("Every {}th point; all points are in curves.csv and report.json.", stride);
  for (std::size_t i = 0; i < c.allan.points.size(); i += stride) {
    const AllanPoint& p = c.allan.points[i];
    const bool known = p.edf > 0;
    out.add({number_text(p.tau_s, 6), number_text(p.deviation, 5), known ? interval_text(p.ci68) : "–",
             known ? interval_text(p.ci95) : "–", known ? number_text(p.edf, 4) : "–", count_text(p.terms),
             p.reliable ? "" : "unreliable"});
  }
  return folded(fmt::format("Points of the {} curve ({})", name_of(c.allan.type), c.allan.points.size()),
                html_table(out, {.css = "points"}) + bullet_list(c.allan.notes, "plain") +
                    bullet_list(c.spectrum.notes, "plain"));
}

/// What can be unfolded of one channel: plots, numbers, trust, data quality, units for consumers, points of the curve.
std::string channel_section(const ChannelView& view, const LogInfo& log, std::size_t index,
                            const ChannelLayout& layout) {
  const ChannelResult& c = *view.result;
  const double rate_hz = log.rate_hz_of(c.channel);
  std::string out =
      fmt::format("<details class=\"channel\" id=\"channel-{}\"{}><summary>{} <b>{}</b>{}</summary>\n", index,
                  layout.open ? " open" : "", rating_badge(view.judgement.rating), html_text(c.channel.name),
                  view.unit.empty() ? " <span class=\"unit\">unit not stated, written U</span>"
                                    : " <span class=\"unit\">" + html_text(view.shown_unit) + "</span>");
  out += "<p class=\"sentence\">" + html_text(view.summary) + "</p>\n";
  out += findings_list(view.judgement.findings) + bullet_list(view.beside_terms, "plain");
  out += curve_plots(view, index);
  if (layout.trace) out += trace_plot(view, index, log);
  if (c.fit) out += numbers_table(view, rate_hz) + folded(trust_summary(*c.fit), trust(view, index));
  if (c.verification) out += verification_section(view);
  out += folded("Data quality", html_table(quality_table(view), {.css = "facts"}) + lines_table(view) +
                                    findings_list(c.quality.findings));
  return out + consumers(view, rate_hz) + curve_points(view) + "</details>\n";
}

std::string facts(const CharacterizationView& view) {
  const Characterization& result = *view.result;
  const LogInfo& log = result.log;
  std::string out = "<p class=\"facts\">";
  out += fmt::format("<b>{}</b> {} · <b>{}</b> samples per channel", result.channels.size(),
                     result.channels.size() == 1 ? "channel" : "channels", count_text(log.samples));
  if (log.time.rate_hz > 0) {
    out += fmt::format(" at <b>{}</b>{} · <b>{}</b>", detail::frequency_text(log.time.rate_hz, 6),
                       log.time.from_stamps ? " (from the stamps)" : " (stated)",
                       html_text(duration_text(view.duration_s)));
  }
  std::uint64_t blank = 0;
  for (const ChannelResult& c : result.channels) blank = std::max<std::uint64_t>(blank, c.quality.missing);
  return out + " · " + detail::missing_text({log.time.gaps, log.time.missing_samples, blank}, "<b>", "</b>") + "</p>\n";
}

std::string channel_link(const ChannelView& c, std::size_t i) {
  const std::string name = html_text(c.result->channel.name);
  return c.in_detail ? fmt::format("<a href=\"#channel-{}\">{}</a>", i, name) : "<b>" + name + "</b>";
}

/// The rating, and a chip a finding.
Cell verdict_cell(const Judgement& judgement) {
  constexpr std::size_t kMost = 4;
  Cell out = Cell::word(fmt::format("{} {}", rating_sign(judgement.rating), rating_word(judgement.rating)),
                        tint_of(judgement.rating));
  std::vector<Cell::Mark> chips;
  for (const Finding& one : judgement.findings) {
    const FindingKind* kind = find_finding_kind(one.code);
    if (kind == nullptr || one.severity == Severity::note) continue;
    chips.push_back({std::string(kind->title), one.severity == Severity::bad ? Tint::bad : Tint::doubtful});
  }
  const std::size_t more = chips.size() > kMost ? chips.size() - kMost : 0;
  chips.resize(chips.size() - more);
  if (more > 0) chips.push_back({fmt::format("{} more", more)});
  out.marks = std::move(chips);
  return out;
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
  row.push_back(verdict_cell(view.judgement));
  table.add(std::move(row));
}

std::string overview_table(const CharacterizationView& view) {
  Table out(
      "channel|N (angle random walk, white noise)|B (bias instability)|K (random walk)|Allan minimum|sample sd "
      "N·√f|goodness of fit|verdict");
  out.note =
      "In brackets: 95 % intervals. ≤: not detected, upper 95 % limit. ?: undetermined, the recording cannot separate "
      "this term from another or contradicts it; or the noise terms do not describe the recording.";
  for (std::size_t i = 0; i < view.channels.size(); ++i)
    add_channel(out, view.channels[i], i, view.result->log.rate_hz_of(view.channels[i].result->channel));
  return html_table(out, {.css = "overview cards", .cards = true});
}

// The sensor first: a sentence a channel, with its colour.
std::string sentences(const CharacterizationView& view) {
  std::string out = "<ul class=\"sensors\">\n";
  for (std::size_t i = 0; i < view.channels.size(); ++i) {
    const ChannelView& c = view.channels[i];
    out += fmt::format("<li class=\"{}\">{} {} {}</li>\n", name_of(c.judgement.rating),
                       rating_badge(c.judgement.rating), channel_link(c, i), html_text(c.summary));
  }
  return out + "</ul>\n";
}

// Traces of more channels than these stand with each channel.
constexpr std::size_t kTracesInGroup = 6;

std::string group_part(const CharacterizationView& view, const ChannelGroup& group) {
  std::string out = "<div class=\"plots group\">\n";
  out += group_plot(view, group);
  if (group.channels.size() <= kTracesInGroup) {
    out += group.channels.size() > 3 ? "<div class=\"traces many\">\n" : "<div class=\"traces\">\n";
    for (const std::size_t i : group.channels)
      if (view.channels[i].in_detail) out += trace_plot(view.channels[i], i, view.result->log);
    out += "</div>\n";
  }
  const std::string title = group.title.empty() ? group.unit.empty() ? "Unit not stated" : group.unit : group.title;
  const std::string unit = group.title.empty() ? "" : shown_unit(group.unit);
  return fmt::format("<h2>{} <span class=\"unit\">{}</span></h2>\n", html_text(title), html_text(unit)) + out +
         "</div>\n";
}

bool all_in_detail(const CharacterizationView& view) {
  return std::all_of(view.channels.begin(), view.channels.end(), [](const ChannelView& c) { return c.in_detail; });
}

std::string which_in_detail(const CharacterizationView& view) {
  if (all_in_detail(view)) return "";
  return fmt::format(
      "<p class=\"note\">Shown and drawn here: the {} of {} channels with the most findings. All are in the table "
      "above, in report.json and in curves.csv.</p>\n",
      kMostInDetail, view.channels.size());
}

// Of what has a part for each channel, only those that the page draws.
Json of_details(const CharacterizationView& view, const Json& document) {
  Json out = Json::object();
  for (const auto& [key, part] : document.items()) {
    Json& kept = out[key];
    const bool by_channel = part.is_object() && part.contains("channels") && part["channels"].is_array() &&
                            part["channels"].size() == view.channels.size();
    if (!by_channel) {
      kept = part;
      continue;
    }
    for (const auto& [name, value] : part.items()) {
      if (name != "channels") {
        kept[name] = value;
        continue;
      }
      Json& channels = kept[name] = Json::array();
      for (std::size_t i = 0; i < view.channels.size(); ++i)
        channels.push_back(view.channels[i].in_detail ? value[i] : Json(nullptr));
    }
  }
  return out;
}

constexpr std::size_t kUnfoldedRows = 24;

// First the answer: a headline, the numbers of every channel, their curves. The same in words is folded.
std::string overview(const CharacterizationView& view) {
  std::string out = fmt::format("<section id=\"overview\">\n<p class=\"verdict {}\">{} ", name_of(view.rating),
                                rating_badge(view.rating)) +
                    html_text(view.verdict) + "</p>\n" + facts(view);
  const std::size_t channels = view.channels.size();
  out += channels > kUnfoldedRows ? folded("All coefficients in a table", overview_table(view)) : overview_table(view);
  // The only channel follows unfolded, with its sentence and its plots.
  if (channels == 1) return out + next_part(view.result->next) + "</section>\n";
  out += folded("Each channel in words", sentences(view));
  for (const ChannelGroup& group : view.groups) out += group_part(view, group);
  return out + next_part(view.result->next) + "</section>\n";
}

std::string time_base(const LogInfo& log) {
  const TimeBase& t = log.time;
  Table out("|");
  out.title = "Time base";
  out.add({"Rate", t.rate_hz > 0 ? detail::frequency_text(t.rate_hz, 9) : "unknown"});
  out.add({"Where from", t.from_stamps ? "stamps in " + t.column + " (" + t.unit + (t.unit_guessed ? ", guessed)" : ")")
                                       : "stated by the user or the file"});
  if (t.from_stamps) {
    out.add({"Jitter", duration_text(t.jitter_s) + " (robust standard deviation of stamp against grid)"});
    out.add({"Largest deviation", duration_text(t.max_deviation_s)});
  }
  out.add({"Gaps", t.gaps == 0 ? "none" : count_text(t.gaps) + ", " + plural(t.missing_samples, "sample")});
  return html_table(out, {.css = "facts"});
}

std::string provenance(const Characterization& result) {
  const LogInfo& log = result.log;
  Table input("|");
  input.title = "Input";
  add_input_file(input, log);
  add_program(input, result.command);
  std::string out = "<section id=\"provenance\">\n<h2>Where it comes from</h2>\n<div class=\"two-columns\">\n<div>\n" +
                    html_table(input, {.css = "facts"});
  if (!log.dialect.empty()) out += "<h4>How the file was understood</h4>\n" + bullet_list(log.dialect, "plain");
  if (!log.guesses.empty()) out += "<h4>Guessed, not read</h4>\n" + bullet_list(log.guesses, "cautions");
  out += "</div>\n<div>\n" + time_base(log) + warnings_part(log.warnings) + "</div>\n</div>\n";
  out += settings_details(json_of(result.settings));
  return out + "</section>\n";
}

}  // namespace

std::string html_report(const CharacterizationView& view, const Json& without_times) {
  const Characterization& result = *view.result;
  std::string body = overview(view);
  if (result.limits) body += limits_section(*result.limits);
  const bool alone = view.channels.size() == 1;
  body +=
      "<section id=\"channels\">\n" + std::string(alone ? "" : "<h2>Channel by channel</h2>\n") + which_in_detail(view);
  for (const ChannelGroup& group : view.groups)
    for (const std::size_t i : group.channels)
      if (view.channels[i].in_detail)
        body += channel_section(view.channels[i], result.log, i,
                                {.open = alone, .trace = alone || group.channels.size() > kTracesInGroup});
  body += "</section>\n";
  body += provenance(result);
  return html_page(
      {"Sensor noise", result.log.file, std::string(page_js()), std::string(page_css()), all_in_detail(view)}, body,
      json_in_script(all_in_detail(view) ? without_times : of_details(view, without_times)));
}

std::string html_report(const Characterization& result) {
  const CharacterizationView view = characterization_view(result);
  return html_report(view, json_without_times(view));
}

}  // namespace libchar
