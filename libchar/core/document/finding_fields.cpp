#include "libchar/core/document/finding_fields.hpp"

namespace libchar {
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
      list_of<&T::options>(
          "options", setting_fields(), {.meaning = "of the same call, that do it"}),
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
