// The rows of report.json: its writer, its reader and its schema. Keys may be added; none changes its meaning or goes.

#include <algorithm>
#include <cmath>

#include "libchar/core/document/coefficient_fields.hpp"
#include "libchar/replay/report/replay_report.hpp"
#include "libchar/replay/view/words.hpp"

namespace libchar {

// The rows of what a run looks like, of a sensor and of an algorithm.

namespace {

constexpr Word kRanWords[] = {{"ran", 1}, {"skipped", 0}};

bool same_lists(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double left, double right) {
    return left == right || (!std::isfinite(left) && !std::isfinite(right));
  });
}

// Where each stretch is one instant, smallest and largest are the same.
template <bool Plain>
bool is_plain(const Timeline& track) {
  return Plain == std::equal(track.low.begin(), track.low.end(), track.high.begin(), track.high.end(), same_lists);
}

template <auto Track>
bool is_there(const typename fields_detail::MemberOf<decltype(Track)>::Class& object) {
  return !(object.*Track).empty();
}

template <auto Track>
auto track(std::string_view key, const Fields<Timeline>& rows) {
  return part<Track>(key, rows, {.known = when<is_there<Track>>});
}

const Fields<Timeline> kTimelineFields = always(Fields<Timeline>{
    field<&Timeline::time_s>("time_s", {.meaning = "middle of each stretch of time"}),
    field<&Timeline::low>("low", {.meaning = "smallest value of each, a list a series"}),
    field<&Timeline::high>("high", {.meaning = "largest"}),
});

const Fields<ReplayReport::Stretch>& reported_run_fields() {
  using T = ReplayReport::Stretch;
  using I = InputTracks;
  static const FieldText plain{.written = Written::if_known, .known = when<is_plain<true>>},
      band{.written = Written::if_known, .known = when<is_plain<false>>};
  static const Fields<Timeline> values = {
      field<&Timeline::low>("value", plain),
      field<&Timeline::low>("low", band),
      field<&Timeline::high>("high", band),
  };
  static const Fields<Timeline> with_time =
      joined(values, always(Fields<Timeline>{field<&Timeline::time_s>("time_s")}));
  static const Fields<I> inputs = always(Fields<I>{
      track<&I::reference>("reference", values),
      track<&I::estimate>("estimate", values),
      track<&I::error>("error", values),
  });
  static const Fields<T> stretch = always(Fields<T>{
      field<&T::time_s>("time_s", {.meaning = "of all tracks that have none of their own"}),
      list_of<&T::inputs>("inputs", inputs),
      track<&T::sensor>("sensor_value", values),
      track<&T::sensor_error>("sensor_error", values),
      track<&T::deviations>("deviations", with_time),
  });
  static const Fields<T> of_close_up = always(Fields<T>{
      field<&T::label>("label"),
      field<&T::from_s>("from_s"),
      field<&T::to_s>("to_s"),
  });
  static const Fields<T> close_up = joined(stretch, of_close_up);
  static const Fields<T> of_run = always(Fields<T>{
      field_or_null<&T::method>("method"),
      field_or_null<&T::sensor_name>("sensor"),
      list_of<&T::close_ups>("close_ups", close_up),
  });
  static const Fields<T> rows = joined(stretch, of_run);
  return rows;
}

const Fields<ReplayReport::Fault>& reported_fault_fields() {
  using T = ReplayReport::Fault;
  static const Fields<T> rows = always(Fields<T>{
      field<&T::sensor>("sensor", {.required = true}),
      field<&T::kind>("kind", {.required = true}),
      field<&T::value>("value"),
      field<&T::from_s>("from_s"),
      field<&T::to_s>("to_s", {.known = when<[](const T& f) { return std::isfinite(f.to_s); }>}),
  });
  return rows;
}

}  // namespace

const Fields<ReplayReport::Fault>& ReplayReport::Fault::found_fields() {
  static const Fields<ReplayReport::Fault> rows =
      selected(reported_fault_fields(), {"sensor", "kind", "from_s", "to_s"}, Written::always);
  return rows;
}

