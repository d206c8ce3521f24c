// A YAML library prints 200 for 200.0 and 0.33333333333333331 for a third, and a number such as 1e-05 is text to YAML
// 1.1 readers: core/fields writes numbers with a decimal point that read back to the same double.

#include "libchar/model/model_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "libchar/core/file/output_files.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/model/model_fields.hpp"

namespace libchar {

std::string model_yaml(const SensorModel& model) {
  return "# Noise of one sensor channel. Keys name each term in full.\n" + yaml_of(model_entries(model));
}

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
  const MapReader part = at.map("gauss_markov", {"sigma", "tau_s", "sigma_ci95", "tau_ci95_s", "status"});
  if (process.sigma > 0 && !(process.tau_s > 0))
    part.refuse("sigma", "a Gauss-Markov process needs `tau_s`, its correlation time, above 0");
  if (!process.sigma_ci95.empty() && process.sigma_ci95.size() != 2) part.refuse("sigma_ci95", "expected [low, high]");
  if (process.tau_ci95_s.size() > 2)
    part.refuse("tau_ci95_s", "expected [low, high], or [low] where no upper end is known");
}

}  // namespace

SensorModel sensor_model_of(const Document& node, const std::string& file, const std::string& path) {
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

SensorModel read_model_file(const std::string& path) { return parse_sensor_model(read_document_text(path), path); }

namespace {

constexpr const char* kListFormat = "sensor-models";

}  // namespace

Json model_json(const SensorModel& model) { return json_of(model_entries(model)); }

Json models_json(const std::vector<const SensorModel*>& models) {
  if (models.size() == 1) return model_json(*models.front());
  Json out = json_of({{"format", std::string(kListFormat)}, {"version", std::uint64_t{1}}, tool_entry()});
  out["models"] = Json::array();
  for (const SensorModel* m : models) out["models"].push_back(model_json(*m));
  return out;
}

namespace {

std::vector<SensorModel> listed_models(const std::string& path) {
  const Document document = parse_document(read_document_text(path), path);
  if (std::vector<SensorModel> foreign = detail::foreign_models(document, path); !foreign.empty()) return foreign;
  const DocumentEntry* format = document.kind == Document::Kind::map ? document.find("format") : nullptr;
  if (format == nullptr || format->value.text != kListFormat) {
    check_format(document, path, "sensor-model", 1);
    return {sensor_model_of(document, path, "")};
  }
  check_format(document, path, kListFormat, 1);
  const MapReader top(document, path, "", {"format", "version", "tool", "models"});
  std::vector<SensorModel> models;
  std::size_t index = 0;
  for (const Document& node : top.list("models"))
    models.push_back(sensor_model_of(node, path, "models[" + std::to_string(index++) + "]"));
  if (models.empty()) top.refuse("models", "an empty list");
  return models;
}

bool is_called_document(const std::string& path) {
  const std::string ending = ascii_lower(std::filesystem::path(path).extension().string());
  return ending == ".yaml" || ending == ".yml" || ending == ".json";
}

}  // namespace

std::vector<SensorModel> read_model_list(const std::string& path) {
  try {
    return listed_models(path);
  } catch (const Error& error) {
    const Problem& problem = error.problem();
    if (is_called_document(path) || (problem.code != "E0522" && problem.code != "E0546")) throw;
    throw input_error("E0546", path)
        .says("is not a sensor-model")
        .hint("of a log, make the models first: sensorchar characterize " + shell_word(path) + " -o FOLDER");
  }
}

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kEnding = ".sensor.yaml";

/// Those that a report names as its own.
std::vector<std::string> named_by(const fs::path& report) {
  refuse_interrupted(report);
  std::vector<std::string> files;
  for (const std::string& name : detail::named_files(report.string()))
    if (name.ends_with(kEnding)) files.push_back((report.parent_path() / name).string());
  return files;
}

std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) entries.push_back(entry.path());
  std::sort(entries.begin(), entries.end());
  return entries;
}

std::vector<std::string> models_in(const fs::path& folder) {
  std::error_code ignored;
  if (const fs::path report = folder / "report.json"; fs::is_regular_file(report, ignored)) return named_by(report);
  std::vector<std::string> files;
  for (const fs::path& entry : entries_of(folder))
    if (entry.string().ends_with(kEnding)) files.push_back(entry.string());
  return files;
}

}  // namespace

std::vector<std::string> model_files(const std::string& path) {
  std::error_code ignored;
  const bool is_folder = fs::is_directory(path, ignored);
  if (!is_folder && fs::path(path).filename() != "report.json") return {path};
  std::vector<std::string> files = is_folder ? models_in(path) : named_by(path);
  if (is_folder && files.empty())
    for (const fs::path& entry : entries_of(path))
      if (fs::is_directory(entry, ignored))
        for (std::string& file : models_in(entry)) files.push_back(std::move(file));
  if (files.empty())
    throw input_error("E0551", path)
        .says(is_folder ? "the folder holds no sensor model" : "the report names no sensor model")
        .hint("sensorchar characterize writes one for each channel that it can fit");
  return files;
}

}  // namespace libchar
