#include "libchar/model/model_reader.hpp"

#include <fmt/format.h>

#include "libchar/core/document/document.hpp"
#include "libchar/core/document/document_file.hpp"
#include "libchar/model/model_fields.hpp"

namespace libchar {
namespace {

void check_shape(const SensorModel& model, const MapReader& at) {
  const NoiseShape& shape = model.noise_shape;
  const MapReader part = at.map("noise_shape", {"kind", "taps", "frequency_hz", "ratio"});
  using Kind = NoiseShape::Kind;
  const bool averages = shape.kind == Kind::boxcar || shape.kind == Kind::bartlett;
  const auto only = [&](std::string_view key, bool used) {
    if (part.has(key) && !used)
      part.refuse(key, fmt::format("says nothing of a shape of kind {}", name_of(shape.kind)));
  };
  only("taps", averages);
  only("frequency_hz", shape.kind == Kind::measured);
  only("ratio", shape.kind == Kind::measured);
  if (shape.kind != Kind::none && model.noise_sampling == NoiseSampling::band_limited)
    part.refuse("kind", "noise with a shape is made sample by sample, not band-limited");
  if (averages && (shape.taps < 2 || shape.taps > 4096))
    part.refuse("kind", "a moving average needs `taps` from 2 to 4096");
  if (shape.kind != Kind::measured) return;
  if (shape.ratio.empty() || shape.ratio.size() != shape.frequency_hz.size())
    part.refuse("ratio", "`frequency_hz` and `ratio` need the same number of values, at least one");
  for (std::size_t i = 0; i < shape.ratio.size(); ++i) {
    if (!(shape.ratio[i] > 0)) part.refuse("ratio", "every ratio must be above 0");
    if (!(shape.frequency_hz[i] > (i == 0 ? 0 : shape.frequency_hz[i - 1])))
      part.refuse("frequency_hz", "frequencies must be above 0 and rise");
  }
}

void check_process(const GaussMarkovNoise& process, const MapReader& at) {
  const MapReader part =
      at.map("gauss_markov", {"sigma", "tau_s", "sigma_ci95", "tau_ci95_s", "status"});
  if (process.sigma > 0 && !(process.tau_s > 0))
    part.refuse("sigma", "a Gauss-Markov process needs `tau_s`, its correlation time, above 0");
  if (!process.sigma_ci95.empty() && process.sigma_ci95.size() != 2)
    part.refuse("sigma_ci95", "expected [low, high]");
  if (process.tau_ci95_s.size() > 2)
    part.refuse("tau_ci95_s", "expected [low, high], or [low] where no upper end is known");
}

}  // namespace

SensorModel sensor_model_of(const Document& node,
                            const std::string& file,
                            const std::string& path) {
  const MapReader at(node, file, path, keys_of(model_fields()));
  SensorModel model;
  model.obtained = "written by hand";
  read_fields(model_fields(), at, model);
  if (model.noise_sampling == NoiseSampling::band_limited && !model.bandwidth_hz)
    at.refuse("noise_sampling", "band-limited noise needs bandwidth_hz");
  if (at.has("gauss_markov")) check_process(model.gauss_markov, at);
  if (at.has("noise_shape")) check_shape(model, at);
  if (model.sensitivity.gain == 0)
    at.map("sensitivity", {"gain", "unit"}).refuse("gain", "a gain of 0 leaves no output");
  return model;
}

SensorModel parse_sensor_model(std::string_view text, const std::string& file) {
  const Document document = parse_document(text, file);
  check_format(document, file, "sensor-model", 1);
  return sensor_model_of(document, file, "");
}

SensorModel read_model_file(const std::string& path) {
  return parse_sensor_model(read_document_text(path), path);
}

}  // namespace libchar