namespace {

const Fields<FaultAnswer>& reported_answer_fields() {
  using T = FaultAnswer;
  static const Fields<T> rows = always(Fields<T>{
      field<&T::fault>("fault", {.meaning = "its place in the list of faults"}),
      field<&T::found_s>("found_after_s"),
      field<&T::returned_s>("returned_after_s"),
  });
  return rows;
}

const Fields<ErrorScore> kErrorFields = always(Fields<ErrorScore>{
    field<&ErrorScore::rmse>("rmse", {.range = kNotNegative}),
    field<&ErrorScore::rmse_ci95>("rmse_ci95"),
    field<&ErrorScore::bias>("bias"),
    field<&ErrorScore::bias_ci95>("bias_ci95"),
    field<&ErrorScore::deviation>("deviation"),
    field<&ErrorScore::maximum>("maximum"),
    field<&ErrorScore::availability>("availability"),
    field<&ErrorScore::samples>("samples"),
    field<&ErrorScore::stationary>("stationary"),
    field<&ErrorScore::converged_s>("converged_s"),
});

const Fields<SensorResult>& reported_sensor_fields() {
  using T = SensorResult;
  static const Fields<ErrorScore> own = [] {
    Fields<ErrorScore> kept = kErrorFields;
    std::erase_if(kept.rows, [](const Field& row) { return row.key == "availability" || row.key == "converged_s"; });
    return kept;
  }();
  static const Fields<T> rows = always(Fields<T>{
      field<&T::name>("name", {.required = true}),
      field<&T::unit>("unit"),
      beside<&T::error>(own),
      field<&T::missing>("missing"),
      field<&T::constant>("constant"),
      field<&T::copy_of>("copy_of", {.written = Written::when_set}),
      field<&T::offset>("offset"),
      field<&T::noise_variance>("noise_variance", {.range = kNotNegative}),
      field_or_null<&T::noise_source>("noise_source"),
      field<&T::h>("h", {.required = true}),
  });
  return rows;
}

// ---- an algorithm ----

const Fields<AllanPoint> kScorePoints = always(Fields<AllanPoint>{
    field<&AllanPoint::tau_s>("tau_s"),
    field<&AllanPoint::deviation>("deviation"),
});
const Fields<AllanCurve> kScoreAllan = always(Fields<AllanCurve>{
    computed<[](const AllanCurve& curve) { return name_of(curve.type); }>("type"),
    columns_of<&AllanCurve::points>("", kScorePoints),
});
const auto kScoreHasAllan = when<[](const InputScore& score) { return !score.allan.points.empty(); }>;
const Fields<InputScore> kScoreFields = always(Fields<InputScore>{
    field<&InputScore::name>("name"),
    field<&InputScore::unit>("unit"),
    beside<&InputScore::error>(kErrorFields),
    field<&InputScore::optimum_ratio>("optimum_ratio"),
    part<&InputScore::allan>("allan", kScoreAllan, {.known = kScoreHasAllan}),
    track<&InputScore::window_rms>("window_rms", kTimelineFields),
});

const Fields<BlindScore> kBlindFields = always(Fields<BlindScore>{
    field<&BlindScore::share>("share"),
    field<&BlindScore::leave_one_out_rms>("leave_one_out_rms", {.range = kNotNegative}),
    field<&BlindScore::leave_one_out_ci95>("leave_one_out_ci95"),
    field<&BlindScore::leave_one_out>("leave_one_out"),
    field<&BlindScore::predictive_rms>("predictive_rms", {.range = kNotNegative}),
    field<&BlindScore::predictive_ci95>("predictive_ci95"),
    field<&BlindScore::offset_share>("offset_share"),
    field<&BlindScore::split_rms>("split_array_rms"),
});

// One input: a flat list; several: a row a sensor.
void write_weights(const Field& row, const AlgorithmResult& algorithm, std::vector<Entry>& out) {
  const std::vector<std::vector<double>>& weights = algorithm.weights;
  Entry entry{std::string(row.key)};
  if (weights.size() == 1) entry.value = weights[0];
  if (weights.size() > 1) entry.form = Entry::Form::list;
  for (std::size_t i = 0; weights.size() > 1 && i < weights[0].size(); ++i) {
    std::vector<double> of_sensor;
    for (const std::vector<double>& of_input : weights) of_sensor.push_back(of_input[i]);
    entry.below.push_back({"", std::move(of_sensor)});
  }
  out.push_back(std::move(entry));
}

void read_weights(const MapReader& at, std::string_view key, AlgorithmResult& algorithm) {
  if (!at.has(key)) return;
  const std::vector<Document>& list = at.list(key);
  if (list.empty() || list[0].kind != Document::Kind::list) {
    algorithm.weights = {at.numbers(key)};
    return;
  }
  algorithm.weights.assign(list[0].list.size(), {});
  for (const Document& one : list) {
    const std::vector<double> of_sensor = at.numbers_in(key, one);
    for (std::size_t j = 0; j < std::min(of_sensor.size(), algorithm.weights.size()); ++j)
      algorithm.weights[j].push_back(of_sensor[j]);
  }
}

void write_options_used(const Field& row, const ReplayReport::Algorithm& a, std::vector<Entry>& out) {
  Entry options = part_entry(std::string(row.key), {});
  for (const auto& [name, value] : a.options) options.below.push_back({name, value});
  out.push_back(std::move(options));
}

void read_options_used(const MapReader& at, std::string_view key, ReplayReport::Algorithm& a) {
  if (!at.has(key)) return;
  const MapReader options = at.map(key);
  for (const DocumentEntry& entry : options.node().map)
    a.options.emplace_back(entry.key, options.number_or(entry.key, kNone));
}

}  // namespace

