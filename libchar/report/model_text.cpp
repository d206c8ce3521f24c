#include "libchar/report/model_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "libchar/core/decimal.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/text_table.hpp"
#include "libchar/core/units.hpp"
#include "libchar/export/sensor_group.hpp"

namespace libchar {
namespace {

// The figure of a term in the habitual units, its sides said.
std::string in_other_words(const Coefficient& c, std::size_t t, const std::string& unit) {
  std::string text;
  for (const HabitualValue& habit : habitual_units(kTermNames[t].key, unit))
    text += fmt::format("{}{}{} {}{}",
                        text.empty() ? "" : ", ",
                        c.value ? "" : "≤ ",
                        significant(habit.factor * c.value.value_or(c.upper95.value_or(0)), 4),
                        habit.symbol,
                        habit.name.find("floor") != std::string::npos       ? " floor"
                        : habit.name.find("one-sided") != std::string::npos ? " one-sided"
                        : habit.name.find("two-sided") != std::string::npos ? " two-sided"
                                                                            : "");
  return text;
}

std::vector<std::string> term_row(const Coefficient& c, std::size_t t, const std::string& unit) {
  const bool interval = c.value && c.status != Status::given && c.ci95.high > 0;
  std::string status(name_of(c.status));
  std::replace(status.begin(), status.end(), '_', ' ');
  return {fmt::format("{} {}", kTermNames[t].key, kTermNames[t].letter),
          c.value     ? significant(*c.value, 5)
          : c.upper95 ? "≤ " + significant(*c.upper95, 3)
                      : "–",
          interval ? fmt::format("{} … {}", significant(c.ci95.low, 4), significant(c.ci95.high, 4))
                   : "",
          term_unit(kTermNames[t].key, printable(unit)),
          status,
          c.value || c.upper95 ? in_other_words(c, t, unit) : ""};
}

}  // namespace

std::string model_text(const SensorModel& m, std::size_t width) {
  const std::string axis = axis_of(m);
  std::string text = fmt::format("{}{}: {}{}, {}, {}\n",
                                 printable(m.channel),
                                 m.unit.empty() ? "" : fmt::format(" [{}]", printable(m.unit)),
                                 printable(kind_of(m)),
                                 axis.empty() ? "" : " " + axis,
                                 m.rate_hz > 0 ? significant(m.rate_hz, 6) + " Hz" : "rate unknown",
                                 printable(m.obtained));
  std::vector<std::vector<std::string>> rows = {
      {"term", "value", "95 % interval", "unit", "status", "in other words"}};
  for (std::size_t t = 0; t < kTerms; ++t) {
    if (m.noise[t].status == Status::not_fitted && !m.noise[t].value) continue;
    rows.push_back(term_row(m.noise[t], t, m.unit));
  }
  if (m.gauss_markov.sigma > 0) {
    const std::string u = m.unit.empty() ? "U" : printable(m.unit);
    rows.push_back({"gauss_markov sigma", significant(m.gauss_markov.sigma, 5), "", u, "", ""});
    rows.push_back({"gauss_markov tau", significant(m.gauss_markov.tau_s, 5), "", "s", "", ""});
  }
  text += rows.size() > 1 ? text_table(rows, "  ", true, width) : "  no noise\n";
  text += "  coefficients are roots of two-sided densities; one-sided is √2 times as large\n";
  if (m.bandwidth_hz)
    text += fmt::format("  low-pass corner {} Hz\n", significant(*m.bandwidth_hz, 4));
  if (m.resolution) text += fmt::format("  resolution {}\n", significant(*m.resolution, 4));
  if (m.tau_max_s > 0)
    text += fmt::format("  valid for averaging times of {} s … {} s\n",
                        significant(m.tau_min_s, 3),
                        significant(m.tau_max_s, 3));
  for (const std::string& remark : m.remarks) text += fmt::format("  {}\n", printable(remark));
  return text;
}

}  // namespace libchar
