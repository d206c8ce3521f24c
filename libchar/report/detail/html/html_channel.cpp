// One channel's section of report.html.

#include "libchar/report/detail/html/html_channel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/characterize/compare/verification.hpp"
#include "libchar/characterize/verdict.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/term_cells.hpp"
#include "libchar/core/text/text_table.hpp"
#include "libchar/core/units.hpp"
#include "libchar/fit/curve/power_laws.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/html/html_plots.hpp"
#include "libchar/report/detail/html/html_tables.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMostRows = 200;

std::string_view chip_class(Status status) {
  switch (tint_of(status)) {
    case Tint::good:
      return status == Status::given ? "" : " detected";
    case Tint::doubtful:
      return " unsure";
    case Tint::bad:
      return " alarm";
    case Tint::absent:
      return " absent";
  }
  return "";
}

std::string status_chip(Status status) {
  return fmt::format("<span class=\"chip{}\">{}</span>", chip_class(status), status_words(status));
}

std::string in_field_units(const std::vector<ShownValue>& shown) {
  std::string out;
  for (const ShownValue& one : shown)
    out += fmt::format("<div><b>{}</b> {} <span class=\"dim\">{}</span></div>",
                       html_text(one.value),
                       html_text(unit_with_reading(one)),
                       html_text(one.name));
  return out;
}

std::string value_cell(const ShownValue& shown) {
  return card_cell("Value",
                   fmt::format("<b>{}</b> <span class=\"dim\">{}</span>{}",
                               html_text(shown.value),
                               html_text(shown.unit),
                               interval_span(shown)),
                   "n");
}

std::string cell_or_dash(const char* head, const std::string& text) {
  return card_cell(head, text.empty() ? "–" : html_text(text), "n");
}

/// The cells of a coefficient, behind its name.
std::string coefficient_cells(const TermCells& cells) {
  return value_cell(cells.own) +
         card_cell("As the field says it", in_field_units(cells.field), "") +
         card_cell("Status", status_chip(cells.status), "") +
         cell_or_dash("Known to", cells.known_to) +
         cell_or_dash("Best possible", cells.best_possible) +
         cell_or_dash("Record for 10 %", cells.length_for_10_percent) + "</tr>\n";
}

std::string coefficient_row(const NoiseFit& fit, std::size_t t, const std::string& unit) {
  const TermCells cells = term_cells(fit.term[t], static_cast<Term>(t), unit);
  return fmt::format(
             "<tr><th scope=\"row\">{} <b>{}</b></th>", html_text(cells.title), cells.letter) +
         coefficient_cells(cells);
}

std::string derived_row(const std::string& name,
                        const std::string& value,
                        const std::string& interval,
                        const std::string& unit,
                        const std::string& what) {
  return fmt::format("<tr class=\"derived\"><th scope=\"row\">{}</th>", html_text(name)) +
         card_cell(
             "Value",
             fmt::format(
                 "<b>{}</b> <span class=\"dim\">{}</span>{}",
                 html_text(value),
                 html_text(unit),
                 interval.empty() ? "" : "<span class=\"ci\">" + html_text(interval) + "</span>"),
             "n") +
         fmt::format("<td colspan=\"5\">{}</td></tr>\n", html_text(what));
}

std::string process_row(const char* name, const Coefficient& c, const std::string& unit) {
  TermCells cells;
  cells.own = shown_value(c, 1, unit);
  cells.status = c.status;
  cells.known_to = known_to(c);
  return fmt::format("<tr><th scope=\"row\">{}</th>", name) + coefficient_cells(cells);
}

std::string process_rows(const GaussMarkovFit& process, const std::string& unit) {
  return process_row("Gauss–Markov <b>σ</b><span class=\"dim\"> standard deviation</span>",
                     process.sigma,
                     unit.empty() ? "U" : unit) +
         process_row("Gauss–Markov <b>τ</b><span class=\"dim\"> correlation time</span>",
                     process.tau_s,
                     "s");
}

