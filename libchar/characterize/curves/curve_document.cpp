#include "libchar/characterize/curves/curve_document.hpp"

#include "libchar/core/document/coefficient_fields.hpp"
#include "libchar/core/not_known.hpp"
#include "libchar/spectrum/spectrum_words.hpp"

namespace libchar {
namespace {

// ---- what a model predicts: rows beside those of the curve ----

bool is_predicted(const PredictedCurve& predicted) { return predicted.known; }

// Each a straight line on logarithmic axes: two points.
void write_lines(const Field& row, const PredictedCurve& predicted, std::vector<Entry>& out) {
  Entry lines = part_entry(std::string(row.key), {});
  for (const Asymptote& line : predicted.asymptotes)
    lines.below.push_back({std::string(word_of(term_words(), static_cast<int>(line.term))),
                           std::vector<Interval>{{line.x[0], line.y[0]}, {line.x[1], line.y[1]}}});
  out.push_back(std::move(lines));
}

void read_lines(const MapReader& at, std::string_view key, PredictedCurve& predicted) {
  predicted.known = at.has("model");
  if (!at.has(key)) return;
  const MapReader lines = at.map(key);
  for (std::size_t t = 0; t < kTerms; ++t) {
    if (!lines.has(kTermNames[t].key)) continue;
    Asymptote& line = predicted.asymptotes.emplace_back(Asymptote{static_cast<Term>(t), {}, {}});
    const std::vector<Document>& points = lines.list(kTermNames[t].key);
    for (std::size_t i = 0; i < 2; ++i) {
      const std::vector<double> point =
          i < points.size() ? lines.numbers_in(kTermNames[t].key, points[i]) : std::vector<double>{};
      if (points.size() != 2 || point.size() != 2) lines.refuse(kTermNames[t].key, "a line goes through two points");
      line.x[i] = point[0];
      line.y[i] = point[1];
    }
  }
}

const Fields<PredictedCurve>& predicted_fields() {
  using T = PredictedCurve;
  static const Fields<T> rows = {
      field<&T::model>("model",
                       {.meaning = "what the fit predicts", .written = Written::if_known, .known = when<is_predicted>}),
      field<&T::model_ci95>("model_ci95", {.meaning = "where that of another recording is expected"}),
      custom<T, read_lines, write_lines>("asymptotes", "",
                                         {.meaning = "of each term, between two points [x, y]",
                                          .written = Written::if_known,
                                          .known = when<is_predicted>}),
  };
  return rows;
}

PredictedCurve predicted_of(const ModelCurve* model, bool any_point) {
  PredictedCurve out;
  if (model == nullptr || !any_point) return out;
  out.known = true;
  for (const auto& value : model->values) out.model.push_back(value.value_or(kNone));
  for (const auto& ends : model->intervals) out.model_ci95.push_back(ends.value_or(Interval{kNone, kNone}));
  out.asymptotes = model->asymptotes;
  return out;
}

// ---- points ----

bool has_edf(const AllanPoint& point) { return point.edf > 0; }

const Fields<AllanPoint>& point_fields() {
  using T = AllanPoint;
  static const Fields<T> rows =
      joined(always(Fields<T>{
                 field<&T::tau_s>("tau_s"),
                 field<&T::deviation>("deviation"),
                 field<&T::ci95>("ci95", {.known = when<has_edf>}),
                 field<&T::edf>("edf", {.meaning = "degrees of freedom", .known = when<has_edf>}),
                 field<&T::terms>("terms", {.meaning = "differences averaged"}),
                 field<&T::m>("m", {.meaning = "averaging factor"}),
                 field<&T::ci68>("ci68", {.known = when<has_edf>}),
                 field<&T::reliable>("reliable", {.meaning = "5 degrees of freedom and more"}),
             }),
             {field<&T::bias>("bias", {.meaning = "by which the variance was divided"})});
  return rows;
}

const Fields<NoiseType>& noise_type_fields() {
  using T = NoiseType;
  static const Fields<T> rows = always(Fields<T>{
      field<&T::tau_s>("tau_s"),
      field<&T::alpha>("alpha"),
      field<&T::estimate>("estimate"),
      computed<[](const T& type) { return noise_type_name(type.alpha); }>("name"),
  });
  return rows;
}

const Fields<AllanOfChannel>& allan_channel_fields() {
  using T = AllanOfChannel;
  static const Fields<T> rows = {
      field<&T::name>("name", {.written = Written::always}),
      field<&T::unit>("unit", {.written = Written::always}),
      field<&T::value_unit>("value_unit", {.meaning = "of the deviation, where it is not that of the channel"}),
      columns_of<&T::curve, &AllanCurve::points>("", point_fields()),
      beside<&T::predicted>(predicted_fields()),
      field<&T::curve, &AllanCurve::dt_s>("dt_s", {.written = Written::always}),
      field<&T::curve, &AllanCurve::samples>("samples", {.written = Written::always}),
      field<&T::curve, &AllanCurve::missing>("missing", {.written = Written::always}),
      field<&T::curve, &AllanCurve::stride_divisor>("stride_divisor", {.written = Written::always}),
      field<&T::curve, &AllanCurve::notes>("notes", {.written = Written::always}),
      list_of<&T::noise_types>("noise_types", noise_type_fields(), {.meaning = "of a clock"}),
      field<&T::data_sheet>("data_sheet", {.meaning = "of a sensor at its limits"}),
      field<&T::type>("type", {.meaning = "where there are several"}),
      list_of<&T::findings>("findings", finding_fields(), {.meaning = "what is known of the channel"}),
  };
  return rows;
}

}  // namespace

const Fields<AllanDocument>& allan_fields() {
  using T = AllanDocument;
  static const Fields<T> rows = {
      constant<T>("format", "allan"),
      constant<T>("version", std::uint64_t{1}),
      field<&T::type>("type", {.written = Written::always}),
      field<&T::types>("types", {.meaning = "where there are several"}),
      list_of<&T::channels>("channels", allan_channel_fields(), {.written = Written::always}),
  };
  return rows;
}

const Fields<SpectralLine>& line_fields() {
  using T = SpectralLine;
  static const Fields<T> rows = always(Fields<T>{
      field<&T::frequency_hz>("frequency_hz"),
      field<&T::amplitude>("amplitude", {.meaning = "peak, in the unit of the channel"}),
      field<&T::excess>("excess", {.meaning = "power over the floor around it"}),
      field<&T::width_hz>("width_hz"),
  });
  return rows;
}

const Fields<SpectrumOfChannel>& spectrum_channel_fields() {
  using T = SpectrumOfChannel;
  static const Fields<T> rows = always(Fields<T>{
      field<&T::name>("name"),
      field<&T::unit>("unit"),
      field<&T::spectrum, &Spectrum::frequency_hz>("frequency_hz"),
      field<&T::spectrum, &Spectrum::value>("value"),
      field<&T::spectrum, &Spectrum::dof>("dof", {.meaning = "degrees of freedom"}),
      field<&T::ci95>("ci95"),
      beside<&T::predicted>(predicted_fields()),
      field<&T::value_unit>("value_unit"),
      field<&T::spectrum, &Spectrum::window>("window"),
      field<&T::spectrum, &Spectrum::rate_hz>("rate_hz"),
      field<&T::spectrum, &Spectrum::segment>("segment", {.meaning = "samples"}),
      field<&T::spectrum, &Spectrum::segments>("segments", {.meaning = "averaged"}),
      field<&T::spectrum, &Spectrum::dropped>("dropped"),
      field<&T::spectrum, &Spectrum::enbw_hz>("enbw_hz", {.meaning = "equivalent noise bandwidth"}),
      field<&T::spectrum, &Spectrum::notes>("notes"),
      list_of<&T::lines>("lines", line_fields(),
                         {.written = Written::if_known, .known = when<[](const T& one) { return one.with_lines; }>}),
      list_of<&T::findings>("findings", finding_fields(),
                            {.meaning = "what is known of the channel",
                             .written = Written::if_known,
                             .known = when<[](const T& one) { return !one.findings.empty(); }>}),
  });
  return rows;
}

const Fields<SpectrumDocument>& spectrum_fields() {
  using T = SpectrumDocument;
  static const Fields<T> rows = always(Fields<T>{
      constant<T>("format", "spectrum"),
      constant<T>("version", std::uint64_t{1}),
      field<&T::sides>("sides"),
      field<&T::scaling>("scaling"),
      list_of<&T::channels>("channels", spectrum_channel_fields()),
  });
  return rows;
}

const Fields<DerivedNumbers>& derived_fields() {
  using T = DerivedNumbers;
  static const Fields<AllanPoint> lowest =
      always(Fields<AllanPoint>{field<&AllanPoint::deviation>("deviation"), field<&AllanPoint::tau_s>("tau_s")});
  static const Fields<ReadOff> points = always(Fields<ReadOff>{
      field<&ReadOff::term>("term", {.words = term_words()}),
      field<&ReadOff::tau_s>("tau_s"),
      field<&ReadOff::deviation>("deviation"),
      field<&ReadOff::label>("label"),
  });
  static const Fields<T> rows = {
      field<&T::per_sample_sd>("per_sample_sd", {.meaning = "of white noise alone"}),
      field<&T::noise_density_one_sided>("noise_density_one_sided"),
      maybe_part<&T::allan_minimum>("allan_minimum", lowest),
      list_of<&T::read_off_points>("read_off_points", points, {.written = Written::always}),
      field<&T::plain_from_s>("plain_from_s", {.meaning = "averaging time from which the noise terms are the curve",
                                               .written = Written::always}),
  };
  return rows;
}

namespace {

// The blocks in which samples are missing, each with how many.
void write_missing(const Field& row, const TraceOfChannel& channel, std::vector<Entry>& out) {
  Entry list = part_entry(std::string(row.key), {}, Entry::Form::list);
  const std::vector<std::uint64_t>& missing = channel.trace.missing;
  for (std::size_t i = 0; i < missing.size(); ++i)
    if (missing[i] > 0) list.below.push_back({"", std::vector<std::uint64_t>{i, missing[i]}});
  out.push_back(std::move(list));
}

}  // namespace

const Fields<TraceOfChannel>& trace_fields() {
  using T = TraceOfChannel;
  static const Fields<TraceMark> marks = always(Fields<TraceMark>{
      field<&TraceMark::kind>("kind"),
      field<&TraceMark::from_s>("from_s"),
      field<&TraceMark::to_s>("to_s"),
      field<&TraceMark::label>("label"),
  });
  static const Fields<T> own = {
      field<&T::own_rate_hz>("own_rate_hz", {.unit = "Hz", .meaning = "of a channel on a grid of its own"})};
  static const Fields<T> rows =
      joined(always(Fields<T>{
                 field<&T::name>("name"),
                 field<&T::unit>("unit"),
                 field<&T::trace, &Trace::block>("samples_per_block", {.range = kPositive}),
                 field<&T::trace, &Trace::low>("low", {.meaning = "smallest sample of each block"}),
                 field<&T::trace, &Trace::high>("high", {.meaning = "largest"}),
                 written<T, write_missing>("missing", "pairs", {.meaning = "block, missing samples"}),
                 list_of<&T::marks>("marks", marks),
             }),
             own);
  return rows;
}

const Fields<VerificationOfChannel>& verification_fields() {
  using T = VerificationOfChannel;
  using V = ChannelVerification;
  using Of = TermVerification;
  using Point = PointVerification;
  static const Fields<Of> terms = always(Fields<Of>{
      field<&Of::term>("term", {.words = term_words()}),
      field<&Of::model, &Coefficient::value>("model"),
      field<&Of::simulated, &Coefficient::value>("simulated"),
      field<&Of::agrees>("agrees"),
      field<&Of::simulated, &Coefficient::ci95>(
          "simulated_ci95", {.written = Written::if_known,
                             .known = when<[](const Of& term) { return term.simulated.value.has_value(); }>}),
  });
  static const Fields<Point> points = always(Fields<Point>{
      field<&Point::tau_s>("tau_s"),
      field<&Point::ratio>("ratio", {.meaning = "of the recording over the simulation"}),
      field<&Point::p>("p"),
      field<&Point::agrees>("agrees"),
  });
  static const Fields<T> rows = always(Fields<T>{
      field<&T::name>("name"),
      field<&T::result, &V::agrees>("agrees"),
      field<&T::result, &V::nearly>("nearly"),
      field<&T::result, &V::sentences>("sentences"),
      list_of<&T::result, &V::terms>("terms", terms),
      list_of<&T::result, &V::points>("points", points),
      part<&T::allan>("allan", allan_channel_fields(), {.meaning = "of the simulation"}),
      part<&T::spectrum>("spectrum", spectrum_channel_fields()),
  });
  return rows;
}

AllanOfChannel allan_of_channel(const Channel& channel, const AllanCurve& curve, const ModelCurve* model) {
  AllanOfChannel out;
  out.name = channel.name;
  out.unit = channel.unit;
  out.curve = curve;
  const std::string unit = deviation_unit(curve.type, channel.unit);
  if (unit != channel.unit) out.value_unit = unit;
  out.predicted = predicted_of(model, !curve.points.empty());
  return out;
}

SpectrumOfChannel spectrum_of_channel(const Channel& channel, const Spectrum& spectrum,
                                      const std::vector<std::optional<Interval>>& ci95, const ModelCurve* model) {
  SpectrumOfChannel out;
  out.name = channel.name;
  out.unit = channel.unit;
  out.value_unit = spectrum_unit(spectrum.scaling, channel.unit);
  out.spectrum = spectrum;
  out.spectrum.dof.resize(spectrum.frequency_hz.size());
  for (const auto& ends : ci95) out.ci95.push_back(ends.value_or(Interval{kNone, kNone}));
  out.predicted = predicted_of(model, !spectrum.frequency_hz.empty());
  return out;
}

namespace {

// As long as the curve, or absent.
void check_lengths(const MapReader& document, std::string_view abscissa, std::initializer_list<std::string_view> keys) {
  for (const MapReader& channel : document.maps("channels")) {
    if (!channel.has(abscissa)) continue;
    const std::size_t length = channel.list(abscissa).size();
    for (const std::string_view key : keys)
      if (channel.has(key)) channel.list(key, length);
  }
}

}  // namespace

AllanDocument read_allan(const MapReader& document) {
  AllanDocument out;
  read_fields(allan_fields(), document, out);
  check_lengths(document, "tau_s", {"model", "model_ci95", "data_sheet"});
  return out;
}

SpectrumDocument read_spectra(const MapReader& document) {
  SpectrumDocument out;
  read_fields(spectrum_fields(), document, out);
  check_lengths(document, "frequency_hz", {"value", "dof", "ci95", "model"});
  return out;
}

}  // namespace libchar
