#include "libchar/report/fit_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "libchar/characterize/summary.hpp"
#include "libchar/core/decimal.hpp"
#include "libchar/core/readable.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/text_table.hpp"
#include "libchar/core/units.hpp"
#include "libchar/fit/power_laws.hpp"

namespace libchar {

namespace {

std::string rounded_length(double seconds) {
  if (seconds < 120) return fmt::format("{} s", number_text(seconds, 2));
  if (seconds < 7200) return fmt::format("{} min", number_text(seconds / 60, 2));
  if (seconds < 172800) return fmt::format("{} h", number_text(seconds / 3600, 2));
  if (seconds < 3.2e8) return fmt::format("{} d", number_text(seconds / 86400, 2));
  return "> 10 years";
}

std::string in_habitual_units(const Coefficient& term, std::size_t i, const std::string& unit) {
  std::string text;
  for (const HabitualValue& habit : habitual_units(kTermNames[i].key, unit)) {
    const double value = term.value ? *term.value : term.upper95.value_or(0);
    text += fmt::format("{}{}{} {}",
                        text.empty() ? "" : ", ",
                        term.value ? "" : "≤ ",
                        significant(habit.factor * value, 4),
                        habit.symbol);
  }
  return text;
}

// "N angle random walk": the letter of IEEE 952 and the field's name.
std::string named(Term term, const std::string& unit) {
  std::string title = term_title(term, unit);
  if (!title.empty() && title[0] >= 'A' && title[0] <= 'Z')
    title[0] = static_cast<char>(title[0] - 'A' + 'a');
  return fmt::format("{} {}", kTermNames[static_cast<std::size_t>(term)].letter, title);
}

std::vector<std::string> row_of(const Coefficient& term, std::size_t i, const std::string& unit) {
  const std::string value = term.value     ? significant(*term.value, 5)
                            : term.upper95 ? "≤ " + significant(*term.upper95, 3)
                                           : "–";
  const std::string interval =
      term.value
          ? fmt::format("{} … {}", significant(term.ci95.low, 4), significant(term.ci95.high, 4))
          : "";
  std::string status(name_of(term.status));
  std::replace(status.begin(), status.end(), '_', ' ');
  return {named(static_cast<Term>(i), unit),
          value,
          interval,
          shown_term_unit(kTermNames[i].key, printable(unit)),
          status,
          term.bound ? fmt::format("{} %", significant(100 * *term.bound, 2)) : "",
          term.seconds_for_10_percent ? rounded_length(*term.seconds_for_10_percent) : "",
          in_habitual_units(term, i, unit)};
}

std::vector<std::string> process_row(const Coefficient& c,
                                     const std::string& name,
                                     const std::string& unit) {
  const std::string high = std::isfinite(c.ci95.high) ? significant(c.ci95.high, 4) : "no end";
  std::string status(name_of(c.status));
  std::replace(status.begin(), status.end(), '_', ' ');
  return {name,
          significant(*c.value, 5),
          fmt::format("{} … {}", significant(c.ci95.low, 4), high),
          unit,
          status,
          c.bound ? fmt::format("{} %", significant(100 * *c.bound, 2)) : "",
          "",
          ""};
}

std::string power_laws_text(const NoiseFit& fit, std::size_t width) {
  std::vector<std::vector<std::string>> rows = {
      {"S_y(f), one-sided", "noise type", "h", "95 % interval", "status"}};
  for (const PowerLaw& law : power_laws(fit)) {
    std::string status(name_of(law.h.status));
    std::replace(status.begin(), status.end(), '_', ' ');
    rows.push_back({fmt::format("h{} f^{}", law.alpha, law.alpha),
                    fmt::format("{} {}", law.name, law.abbreviation),
                    law.h.value     ? significant(*law.h.value, 4)
                    : law.h.upper95 ? "≤ " + significant(*law.h.upper95, 3)
                                    : "–",
                    law.h.value ? fmt::format("{} … {}",
                                              significant(law.h.ci95.low, 3),
                                              significant(law.h.ci95.high, 3))
                                : "",
                    status});
  }
  return rows.size() > 1 ? text_table(rows, "  ", true, width) : "";
}

}  // namespace

std::string fit_text(const Channel& channel, const NoiseFit& fit, std::size_t width) {
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
                                                 "least error",
                                                 "record for 10 %",
                                                 "in other words"}};
  for (std::size_t i = 0; i < kTerms; ++i) {
    if (fit.term[i].status != Status::not_fitted)
      rows.push_back(row_of(fit.term[i], i, channel.unit));
  }
  if (fit.gauss_markov && fit.gauss_markov->in_model) {
    const std::string unit = channel.unit.empty() ? "U" : printable(channel.unit);
    rows.push_back(process_row(fit.gauss_markov->sigma, "gauss_markov sigma", unit));
    rows.push_back(process_row(fit.gauss_markov->tau_s, "gauss_markov tau", "s"));
  }
  text += text_table(rows, "  ", true, width);
  if (!fit.band.whole)
    text +=
        "  least error, record for 10 %: of a record whose whole spectrum the terms describe, not "
        "this band "
        "alone\n";
  text += power_laws_text(fit, width);
  if (fit.bandwidth_hz)
    text += fmt::format("  low-pass corner {} Hz ({} … {})\n",
                        significant(*fit.bandwidth_hz, 4),
                        significant(fit.bandwidth_ci95->low, 4),
                        significant(fit.bandwidth_ci95->high, 4));
  // A curve without uncertainties is scaled to its own scatter: its chi-square says nothing.
  const bool judged = fit.goodness.p < 1 || fit.goodness.chi2 != fit.goodness.dof;
  text += "  " + fit.method;
  if (judged)
    text += fmt::format("; goodness of fit: chi-square {} for {} degrees of freedom, p = {}",
                        significant(fit.goodness.chi2, 4),
                        significant(fit.goodness.dof, 4),
                        significant(fit.goodness.p, 2));
  text += "\n";
  if (fit.second_opinion)
    text += fmt::format("  second opinion (covariance-weighted Allan fit): {}\n",
                        fit.second_opinion->sentence);
  for (const Remedy& remedy : fit.remedies)
    text += fmt::format("  remedy {}: {} – because {}\n", remedy.kind, remedy.action, remedy.alarm);
  for (const std::string& sentence : fit.sentences) text += fmt::format("  {}\n", sentence);
  return text;
}

}  // namespace libchar