std::string derived_rows(const ChannelView& view, double rate_hz) {
  const ChannelResult& c = *view.result;
  const std::string& unit = view.shown_unit;
  std::string out;
  const Coefficient& white = (*c.fit)[Term::white];
  if (white.value) {
    out += derived_row(
        "Noise of a single sample",
        value_text(white, std::sqrt(rate_hz)),
        "",
        unit,
        fmt::format("N·√f: what white noise alone gives at f = {} Hz; the samples of this "
                    "recording have a standard deviation of {} {}",
                    brief_text(rate_hz, 6),
                    number_text(c.quality.standard_deviation, 4),
                    unit));
  }
  if (const AllanPoint* lowest = view.allan_minimum) {
    out += derived_row(
        "Minimum of the Allan curve",
        number_text(lowest->deviation, 4),
        "",
        unit,
        fmt::format("at τ = {}: the best an average over a constant time can do; it is not B",
                    duration_text(lowest->tau_s)));
  }
  if (c.fit->bandwidth_hz) {
    const auto& ci = c.fit->bandwidth_ci95;
    const int digits = ci ? digits_of(*c.fit->bandwidth_hz, *ci) : 4;
    out += derived_row(
        "Bandwidth",
        number_text(*c.fit->bandwidth_hz, digits),
        ci ? fmt::format("[{}, {}]", number_text(ci->low, digits), number_text(ci->high, digits))
           : "",
        "Hz",
        "corner of the first-order low-pass that the fit needed");
  }
  return out;
}

std::string power_laws_table(const NoiseFit& fit) {
  const std::vector<PowerLaw> laws = power_laws(fit);
  if (laws.empty()) return "";
  std::string out =
      "<h4>As a clock: one-sided S<sub>y</sub>(f) = Σ h<sub>α</sub> f<sup>α</sup></h4>\n<div "
      "class=\"wide\"><table>\n" +
      table_head({"Noise type", "Stable32", "α", "h", "95 % interval", "Status"});
  for (const PowerLaw& law : laws) {
    const ShownValue h = shown_value(law.h, 1, "");
    out += table_row({std::string(law.name),
                      std::string(law.abbreviation),
                      std::to_string(law.alpha),
                      h.value,
                      interval_words(h),
                      status_words(law.h.status)});
  }
  return out + "</tbody></table></div>\n";
}

std::string numbers_table(const ChannelView& view, double rate_hz) {
  const ChannelResult& c = *view.result;
  std::string out =
      "<h3>Noise coefficients</h3>\n<div class=\"wide\"><table class=\"numbers "
      "cards\">\n<thead><tr><th "
      "scope=\"col\">Term</th><th scope=\"col\">Value, 95 % interval</th>"
      "<th scope=\"col\">As the field says it</th><th scope=\"col\">Status</th>"
      "<th scope=\"col\" title=\"one standard deviation\">Known to</th><th scope=\"col\" "
      "title=\"Cramér–Rao bound: one standard deviation, relative\">Best possible</th>"
      "<th scope=\"col\" title=\"record length at which the bound is 10 %\">Record for 10 "
      "%</th></tr></thead>\n<tbody>\n";
  for (std::size_t t = 0; t < kTerms; ++t) {
    if (c.fit->term[t].status != Status::not_fitted) out += coefficient_row(*c.fit, t, view.unit);
  }
  if (c.fit->gauss_markov && c.fit->gauss_markov->in_model)
    out += process_rows(*c.fit->gauss_markov, view.unit);
  out += derived_rows(view, rate_hz) + "</tbody></table></div>\n" + power_laws_table(*c.fit);
  out +=
      "<p class=\"note\">Letters are those of IEEE 952. N and K are roots of two-sided densities; "
      "a data "
      "sheet's noise density is one-sided, √2·N. <i>Best possible</i> is the Cramér–Rao bound for "
      "this "
      "record length";
  if (!c.fit->band.whole) out += ", were its whole spectrum described by the noise terms";
  return out + ".</p>\n";
}

std::string second_opinion_table(const ChannelView& view) {
  const NoiseFit& fit = *view.result->fit;
  const SecondOpinion& opinion = *fit.second_opinion;
  std::string out = "<div class=\"wide\"><table>\n" +
                    table_head({"Term", "Spectral fit", "Allan fit", "± sd", "Unit", "Apart by"});
  for (const OtherOpinion& other : view.other_opinions)
    out +=
        table_row({term_title(other.term, view.unit),
                   value_text(fit[other.term]),
                   number_text(other.value),
                   number_text(other.sd, 2),
                   shown_term_unit(kTermNames[static_cast<std::size_t>(other.term)].key, view.unit),
                   other.apart ? number_text(*other.apart, 2) + " sd" : "–"});
  out += "</tbody></table></div>\n";
  // The badge above says that much already.
  return opinion.sentence == "agrees" ? out : out + "<p>" + html_text(opinion.sentence) + "</p>\n";
}

