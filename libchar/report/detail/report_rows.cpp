#include "libchar/report/detail/report_rows.hpp"

#include <cmath>

#include "libchar/characterize/curves/curve_document.hpp"
#include "libchar/core/document/coefficient_fields.hpp"
#include "libchar/core/units.hpp"

namespace libchar {
namespace {

const Fields<DigitalFaults>& digital_fields() {
  using T = DigitalFaults;
  static const Fields<Rail> rails = always(Fields<Rail>{
      field<&Rail::value>("value"),
      field<&Rail::high>("high"),
      field<&Rail::share>("share", {.meaning = "of the samples"}),
  });
  static const Fields<HeldValues> held = always(Fields<HeldValues>{
      field<&HeldValues::times>("times", {.meaning = "each value is recorded, on average"}),
      field<&HeldValues::sensor_rate_hz>("sensor_rate_hz"),
  });
  static const Fields<Staircase> staircase = always(Fields<Staircase>{
      field<&Staircase::step>("step"),
      field<&Staircase::noise>("noise"),
      field<&Staircase::bounded>("bounded", {.meaning = "the noise is an upper bound"}),
  });
  static const Fields<T> rows = always(Fields<T>{
      list_of<&T::rails>("rails", rails),
      maybe_part<&T::held>("held", held),
      maybe_part<&T::staircase>("staircase", staircase),
  });
  return rows;
}

template <LimitStatus Status>
std::uint64_t judged(const LimitReport& report) {
  return report.count(Status);
}

const Fields<LimitJudgement>& judgement_fields() {
  using T = LimitJudgement;
  static const Fields<T> rows = always(Fields<T>{
      field<&T::channel>("channel"),
      field<&T::term>("term", {.words = term_words()}),
      field<&T::most>("limit"),
      computed<[](const T& j) { return term_unit(kTermNames[static_cast<std::size_t>(j.term)].key, j.unit); }>("unit"),
      field<&T::text>("limit_as_given"),
      field<&T::measured, &Coefficient::value>("value"),
      field<&T::measured, &Coefficient::ci95>("ci95",
                                              {.known = when<[](const T& j) { return j.measured.value.has_value(); }>}),
      field<&T::measured, &Coefficient::upper95>("upper95"),
      field<&T::measured, &Coefficient::status>("status"),
      field<&T::status>("judgement"),
      field<&T::sentence>("sentence"),
  });
  return rows;
}

}  // namespace

const Fields<SummaryOfChannel>& summary_fields() {
  using T = SummaryOfChannel;
  static const Fields<T> rows = always(Fields<T>{
      field<&T::name>("name"),
      field<&T::rating>("rating"),
      field<&T::sentence>("sentence"),
      list_of<&T::findings>("findings", finding_fields(), {.meaning = "the worst first"}),
  });
  return rows;
}

const Fields<QualityOfChannel>& quality_fields() {
  using T = QualityOfChannel;
  static const Fields<T> rows = always(Fields<T>{
      beside<&T::described>(described_channel_fields()),
      part<&T::digital>("digital", digital_fields()),
      list_of<&T::lines>("lines", line_fields()),
  });
  return rows;
}

const Fields<Stretch>& still_fields() {
  static const Fields<Stretch> rows = always(Fields<Stretch>{
      field<&Stretch::from_s>("from_s"),
      field<&Stretch::to_s>("to_s"),
      field<&Stretch::found>("found"),
      field<&Stretch::whole>("whole"),
      field<&Stretch::sentence>("sentence"),
  });
  return rows;
}

const Fields<LimitReport>& limit_report_fields() {
  using T = LimitReport;
  static const Fields<T> rows = always(Fields<T>{
      field<&T::file>("file"),
      field<&T::sensor>("sensor"),
      field<&T::verdict>("verdict"),
      computed<judged<LimitStatus::pass>>("pass"),
      computed<judged<LimitStatus::fail>>("fail"),
      computed<judged<LimitStatus::not_decided>>("not_decided"),
      list_of<&T::judgements>("terms", judgement_fields()),
  });
  return rows;
}

// The JSON pieces that the verbs share; the keys are those of docs/json.md, which may grow and never change.

Json texts_json(const std::vector<std::string>& texts) {
  Json out = Json::array();
  for (const std::string& text : texts) out.push_back(json_text(text));
  return out;
}

Json json_frame(std::string_view format) { return {{"format", format}, {"version", 1}}; }

Json interval_json(const Interval& interval) {
  if (std::isnan(interval.low) || std::isnan(interval.high)) return nullptr;
  return Json::array({json_number(interval.low), json_number(interval.high)});
}

}  // namespace libchar