const Fields<ReplayReport::Algorithm>& ReplayReport::Algorithm::fields() {
  using T = ReplayReport::Algorithm;
  static const auto kWatches = when<[](const T& a) { return a.watches_faults; }>;
  static const auto kHandsOver = when<[](const T& a) { return !a.leads.empty(); }>;
  using L = T::Lead;
  static const Fields<L> kLeadFields = always(Fields<L>{
      field<&L::lead>("lead", {.meaning = "network, retrained, past"}),
      field<&L::from_s>("from_s"),
      field<&L::to_s>("to_s"),
      field<&L::ended>("ended",
                       {.meaning = "why: missing, outside, apart, inconsistent, no_gain; right: another network led"}),
  });
  static const Fields<T> description = always(Fields<T>{
      field<&T::title>("title"),
      field<&T::source>("source"),
      field<&T::needs>("needs"),
      field<&T::learns>("learns_from_reference"),
      field<&T::accepts_missing>("accepts_missing"),
      field<&T::complexity>("complexity"),
      field<&T::learning_complexity>("learning_complexity"),
  });
  static const Fields<T> front = always(Fields<T>{
      field<&T::on_time_front>("time"),
      field<&T::on_memory_front>("memory"),
  });
  static const Fields<T> rows = always(Fields<T>{
      field<&T::name>("name", {.required = true}),
      field<&T::label>("label"),
      field<&T::ran>("status", {.words = kRanWords, .required = true}),
      field_or_null<&T::why>("why"),
      field<&T::bound>("bound", {.meaning = "it looked at the reference of the run itself"}),
      field<&T::rmse>("rmse", {.range = kNotNegative}),
      field<&T::rmse_ci95>("rmse_ci95"),
      field<&T::regret>("regret"),
      field<&T::as_good_as_best>("as_good_as_best"),
      field<&T::ratio_to_best>("ratio_to_best_ci95"),
      field<&T::availability>("availability"),
      field<&T::ns_per_sample>("ns_per_sample", {.range = kNotNegative}),
      field<&T::learning_s>("learning_s"),
      field<&T::peak_bytes>("peak_bytes"),
      custom<AlgorithmResult, read_weights, write_weights>(
          "weights", "", {.meaning = "at the end, one per sensor; of several inputs one list per sensor"}),
      field_or_null<&T::variances>("variances"),
      list_of<&T::found>("faults", ReplayReport::Fault::found_fields()),
      field<&T::faults_not_kept>("faults_not_kept"),
      field<&T::watches_faults>("watches_faults"),
      list_of<&T::leads>("leads", kLeadFields, {.known = kHandsOver}),
      field<&T::hand_overs>("hand_overs", {.known = kHandsOver}),
      list_of<&T::answers>("answers", reported_answer_fields(), {.known = kWatches}),
      field<&T::out_share>("out_share", {.known = kWatches}),
      field<&T::weight_distance>("weight_distance"),
      field<&T::variance_error>("variance_error"),
      list_of<&T::inputs>("inputs", kScoreFields),
      maybe_part<&T::blind>("without_reference", kBlindFields),
      track<&T::weight_track>("weight_track", kTimelineFields),
      track<&T::variance_track>("variance_track", kTimelineFields),
      computed_list<[](const T& a) { return a.remarks.list(); }>("remarks", finding_fields()),
      custom<T, read_options_used, write_options_used>("options", "map of numbers"),
      level<T>("description", description),
      level<T>("on_front", front),
  });
  return rows;
}