std::string trust(const ChannelView& view, std::size_t index) {
  const ChannelResult& c = *view.result;
  const NoiseFit& fit = *c.fit;
  std::string out = "<div class=\"two-columns\">\n<div>\n";
  if (!fit.residuals.empty()) {
    out += plot_figure(
        "residuals",
        index,
        {"Residuals of the fit",
         "residual",
         "sd",
         "Each point: measured against model in one bin, as a standard normal deviate. "
         "They should scatter evenly, 95 % within "
         "the grey band; triangles on the edge lie beyond it. Bins outside the fitted band are not "
         "shown."},
        c.channel.name);
  }
  out += "</div>\n<div>\n<p>" + html_text(view.goodness) + "</p>\n";
  out += "<p class=\"note\">Method: " + html_text(fit.method) + "; " +
         std::to_string(fit.iterations) +
         (fit.converged ? " iterations, converged.</p>\n"
                        : " iterations, <b>not converged</b>.</p>\n");
  if (!fit.remedies.empty()) {
    out += "<h4>What was done to the data before the fit</h4>\n<div class=\"wide\"><table>\n" +
           table_head({"Remedy", "Because", "What was done", "Count"});
    for (const Remedy& r : fit.remedies)
      out += table_row({r.kind, r.alarm, r.action, count_text(r.count)});
    out += "</tbody></table></div>\n";
  }
  if (fit.second_opinion) {
    out += std::string("<h4>Second opinion: fit of the Allan curve ") +
           (fit.second_opinion->agrees ? "<span class=\"chip detected\">agrees</span>"
                                       : "<span class=\"chip alarm\">disagrees</span>") +
           "</h4>\n" + second_opinion_table(view);
  }
  return out + "</div>\n</div>\n";
}

std::string trust_summary(const NoiseFit& fit) {
  std::string out = "Can it be trusted? <span class=\"dim\">goodness of fit " +
                    html_text(probability_text(fit.goodness.p));
  if (fit.second_opinion)
    out += fit.second_opinion->agrees ? "; the Allan fit agrees" : "; the Allan fit disagrees";
  return out + "</span>";
}

std::string verification_section(const ChannelView& view) {
  const ChannelVerification& v = *view.result->verification;
  std::string out = bullet_list(v.sentences, "plain") + "<div class=\"wide\"><table>\n" +
                    table_head({"Term", "Model", "Fit of the simulated record", "Unit", ""});
  for (const TermVerification& t : v.terms) {
    out += table_row({term_title(t.term, view.unit),
                      value_text(t.model),
                      coefficient_text(t.simulated),
                      shown_term_unit(kTermNames[static_cast<std::size_t>(t.term)].key, view.unit),
                      t.agrees ? "agrees" : "disagrees"});
  }
  return folded(std::string("Simulated from the model ") +
                    (v.agrees ? "<span class=\"chip detected\">agrees</span>"
                              : "<span class=\"chip alarm\">disagrees</span>"),
                out + "</tbody></table></div>\n");
}

std::string lines_table(const ChannelView& view) {
  const ChannelResult& c = *view.result;
  if (c.lines.empty()) return "";
  std::string out = "<h4>Spectral lines</h4>\n<table>\n" +
                    table_head({"Frequency", "Amplitude (peak)", "Above the floor", "Width"});
  for (const SpectralLine& line : c.lines) {
    out += table_row({number_text(line.frequency_hz, 5) + " Hz",
                      number_text(line.amplitude, 3) + " " + view.unit,
                      "×" + number_text(line.excess, 3),
                      number_text(line.width_hz, 2) + " Hz"});
  }
  return out + "</tbody></table>\n";
}

std::string quality(const ChannelView& view) {
  const ChannelQuality& q = view.result->quality;
  const std::string& unit = view.shown_unit;
  const double all = static_cast<double>(q.samples + q.missing);
  std::string out = "<table class=\"facts\"><tbody>\n";
  out += table_row({"Samples", count_text(q.samples)});
  out += table_row({"Missing",
                    q.missing == 0
                        ? "none"
                        : fmt::format("{} ({} %)",
                                      count_text(q.missing),
                                      number_text(100 * static_cast<double>(q.missing) / all, 2))});
  out += table_row({"Mean", number_text(q.mean, 6) + " " + unit});
  const bool constant = q.samples > 0 && q.minimum == q.maximum;
  out += table_row({"Standard deviation",
                    constant ? "constant" : number_text(q.standard_deviation, 4) + " " + unit});
  if (q.samples > 0)
    out += table_row(
        {"Range",
         fmt::format("{} … {} {}", number_text(q.minimum, 5), number_text(q.maximum, 5), unit)});
  out += table_row(
      {"Resolution (LSB)",
       q.resolution ? number_text(*q.resolution, 4) + " " + unit : "no grid of values found"});
  out += table_row({"Distinct values",
                    q.distinct_values >= 4096 ? "4096 or more" : count_text(q.distinct_values)});
  out += table_row({"Saturated samples", q.saturated == 0 ? "none" : count_text(q.saturated)});
  out += table_row({"Longest run of one value",
                    count_text(q.longest_stuck) + (q.longest_stuck == 1 ? " sample" : " samples")});
  if (!constant)
    out +=
        table_row({"Kurtosis of differences",
                   number_text(q.difference_kurtosis, 3) + " (3 is Gaussian, more means spikes)"});
  if (q.float32 && !constant)
    out += table_row({"Number format",
                      "32-bit floats, in steps of " + number_text(q.float32_step, 2) + " " + unit});
  out += "</tbody></table>\n" + lines_table(view);
  return out + findings_list(q.findings);
}

