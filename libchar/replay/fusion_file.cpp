#include "libchar/replay/fusion_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "libchar/core/document/coefficient_fields.hpp"
#include "libchar/core/document/document.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/file/sha256.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/fusion/alignment.hpp"

namespace libchar {
namespace {

constexpr const char* kFormat = "fusion";
constexpr Word kInterpolations[] = {{"sinc"}, {"cubic"}};
constexpr Word kTrends[] = {{"none"}, {"mean"}, {"line"}};

const Fields<LearntInput> kLearntInputFields = {
    field<&LearntInput::name>("name", {.meaning = "of the estimate's column", .required = true}),
    field<&LearntInput::unit>("unit", {.meaning = "of the estimate", .otherwise = "not known"}),
    field<&LearntInput::reference_offset>("reference_offset",
                                          {.meaning = "subtracted from the reference", .otherwise = "0"}),
    field<&LearntInput::level_sd>("level_sd", {.range = kNotNegative,
                                               .meaning = "deviation of the mean of the sensors' means",
                                               .otherwise = "offsets are not taken out"}),
    field<&LearntInput::gain_sd>(
        "gain_sd",
        {.range = kNotNegative, .meaning = "deviation of the gain that all share", .otherwise = "not known"}),
    field<&LearntInput::gain_about>("gain_about", {.meaning = "input at which it does not matter", .otherwise = "0"}),
};

const Fields<LearntFrom> kLearntFromFields = {
    field<&LearntFrom::path>("path", {.meaning = "of a recording or reference"}),
    field<&LearntFrom::sha256>("sha256", {.meaning = "of its content"}),
};

const Fields<LearntTilt> kLearntTiltFields = {
    field<&LearntTilt::gyroscope>("gyroscope", {.meaning = "name of a sensor"}),
    field<&LearntTilt::accelerometer_x>("accelerometer_x", {.meaning = "name of a sensor"}),
    field<&LearntTilt::accelerometer_z>("accelerometer_z", {.meaning = "name of a sensor"}),
};

const Fields<LearntAlignment> kLearntAlignmentFields = {
    field<&LearntAlignment::delay_samples>("delay_samples",
                                           {.range = {-fusion::kMostDelay, fusion::kMostDelay},
                                            .meaning = "the sensor is so late, in samples at `rate_hz`",
                                            .otherwise = "0"}),
    field<&LearntAlignment::bias>("bias", {.meaning = "in units of the input", .otherwise = "0"}),
    field<&LearntAlignment::gain>(
        "gain", {.range = {-1, std::numeric_limits<double>::max(), true}, .meaning = "beyond one", .otherwise = "0"}),
    field<&LearntAlignment::cross>("cross", {.meaning = "share of each further axis", .otherwise = "none"}),
    field<&LearntAlignment::low>(
        "low",
        {.meaning = "samples at or below are saturated: of the sensor, then of its further axes; −10³⁰⁰: no limit",
         .otherwise = "no limits"}),
    field<&LearntAlignment::high>("high", {.meaning = "the same above; 10³⁰⁰: no limit", .otherwise = "no limits"}),
};

// One sensor may be the median at nearly every instant: zeros are written too.
const Fields<LearntAlgorithm::Usual> kLearntUsualFields = always(Fields<LearntAlgorithm::Usual>{
    field<&LearntAlgorithm::Usual::distance>(
        "distance", {.range = kNotNegative,
                     .meaning = "RMS, of the estimates from the sensors' mean, weighted by their usual scatter"}),
    field<&LearntAlgorithm::Usual::sd>(
        "sd", {.range = kNotNegative, .meaning = "standard deviation, in the better quarter; 0: not known"}),
});

const Fields<LearntSensor::Reading> kLearntReadingFields = always(Fields<LearntSensor::Reading>{
    field<&LearntSensor::Reading::offset>("offset", {.meaning = "in units of the input"}),
    field<&LearntSensor::Reading::gain>("gain", {.meaning = "beyond one"}),
    field<&LearntSensor::Reading::usual_mean>(
        "usual_mean", {.range = kNotNegative, .meaning = "nine of ten blocks were in the mean no further from that"}),
    field<&LearntSensor::Reading::usual_rms>("usual_rms",
                                             {.range = kNotNegative, .meaning = "nor did they scatter more"}),
});

// ---- options and learnt numbers: keys that the algorithm names ----

// A map whose keys the algorithm knows, not the file.
MapReader any_keys(const MapReader& at, std::string_view key, std::vector<std::string>& names) {
  const Document& node = at.require(key);
  if (node.kind != Document::Kind::map) at.refuse(key, "expected a map");
  for (const DocumentEntry& entry : node.map) names.push_back(entry.key);
  return MapReader(node, at.file(), at.path_of(key), names);
}

void read_options(const MapReader& at, std::string_view key, LearntAlgorithm& algorithm) {
  algorithm.line = at.node().line;
  algorithm.column = at.node().column;
  if (!at.has(key)) return;
  std::vector<std::string> names;
  const MapReader numbers = any_keys(at, key, names);
  for (const std::string& name : names) algorithm.options.emplace_back(name, numbers.number(name));
}

void write_options_of(const Field& row, const LearntAlgorithm& algorithm, std::vector<Entry>& out) {
  if (algorithm.options.empty()) return;
  std::vector<Entry> below;
  for (const auto& [name, value] : algorithm.options) below.push_back({name, value});
  out.push_back(part_entry(std::string(row.key), std::move(below), Entry::Form::flow));
}

void read_learnt(const MapReader& at, std::string_view key, LearntAlgorithm& algorithm) {
  if (!at.has(key)) return;
  std::vector<std::string> names;
  const MapReader numbers = any_keys(at, key, names);
  for (const std::string& name : names) algorithm.learnt.push_back({name, numbers.numbers(name)});
}

void write_learnt(const Field& row, const LearntAlgorithm& algorithm, std::vector<Entry>& out) {
  if (algorithm.learnt.empty()) return;
  std::vector<Entry> below;
  for (const fusion::LearntNumbers& numbers : algorithm.learnt) below.push_back({numbers.name, numbers.values});
  out.push_back(part_entry(std::string(row.key), std::move(below)));
}

// A file that was cut off can still be YAML.
void read_complete(const MapReader& at, std::string_view key, LearntFusion&) {
  if (!at.flag_or(key, false)) at.refuse(key, "the file ends before its last line: it is cut off");
}
void write_complete(const Field& row, const LearntFusion&, std::vector<Entry>& out) {
  out.push_back({std::string(row.key), true});
}

// ---- what single keys cannot tell ----

// Checks of a file as a whole; each refusal names the key and its place.
class FileCheck {
 public:
  FileCheck(const MapReader& top, const LearntFusion& learnt) : top_(top), learnt_(learnt) {}

