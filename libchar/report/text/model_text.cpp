#include "libchar/report/text/model_text.hpp"

#include <fmt/format.h>

#include <vector>

#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/term_cells.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/text/text_table.hpp"
#include "libchar/export/sensor_group.hpp"

namespace libchar {
namespace {

std::vector<std::string> term_row(const Coefficient& c,
                                  std::size_t t,
                                  const std::string& unit,
                                  bool colours) {
  const TermCells cells = term_cells(c, static_cast<Term>(t), printable(unit));
  return {fmt::format("{} {}", kTermNames[t].key, cells.letter),
          cells.own.value,
          interval_words(cells.own),
          cells.own.unit,
          tinted(status_words(c.status), tint_of(c.status), colours),
          said(cells.field)};
}

}  // namespace

std::string model_text(const SensorModel& m, const TextLook& look) {
  const std::string axis = axis_of(m);
  std::string text = fmt::format("{}{}: {}{}, {}, {}\n",
                                 printable(m.channel),
                                 m.unit.empty() ? "" : fmt::format(" [{}]", printable(m.unit)),
                                 printable(kind_of(m)),
                                 axis.empty() ? "" : " " + axis,
                                 m.rate_hz > 0 ? brief_text(m.rate_hz, 6) + " Hz" : "rate unknown",
                                 printable(m.obtained));
  std::vector<std::vector<std::string>> rows = {
      {"term", "value", "95 % interval", "unit", "status", "in other words"}};
  for (std::size_t t = 0; t < kTerms; ++t) {
    if (m.noise[t].status == Status::not_fitted && !m.noise[t].value) continue;
    rows.push_back(term_row(m.noise[t], t, m.unit, look.colours));
  }
  if (m.gauss_markov.sigma > 0) {
    const std::string u = m.unit.empty() ? "U" : printable(m.unit);
    rows.push_back({"gauss_markov sigma", brief_text(m.gauss_markov.sigma, 5), "", u, "", ""});
    rows.push_back({"gauss_markov tau", brief_text(m.gauss_markov.tau_s, 5), "", "s", "", ""});
  }
  text += rows.size() > 1 ? text_table(rows, "  ", true, look.width) : "  no noise\n";
  text += "  coefficients are roots of two-sided densities; one-sided is √2 times as large\n";
  if (m.bandwidth_hz)
    text += fmt::format("  low-pass corner {} Hz\n", brief_text(*m.bandwidth_hz, 4));
  if (m.resolution) text += fmt::format("  resolution {}\n", brief_text(*m.resolution, 4));
  if (m.tau_max_s > 0)
    text += fmt::format("  valid for averaging times of {} … {}\n",
                        duration_text(m.tau_min_s),
                        duration_text(m.tau_max_s));
  for (const std::string& remark : m.remarks) text += fmt::format("  {}\n", printable(remark));
  return text;
}

}  // namespace libchar