std::string consumers(const ChannelView& view, double rate_hz) {
  if (view.consumers.empty()) return "";
  std::string out = "<div class=\"wide\"><table>\n" +
                    table_head({"For", "Name there", "Formula", "Value", "Unit"});
  const std::string* before = nullptr;
  for (const ConsumerNumber& row : view.consumers) {
    const bool repeated = before != nullptr && *before == row.consumer;
    out += fmt::format(
        "<tr><th scope=\"row\">{}</th><td>{}</td><td class=\"u\">{}</td><td class=\"n\">{}</td><td "
        "class=\"u\">{}</td></tr>\n",
        repeated ? "" : html_text(row.consumer),
        html_text(row.key),
        html_text(row.formula),
        html_text(row.value),
        html_text(row.unit));
    before = &row.consumer;
  }
  return out +
         "</tbody></table></div>\n<p class=\"note\">f = " + html_text(brief_text(rate_hz, 6)) +
         " Hz. ≤ stands before an upper 95 % limit of a term that was not detected.</p>\n";
}

std::string curve_points(const ChannelView& view) {
  const ChannelResult& c = *view.result;
  const auto& points = c.allan.points;
  if (points.empty()) return "";
  const std::string& unit = view.shown_unit;
  const std::size_t stride = (points.size() + kMostRows - 1) / kMostRows;
  std::string out = "<div class=\"wide\"><table class=\"points\">\n" +
                    table_head({"τ, s",
                                unit.empty() ? "Deviation" : "Deviation, " + unit,
                                "68 % interval",
                                "95 % interval",
                                "Degrees of freedom",
                                "Terms",
                                ""});
  for (std::size_t i = 0; i < points.size(); i += stride) {
    const AllanPoint& p = points[i];
    const auto interval = [&](const Interval& ci) {
      return p.edf > 0 ? number_text(ci.low) + " … " + number_text(ci.high) : std::string("–");
    };
    out += table_row({number_text(p.tau_s, 6),
                      number_text(p.deviation, 5),
                      interval(p.ci68),
                      interval(p.ci95),
                      p.edf > 0 ? number_text(p.edf, 4) : "–",
                      count_text(p.terms),
                      p.reliable ? "" : "unreliable"});
  }
  out += "</tbody></table></div>\n";
  if (stride > 1)
    out += fmt::format(
        "<p class=\"note\">Every {}th point; all of them are in curves.csv and report.json.</p>\n",
        stride);
  out += bullet_list(c.allan.notes, "plain") + bullet_list(c.spectrum.notes, "plain");
  return folded(fmt::format("Points of the {} curve ({})", name_of(c.allan.type), points.size()),
                out);
}

}  // namespace

std::string channel_section(const ChannelView& view,
                            const LogInfo& log,
                            std::size_t index,
                            const ChannelLayout& layout) {
  const ChannelResult& c = *view.result;
  const double rate_hz = log.time.rate_hz;
  std::string out = fmt::format(
      "<details class=\"channel\" id=\"channel-{}\"{}><summary>{} <b>{}</b>{}</summary>\n",
      index,
      layout.open ? " open" : "",
      rating_badge(view.judgement.rating),
      html_text(c.channel.name),
      view.unit.empty() ? " <span class=\"unit\">unit not stated, written U</span>"
                        : " <span class=\"unit\">" + html_text(view.shown_unit) + "</span>");
  out += "<p class=\"sentence\">" + html_text(view.summary) + "</p>\n";
  out += findings_list(view.judgement.findings) + bullet_list(view.beside_terms, "plain");
  if (layout.trace) out += trace_plot(view, index, log);
  out += curve_plots(view, index);
  if (c.fit)
    out += numbers_table(view, rate_hz) + folded(trust_summary(*c.fit), trust(view, index));
  if (c.verification) out += verification_section(view);
  out += folded("Data quality", quality(view));
  if (const std::string numbers = consumers(view, rate_hz); !numbers.empty())
    out += folded("Which number goes where", numbers);
  return out + curve_points(view) + "</details>\n";
}

}  // namespace libchar