  void run() const {
    if (learnt_.preparation.to_hz > 0 &&
        !(learnt_.preparation.from_hz > 0 && learnt_.preparation.from_hz < learnt_.preparation.to_hz))
      top_.refuse("low_pass_hz", "follows a high-pass with a lower corner");
    if (learnt_.sensors.empty()) top_.refuse("sensors", "expected at least one sensor");
    if (learnt_.inputs.empty()) top_.refuse("inputs", "expected at least one input");
    for (std::size_t i = 0; i < learnt_.sensors.size(); ++i) sensor(i);
    if (!learnt_.tilt.gyroscope.empty()) tilt();
    for (std::size_t k = 0; k < learnt_.algorithms.size(); ++k) algorithm(k);
    if (!learnt_.recommended.empty() && learnt_.find(learnt_.recommended) == nullptr)
      top_.refuse("recommended", "no algorithm of this file has this label");
  }

 private:
  Refusal refusal(const char* list, std::size_t index) const {
    return input_error("E0930", top_.where(top_.list(list)[index])).about(fmt::format("{}[{}]", list, index));
  }

  void sensor(std::size_t i) const {
    const LearntSensor& s = learnt_.sensors[i];
    for (std::size_t j = 0; j < i; ++j)
      if (learnt_.sensors[j].name == s.name)
        throw refusal("sensors", i).says("two sensors have the name {}", printable(s.name, 40));
    if (s.scale == 0) throw refusal("sensors", i).says("a scale of zero leaves nothing of the samples");
    if (!tilted() && s.h.size() != learnt_.inputs.size())
      throw refusal("sensors", i)
          .says("h: expected {} weights, one per input, found {}", learnt_.inputs.size(), s.h.size());
    if (s.flicker.has_value() != s.walk.has_value() || s.gauss_markov_sigma.size() != s.gauss_markov_tau_s.size())
      throw refusal("sensors", i)
          .says("a noise model has flicker and walk, and a gauss_markov_tau_s for each gauss_markov_sigma");
    for (const auto* limits : {&s.alignment.low, &s.alignment.high})
      if (!limits->empty() && limits->size() != 1 + s.cross.size())
        throw refusal("sensors", i).says("alignment: a limit of the sensor and of each of its further axes");
    if (s.cross.size() != learnt_.sensors[0].cross.size() ||
        (!s.alignment.cross.empty() && s.alignment.cross.size() != s.cross.size()))
      throw refusal("sensors", i).says("all sensors name as many further axes, and share in as many");
  }

