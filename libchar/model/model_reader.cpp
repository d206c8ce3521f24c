#include "libchar/model/model_reader.hpp"

#include "libchar/core/document.hpp"
#include "libchar/core/document_file.hpp"
#include "libchar/model/model_fields.hpp"

namespace libchar {

SensorModel sensor_model_of(const Document& node,
                            const std::string& file,
                            const std::string& path) {
  const MapReader at(node, file, path, keys_of(model_fields()));
  SensorModel model;
  model.obtained = "written by hand";
  read_fields(model_fields(), at, model);
  if (model.noise_sampling == NoiseSampling::band_limited && !model.bandwidth_hz)
    at.refuse("noise_sampling", "band-limited noise needs bandwidth_hz");
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
