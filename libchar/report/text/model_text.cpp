#include "libchar/report/text/model_text.hpp"

#include <fmt/format.h>

#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/export/sensor_group.hpp"
#include "libchar/report/detail/tables/coefficients.hpp"

namespace libchar {
std::string model_text(const SensorModel& m, const TextLook& look) {
  const std::string axis = axis_of(m);
  std::string text = fmt::format("{}{}: {}{}, {}, {}\n",
                                 printable(m.channel),
                                 m.unit.empty() ? "" : fmt::format(" [{}]", printable(m.unit)),
                                 printable(kind_of(m)),
                                 axis.empty() ? "" : " " + axis,
                                 m.rate_hz > 0 ? brief_text(m.rate_hz, 6) + " Hz" : "rate unknown",
                                 printable(m.obtained));
  std::vector<Coefficient> process;
  if (m.gauss_markov.sigma > 0) {
    process.resize(2);
    process[0].value = m.gauss_markov.sigma;
    process[1].value = m.gauss_markov.tau_s;
  }
  const Table noise = coefficients_table(m.noise, m.unit, process);
  text += noise.rows.empty() ? "  no noise\n" : terminal_table(noise, look);
  text += "  coefficients are roots of two-sided densities; one-sided is √2 times as large\n";
  if (m.bandwidth_hz)
    text += fmt::format("  low-pass corner {} Hz\n", brief_text(*m.bandwidth_hz, 4));
  if (m.resolution) text += fmt::format("  resolution {}\n", brief_text(*m.resolution, 4));
  if (m.tau_max_s > 0)
    text += fmt::format("  valid for averaging times of {} … {}\n",
                        duration_text(m.tau_min_s),
                        duration_text(m.tau_max_s));
  for (const std::string& remark : m.remarks) text += fmt::format("  {}\n", printable(remark));
  return text + findings_text(m.findings, 5, look.colours);
}

}  // namespace libchar
