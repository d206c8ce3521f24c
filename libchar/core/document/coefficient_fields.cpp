#include "libchar/core/document/coefficient_fields.hpp"

namespace libchar {
namespace {

constexpr Word kStatuses[] = {
    {name_of(Status::detected), static_cast<int>(Status::detected)},
    {name_of(Status::not_detected), static_cast<int>(Status::not_detected), "no value: only an upper limit is known"},
    {name_of(Status::undetermined), static_cast<int>(Status::undetermined),
     "undetermined: the record cannot tell it from another term, or contradicts it"},
    {name_of(Status::misfit), static_cast<int>(Status::misfit),
     "the noise terms do not describe the recording: do not rely on it"},
    {name_of(Status::given), static_cast<int>(Status::given), "stated, not fitted"},
    {name_of(Status::not_fitted), static_cast<int>(Status::not_fitted), "not part of the model that was fitted"},
};
constexpr Word kIntervals[] = {{"profile", 1, "likelihood"}, {"covariance", 0, "of the fit, log-normal"}};

bool has_value(const Coefficient& c) { return c.value.has_value(); }

}  // namespace

std::span<const Word> status_words() { return kStatuses; }

std::span<const Word> interval_words() { return kIntervals; }

std::span<const Word> term_words() {
  static constexpr auto words = [] {
    std::array<Word, kTerms> out;
    for (std::size_t t = 0; t < kTerms; ++t) out[t] = {kTermNames[t].key, static_cast<int>(t)};
    return out;
  }();
  return words;
}

const Fields<Coefficient>& coefficient_fields() {
  static const Fields<Coefficient> rows = always(Fields<Coefficient>{
      field<&Coefficient::value>("value", {.range = kNotNegative, .meaning = "the coefficient"}),
      field<&Coefficient::ci95>("ci95", {.range = kNotNegative, .meaning = "95 % interval", .known = when<has_value>}),
      field<&Coefficient::status>("status", {.words = kStatuses, .meaning = "how it is known"}),
      field<&Coefficient::upper95>("upper95",
                                   {.range = kNotNegative, .meaning = "upper limit of a term that was not detected"}),
      field<&Coefficient::relative_sd>(
          "relative_sd",
          {.range = kNotNegative, .meaning = "standard deviation over the value", .known = when<has_value>}),
      field<&Coefficient::profile>("ci95_by", {.words = kIntervals, .meaning = "where the interval comes from"}),
      field<&Coefficient::likelihood_ratio>("likelihood_ratio", {.meaning = "2 (ln L with the term - ln L without)"}),
      field<&Coefficient::bound>("bound_relative_sd", {.meaning = "Cramér–Rao bound"}),
      field<&Coefficient::seconds_for_10_percent>(
          "seconds_for_10_percent", {.unit = "s", .meaning = "length of a recording whose bound is 10 %"}),
  });
  return rows;
}

const Fields<Goodness>& goodness_fields() {
  static const Fields<Goodness> rows = always(Fields<Goodness>{
      field<&Goodness::chi2>("chi2"),
      field<&Goodness::dof>("dof", {.meaning = "degrees of freedom"}),
      field<&Goodness::p>("p", {.meaning = "probability of a larger chi2"}),
  });
  return rows;
}

namespace {

const Fields<Finding::Place>& place_fields() {
  using T = Finding::Place;
  static const Fields<T> rows = {
      field<&T::time_s>("time_s", {.meaning = "intervals, from the first sample"}),
      field<&T::frequency_hz>("frequency_hz", {.meaning = "intervals of the spectrum"}),
      field<&T::rows>("rows", {.meaning = "the first three, in words"}),
  };
  return rows;
}

const Fields<Finding::Effect>& effect_fields() {
  using T = Finding::Effect;
  static const Fields<T> rows = {
      field<&T::quantity>("quantity", {.written = Written::always}),
      field<&T::direction>("direction"),
      field<&T::factor>("factor", {.meaning = "by which it is too large or too small"}),
  };
  return rows;
}

const Fields<Finding::Setting>& setting_fields() {
  using T = Finding::Setting;
  static const Fields<T> rows = always(Fields<T>{
      field<&T::option>("option", {.meaning = "of the library"}),
      field<&T::value>("value"),
  });
  return rows;
}

const Fields<Finding::Help>& help_fields() {
  using T = Finding::Help;
  static const Fields<T> rows = {
      field<&T::sentence>("sentence", {.written = Written::always}),
      list_of<&T::options>("options", setting_fields(), {.meaning = "of the same call, that do it"}),
  };
  return rows;
}

}  // namespace

const Fields<Finding>& finding_fields() {
  using T = Finding;
  static const Fields<T> rows = {
      field<&T::code>("code", {.written = Written::always}),
      field<&T::severity>("severity", {.written = Written::always}),
      field<&T::subject>("subject", {.meaning = "channel or sensor"}),
      field<&T::sentence>("sentence", {.written = Written::always}),
      field<&T::phrase>("phrase", {.meaning = "the same as a part of a sentence"}),
      field<&T::count>("count", {.written = Written::always}),
      part<&T::where>("where", place_fields()),
      list_of<&T::effects>("effects", effect_fields()),
      list_of<&T::help>("remedies", help_fields()),
  };
  return rows;
}

}  // namespace libchar
