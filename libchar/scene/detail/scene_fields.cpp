#include "libchar/scene/detail/scene_fields.hpp"

#include <fmt/format.h>

#include <tuple>

#include "libchar/log/reading_fields.hpp"
#include "libchar/scene/detail/scene_values.hpp"

namespace libchar {
namespace {

constexpr Word kInterpolations[] = {{"sinc", 0}, {"cubic", 1}};
constexpr Word kReadings[] = {
    {"instant", 0}, {"mean_before", 1}, {"mean_after", 2}, {"mean_centred", 3}, {"estimate", 4}};
constexpr Word kTeachers[] = {{"reference", 0}, {"sensors", 1}};
constexpr Word kDetrendWords[] = {{kDetrends[0], 0}, {kDetrends[1], 1}, {kDetrends[2], 2}};
constexpr Word kLowPassStarts[] = {{"steady", 0}, {"zero", 1}};

// Beside the value of a member: read and written by whoever knows the rest of the scene.
template <class T>
void read_elsewhere(const MapReader&, std::string_view, T&) {}
template <class T>
void written_elsewhere(const Field&, const T&, std::vector<Entry>&) {}

template <class T>
Row<T> elsewhere(std::string_view key, std::string_view kind, const FieldText& text) {
  return custom<T, read_elsewhere<T>, written_elsewhere<T>>(key, kind, text);
}

template <auto Window>
using HasWindow = typename fields_detail::MemberOf<decltype(Window)>::Class;

template <auto Window>
void read_window(const MapReader& at, std::string_view key, HasWindow<Window>& object) {
  object.*Window = window_of(at, key);
}
template <auto Window>
void window_written(const Field& field, const HasWindow<Window>& object, std::vector<Entry>& out) {
  write_window(field.key, object.*Window, out);
}
template <auto Window>
auto window_row(std::string_view key, const FieldText& text) {
  return custom<HasWindow<Window>, read_window<Window>, window_written<Window>>(key, "[from, to]", text);
}

void read_high_pass(const MapReader& at, std::string_view key, Scene& scene) {
  if (!at.has(key)) return;
  scene.preparation.from_hz = at.number(key, kPositive);
}
void high_pass_written(const Field& field, const Scene& scene, std::vector<Entry>& out) {
  const ScenePreparation& p = scene.preparation;
  if (p.filters() && p.to_hz == 0) out.push_back({std::string(field.key), p.from_hz});
}

void read_band(const MapReader& at, std::string_view key, Scene& scene) {
  if (!at.has(key)) return;
  std::tie(scene.preparation.from_hz, scene.preparation.to_hz) = at.interval(key);
}
void band_written(const Field& field, const Scene& scene, std::vector<Entry>& out) {
  const ScenePreparation& p = scene.preparation;
  if (p.to_hz > 0) out.push_back({std::string(field.key), std::vector<double>{p.from_hz, p.to_hz}});
}

void read_lag(const MapReader& at, std::string_view key, SceneReference& reference) {
  if (!at.has(key)) return;
  const OrEstimate said = number_or_estimate(at, key, "a number of seconds");
  reference.lag_s = said.value;
  reference.estimate_lag = said.estimate;
}
void lag_written(const Field& field, const SceneReference& reference, std::vector<Entry>& out) {
  write_or_estimate(field.key, {reference.lag_s, reference.estimate_lag}, out);
}

void read_offset(const MapReader& at, std::string_view key, SceneReference& reference) {
  if (!at.has(key)) return;
  const OrEstimate said = number_or_estimate(at, key, "a number");
  reference.offset = said.value;
  reference.estimate_offset = said.estimate;
}
void offset_written(const Field& field, const SceneReference& reference, std::vector<Entry>& out) {
  write_or_estimate(field.key, {reference.offset, reference.estimate_offset}, out);
}

Row<Scene> align_row() {
  return elsewhere<Scene>(
      "align", "map",
      {.meaning = "delays, biases, gains and misalignments are learnt and taken out before fusion (below)",
       .otherwise = "the sensors are fused as recorded"});
}

Row<Scene> warm_up_row() {
  return field<&Scene::warm_up_s>(
      "warm_up_s", {.unit = "s",
                    .range = kPositive,
                    .meaning = "time from the start of the evaluation in which algorithms run, but are not scored",
                    .otherwise = "0"});
}

Row<Scene> detrend_row() {
  return field<&Scene::preparation, &ScenePreparation::detrend>(
      "detrend", {.words = kDetrendWords,
                  .meaning = "what is subtracted from each sensor and the reference: its mean, or its line of least "
                             "squares, over the whole recording",
                  .otherwise = "none"});
}

Row<Scene> high_pass_row() {
  return custom<Scene, read_high_pass, high_pass_written>(
      "high_pass_hz", "Hz",
      {.meaning = "all sensors and the reference go through one high-pass (below)", .otherwise = "none"});
}

Row<Scene> band_row() {
  return custom<Scene, read_band, band_written>(
      "band_hz", "[low, high]",
      {.meaning = "instead: a high-pass at the first corner and a low-pass at the second", .otherwise = "none"});
}

Row<Scene> fault_free_row() {
  return field<&Scene::fault_free_s>("fault_free_s",
                                     {.unit = "s",
                                      .range = kPositive,
                                      .meaning = "time from the start of the evaluation in which no sensor fails",
                                      .otherwise = "up to the first fault that the scene knows"});
}

}  // namespace

const Fields<Scene>& scene_fields() {
  static const Fields<Scene> rows = {
      constant<Scene>("format", std::string("scene"), {.meaning = "scene"}),
      constant<Scene>("version", std::uint64_t{1}, {.meaning = "1"}),
      tool_row<Scene>(),
      field<&Scene::name>("name", {.meaning = "a title for reports", .otherwise = "none"}),
      elsewhere<Scene>("recording", "path, or a map", {.meaning = "a log, or a map that says how to read it (below)"}),
      elsewhere<Scene>("simulate", "map", {.meaning = "instead: how to make one (below)"}),
      elsewhere<Scene>("sensors", "list", {.meaning = "of 1 to 10000 sensors (below)"}),
      elsewhere<Scene>("reference", "text, list or map",
                       {.meaning = "channel with the truth, a list of them, or a map (below)",
                        .otherwise = "of a simulation all truth signals"}),
      elsewhere<Scene>("tilt", "map",
                       {.meaning = "sensors of a tilt, atan2(x, z); then the reference is the angle (below)"}),
      window_row<&Scene::learning>(
          "learning",
          {.meaning = "in seconds from the first sample; `[from, end]` up to the end", .otherwise = "none"}),
      window_row<&Scene::evaluation>(
          "evaluation", {.meaning = "what is run and scored", .otherwise = "from the end of the learning window on"}),
      window_row<&Scene::rest>(
          "rest",
          {.meaning = "the true inputs are zero there: each sensor's mean is subtracted, and its noise measured"}),
      warm_up_row(),
      detrend_row(),
      high_pass_row(),
      band_row(),
      align_row(),
      fault_free_row(),
      elsewhere<Scene>("faults", "list", {.meaning = "injected into the samples (below)"}),
      elsewhere<Scene>(
          "simulated", "map",
          {.meaning = "written by `simulate`: `{seed, oversampling, faults, simulate…}` that the recording holds "
                      "already; nothing of it is injected again, and `simulate` makes the log again from it"}),
      elsewhere<Scene>("algorithms", "list",
                       {.meaning = "names, or maps `{name: NAME, OPTION: NUMBER…}`",
                        .otherwise = "all whose needs the scene meets"}),
  };
  return rows;
}

const Fields<Scene>& scene_time_fields() {
  static const Fields<Scene> rows =
      selected(scene_fields(),
               {"learning", "evaluation", "rest", "warm_up_s", "detrend", "high_pass_hz", "band_hz", "fault_free_s"},
               Written::when_set);
  return rows;
}

const Fields<SceneSensor>& sensor_fields() {
  static const Fields<SceneSensor> rows = {
      field<&SceneSensor::name>(
          "name", {.meaning = "of the sensor; the channel's when it is left out", .written = Written::always}),
      field<&SceneSensor::channel>("channel", {.meaning = "of the recording", .otherwise = "the name"}),
      field<&SceneSensor::h>(
          "h", {.meaning = "row of the observation matrix: one weight a truth signal or reference channel",
                .otherwise = "`1`"}),
      field<&SceneSensor::scale>(
          "scale",
          {.meaning = "the recording's samples are multiplied by it on reading: a unit, or −1 for an axis turned round",
           .otherwise = "1"}),
      field<&SceneSensor::unit>("unit", {.meaning = "of the samples after `scale`",
                                         .otherwise = "the recording's, with its scale if that is not 1 or −1"}),
      field<&SceneSensor::noise>("noise", {.range = kPositive,
                                           .meaning = "standard deviation of a sample's noise",
                                           .otherwise = "said by the model, or measured"}),
      elsewhere<SceneSensor>("model", "path, or the keys of a model",
                             {.meaning = "a model file (`docs/models.md`), the keys of one, or `none`. A simulated "
                                         "sensor needs it; `none` is a perfect one"}),
      field<&SceneSensor::cross>(
          "cross",
          {.meaning =
               "channels of the same device's other axes, for the alignment; the sensors name them in one order"}),
      elsewhere<SceneSensor>("count", "whole number",
                             {.meaning = "of a simulation: number of devices of one model, called NAME1, NAME2…, each "
                                         "with its own draws and noise"}),
  };
  return rows;
}

const Fields<SceneReference>& reference_fields() {
  static const Fields<SceneReference> rows = {
      elsewhere<SceneReference>("channels", "text or list",
                                {.meaning = "one a true input; of a simulation truth signals"}),
      field<&SceneReference::mean>("mean",
                                   {.meaning = "the mean of the channels is the one true input", .otherwise = "false"}),
      elsewhere<SceneReference>(
          "recording", "path, or a map",
          {.meaning = "a log of its own, as the scene's `recording`", .otherwise = "the scene's"}),
      custom<SceneReference, read_lag, lag_written>(
          "lag_s", "s, or estimate", {.meaning = "lag of the sensors relative to the reference", .otherwise = "0"}),
      custom<SceneReference, read_lag, written_elsewhere<SceneReference>>("delay", "s, or estimate",
                                                                          {.meaning = "another word for lag_s"}),
      custom<SceneReference, read_offset, offset_written>(
          "offset", "number, or estimate",
          {.meaning = "offset of the reference relative to the sensors, in the reference's unit; it is subtracted from "
                      "the reference (below)",
           .otherwise = "0"}),
      field<&SceneReference::samples>(
          "samples",
          {.words = kReadings,
           .meaning = "what each value represents if the reference has less than half as many values as samples: the "
                      "instant of its stamp, or the mean over the interval before, after or around it",
           .otherwise = "estimate: the most likely of the four"}),
      field<&SceneReference::teach>(
          "teach", {.meaning = "false: without a learning window nothing is learnt",
                    .otherwise = "true: without windows and alignment, the first half of the recording teaches"}),
  };
  return rows;
}

const Fields<SceneAlign>& align_fields() {
  static const Fields<SceneAlign> rows = {
      elsewhere<SceneAlign>("learn", "rest, learning, run, or [from, to]",
                            {.meaning = "the stretch it is learnt on: a window of the scene, the whole evaluation, or "
                                        "seconds from the first sample",
                             .otherwise = "learning where the scene has one, else run"}),
      field<&SceneAlign::terms>(
          "terms", {.meaning = "of delay, bias, gain, misalignment", .otherwise = "all; bias only without rest"}),
      field<&SceneAlign::by>("by", {.words = kTeachers,
                                    .meaning = "who knows the truth: sensors takes their mean for it",
                                    .otherwise = "the reference, if there is one"}),
      field<&SceneAlign::interpolation>("interpolation",
                                        {.words = kInterpolations,
                                         .meaning = "sinc is within 0.01 % up to 0.37 of the rate; cubic damps what is "
                                                    "faster than 0.12 of it, aliased vibration too",
                                         .otherwise = "sinc"}),
      field<&SceneAlign::choose>("choose",
                                 {.meaning = "terms are tried one by one, each learnt on one half of the stretch and "
                                             "judged on the other, and kept where they pay; needs a reference",
                                  .otherwise = "false"}),
      field<&SceneAlign::apply>(
          "apply", {.meaning = "false: the error budget is reported, and the sensors are fused as recorded",
                    .otherwise = "true"}),
  };
  return rows;
}

const Fields<FaultText>& fault_fields() {
  static const Fields<FaultText> rows = {
      field<&FaultText::sensor>("sensor", {.meaning = "its name", .written = Written::always, .required = true}),
      field<&FaultText::kind>("kind", {.meaning = "what goes wrong", .written = Written::always, .required = true}),
      field<&FaultText::value>("value", {.meaning = "factor, offset, slope, limit or standard deviation"}),
      field<&FaultText::from_s>("from_s", {.unit = "s",
                                           .range = kNotNegative,
                                           .meaning = "first instant of the fault",
                                           .otherwise = "0",
                                           .written = Written::always}),
      field<&FaultText::to_s>(
          "to_s", {.unit = "s", .range = kPositive, .meaning = "first instant after it", .otherwise = "the end"}),
  };
  return rows;
}

const Fields<ArraySimulation>& simulation_fields() {
  static const Fields<ArraySimulation> rows = {
      field<&ArraySimulation::rate_hz>(
          "rate_hz",
          {.unit = "Hz", .range = kRates, .meaning = "sampling rate", .written = Written::always, .required = true}),
      elsewhere<ArraySimulation>("duration_s", "s", {.meaning = "length"}),
      elsewhere<ArraySimulation>("samples", "whole number", {.meaning = "length, instead"}),
      field<&ArraySimulation::seed>(
          "seed", {.meaning = "0 to 2⁶⁴ − 1; same seed, same samples", .otherwise = "1", .written = Written::always}),
      field<&ArraySimulation::oversampling>(
          "oversampling",
          {.meaning =
               "everything up to the quantization runs so many times as fast, so that aliases are in the samples",
           .otherwise = "1"}),
      elsewhere<ArraySimulation>("truth", "list of signals",
                                 {.meaning = "a signal or a list of them", .otherwise = "zero"}),
      field<&ArraySimulation::truth_bandwidth_hz>(
          "truth_bandwidth_hz",
          {.unit = "Hz",
           .range = kPositive,
           .meaning = "the truth columns are given through a first-order low-pass, as the sensors see it",
           .otherwise = "as it is"}),
      elsewhere<ArraySimulation>("temperature", "signal", {.meaning = "in °C", .otherwise = "each model's reference"}),
      field<&ArraySimulation::low_pass_starts_at_zero>(
          "low_pass_start",
          {.words = kLowPassStarts,
           .meaning = "steady: low-passes start in the steady state of the first sample; zero: as published",
           .otherwise = "steady"}),
  };
  return rows;
}

const Fields<SignalSpec>& signal_fields() {
  static const Fields<SignalSpec> rows = {
      field<&SignalSpec::offset>("offset", {.meaning = "added", .otherwise = "0"}),
      field<&SignalSpec::value>("value", {.meaning = "constant", .written = Written::always}),
      field<&SignalSpec::amplitude>("amplitude", {.meaning = "± this", .otherwise = "1"}),
      field<&SignalSpec::frequency_hz>("frequency_hz", {.unit = "Hz", .range = kNotNegative, .otherwise = "1"}),
      field<&SignalSpec::phase_rad>("phase_rad", {.unit = "rad", .otherwise = "0"}),
      field<&SignalSpec::from_hz>("from_hz",
                                  {.unit = "Hz", .range = kNotNegative, .meaning = "chirp", .otherwise = "0.01"}),
      field<&SignalSpec::to_hz>("to_hz", {.unit = "Hz", .range = kNotNegative, .meaning = "chirp", .otherwise = "1"}),
      field<&SignalSpec::standard_deviation>("standard_deviation",
                                             {.range = kNotNegative, .meaning = "noise", .otherwise = "1"}),
      field<&SignalSpec::bandwidth_hz>("bandwidth_hz",
                                       {.unit = "Hz", .range = kNotNegative, .meaning = "noise", .otherwise = "white"}),
      field<&SignalSpec::renew_s>(
          "renew_s", {.unit = "s", .range = kNotNegative, .meaning = "uniform", .otherwise = "every sample"}),
      field<&SignalSpec::repeat>(
          "repeat",
          {.range = {0, 1, false}, .meaning = "uniform: probability that the old value stays", .otherwise = "0"}),
      field<&SignalSpec::step>("step",
                               {.unit = "U/√s", .range = kNotNegative, .meaning = "random_walk", .otherwise = "1"}),
      field<&SignalSpec::slope>("slope", {.unit = "U/s", .meaning = "ramp", .written = Written::always}),
  };
  return rows;
}

std::string signal_kinds_table() {
  std::string out = "| kind | keys | signal |\n|---|---|---|\n";
  for (const SignalKind& kind : signal_kind_rows()) {
    std::string keys;
    for (const std::string& key : kind.keys) keys += fmt::format("{}`{}`", keys.empty() ? "" : ", ", key);
    out += fmt::format("| `{}` | {} | {} |\n", kind.word, keys.empty() ? "–" : keys, kind.meaning);
  }
  return out;
}

const Fields<ReadOptions>& scene_reading_fields() {
  static const Fields<ReadOptions> rows = selected(reading_fields(),
                                                   {"topic",
                                                    "time_source",
                                                    "msg",
                                                    "rate_hz",
                                                    "channel_rate",
                                                    "delimiter",
                                                    "decimal",
                                                    "header",
                                                    "encoding",
                                                    "names",
                                                    "units",
                                                    "channel_scale",
                                                    "channel_unit",
                                                    "where",
                                                    "group_by",
                                                    "date_order",
                                                    "time_column",
                                                    "time_unit",
                                                    "preset",
                                                    "skip_rows",
                                                    "format",
                                                    "from_s",
                                                    "to_s",
                                                    "missing",
                                                    "overflow_as_missing",
                                                    "drop_bad_rows",
                                                    "skip_repeated_header"},
                                                   Written::when_set);
  return rows;
}

const Fields<SimulatedFrom>& simulated_fields() {
  static const Fields<SimulatedFrom> rows = {
      field<&SimulatedFrom::seed>("seed", {.meaning = "it was simulated with", .written = Written::always}),
      field<&SimulatedFrom::oversampling>("oversampling", {.meaning = "likewise", .otherwise = "1"}),
      elsewhere<SimulatedFrom>("faults", "list", {.meaning = "that its samples hold"}),
      elsewhere<SimulatedFrom>("simulate", "map", {.meaning = "the rest of the simulation"}),
      field<&SimulatedFrom::rows>(
          "rows", {.meaning = "weights of the true inputs, sensor after sensor", .otherwise = "the sensors' h"}),
      field<&SimulatedFrom::truth_columns>("truth_columns",
                                           {.meaning = "the log has the true inputs", .otherwise = "true"}),
      field<&SimulatedFrom::deterministic>("deterministic",
                                           {.meaning = "steps, warm-ups and ramps", .otherwise = "false"}),
      field<&SimulatedFrom::command>("command", {.meaning = "for people"}),
  };
  return rows;
}

const Fields<TiltText>& tilt_fields() {
  static const Fields<TiltText> rows = always(Fields<TiltText>{
      field<&TiltText::gyroscope>("gyroscope", {.meaning = "its sensor", .required = true}),
      field<&TiltText::accelerometer_x>("accelerometer_x", {.meaning = "its sensor", .required = true}),
      field<&TiltText::accelerometer_z>("accelerometer_z", {.meaning = "its sensor", .required = true}),
  });
  return rows;
}

bool is_valueless(FaultKind kind) { return kind == FaultKind::stuck || kind == FaultKind::dropout; }

}  // namespace libchar