  bool tilted() const { return !learnt_.tilt.gyroscope.empty(); }

  void tilt() const {
    for (const std::string* name :
         {&learnt_.tilt.gyroscope, &learnt_.tilt.accelerometer_x, &learnt_.tilt.accelerometer_z})
      if (std::none_of(learnt_.sensors.begin(), learnt_.sensors.end(), [&](const auto& s) { return s.name == *name; }))
        top_.refuse("tilt", fmt::format("no sensor has the name {}", printable(*name, 40)));
  }

  void algorithm(std::size_t k) const {
    for (std::size_t j = 0; j < k; ++j)
      if (learnt_.algorithms[j].label == learnt_.algorithms[k].label)
        throw refusal("algorithms", k).says("two algorithms have this label");
  }

  const MapReader& top_;
  const LearntFusion& learnt_;
};

// ---- the keys of the file, in three parts ----

const Fields<LearntFusion> kFusionHead = {
    constant<LearntFusion>("format", std::string(kFormat)),
    constant<LearntFusion>("version", std::uint64_t{1}),
    tool_row<LearntFusion>(),
    field<&LearntFusion::name>("name", {.meaning = "of the scene"}),
    list_of<&LearntFusion::learnt_from>(
        "learnt_from", kLearntFromFields,
        {.meaning = "files it was learnt from: their path and SHA-256", .form = Entry::Form::flow}),
    field<&LearntFusion::rate_hz>("rate_hz", {.unit = "Hz",
                                              .range = kPositive,
                                              .meaning = "of the instants that were fused",
                                              .written = Written::always,
                                              .required = true}),
};

// How samples become instants.
const Fields<LearntFusion> kFusionInstants = {
    field<&LearntFusion::average_s>("average_s", {.unit = "s",
                                                  .range = kPositive,
                                                  .meaning = "an instant is the mean over this time",
                                                  .otherwise = "one sample"}),
    field<&LearntFusion::resample_hz>("resample_hz",
                                      {.unit = "Hz",
                                       .range = kPositive,
                                       .meaning = "samples are interpolated to this rate by their stamps",
                                       .otherwise = "they are not"}),
    field<&LearntFusion::preparation, &ScenePreparation::detrend>(
        "detrend", {.words = kTrends, .meaning = "subtracted from each sensor, of the whole log", .otherwise = "none"}),
    field<&LearntFusion::preparation, &ScenePreparation::from_hz>(
        "high_pass_hz", {.unit = "Hz",
                         .range = kNotNegative,
                         .meaning = "corner of a high-pass that each sensor goes through",
                         .otherwise = "no filter"}),
    field<&LearntFusion::preparation, &ScenePreparation::to_hz>(
        "low_pass_hz",
        {.unit = "Hz", .range = kNotNegative, .meaning = "corner of the low-pass behind it", .otherwise = "none"}),
    field<&LearntFusion::learning_instants>("learning_instants",
                                            {.meaning = "with a reference, before the run", .otherwise = "0"}),
    field<&LearntFusion::fault_free_s>("fault_free_s", {.unit = "s",
                                                        .range = kNotNegative,
                                                        .meaning = "time at the start in which no sensor failed",
                                                        .otherwise = "0: not known"}),
};

const Fields<LearntFusion> kFusionContent = {
    list_of<&LearntFusion::inputs>(
        "inputs", kLearntInputFields,
        {.meaning = "what is estimated: `name`, `unit`, `reference_offset`: subtracted from the reference, "
                    "`level_sd`: deviation of the level, by what the sensors' means differ, `gain_sd`: of the gain "
                    "that all share, by what their gains differ (times the distance of the input from `gain_about`)",
         .required = true,
         .form = Entry::Form::flow}),
    field<&LearntFusion::interpolation>(
        "interpolation", {.words = kInterpolations, .meaning = "of the alignment", .otherwise = "nothing is aligned"}),
    part<&LearntFusion::tilt>("tilt", kLearntTiltFields, {.meaning = "sensors of a tilt", .form = Entry::Form::flow}),
    list_of<&LearntFusion::sensors>("sensors", fusion_sensor_fields(),
                                    {.meaning = "in their order (below)", .required = true}),
    field<&LearntFusion::recommended>("recommended", {.meaning = "label of the best method", .otherwise = "none"}),
    list_of<&LearntFusion::findings>("findings", finding_fields(),
                                     {.meaning = "about the recording and its sensors when this was learnt"}),
    list_of<&LearntFusion::algorithms>("algorithms", fusion_algorithm_fields(),
                                       {.meaning = "that ran (below)", .required = true}),
    custom<LearntFusion, read_complete, write_complete>("complete", "true",
                                                        {.meaning = "the last line: a file without it is cut off"}),
};

}  // namespace

const Fields<LearntSensor>& fusion_sensor_fields() {
  static const Fields<LearntSensor> rows = {
      field<&LearntSensor::name>("name", {.meaning = "of the sensor", .required = true}),
      field<&LearntSensor::channel>("channel", {.meaning = "of the log", .required = true}),
      field<&LearntSensor::recorded_unit>("recorded_unit",
                                          {.meaning = "of the channel as recorded", .otherwise = "not known"}),
      field<&LearntSensor::unit>("unit",
                                 {.meaning = "of the samples after `scale`", .otherwise = "that of the channel"}),
      field<&LearntSensor::scale>("scale", {.meaning = "recorded samples are multiplied by it", .otherwise = "1"}),
      field<&LearntSensor::h>("h", {.meaning = "weights of the inputs in this sensor", .otherwise = "`1`"}),
      field<&LearntSensor::offset>("offset", {.meaning = "subtracted from the scaled samples", .otherwise = "0"}),
      field<&LearntSensor::noise_variance>("noise_variance",
                                           {.range = kPositive, .meaning = "of a sample, given to the algorithms"}),
      field<&LearntSensor::flicker>("flicker", {.range = kNotNegative, .meaning = "B of its noise model"}),
      field<&LearntSensor::walk>("walk", {.range = kNotNegative, .meaning = "K of its noise model"}),
      field<&LearntSensor::gauss_markov_sigma>("gauss_markov_sigma",
                                               {.meaning = "deviations of its Gauss–Markov processes"}),
      field<&LearntSensor::gauss_markov_tau_s>("gauss_markov_tau_s", {.meaning = "their times of correlation, in s"}),
      field<&LearntSensor::cross>("cross", {.meaning = "channels of the device's further axes"}),
      part<&LearntSensor::alignment>("alignment", kLearntAlignmentFields,
                                     {.meaning = "what is taken out of the sensor"}),
      field<&LearntSensor::step_noise>("step_noise",
                                       {.range = kPositive,
                                        .meaning = "deviation of its noise from sample to sample, by the "
                                                   "differences between sensors: a log that differs is warned of"}),
      field<&LearntSensor::step_noise_error>(
          "step_noise_error", {.range = kNotNegative, .meaning = "standard error of the logarithm of its square"}),
      maybe_part<&LearntSensor::reading>(
          "reading", kLearntReadingFields,
          {.meaning = "relative to the median of the sensors: a log that differs is warned of",
           .form = Entry::Form::flow}),
      field<&LearntSensor::left_out>(
          "left_out", {.meaning = "true: it had no samples, and algorithms were not given it", .otherwise = "false"}),
  };
  return rows;
}

const Fields<LearntAlgorithm>& fusion_algorithm_fields() {
  static const Fields<LearntAlgorithm> rows = {
      field<&LearntAlgorithm::label>("label",
                                     {.meaning = "as in the report", .written = Written::always, .required = true}),
      field<&LearntAlgorithm::name>("name",
                                    {.meaning = "of the algorithm", .written = Written::always, .required = true}),
      field<&LearntAlgorithm::refused>("refused", {.meaning = "why it cannot be applied", .otherwise = "it can"}),
      custom<LearntAlgorithm, read_options, write_options_of>("options", "map of numbers", {.meaning = "as used"}),
      field<&LearntAlgorithm::sd_factor>(
          "sd_factor",
          {.meaning =
               "of each input: the stated standard deviation times this covered 95 % of the errors of the replay",
           .otherwise = "not known"}),
      field<&LearntAlgorithm::sd>(
          "sd", {.meaning = "of each input, of a method that states no deviation: the RMS error of the replay",
                 .otherwise = "not known"}),
      maybe_part<&LearntAlgorithm::usual>(
          "usual", kLearntUsualFields,
          {.meaning = "while all sensors read as they usually do: what is expected where one does not",
           .form = Entry::Form::flow}),
      custom<LearntAlgorithm, read_learnt, write_learnt>("learnt", "map of lists of numbers",
                                                         {.meaning = "from the reference"}),
  };
  return rows;
}

const Fields<LearntFusion>& fusion_fields() {
  static const Fields<LearntFusion> rows = joined(joined(kFusionHead, kFusionInstants), kFusionContent);
  return rows;
}

const LearntAlgorithm* LearntFusion::find(std::string_view label) const {
  for (const LearntAlgorithm& algorithm : algorithms)
    if (algorithm.label == label) return &algorithm;
  return nullptr;
}

std::vector<std::string> LearntFusion::labels() const {
  std::vector<std::string> out;
  for (const LearntAlgorithm& algorithm : algorithms) out.push_back(algorithm.label);
  return out;
}

std::string fusion_yaml(const LearntFusion& learnt) {
  return "# What a replay learnt of an array of sensors, for `sensorchar fuse`: docs/fuse.md\n" +
         yaml_of(entries_of(fusion_fields(), learnt));
}

LearntFusion parse_fusion_file(std::string_view text, const std::string& path) {
  const Document document = parse_document(text, path);
  check_format(document, path, kFormat, 1);
  LearntFusion out;
  const MapReader top(document, path, "", keys_of(fusion_fields()));
  read_fields(fusion_fields(), top, out);
  out.file = path;
  Sha256 hash;
  hash.update(text);
  out.sha256 = hash.finish();
  FileCheck(top, out).run();
  return out;
}

LearntFusion read_fusion_file(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code ignored;  // what cannot be looked at is told when it is opened
  if (!fs::is_directory(path, ignored)) return parse_fusion_file(read_document_text(path), path);
  refuse_interrupted(path);
  const std::string inside = (fs::path(path) / "fusion.yaml").string();
  if (fs::status(inside, ignored).type() == fs::file_type::not_found)
    throw input_error("E0931", path)
        .says("the folder holds no fusion.yaml of a replay")
        .hint("sensorchar replay SCENE -o DIR writes one");
  return parse_fusion_file(read_document_text(inside), inside);
}

}  // namespace libchar
