#include "libchar/fit/fit_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "libchar/core/document/coefficient_fields.hpp"
#include "libchar/core/units.hpp"
#include "libchar/fit/curve/power_laws.hpp"

namespace libchar {
namespace {

using ForTerms = std::make_index_sequence<kTerms>;

// "{white_noise}": its unit.
template <std::size_t I>
Row<NoiseFit> term_row() {
  const Fields<Coefficient>& all = coefficient_fields();
  Fields<Coefficient> rows = selected(all, {"value", "ci95", "status", "upper95"}, Written::always);
  rows = joined(rows, {constant<Coefficient>("unit", fmt::format("{{{}}}", kTermNames[I].key))});
  rows = joined(
      rows, selected(all, {"relative_sd", "ci95_by", "likelihood_ratio", "bound_relative_sd", "seconds_for_10_percent"},
                     Written::always));
  for (Field& row : rows.rows) row.text.required = row.key == "status";
  return {{kTermNames[I].key,
           [](void* fit) -> Slot { return static_cast<void*>(&static_cast<NoiseFit*>(fit)->term[I]); },
           {.written = Written::always, .required = true},
           "",
           std::move(rows.rows)}};
}

template <std::size_t... I>
Fields<NoiseFit> term_rows(std::index_sequence<I...>) {
  return {term_row<I>()...};
}

const Fields<Coefficient>& figure_fields() {
  static const Fields<Coefficient> rows = always(Fields<Coefficient>{
      field<&Coefficient::value>("value"),
      field<&Coefficient::ci95>("ci95", {.known = when<[](const Coefficient& c) { return 0 < c.ci95.high; }>}),
      field<&Coefficient::relative_sd>("relative_sd",
                                       {.known = when<[](const Coefficient& c) { return 0 < c.relative_sd; }>}),
  });
  return rows;
}

const Fields<GaussMarkovFit>& gauss_markov_fields() {
  using T = GaussMarkovFit;
  static const Fields<T> rows = always(Fields<T>{
      field<&T::sigma, &Coefficient::status>("status"),
      field<&T::in_model>("in_model", {.meaning = "false: looked for and not needed"}),
      part<&T::sigma>("sigma", figure_fields(), {.meaning = "standard deviation"}),
      constant<T>("sigma_unit", "{unit}"),
      part<&T::tau_s>("tau_s", figure_fields(), {.meaning = "correlation time"}),
      field<&T::sigma, &Coefficient::likelihood_ratio>("likelihood_ratio"),
  });
  return rows;
}

const Fields<PowerLaw>& power_law_fields() {
  static const Fields<PowerLaw> rows = always(Fields<PowerLaw>{
      field<&PowerLaw::alpha>("alpha"),
      computed<[](const PowerLaw& law) { return law.name; }>("name"),
      computed<[](const PowerLaw& law) { return law.abbreviation; }>("stable32"),
      field<&PowerLaw::h, &Coefficient::value>("h"),
      field<&PowerLaw::h, &Coefficient::ci95>(
          "ci95", {.known = when<[](const PowerLaw& law) { return law.h.value.has_value(); }>}),
      field<&PowerLaw::h, &Coefficient::upper95>("upper95"),
      field<&PowerLaw::h, &Coefficient::status>("status"),
  });
  return rows;
}

const Fields<FitBand>& band_fields() {
  static const Fields<FitBand> rows = always(Fields<FitBand>{
      field<&FitBand::top_hz>("top_hz", {.meaning = "upper end"}),
      field<&FitBand::whole>("whole", {.meaning = "every bin is inside"}),
      field<&FitBand::orders>("shape_coefficients"),
      field<&FitBand::left_out_hz>("left_out_hz", {.meaning = "below the upper end"}),
  });
  return rows;
}

const Fields<NoiseShape>& shape_fields() {
  static constexpr auto kMeasured =
      when<[](const NoiseShape& shape) { return shape.kind == NoiseShape::Kind::measured; }>;
  static const Fields<NoiseShape> rows = {
      field<&NoiseShape::kind>("kind", {.written = Written::always}),
      field<&NoiseShape::taps>("taps"),
      field<&NoiseShape::frequency_hz>("frequency_hz", {.written = Written::if_known, .known = kMeasured}),
      field<&NoiseShape::ratio>("ratio", {.written = Written::if_known, .known = kMeasured}),
  };
  return rows;
}

template <std::size_t I>
Row<SecondOpinion> opinion_row() {
  using T = SecondOpinion;
  const Fields<T> rows = {
      {{"value",
        [](void* second) -> Slot { return &static_cast<T*>(second)->value[I]; },
        {.written = Written::always},
        "number"}},
      {{"sd",
        [](void* second) -> Slot { return &static_cast<T*>(second)->sd[I]; },
        {.written = Written::always},
        "number"}},
  };
  return level<T>(
      kTermNames[I].key, rows,
      {.written = Written::if_known, .known = when<[](const T& second) { return second.value[I].has_value(); }>});
}

template <std::size_t... I>
Fields<SecondOpinion> opinion_rows(std::index_sequence<I...>) {
  return {constant<SecondOpinion>("method", "generalised least squares on the Allan variances"), opinion_row<I>()...};
}

const Fields<SecondOpinion>& second_fields() {
  using T = SecondOpinion;
  static const Fields<T> rows =
      always(joined(opinion_rows(ForTerms()), {part<&T::goodness>("goodness", goodness_fields()),
                                               field<&T::agrees>("agrees"), field<&T::sentence>("sentence")}));
  return rows;
}

const Fields<Remedy>& remedy_fields() {
  static const Fields<Remedy> rows = always(Fields<Remedy>{
      field<&Remedy::kind>("kind"),
      field<&Remedy::alarm>("alarm", {.meaning = "what asked for it"}),
      field<&Remedy::action>("action", {.meaning = "what was done"}),
      field<&Remedy::count>("count"),
  });
  return rows;
}

// An upper end of 0: the record sets none.
Interval open_above(const Interval& ends) {
  return {ends.low, ends.high > 0 ? ends.high : std::numeric_limits<double>::infinity()};
}

template <EventKind Kind>
FieldText of_kind(FieldText text = {}) {
  text.written = Written::if_known;
  text.known = when<[](const Event& event) { return event.kind == Kind; }>;
  return text;
}

std::vector<std::string> not_told_from(const Event& event) {
  std::vector<std::string> names;
  for (const EventKind kind : event.not_told_from) names.emplace_back(event_name(kind));
  return names;
}

const Fields<Event>& event_fields() {
  static const Word kKinds[] = {
      {event_name(EventKind::step), 0}, {event_name(EventKind::warm_up), 1}, {event_name(EventKind::ramp), 2}};
  static const Fields<Event> rows = always(Fields<Event>{
      field<&Event::kind>("kind", {.words = kKinds}),
      field<&Event::size>("size"),
      field<&Event::sd>("sd", {.meaning = "of the size"}),
      field<&Event::score>("score"),
      field<&Event::threshold>("threshold"),
      field<&Event::at_s>("at_s", of_kind<EventKind::step>()),
      field<&Event::at_ci95>("at_ci95", of_kind<EventKind::step>()),
      field<&Event::in_gap>("in_gap", of_kind<EventKind::step>()),
      field<&Event::tau_s>("tau_s", of_kind<EventKind::warm_up>()),
      computed<[](const Event& event) { return open_above(event.tau_ci95); }>("tau_ci95",
                                                                              of_kind<EventKind::warm_up>()),
      field<&Event::slope>("slope_per_s", of_kind<EventKind::ramp>()),
      computed<not_told_from>("not_told_from", {.meaning = "kinds that explain the record nearly as well"}),
  });
  return rows;
}

const Fields<Event>& cycle_fields() {
  static const Fields<Event> rows =
      always(Fields<Event>{field<&Event::period_s>("period_s"), field<&Event::size>("amplitude"),
                           field<&Event::phase>("phase_rad", {.meaning = "amplitude cos(2 pi t/period - phase)"})});
  return rows;
}

template <std::size_t I>
Row<TemperatureEffect> without_row() {
  using T = TemperatureEffect;
  Fields<Coefficient> rows = selected(coefficient_fields(), {"value", "ci95", "upper95", "status"}, Written::always);
  const auto fitted = [](const T& effect) { return effect.without[I].status != Status::not_fitted; };
  return {{kTermNames[I].key,
           [](void* effect) -> Slot { return static_cast<void*>(&static_cast<T*>(effect)->without[I]); },
           {.written = Written::if_known, .known = when<fitted>},
           "",
           std::move(rows.rows)}};
}

template <std::size_t... I>
Fields<TemperatureEffect> without_rows(std::index_sequence<I...>) {
  return {without_row<I>()...};
}

FieldText if_moved(std::string_view meaning = "") {
  return {.meaning = meaning,
          .written = Written::if_known,
          .known = when<[](const TemperatureEffect& effect) { return 0 < effect.order; }>};
}

std::vector<double> coefficients_of(const TemperatureEffect& effect) {
  return {effect.coefficient.begin(), effect.coefficient.begin() + effect.order};
}

bool has_without(const TemperatureEffect& effect) {
  return effect.order > 0 && std::any_of(effect.without.begin(), effect.without.end(),
                                         [](const Coefficient& c) { return c.status != Status::not_fitted; });
}

const Fields<TemperatureEffect>& temperature_fields() {
  using T = TemperatureEffect;
  static const Fields<T> rows = always(Fields<T>{
      field<&T::channel>("channel", {.meaning = "of the temperature"}),
      field<&T::unit>("unit"),
      field<&T::order>("order", {.meaning = "of the polynomial; 0: not significant"}),
      field<&T::p>("p"),
      field<&T::mean>("mean", {.meaning = "of the temperature"}),
      field<&T::range>("range", {.meaning = "of the temperature"}),
      computed<coefficients_of>("coefficients", if_moved()),
      field<&T::ci95>("ci95", if_moved("of the first coefficient")),
      field<&T::lag_s>("lag_s", if_moved()),
      computed<[](const T& effect) { return open_above(effect.lag_ci95); }>("lag_ci95", if_moved()),
      field<&T::gain>("likelihood_ratio", if_moved()),
      field<&T::rms>("rms", if_moved("of what was taken out")),
      field<&T::like_drift>("like_drift", if_moved("a drift or a warm-up explains the record nearly as well")),
      level<T>("without", without_rows(ForTerms()),
               {.meaning = "of the noise when temperature is left in",
                .written = Written::if_known,
                .known = when<has_without>}),
  });
  return rows;
}

const Fields<StretchSpread>& spread_fields() {
  using T = StretchSpread;
  static const Fields<T> rows = always(Fields<T>{
      field<&T::tau_s>("tau_s"),
      field<&T::stretches>("stretches"),
      field<&T::relative_sd>("relative_sd"),
      field<&T::p>("p"),
  });
  return rows;
}

const Fields<Stationarity>& stationarity_fields() {
  using T = Stationarity;
  const FieldText unsteady = {.written = Written::if_known,
                              .known = when<[](const T& found) { return !found.steady; }>};
  static const Fields<T> rows = always(Fields<T>{
      field<&T::steady>("steady"),
      list_of<&T::spread>("spread", spread_fields()),
      field<&T::clearest_tau_s>("clearest_tau_s", unsteady),
      field<&T::stretch_s>("stretch_s", unsteady),
      level<T>("largest", always(Fields<T>{field<&T::largest>("ratio"), field<&T::largest_s>("from_to_s")}), unsteady),
      level<T>("smallest", always(Fields<T>{field<&T::smallest>("ratio"), field<&T::smallest_s>("from_to_s")}),
               unsteady),
  });
  return rows;
}

// In columns: five lists take a third of the bytes of as many objects.
const Fields<FitResidual>& residual_fields() {
  using T = FitResidual;
  static const Fields<T> rows = always(Fields<T>{
      field<&T::frequency_hz>("frequency_hz"),
      field<&T::measured>("measured"),
      field<&T::model>("model"),
      field<&T::dof>("dof"),
      field<&T::z>("z"),
      field<&T::inside>("inside", {.meaning = "of the band that is fitted"}),
  });
  return rows;
}

bool is_clock(const NoiseFit& fit) { return fit.flicker_phase.has_value(); }

}  // namespace

const Fields<NoiseFit>& noise_fit_fields() {
  using T = NoiseFit;
  auto goodness = part<&T::goodness>("goodness", goodness_fields());
  goodness.field.optional = true;  // null where nothing could be fitted
  static const Fields<T> rows = always(joined(
      term_rows(ForTerms()),
      {part<&T::band>("band", band_fields()),
       part<&T::shape>("shape", shape_fields()),
       field<&T::bandwidth_hz>("bandwidth_hz", {.meaning = "corner of a first-order low-pass"}),
       field<&T::bandwidth_ci95>("bandwidth_ci95"),
       maybe_part<&T::gauss_markov>("gauss_markov", gauss_markov_fields()),
       computed_list<power_laws>("power_laws", power_law_fields(),
                                 {.meaning = "of a clock", .written = Written::if_known, .known = when<is_clock>}),
       maybe_part<&T::second_opinion>("second_opinion", second_fields()),
       goodness,
       list_of<&T::remedies>("remedies", remedy_fields()),
       list_of<&T::events>("events", event_fields()),
       list_of<&T::cycles>("cycles", cycle_fields(),
                           {.meaning = "slow ones of the surroundings, no part of the model"}),
       field<&T::moving_s>("moving_s"),
       maybe_part<&T::temperature>("temperature", temperature_fields()),
       part<&T::stationarity>("stationarity", stationarity_fields(),
                              {.known = when<[](const T& fit) { return fit.stationarity.tested; }>}),
       list_of<&T::findings>("findings", finding_fields()),
       field<&T::search, &T::Search::method>("method"),
       field<&T::search, &T::Search::converged>("converged"),
       field<&T::search, &T::Search::iterations>("iterations"),
       field<&T::rate_hz>("rate_hz", {.range = kPositive, .required = true}),
       field<&T::duration_s>("duration_s", {.range = kPositive, .required = true}),
       field<&T::samples>("samples")}));
  return rows;
}

const Fields<NoiseFit>& fit_residual_fields() {
  static const Fields<NoiseFit> rows = {columns_of<&NoiseFit::residuals>("residuals", residual_fields())};
  return rows;
}

Json noise_fit_json(const std::string& name, const std::string& unit, const NoiseFit& fit, bool with_residuals) {
  Substitutions units = {{"unit", unit}};
  for (const TermName& term : kTermNames) units.emplace_back(term.key, term_unit(term.key, unit));
  std::vector<Entry> entries = {{"name", name}, {"unit", unit}};
  std::ranges::move(entries_of(noise_fit_fields(), fit, units), std::back_inserter(entries));
  if (with_residuals) std::ranges::move(entries_of(always(fit_residual_fields()), fit), std::back_inserter(entries));
  return json_of(entries);
}

Json no_fit_json(const std::string& name, const std::string& unit, const std::vector<Finding>& why) {
  NoiseFit none;
  none.findings = why;
  Json json = noise_fit_json(name, unit, none);
  json["goodness"] = nullptr;
  return json;
}

Json noise_fit_document(Json channels) {
  return {{"format", "noise-fit"}, {"version", 1}, {"density_sides", "two"}, {"channels", std::move(channels)}};
}

}  // namespace libchar
