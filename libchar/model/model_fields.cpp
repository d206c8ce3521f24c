#include "libchar/model/model_fields.hpp"

#include <fmt/format.h>

#include "libchar/core/document/coefficient_fields.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/model/detail/noise_term.hpp"

namespace libchar {
namespace {

constexpr Word kAxes[] = {{"x"}, {"y"}, {"z"}, {""}};
constexpr Word kPoint[] = {{"point"}};
constexpr Word kDensities[] = {{"one-sided"}, {"two-sided"}};
constexpr Word kSamplings[] = {
    {"per-sample", static_cast<int>(NoiseSampling::per_sample),
     "noise is made at rate_hz, then low-passed with the signal"},
    {"band-limited", static_cast<int>(NoiseSampling::band_limited),
     "continuous white noise, low-passed before sampling: aliases included"},
};
constexpr Word kStarts[] = {
    {"stationary", static_cast<int>(NoiseStart::stationary)},
    {"zero", static_cast<int>(NoiseStart::zero), "flicker starts at the first sample"},
};
constexpr Word kFlickerMethods[] = {{"recursive"}, {"rv-truncated-iir"}};

// ---- keys that are no single member ----

void read_unit(const MapReader& at, std::string_view key, SensorModel& model) { model.unit = at.text_or(key, ""); }

void write_unit(const Field& row, const SensorModel& model, std::vector<Entry>& out) {
  Entry entry{std::string(row.key), model.unit};
  if (model.unit.empty()) entry = {std::string(row.key), {}, "the log names none: U below", false, false};
  out.push_back(std::move(entry));
}

void read_output_unit(const MapReader& at, std::string_view key, Sensitivity& sensitivity) {
  sensitivity.unit = at.text_or(key, "");
}

void write_output_unit(const Field& row, const Sensitivity& sensitivity, std::vector<Entry>& out) {
  Entry entry{std::string(row.key), sensitivity.unit};
  if (sensitivity.unit.empty()) entry = {std::string(row.key), {}, "", false, false};
  out.push_back(std::move(entry));
}

void read_saturation(const MapReader& at, std::string_view key, SensorModel& model) {
  if (!at.has(key)) return;
  const auto ends = at.interval(key);
  if (!(ends.first < ends.second)) at.refuse(key, "expected [low, high] with low below high");
  model.saturation_low = ends.first;
  model.saturation_high = ends.second;
}

void write_saturation(const Field& row, const SensorModel& m, std::vector<Entry>& out) {
  if (m.saturation_low && m.saturation_high)
    out.push_back({std::string(row.key), std::vector<double>{*m.saturation_low, *m.saturation_high},
                   std::string(row.text.comment)});
}

void read_valid_tau(const MapReader& at, std::string_view key, SensorModel& model) {
  if (at.has(key)) std::tie(model.tau_min_s, model.tau_max_s) = at.interval(key);
}

void write_valid_tau(const Field& row, const SensorModel& m, std::vector<Entry>& out) {
  if (m.tau_max_s > 0)
    out.push_back({std::string(row.key), std::vector<double>{m.tau_min_s, m.tau_max_s}, std::string(row.text.comment)});
}

// In front of what the conversions said.
void read_remarks(const MapReader& at, std::string_view key, SensorModel& model) {
  if (!at.has(key)) return;
  const std::vector<std::string> read = at.texts(key);
  model.remarks.insert(model.remarks.begin(), read.begin(), read.end());
}

void write_remarks(const Field& row, const SensorModel& model, std::vector<Entry>& out) {
  if (model.remarks.empty()) return;
  Entry entry{std::string(row.key), model.remarks};
  entry.form = Entry::Form::block;
  out.push_back(std::move(entry));
}

Row<SensorModel> term_row(Term term, std::string_view meaning) {
  auto row = custom<SensorModel, read_term, write_term>(kTermNames[static_cast<std::size_t>(term)].key, "number or map",
                                                        {.meaning = meaning});
  if (term == Term::white) row.field.below = term_fields().rows;
  return row;
}

// ---- parts ----

const Fields<ScaleFactor>& scale_factor_fields() {
  static const Fields<ScaleFactor> rows = {
      field<&ScaleFactor::value>("value", {.meaning = "output per input", .otherwise = "1"}),
      field<&ScaleFactor::spread>(
          "spread", {.range = kNotNegative, .meaning = "standard deviation from device to device", .otherwise = "0"}),
      field<&ScaleFactor::tc1_per_k>("tc1_per_k", {.unit = "1/K", .meaning = "linear in ΔT"}),
      field<&ScaleFactor::tc2_per_k2>("tc2_per_k2", {.unit = "1/K²", .meaning = "square in ΔT"}),
  };
  return rows;
}

const Fields<NoiseShape>& noise_shape_fields() {
  static const Fields<NoiseShape> rows = {
      field<&NoiseShape::kind>("kind", {.meaning = "of the filter", .otherwise = "`none`"}),
      field<&NoiseShape::taps>("taps", {.meaning = "of boxcar and bartlett: samples"}),
      field<&NoiseShape::frequency_hz>("frequency_hz",
                                       {.unit = "Hz", .meaning = "of measured: where `ratio` holds, rising"}),
      field<&NoiseShape::ratio>(
          "ratio", {.meaning = "of measured: density over that of the noise terms; of the nearest frequency"}),
  };
  return rows;
}

const Fields<GaussMarkovNoise>& gauss_markov_fields() {
  static const Fields<GaussMarkovNoise> rows = {
      field<&GaussMarkovNoise::sigma>("sigma", {.unit = "U", .range = kNotNegative, .meaning = "standard deviation"}),
      field<&GaussMarkovNoise::tau_s>("tau_s", {.unit = "s", .range = kNotNegative, .meaning = "correlation time"}),
      field<&GaussMarkovNoise::sigma_ci95>("sigma_ci95", {.unit = "U", .meaning = "95 % interval of sigma"}),
      field<&GaussMarkovNoise::tau_ci95_s>(
          "tau_ci95_s", {.unit = "s", .meaning = "95 % interval of tau_s; the lower end alone: no upper end known"}),
      field<&GaussMarkovNoise::status>("status", {.otherwise = "detected"}),
  };
  return rows;
}

const Fields<Nonlinearity>& nonlinearity_fields() {
  static const Fields<Nonlinearity> rows = {
      field<&Nonlinearity::quadratic>("quadratic", {.unit = "1/U", .meaning = "c₁"}),
      field<&Nonlinearity::quadratic_tc_per_k>("quadratic_tc_per_k", {.unit = "1/K", .meaning = "of c₁"}),
      field<&Nonlinearity::cubic>("cubic", {.unit = "1/U²", .meaning = "c₂"}),
      field<&Nonlinearity::cubic_tc_per_k>("cubic_tc_per_k", {.unit = "1/K", .meaning = "of c₂"}),
  };
  return rows;
}

const Fields<Bias>& bias_fields() {
  static const Fields<Bias> rows = {
      field<&Bias::value>("value", {.unit = "U", .meaning = "at the reference temperature"}),
      field<&Bias::spread>("spread",
                           {.unit = "U", .range = kNotNegative, .meaning = "standard deviation from device to device"}),
      field<&Bias::tc1_per_k>("tc1_per_k", {.unit = "U/K", .meaning = "linear in ΔT"}),
      field<&Bias::tc2_per_k2>("tc2_per_k2", {.unit = "U/K²", .meaning = "square in ΔT"}),
      field<&Bias::tc3_per_k3>("tc3_per_k3", {.unit = "U/K³", .meaning = "cube of ΔT"}),
      field<&Bias::lag_s>(
          "lag_s",
          {.unit = "s", .range = kNotNegative, .meaning = "time constant by which ΔT lags behind the temperature"}),
  };
  return rows;
}

const Fields<Sensitivity>& sensitivity_fields() {
  static const Fields<Sensitivity> rows = {
      field<&Sensitivity::gain>("gain", {.meaning = "output unit per U", .otherwise = "1"}),
      custom<Sensitivity, read_output_unit, write_output_unit>("unit", "text",
                                                               {.meaning = "of the output", .otherwise = "U"}),
  };
  return rows;
}

const Fields<DeterministicTerm>& deterministic_fields() {
  using T = DeterministicTerm;
  static const Fields<T> rows = {
      field<&T::kind>("kind", {.meaning = "what it is", .written = Written::always}),
      field<&T::size>("size",
                      {.unit = "U",
                       .meaning = "step: after less before; warm-up: at the first sample; ramp: over the recording",
                       .written = Written::always}),
      field<&T::sd>("sd", {.unit = "U", .range = kNotNegative, .meaning = "standard deviation"}),
      field<&T::at_s>("at_s", {.unit = "s", .meaning = "step: from the first sample"}),
      field<&T::tau_s>("tau_s", {.unit = "s", .range = kNotNegative, .meaning = "warm-up: time constant"}),
      field<&T::per_s>("per_s", {.unit = "U/s", .meaning = "ramp: slope"}),
  };
  return rows;
}

// A key of another kind would say nothing.
void check_deterministic(const MapReader& at, const DeterministicTerm& term) {
  using Kind = DeterministicTerm::Kind;
  const auto only = [&](std::string_view key, Kind kind) {
    if (at.has(key) && term.kind != kind) at.refuse(key, fmt::format("is not a key of a {}", name_of(term.kind)));
    if (!at.has(key) && term.kind == kind) at.refuse("kind", fmt::format("a {} needs `{}`", name_of(kind), key));
  };
  if (!at.has("kind")) at.refuse("kind", "is missing: step, warm-up or ramp");
  only("at_s", Kind::step);
  only("tau_s", Kind::warm_up);
  only("per_s", Kind::ramp);
  if (term.kind == Kind::warm_up && !(term.tau_s > 0)) at.refuse("tau_s", "must be above 0");
}

void read_deterministic(const MapReader& at, std::string_view key, SensorModel& model) {
  if (!at.has(key)) return;
  std::size_t i = 0;
  for (const Document& element : at.list(key)) {
    const MapReader one(element, at.file(), fmt::format("{}[{}]", at.path_of(key), i++),
                        keys_of(deterministic_fields()));
    DeterministicTerm term;
    read_fields(deterministic_fields(), one, term);
    check_deterministic(one, term);
    model.deterministic.push_back(term);
  }
}

void write_deterministic(const Field& row, const SensorModel& model, std::vector<Entry>& out) {
  if (model.deterministic.empty()) return;
  std::vector<Entry> terms;
  for (const DeterministicTerm& term : model.deterministic) {
    std::vector<Entry> keys;
    for (Entry& entry : entries_of(always(deterministic_fields()), term)) {
      const bool other = (entry.key == "at_s" && term.kind != DeterministicTerm::Kind::step) ||
                         (entry.key == "tau_s" && term.kind != DeterministicTerm::Kind::warm_up) ||
                         (entry.key == "per_s" && term.kind != DeterministicTerm::Kind::ramp);
      if (!other) keys.push_back(std::move(entry));
    }
    terms.push_back(part_entry("", std::move(keys), Entry::Form::flow));
  }
  out.push_back(part_entry(std::string(row.key), std::move(terms), Entry::Form::list));
  out.back().comment = row.text.comment;
}

void read_stretch(const MapReader& at, std::string_view key, SensorModel& model) {
  if (!at.has(key)) return;
  const auto ends = at.interval(key);
  model.stretch_s = Interval{ends.first, ends.second};
}

void write_stretch(const Field& row, const SensorModel& model, std::vector<Entry>& out) {
  if (model.stretch_s)
    out.push_back({std::string(row.key), std::vector<double>{model.stretch_s->low, model.stretch_s->high}});
}

Row<SensorModel> deterministic_row() {
  auto row = custom<SensorModel, read_deterministic, write_deterministic>(
      "deterministic", "list of maps",
      {.comment = "no noise, and of this recording: simulated only when asked",
       .meaning = "steps, warm-up, ramp of the recording; simulated only with `deterministic`",
       .otherwise = "none"});
  row.field.below = deterministic_fields().rows;
  return row;
}

const Fields<SensorModel>& recording_fields() {
  static const Fields<SensorModel> rows = {
      field<&SensorModel::recording, &SensorModel::Recorded::file>("file",
                                                                   {.meaning = "name", .written = Written::always}),
      field<&SensorModel::recording, &SensorModel::Recorded::sha256>(
          "sha256", {.meaning = "of its bytes", .written = Written::always}),
      field<&SensorModel::recording, &SensorModel::Recorded::topic>("topic", {.meaning = "of a ROS bag"}),
      field<&SensorModel::duration_s>(
          "duration_s", {.unit = "s", .range = kNotNegative, .meaning = "length", .written = Written::always}),
      custom<SensorModel, read_stretch, write_stretch>(
          "stretch_s", "[low, high]",
          {.meaning = "what was used of it, in seconds after its first sample", .otherwise = "all of it"}),
  };
  return rows;
}

// What the file is, and what its samples are.
const Fields<SensorModel>& head_fields() {
  static const Fields<SensorModel> rows = {
      constant<SensorModel>("format", std::string("sensor-model"), {.meaning = "sensor-model"}),
      constant<SensorModel>("version", std::uint64_t{1}, {.meaning = "1"}),
      tool_row<SensorModel>(),
      field<&SensorModel::channel>(
          "channel", {.meaning = "name of its samples", .otherwise = "the file's name", .written = Written::always}),
      custom<SensorModel, read_unit, write_unit>("unit", "text",
                                                 {.meaning = "U, the unit of the input", .otherwise = "none"}),
      field<&SensorModel::kind>("kind", {.meaning = "gyroscope, accelerometer…", .otherwise = "said by the unit"}),
      field<&SensorModel::axis>("axis", {.words = kAxes, .meaning = "axis", .otherwise = "said by the name"}),
      field<&SensorModel::rate_hz>("rate_hz", {.unit = "Hz",
                                               .range = kNotNegative,
                                               .meaning = "sampling rate",
                                               .otherwise = "said by who simulates",
                                               .written = Written::always}),
      constant<SensorModel>(
          "sampling", std::string("point"),
          {.words = kPoint, .comment = "samples at an instant, not averages over the sampling interval"}),
      constant<SensorModel>("density", std::string("two-sided"),
                            {.words = kDensities,
                             .comment = "a data sheet's noise density is one-sided: sqrt(2) times white_noise",
                             .meaning = "side of every value per √Hz",
                             .otherwise = "needed where a value is per √Hz"}),
  };
  return rows;
}

// The noise, and how a simulation makes it.
const Fields<SensorModel>& noise_fields() {
  static const Fields<SensorModel> rows = {
      term_row(Term::white, "N; each term has these keys"),
      term_row(Term::flicker, "B"),
      term_row(Term::walk, "K"),
      term_row(Term::quantization, "Q"),
      term_row(Term::ramp, "R"),
      part<&SensorModel::gauss_markov>("gauss_markov", gauss_markov_fields(),
                                       {.comment = "first-order Gauss-Markov process next to the terms, sigma in {U}: "
                                                   "density 2 sigma^2 tau / (1 + (2 pi f tau)^2)",
                                        .meaning = "first-order Gauss–Markov process next to the terms",
                                        .otherwise = "none",
                                        .form = Entry::Form::flow}),
      field<&SensorModel::flicker_phase>(
          "flicker_phase",
          {.unit = "U·s",
           .range = kNotNegative,
           .comment = "of a clock: flicker phase noise, one-sided density 4 pi value^2 f of the frequency",
           .meaning = "of a clock: flicker phase noise",
           .otherwise = "0"}),
      field<&SensorModel::noise_sampling>(
          "noise_sampling",
          {.words = kSamplings, .meaning = "see below", .otherwise = "per-sample", .written = Written::always}),
      field<&SensorModel::noise_start>("noise_start",
                                       {.words = kStarts,
                                        .meaning = "flicker has always run, or starts with the record as published",
                                        .otherwise = "stationary"}),
      field<&SensorModel::flicker_method>("flicker_method",
                                          {.words = kFlickerMethods,
                                           .meaning = "the truncated filter of [RV app. A] is for comparison",
                                           .otherwise = "recursive"}),
      field<&SensorModel::white_hold_s>("white_hold_s",
                                        {.unit = "s",
                                         .range = kPositive,
                                         .comment = "white noise is renewed this often and held",
                                         .meaning = "white noise is renewed this often and held, as [RV 3.3] did",
                                         .otherwise = "every sample"}),
      field<&SensorModel::flicker_hold_s>("flicker_hold_s", {.unit = "s",
                                                             .range = kPositive,
                                                             .comment = "flicker is made at this step and held",
                                                             .otherwise = "every sample"}),
  };
  return rows;
}

Row<SensorModel> noise_shape_field() {
  return part<&SensorModel::noise_shape>(
      "noise_shape", noise_shape_fields(),
      {.comment = "what the sensor's filter and surroundings make of the noise: power ratio over frequency",
       .meaning = "multiplies the density of the noise, not of the signal",
       .otherwise = "none"});
}

// The way of the signal, block by block.
const Fields<SensorModel>& signal_path_fields() {
  static const Fields<SensorModel> rows = {
      part<&SensorModel::scale_factor>("scale_factor", scale_factor_fields(),
                                       {.comment = "N(value, spread) a device, times 1 + tc1 dT + tc2 dT^2",
                                        .meaning = "N(value, spread) a device × (1 + tc1 ΔT + tc2 ΔT²)",
                                        .otherwise = "1",
                                        .form = Entry::Form::flow}),
      part<&SensorModel::nonlinearity>("nonlinearity", nonlinearity_fields(),
                                       {.comment = "of the input x: quadratic (1 + tc dT) x^2 + cubic (1 + tc dT) x^3",
                                        .meaning = "c₁(1 + tc ΔT)x² + c₂(1 + tc ΔT)x³ of the raw input",
                                        .otherwise = "none",
                                        .form = Entry::Form::flow}),
      part<&SensorModel::bias>("bias", bias_fields(),
                               {.comment = "N(value, spread) a device, plus tc1 dT + tc2 dT^2 + tc3 dT^3, in {U}",
                                .meaning = "N(value, spread) a device + tc1 ΔT + tc2 ΔT² + tc3 ΔT³, in U",
                                .otherwise = "0",
                                .form = Entry::Form::flow}),
      field<&SensorModel::reference_temperature_degc>(
          "reference_temperature_degc", {.unit = "°C", .meaning = "ΔT = temperature − this", .otherwise = "25"}),
      noise_shape_field(),
      field<&SensorModel::bandwidth_hz>("bandwidth_hz", {.unit = "Hz",
                                                         .range = kPositive,
                                                         .comment = "corner of a first-order low-pass behind the noise",
                                                         .otherwise = "none"}),
      custom<SensorModel, read_saturation, write_saturation>(
          "saturation", "[low, high]",
          {.comment = "ends of the range, in {U}", .meaning = "in U, before the sensitivity", .otherwise = "none"}),
      part<&SensorModel::sensitivity>("sensitivity", sensitivity_fields(),
                                      {.comment = "output = gain times the above",
                                       .meaning = "output = gain × the above, in `unit`",
                                       .otherwise = "1",
                                       .form = Entry::Form::flow}),
      field<&SensorModel::resolution>("resolution",
                                      {.range = kPositive,
                                       .comment = "least step between two values of the output, in {output}",
                                       .meaning = "quantization step of the output",
                                       .otherwise = "none"}),
      field<&SensorModel::mean>(
          "mean", {.comment = "of the recording, in {U}; holds the true input at rest as well as the bias",
                   .meaning = "of the recording; simulations do not read it",
                   .written = Written::always}),
  };
  return rows;
}

// Where the numbers come from.
const Fields<SensorModel>& origin_fields() {
  static const Fields<SensorModel> rows = {
      field<&SensorModel::obtained>(
          "obtained",
          {.meaning = "where the numbers come from", .otherwise = "written by hand", .written = Written::always}),
      field<&SensorModel::method>("method", {.meaning = "how they were computed", .written = Written::always}),
      level<SensorModel>("recording", recording_fields(), {.meaning = "what was fitted", .written = Written::always}),
      custom<SensorModel, read_valid_tau, write_valid_tau>(
          "valid_tau_s", "[low, high]", {.comment = "averaging times, in seconds, that the recording covers reliably"}),
      deterministic_row(),
      custom<SensorModel, read_remarks, write_remarks>(
          "remarks", "list of texts", {.meaning = "conversions on reading, what was done before the fit"}),
      list_of<&SensorModel::findings>("findings", finding_fields(),
                                      {.meaning = "about the recording and the numbers, the worst first"}),
  };
  return rows;
}

}  // namespace

const Fields<SensorModel>& model_fields() {
  static const Fields<SensorModel> rows = [] {
    Fields<SensorModel> all = head_fields();
    for (const auto* part : {&noise_fields(), &signal_path_fields(), &origin_fields()}) {
      all.rows.push_back(empty_line<SensorModel>().field);
      all.rows.insert(all.rows.end(), part->rows.begin(), part->rows.end());
    }
    return all;
  }();
  return rows;
}

std::vector<Entry> model_entries(const SensorModel& m) {
  const std::string u = m.unit.empty() ? "U" : printable(m.unit);
  const std::string output = m.sensitivity.unit.empty() ? u : printable(m.sensitivity.unit);
  return entries_of(model_fields(), m, {{"U", u}, {"output", output}});
}

}  // namespace libchar
