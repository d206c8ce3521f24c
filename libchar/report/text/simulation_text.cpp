#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "libchar/core/document/coefficient_fields.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/report/detail/tables/coefficients.hpp"
#include "libchar/report/text/characterization_text.hpp"

namespace libchar {

std::string simulation_text(const ArraySimulation& s, const SimulatedLog& written) {
  std::string text = fmt::format("{}: {} samples of {} at {}, {}, seed {}\n", printable(written.files.at(0)), s.samples,
                                 plural(written.channels, "channel"), detail::frequency_text(s.rate_hz, 6),
                                 duration_text(static_cast<double>(s.samples) / s.rate_hz), s.seed);
  for (std::size_t i = 0; i < s.sensors.size(); ++i) {
    const SensorModel& m = s.sensors[i].model;
    if (m.scale_factor.spread > 0 || m.bias.spread > 0)
      text += fmt::format("  {}: drew scale factor {}, bias {} {}\n", printable(s.sensors[i].name),
                          brief_text(written.draws[i].scale_factor, 6), brief_text(written.draws[i].bias, 6),
                          printable(m.unit));
  }
  for (std::size_t i = 1; i < written.files.size(); ++i) text += fmt::format("wrote {}\n", printable(written.files[i]));
  return text;
}

Json simulation_json(const ArraySimulation& s, const SimulatedLog& written) {
  Json out = {{"samples", s.samples},    {"rate_hz", s.rate_hz},     {"seed", s.seed},
              {"output", Json::array()}, {"sensors", Json::array()}, {"truth", s.truth_names}};
  for (const std::string& file : written.files) out["output"].push_back(printable(file));
  for (std::size_t i = 0; i < s.sensors.size(); ++i) {
    Json findings = Json::array();
    for (const Finding& one : s.sensors[i].model.findings) findings.push_back(document_of(finding_fields(), one));
    out["sensors"].push_back({{"name", printable(s.sensors[i].name)},
                              {"unit", printable(output_unit(s.sensors[i].model))},
                              {"scale_factor", written.draws[i].scale_factor},
                              {"bias", written.draws[i].bias},
                              {"findings", std::move(findings)}});
  }
  return out;
}

std::string model_text(const SensorModel& m, const TextLook& look) {
  const std::string axis = axis_of(m);
  std::string text = fmt::format(
      "{}{}: {}{}, {}, {}\n", printable(m.channel), m.unit.empty() ? "" : fmt::format(" [{}]", printable(m.unit)),
      printable(kind_of(m)), axis.empty() ? "" : " " + axis,
      m.rate_hz > 0 ? detail::frequency_text(m.rate_hz, 6) : "rate unknown", printable(m.obtained));
  std::vector<Coefficient> process;
  if (m.gauss_markov.sigma > 0) {
    process.resize(2);
    process[0].value = m.gauss_markov.sigma;
    process[1].value = m.gauss_markov.tau_s;
  }
  const Table noise = coefficients_table(m.noise, m.unit, process);
  text += noise.rows.empty() ? "  no noise\n" : terminal_table(noise, look);
  text += "  coefficients are roots of two-sided densities; one-sided is √2 times as large\n";
  if (m.bandwidth_hz) text += fmt::format("  low-pass corner {}\n", detail::frequency_text(*m.bandwidth_hz, 4));
  if (m.resolution) text += fmt::format("  resolution {}\n", brief_text(*m.resolution, 4));
  if (m.tau_max_s > 0)
    text +=
        fmt::format("  valid for averaging times of {} … {}\n", duration_text(m.tau_min_s), duration_text(m.tau_max_s));
  for (const std::string& remark : m.remarks) text += fmt::format("  {}\n", printable(remark));
  return text + findings_text(m.findings, 5, look.colours);
}

}  // namespace libchar