namespace {

constexpr Word kInterpolationWords[] = {{"sinc", 0}, {"cubic", 1}};

const Fields<TimeWindow> kWindowFields = always(Fields<TimeWindow>{
    field<&TimeWindow::from_s>("from_s"),
    field<&TimeWindow::to_s>("to_s", {.known = when<[](const TimeWindow& w) { return std::isfinite(w.to_s); }>}),
});

// ---- alignment ----

// A key for each part of an error.
void write_savings(const Field& row, const ReplayReport::Alignment& a, std::vector<Entry>& out) {
  Entry savings = part_entry(std::string(row.key), {});
  for (std::size_t p = 0; p < a.budget.savings.size(); ++p)
    savings.below.push_back({std::string(name_of(static_cast<fusion::ErrorPart>(p))), a.budget.savings[p]});
  out.push_back(std::move(savings));
}

void write_parts(const Field& row, const ReplayReport::Sensor& channel, std::vector<Entry>& out) {
  Entry parts = part_entry(std::string(row.key), {});
  for (std::size_t p = 0; p < channel.budget.parts.size(); ++p) {
    const fusion::PartShare& part = channel.budget.parts[p];
    parts.below.push_back(part_entry(std::string(name_of(static_cast<fusion::ErrorPart>(p))),
                                     {{"share", part.share}, {"share_ci95", part.ci95}, {"saving", part.saving}}));
  }
  out.push_back(std::move(parts));
}

const Fields<ReplayReport::Term> kChannelTerm = always(Fields<ReplayReport::Term>{
    field<&ReplayReport::Term::value>("value"),
    field<&ReplayReport::Term::standard_error>("standard_error"),
});
const Fields<ReplayReport::Sensor> kChannelFields = always(Fields<ReplayReport::Sensor>{
    field<&ReplayReport::Sensor::sensor>("sensor"),
    field<&ReplayReport::Sensor::aligned>("aligned"),
    part<&ReplayReport::Sensor::delay_s>("delay_s", kChannelTerm),
    part<&ReplayReport::Sensor::bias>("bias", kChannelTerm),
    part<&ReplayReport::Sensor::gain>("gain", kChannelTerm),
    list_of<&ReplayReport::Sensor::cross>("cross", kChannelTerm),
    field<&ReplayReport::Sensor::limits, &fusion::ChannelLimits::low>("low_limit"),
    field<&ReplayReport::Sensor::limits, &fusion::ChannelLimits::high>("high_limit"),
});

const Fields<ReplayReport::Sensor> kAlignmentBudgeted = always(Fields<ReplayReport::Sensor>{
    field<&ReplayReport::Sensor::sensor>("sensor"),
    field<&ReplayReport::Sensor::budget, &fusion::ChannelBudget::rms>("rms"),
    written<ReplayReport::Sensor, write_parts>(
        "parts", "map", {.meaning = "of each part: its share and what would be saved without it"}),
});
const Fields<ReplayReport::Alignment> kAlignmentBudget = always(Fields<ReplayReport::Alignment>{
    computed<[](const ReplayReport::Alignment& a) { return a.budget.instants; }>("instants"),
    field<&ReplayReport::Alignment::budget, &fusion::ErrorBudget::before>("rms_as_recorded"),
    field<&ReplayReport::Alignment::budget, &fusion::ErrorBudget::after>("rms_aligned"),
    written<ReplayReport::Alignment, write_savings>("savings", "map of numbers"),
    list_of<&ReplayReport::Alignment::budgeted_sensors>("sensors", kAlignmentBudgeted),
});
const Fields<AlignmentResult::Trial> kTrialFields = always(Fields<AlignmentResult::Trial>{
    field<&AlignmentResult::Trial::term>("term", {.meaning = "that was tried; empty: as recorded"}),
    field<&AlignmentResult::Trial::rmse>("rmse", {.meaning = "of weights learnt on the other half"}),
    field<&AlignmentResult::Trial::of_mean>("rmse_of_mean"),
    field<&AlignmentResult::Trial::kept>("kept"),
});
const Fields<ReplayReport::Alignment> kAlignmentFields = always(Fields<ReplayReport::Alignment>{
    beside<&ReplayReport::Alignment::window>(kWindowFields),
    computed<[](const ReplayReport::Alignment& a) { return a.learnt.instants; }>("instants"),
    field<&ReplayReport::Alignment::by_reference>("taught", {.meaning = "by the reference; else by the sensors' mean"}),
    field<&ReplayReport::Alignment::applied>("applied"),
    field<&ReplayReport::Alignment::overlaps>("judged_where_learnt"),
    field<&ReplayReport::Alignment::learnt, &fusion::Alignment::interpolation>("interpolation",
                                                                               {.words = kInterpolationWords}),
    list_of<&ReplayReport::Alignment::trials>("trials", kTrialFields),
    field<&ReplayReport::Alignment::learnt, &fusion::Alignment::notes>("notes"),
    list_of<&ReplayReport::Alignment::sensors>("sensors", kChannelFields),
    level<ReplayReport::Alignment>("budget", kAlignmentBudget),
});

// ---- the document ----

const FieldText kSceneOfSimulation{.written = Written::if_known,
                                   .known = when<[](const ReplayReport::SceneOf& scene) { return scene.simulated; }>};
const Fields<ReplayReport::SceneOf> kSceneFields = always(Fields<ReplayReport::SceneOf>{
    field<&ReplayReport::SceneOf::name>("name"),
    field<&ReplayReport::SceneOf::file>("file"),
    field<&ReplayReport::SceneOf::simulated>("simulated"),
    field<&ReplayReport::SceneOf::seed>("seed", kSceneOfSimulation),
    field<&ReplayReport::SceneOf::identity>("identity", kSceneOfSimulation),
});

const FieldText kReferenceOfEstimate{
    .written = Written::if_known,
    .known = when<[](const ReplayReport::Reference& reference) { return reference.offset_estimated; }>};
const Fields<ReplayReport::Reference> kReferenceFields = always(Fields<ReplayReport::Reference>{
    field<&ReplayReport::Reference::use>("use", {.required = true}),
    field<&ReplayReport::Reference::channels>("channels"),
    field<&ReplayReport::Reference::mean>("mean"),
    field<&ReplayReport::Reference::lag_s>("lag_s", {.meaning = "the sensors are so late"}),
    field<&ReplayReport::Reference::lag_estimated>("lag_estimated"),
    field<&ReplayReport::Reference::offset>("offset", {.meaning = "offset of the reference relative to the sensors"}),
    field<&ReplayReport::Reference::offset_estimated>("offset_estimated"),
    field<&ReplayReport::Reference::offset_ci95>("offset_ci95", kReferenceOfEstimate),
    part<&ReplayReport::Reference::offset_window>("offset_window", kWindowFields, kReferenceOfEstimate),
    field<&ReplayReport::Reference::offset_drifts>("offset_drifts", kReferenceOfEstimate),
});

const auto kPreparationFilters = when<[](const ScenePreparation& p) { return p.filters(); }>;
const Fields<ScenePreparation> kPreparationFields = always(Fields<ScenePreparation>{
    field<&ScenePreparation::detrend>("detrend"),
    field<&ScenePreparation::from_hz>("high_pass_hz", {.known = kPreparationFilters}),
    field<&ScenePreparation::to_hz>("low_pass_hz",
                                    {.known = when<[](const ScenePreparation& p) { return 0 < p.to_hz; }>}),
    computed<[](const ScenePreparation&) { return std::uint64_t{2}; }>("order", {.known = kPreparationFilters}),
    computed<settling_s>("settling_s"),
});

}  // namespace

