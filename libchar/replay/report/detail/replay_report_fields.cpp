// The rows of report.json: its writer, its reader and its schema. Keys may be added; none changes its meaning or goes.

#include <cmath>

#include "libchar/replay/report/detail/report_rows.hpp"
#include "libchar/replay/report/replay_report.hpp"
#include "libchar/replay/view/words.hpp"

namespace libchar {
namespace {

constexpr Word kInterpolationWords[] = {{"sinc", 0}, {"cubic", 1}};

const Fields<TimeWindow> kWindowFields = always(Fields<TimeWindow>{
    field<&TimeWindow::from_s>("from_s"),
    field<&TimeWindow::to_s>(
        "to_s", {.known = when<[](const TimeWindow& w) { return std::isfinite(w.to_s); }>}),
});

// ---- alignment ----

// A key for each part of an error.
void write_savings(const Field& row, const ReplayReport::Alignment& a, std::vector<Entry>& out) {
  Entry savings = part_entry(std::string(row.key), {});
  for (std::size_t p = 0; p < a.budget.savings.size(); ++p)
    savings.below.push_back(
        {std::string(name_of(static_cast<fusion::ErrorPart>(p))), a.budget.savings[p]});
  out.push_back(std::move(savings));
}

void write_parts(const Field& row, const ReplayReport::Sensor& channel, std::vector<Entry>& out) {
  Entry parts = part_entry(std::string(row.key), {});
  for (std::size_t p = 0; p < channel.budget.parts.size(); ++p) {
    const fusion::PartShare& part = channel.budget.parts[p];
    parts.below.push_back(
        part_entry(std::string(name_of(static_cast<fusion::ErrorPart>(p))),
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
    field<&AlignmentResult::Trial::rmse>("rmse",
                                         {.meaning = "of weights learnt on the other half"}),
    field<&AlignmentResult::Trial::of_mean>("rmse_of_mean"),
    field<&AlignmentResult::Trial::kept>("kept"),
});
const Fields<ReplayReport::Alignment> kAlignmentFields = always(Fields<ReplayReport::Alignment>{
    beside<&ReplayReport::Alignment::window>(kWindowFields),
    computed<[](const ReplayReport::Alignment& a) { return a.learnt.instants; }>("instants"),
    field<&ReplayReport::Alignment::by_reference>(
        "taught", {.meaning = "by the reference; else by the sensors' mean"}),
    field<&ReplayReport::Alignment::applied>("applied"),
    field<&ReplayReport::Alignment::overlaps>("judged_where_learnt"),
    field<&ReplayReport::Alignment::learnt, &fusion::Alignment::interpolation>(
        "interpolation", {.words = kInterpolationWords}),
    list_of<&ReplayReport::Alignment::trials>("trials", kTrialFields),
    field<&ReplayReport::Alignment::learnt, &fusion::Alignment::notes>("notes"),
    list_of<&ReplayReport::Alignment::sensors>("sensors", kChannelFields),
    level<ReplayReport::Alignment>("budget", kAlignmentBudget),
});

// ---- the document ----

const FieldText kSceneOfSimulation{
    .written = Written::if_known,
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
    .known =
        when<[](const ReplayReport::Reference& reference) { return reference.offset_estimated; }>};
const Fields<ReplayReport::Reference> kReferenceFields = always(Fields<ReplayReport::Reference>{
    field<&ReplayReport::Reference::use>("use", {.required = true}),
    field<&ReplayReport::Reference::channels>("channels"),
    field<&ReplayReport::Reference::mean>("mean"),
    field<&ReplayReport::Reference::lag_s>("lag_s", {.meaning = "the sensors are so late"}),
    field<&ReplayReport::Reference::lag_estimated>("lag_estimated"),
    field<&ReplayReport::Reference::offset>(
        "offset", {.meaning = "the reference reads so much more than the sensors"}),
    field<&ReplayReport::Reference::offset_estimated>("offset_estimated"),
    field<&ReplayReport::Reference::offset_ci95>("offset_ci95", kReferenceOfEstimate),
    part<&ReplayReport::Reference::offset_window>(
        "offset_window", kWindowFields, kReferenceOfEstimate),
    field<&ReplayReport::Reference::offset_drifts>("offset_drifts", kReferenceOfEstimate),
});

const auto kPreparationFilters = when<[](const ScenePreparation& p) { return p.filters(); }>;
const Fields<ScenePreparation> kPreparationFields = always(Fields<ScenePreparation>{
    field<&ScenePreparation::detrend>("detrend"),
    field<&ScenePreparation::from_hz>("high_pass_hz", {.known = kPreparationFilters}),
    field<&ScenePreparation::to_hz>(
        "low_pass_hz", {.known = when<[](const ScenePreparation& p) { return 0 < p.to_hz; }>}),
    computed<[](const ScenePreparation&) { return std::uint64_t{2}; }>(
        "order", {.known = kPreparationFilters}),
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
  static const auto kPrepared = when<[](const T& report) {
    return report.preparation.filters() || report.preparation.detrend != "none";
  }>;
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
      computed<[](const T& r) { return r.inputs.empty() ? kNone : r.inputs[0].optimum_rmse; }>(
          "optimum_rmse"),
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
