#include "libchar/report/text/simulation_text.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/scene/simulated_scene.hpp"

namespace libchar {

std::string simulation_text(const ArraySimulation& s, const SimulatedLog& written) {
  std::string text = fmt::format("{}: {} samples of {} channel{} at {} Hz, {}, seed {}\n",
                                 printable(written.files.at(0)),
                                 s.samples,
                                 written.channels,
                                 written.channels == 1 ? "" : "s",
                                 brief_text(s.rate_hz, 6),
                                 duration_text(static_cast<double>(s.samples) / s.rate_hz),
                                 s.seed);
  for (std::size_t i = 0; i < s.sensors.size(); ++i) {
    const SensorModel& m = s.sensors[i].model;
    if (m.scale_factor.spread > 0 || m.bias.spread > 0)
      text += fmt::format("  {}: drew scale factor {}, bias {} {}\n",
                          printable(s.sensors[i].name),
                          brief_text(written.draws[i].scale_factor, 6),
                          brief_text(written.draws[i].bias, 6),
                          printable(m.unit));
  }
  for (std::size_t i = 1; i < written.files.size(); ++i)
    text += fmt::format("wrote {}\n", printable(written.files[i]));
  return text;
}

Json simulation_json(const ArraySimulation& s, const SimulatedLog& written) {
  Json out = {{"samples", s.samples},
              {"rate_hz", s.rate_hz},
              {"seed", s.seed},
              {"output", Json::array()},
              {"sensors", Json::array()},
              {"truth", s.truth_names}};
  for (const std::string& file : written.files) out["output"].push_back(printable(file));
  for (std::size_t i = 0; i < s.sensors.size(); ++i)
    out["sensors"].push_back({{"name", printable(s.sensors[i].name)},
                              {"unit", printable(output_unit(s.sensors[i].model))},
                              {"scale_factor", written.draws[i].scale_factor},
                              {"bias", written.draws[i].bias}});
  return out;
}

}  // namespace libchar