const Fields<ReplayReport>& ReplayReport::fields() {
  using T = ReplayReport;
  static const Fields<InputResult> inputs = always(Fields<InputResult>{
      field<&InputResult::name>("name", {.required = true}),
      field<&InputResult::unit>("unit"),
      field<&InputResult::optimum_rmse>("optimum_rmse"),
  });
  static const Fields<DetectionAt> detection = always(Fields<DetectionAt>{
      field<&DetectionAt::false_alarm_s>("false_alarm_s"),
      list_of<&DetectionAt::answers>("answers", reported_answer_fields()),
      field<&DetectionAt::alarms_without_fault>("alarms_without_fault"),
  });
  static const Fields<RunMark> marks = always(Fields<RunMark>{
      field<&RunMark::kind>("kind"),
      field<&RunMark::label>("label"),
      field_or_null<&RunMark::sensor>("sensor"),
      field<&RunMark::from_s>("from_s"),
      field<&RunMark::to_s>("to_s"),
  });
  static const auto kPrepared =
      when<[](const T& report) { return report.preparation.filters() || report.preparation.detrend != "none"; }>;
  static const Fields<T> rows = always(Fields<T>{
      part<&T::scene>("scene", kSceneFields, {.required = true}),
      field<&T::verdict>("verdict"),
      field<&T::verdict_with_costs>("verdict_with_costs"),
      field<&T::plan>("plan"),
      field<&T::rate_hz>("rate_hz", {.range = kPositive, .required = true}),
      field<&T::instants>("instants", {.required = true}),
      field<&T::start_s>("start_s"),
      field<&T::scored_from_s>("scored_from_s"),
      maybe_part<&T::learning>("learning", kWindowFields),
      part<&T::evaluation>("evaluation", kWindowFields, {.required = true}),
      field<&T::window_s>("window_s"),
      maybe_part<&T::reference>("reference", kReferenceFields),
      computed<[](const T& r) { return r.reference ? "rmse" : "predictive_rms"; }>("score"),
      computed<[](const T& r) { return r.inputs.empty() ? kNone : r.inputs[0].optimum_rmse; }>("optimum_rmse"),
      list_of<&T::inputs>("inputs", inputs, {.required = true}),
      list_of<&T::sensors>("sensors", reported_sensor_fields(), {.required = true}),
      part<&T::preparation>("preparation", kPreparationFields, {.known = kPrepared}),
      maybe_part<&T::alignment>("alignment", kAlignmentFields, {.written = Written::when_set}),
      list_of<&T::faults>("faults", reported_fault_fields()),
      list_of<&T::detection>("detection", detection),
      field_or_null<&T::best>("best"),
      field_or_null<&T::best_fusion>("best_fusion"),
      field_or_null<&T::best_sensor>("best_sensor"),
      field<&T::best_over_sensor>("best_over_sensor_ci95"),
      field<&T::level_sd>("level_sd"),
      field<&T::gain_sd>("gain_sd"),
      field<&T::gain_about>("gain_about"),
      field<&T::offsets_decide>("offsets_decide"),
      field<&T::chosen_as_robust>("chosen_as_robust"),
      field<&T::ranked>("ranked"),
      list_of<&T::marks>("marks", marks),
      maybe_part<&T::run>("run", reported_run_fields()),
      list_of<&T::algorithms>("algorithms", ReplayReport::Algorithm::fields(), {.required = true}),
  });
  return rows;
}

}  // namespace libchar
