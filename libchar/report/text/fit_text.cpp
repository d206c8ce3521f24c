#include "libchar/report/text/fit_text.hpp"

#include <fmt/format.h>

#include <vector>

#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/term_cells.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/text/text_table.hpp"
#include "libchar/core/units.hpp"
#include "libchar/fit/curve/power_laws.hpp"

namespace libchar {

namespace {

// "N angle random walk": the letter of IEEE 952 and the field's name.
std::string named(const TermCells& cells) {
  std::string title = cells.title;
  title[0] = static_cast<char>(title[0] - 'A' + 'a');
  return cells.letter + " " + title;
}

std::string status_cell(Status status, bool colours) {
  return tinted(status_words(status), tint_of(status), colours);
}

std::vector<std::string> row_of(const TermCells& cells, bool colours) {
  return {named(cells),
          cells.own.value,
          interval_words(cells.own),
          cells.own.unit,
          status_cell(cells.status, colours),
          cells.best_possible,
          cells.length_for_10_percent,
          said(cells.field)};
}

std::vector<std::string> process_row(const Coefficient& c,
                                     const std::string& name,
                                     const std::string& unit,
                                     bool colours) {
  const ShownValue shown = shown_value(c, 1, unit);
  return {name,
          shown.value,
          interval_words(shown),
          unit,
          status_cell(c.status, colours),
          c.bound ? "±" + percent_text(*c.bound) : "",
          "",
          ""};
}

std::string power_laws_text(const NoiseFit& fit, const TextLook& look) {
  std::vector<std::vector<std::string>> rows = {
      {"S_y(f), one-sided", "noise type", "h", "95 % interval", "status"}};
  for (const PowerLaw& law : power_laws(fit)) {
    const ShownValue h = shown_value(law.h, 1, "");
    rows.push_back({fmt::format("h{} f^{}", law.alpha, law.alpha),
                    fmt::format("{} {}", law.name, law.abbreviation),
                    h.value,
                    interval_words(h),
                    status_cell(law.h.status, look.colours)});
  }
  return rows.size() > 1 ? text_table(rows, "  ", true, look.width) : "";
}

}  // namespace

std::string fit_text(const Channel& channel, const NoiseFit& fit, const TextLook& look) {
  std::string text = fmt::format("{}{}\n",
                                 printable(channel.name),
                                 shown_unit(channel.unit).empty() || channel.unit.empty()
                                     ? ""
                                     : fmt::format(" [{}]", printable(channel.unit)));
  std::vector<std::vector<std::string>> rows = {{"term",
                                                 "value",
                                                 "95 % interval",
                                                 "unit",
                                                 "status",
                                                 "best possible",
                                                 "record for 10 %",
                                                 "in other words"}};
  for (std::size_t i = 0; i < kTerms; ++i) {
    if (fit.term[i].status != Status::not_fitted)
      rows.push_back(row_of(term_cells(fit.term[i], static_cast<Term>(i), printable(channel.unit)),
                            look.colours));
  }
  if (fit.gauss_markov && fit.gauss_markov->in_model) {
    const std::string unit = channel.unit.empty() ? "U" : printable(channel.unit);
    rows.push_back(process_row(fit.gauss_markov->sigma, "gauss_markov sigma", unit, look.colours));
    rows.push_back(process_row(fit.gauss_markov->tau_s, "gauss_markov tau", "s", look.colours));
  }
  text += text_table(rows, "  ", true, look.width);
  if (!fit.band.whole)
    text +=
        "  best possible, record for 10 %: of a record whose whole spectrum the terms describe, "
        "not "
        "this band alone\n";
  text += power_laws_text(fit, look);
  if (fit.bandwidth_hz) {
    const int digits = digits_of(*fit.bandwidth_hz, *fit.bandwidth_ci95);
    text += fmt::format("  low-pass corner {} Hz ({})\n",
                        number_text(*fit.bandwidth_hz, digits),
                        interval_text(*fit.bandwidth_ci95, digits));
  }
  // A curve without uncertainties is scaled to its own scatter: its chi-square says nothing.
  const bool judged = fit.goodness.p < 1 || fit.goodness.chi2 != fit.goodness.dof;
  text += "  " + fit.method;
  if (judged)
    text += fmt::format("; goodness of fit: chi-square {} for {} degrees of freedom, p = {}",
                        brief_text(fit.goodness.chi2, 4),
                        brief_text(fit.goodness.dof, 4),
                        brief_text(fit.goodness.p, 2));
  text += "\n";
  if (fit.second_opinion)
    text += fmt::format("  second opinion (covariance-weighted Allan fit): {}\n",
                        fit.second_opinion->sentence);
  for (const Remedy& remedy : fit.remedies)
    text += fmt::format("  remedy {}: {} – because {}\n", remedy.kind, remedy.action, remedy.alarm);
  return text;
}

}  // namespace libchar
