#include "libchar/report/text/fit_text.hpp"

#include <fmt/format.h>

#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/report/detail/tables/coefficients.hpp"

namespace libchar {

std::string fit_text(const Channel& channel, const NoiseFit& fit, const TextLook& look) {
  std::string text = fmt::format("{}{}\n",
                                 printable(channel.name),
                                 shown_unit(channel.unit).empty() || channel.unit.empty()
                                     ? ""
                                     : fmt::format(" [{}]", printable(channel.unit)));
  text += terminal_table(coefficients_table(fit, channel.unit), look);
  if (!fit.band.whole)
    text +=
        "  best possible, record for 10 %: of a record whose whole spectrum the terms describe, "
        "not "
        "this band alone\n";
  if (const Table laws = power_laws_table(fit); !laws.rows.empty())
    text += "  " + terminal_table(laws, look);
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
