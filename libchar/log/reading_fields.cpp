#include "libchar/log/reading_fields.hpp"

#include <nlohmann/json.hpp>

#include "libchar/log/formats.hpp"

namespace libchar {
namespace {

constexpr Word kDecimals[] = {{"auto"}, {"point"}, {"comma"}};
constexpr Word kHeaders[] = {{"auto"}, {"yes"}, {"no"}};
constexpr Word kEncodings[] = {{"auto"}, {"utf-8"}, {"latin1"}, {"cp1252"}};
constexpr Word kTimeSources[] = {{"auto"}, {"header"}, {"log"}, {"publish"}};
constexpr Word kDateOrders[] = {{"auto"}, {"day"}, {"month"}, {"year"}};
constexpr Word kTimeUnits[] = {{"auto"}, {"s"}, {"ms"}, {"us"}, {"ns"}, {"100us"}, {"100ns"}, {"min"}, {"h"}, {"d"}};

// auto and the names of the table of formats.
const std::vector<Word>& format_choices() {
  static const std::vector<std::string> names = format_words();
  static const std::vector<Word> words = [] {
    std::vector<Word> out;
    out.reserve(names.size());
    for (const std::string& name : names) out.push_back({name});
    return out;
  }();
  return words;
}

/// Of channels and of the text of a table.
Fields<ReadOptions> table_fields() {
  return {
      field<&ReadOptions::channels>("channels", {.meaning = "names or c0, c1… of those to read", .otherwise = "all"}),
      field<&ReadOptions::topic>(
          "topic", {.meaning = "the stream to read of a log that holds several", .otherwise = "the only one"}),
      field<&ReadOptions::time_source>(
          "time_source",
          {.words = kTimeSources, .meaning = "whose stamps, where messages have several", .otherwise = "auto"}),
      field<&ReadOptions::unsaid, &ReadOptions::Unsaid::msg>(
          "msg", {.meaning = "folder of the .msg files of types that a ROS log does not define", .otherwise = "none"}),
      field<&ReadOptions::rate_hz>("rate_hz",
                                   {.unit = "Hz", .range = kRates, .meaning = "sampling rate of a log without stamps"}),
      field<&ReadOptions::unsaid, &ReadOptions::Unsaid::rate_uncertainty_hz>(
          "rate_uncertainty_hz",
          {.unit = "Hz", .range = kNotNegative, .meaning = "of the stated sampling rate", .otherwise = "0"}),
      field<&ReadOptions::unsaid, &ReadOptions::Unsaid::channel_rate>(
          "channel_rate", {.meaning = "rates of channels of a log without stamps, NAME=200Hz, by name or pattern",
                           .otherwise = "rate_hz for all"}),
      field<&ReadOptions::delimiter>("delimiter",
                                     {.meaning = "auto, tab, space or one character (CSV)", .otherwise = "auto"}),
      field<&ReadOptions::decimal>("decimal",
                                   {.words = kDecimals, .meaning = "decimal mark (CSV)", .otherwise = "auto"}),
      field<&ReadOptions::header>(
          "header",
          {.words = kHeaders, .meaning = "is the first line one of names (CSV)", .otherwise = "auto", .quoted = true}),
      field<&ReadOptions::encoding>("encoding", {.words = kEncodings, .meaning = "of the header", .otherwise = "auto"}),
      field<&ReadOptions::names>("names", {.meaning = "new names of the channels", .otherwise = "as in the log"}),
      field<&ReadOptions::units>("units", {.meaning = "of the channels, or one for all", .otherwise = "as in the log"}),
      field<&ReadOptions::channel_scale>(
          "channel_scale", {.meaning = "factors of channels, NAME=1/16.4, by name or pattern", .otherwise = "none"}),
      field<&ReadOptions::channel_unit>("channel_unit", {.meaning = "units of channels, NAME=UNIT, by name or pattern",
                                                         .otherwise = "as in the log"}),
      field<&ReadOptions::kinds, &ReadOptions::Kinds::where>(
          "where", {.meaning = "COLUMN=VALUE: only rows with it (CSV)", .otherwise = "all rows"}),
      field<&ReadOptions::kinds, &ReadOptions::Kinds::group_by>(
          "group_by", {.meaning = "column whose values become channels of their own (CSV)", .otherwise = "none"}),
      field<&ReadOptions::date_order>(
          "date_order", {.words = kDateOrders, .meaning = "first number of a date (CSV)", .otherwise = "auto"}),
  };
}

/// Of time, file and window.
Fields<ReadOptions> time_fields() {
  return {
      field<&ReadOptions::time_column>("time_column", {.meaning = "auto, none, a name or c0", .otherwise = "auto"}),
      field<&ReadOptions::time_unit>("time_unit",
                                     {.words = kTimeUnits, .meaning = "of the stamps", .otherwise = "auto"}),
      field<&ReadOptions::skip_rows>("skip_rows", {.meaning = "lines before the header (CSV)", .otherwise = "0"}),
      field<&ReadOptions::format>("format", {.words = format_choices(), .meaning = "of the file", .otherwise = "auto"}),
      field<&ReadOptions::unsaid, &ReadOptions::Unsaid::preset>(
          "preset", {.meaning = "which instrument wrote a .imu file, as LN200", .otherwise = "none"}),
      field<&ReadOptions::from_s>("from_s", {.unit = "s",
                                             .range = kNotNegative,
                                             .meaning = "first instant used, after the first stamp",
                                             .otherwise = "the first"}),
      field<&ReadOptions::to_s>(
          "to_s", {.unit = "s", .range = kPositive, .meaning = "first instant not used", .otherwise = "the end"}),
      field<&ReadOptions::missing, &ReadOptions::Missing::marks>(
          "missing", {.meaning = "values that mean \"no reading\", such as -999", .otherwise = "none"}),
      field<&ReadOptions::missing, &ReadOptions::Missing::overflow>(
          "overflow_as_missing",
          {.meaning = "a number out of a double's range counts as missing", .otherwise = "false"}),
      field<&ReadOptions::missing, &ReadOptions::Missing::bad_rows>(
          "drop_bad_rows",
          {.meaning = "rows that cannot be read are left out and counted (CSV)", .otherwise = "false"}),
      field<&ReadOptions::skip_repeated_header>(
          "skip_repeated_header", {.meaning = "header lines inside the data are skipped", .otherwise = "false"}),
  };
}

}  // namespace

const Fields<ReadOptions>& reading_fields() {
  static const Fields<ReadOptions> rows = [] {
    Fields<ReadOptions> all = table_fields();
    const Fields<ReadOptions> more = time_fields();
    all.rows.insert(all.rows.end(), more.rows.begin(), more.rows.end());
    return all;
  }();
  return rows;
}

std::vector<std::string> options_given(const ReadOptions& options) {
  static const auto usual = document_of(reading_fields(), ReadOptions{});
  const auto now = document_of(reading_fields(), options);
  std::vector<std::string> out;
  for (const auto& [key, value] : now.items())
    if (!usual.contains(key) || usual[key] != value) out.push_back(key);
  return out;
}

}  // namespace libchar
