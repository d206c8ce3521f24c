#include "libchar/report/fit_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "libchar/characterize/summary.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/text_table.hpp"
#include "libchar/core/units.hpp"

namespace libchar {

namespace {

std::string rounded_length(double seconds) {
  if (seconds < 120) return fmt::format("{} s", significant(seconds, 2));
  if (seconds < 7200) return fmt::format("{} min", significant(seconds / 60, 2));
  if (seconds < 172800) return fmt::format("{} h", significant(seconds / 3600, 2));
  if (seconds < 3.2e8) return fmt::format("{} d", significant(seconds / 86400, 2));
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

}  // namespace

std::string fit_text(const Channel& channel, const NoiseFit& fit) {
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
                                                 "at best",
                                                 "10 % needs",
                                                 "in other words"}};
  for (std::size_t i = 0; i < kTerms; ++i) {
    if (fit.term[i].status != Status::not_fitted)
      rows.push_back(row_of(fit.term[i], i, channel.unit));
  }
  text += text_table(rows, "  ", true);
  if (!fit.band.whole)
    text +=
        "  at best, 10 % needs: were the whole spectrum described by the terms, not this band "
        "alone\n";
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
