#include "reading_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <sstream>

#include "libchar/core/parallel/thread_limit.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/quantity_text.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/formats.hpp"

namespace sensorchar {
namespace {

void add_time_options(VerbOptions& verb, libchar::ReadOptions& options) {
  verb.add_text("--topic", options.topic,
                "stream to read, where a log holds several (bags, flight logs, arrays); a pattern or the name of "
                "instances reads several as one (default: the only one)")
      .value_name("NAME")
      .group("Reading");
  verb.add_choice("--time-source", options.time_source, {"auto", "header", "log", "publish"},
                  "stamps to use, where messages have several: header (the sensor's), log (when recorded), publish "
                  "(default: auto)")
      .group("Reading");
  verb.add_text("--msg", options.unsaid.msg,
                "folder of the .msg files, of types that a recording of ROS 2 does not define (default: those of an "
                "installed ROS)")
      .value_name("DIR")
      .group("Reading");
  verb.add_instant("--from", options.from_s,
                   "first instant to use, after the first stamp (s, or 10min, 2h…; default: all)")
      .group("Reading");
  verb.add_duration("--to", options.to_s,
                    "first instant not to use, after the first stamp (s, or 10min, 2h…; default: all)")
      .group("Reading");
  verb.add_parsed_each(
          "--rate", "RATE",
          [&options](const std::string& text) {
            if (text.find('=') != std::string::npos)
              options.unsaid.channel_rate.push_back(text);
            else if (options.rate_hz)
              throw libchar::usage_error("E0205").says("two rates for all channels").got(text);
            else
              options.rate_hz = libchar::parse_rate_hz(text, options.unsaid.rate_uncertainty_hz);
          },
          "sampling rate (Hz, 1.5kHz, 1/300…), with its uncertainty if it has one (200±0.5Hz, 200Hz±0.1%), of a log "
          "without stamps and without a rate; 'gyro*=200Hz,temp=10Hz' for channels with different rates, by name or "
          "pattern")
      .once_each()
      .group("Reading");
  verb.add_parsed(
          "--interval", "TIME",
          [&options](const std::string& text) { options.rate_hz = 1 / libchar::parse_duration_s(text, true); },
          "sampling interval, in place of --rate (s, or 5min…)")
      .group("Reading");
  verb.add_text("--time-column", options.time_column,
                "column of time stamps: auto, none, a name, or its position c0, c1… (default: auto)")
      .value_name("NAME")
      .group("Reading");
  verb.add_choice("--time-unit", options.time_unit, {"auto", "s", "ms", "us", "ns", "100us", "100ns", "min", "h", "d"},
                  "unit of the time column (default: auto)")
      .group("Reading");
}

void add_channel_values(VerbOptions& verb, libchar::ReadOptions& options) {
  verb.add_texts("--scale", options.channel_scale,
                 "factor of channels by name or pattern, such as 'gyro*=1/16.4'; repeat it or separate by commas "
                 "(default: 1, or the number in the unit)")
      .separated_by_commas()
      .one_value_each()
      .value_name("NAME=FACTOR")
      .once_each()
      .group("Reading");
  verb.add_texts(
          "--unit", options.channel_unit,
          "unit of channels by name or pattern, such as 'gyro*=deg/s'; a number in it is their scale (0.05 deg/s); "
          "values in another unit of the log are converted; repeat it or separate by commas (default: as in the log)")
      .separated_by_commas()
      .one_value_each()
      .value_name("NAME=UNIT")
      .once_each()
      .group("Reading");
}

void add_long_format_options(VerbOptions& verb, libchar::ReadOptions& options) {
  const std::string csv = "Reading CSV";
  verb.add_texts(
          "--where", options.kinds.where,
          "only the rows with this value, such as sensor=Gyroscope; repeat it for several columns (default: all rows)")
      .one_value_each()
      .value_name("COLUMN=VALUE")
      .group(csv);
  verb.add_text("--group-by", options.kinds.group_by,
                "column whose values become channels of their own (default: none)")
      .value_name("COLUMN")
      .group(csv);
  verb.add_choice("--date-order", options.date_order, {"auto", "day", "month", "year"},
                  "meaning of the first number in 05/01/2024 (default: auto)")
      .group(csv);
}

void add_dialect_options(VerbOptions& verb, libchar::ReadOptions& options, bool with_format) {
  const std::string csv = "Reading CSV";
  if (with_format)
    verb.add_choice("--format", options.format, libchar::format_words(), "format of the log (default: auto)")
        .group("Reading");
  verb.add_text("--preset", options.unsaid.preset,
                "instrument that wrote a .imu file: IMAR, LN200, LN200IG, IXSEA, NAVCHIP_INT, NAVCHIP_FLT")
      .value_name("NAME")
      .group("Reading");
  verb.add_parsed(
          "--delimiter", "CHAR",
          [&options](const std::string& text) {
            if (text != "auto" && text != "tab" && text != "space" && text.size() != 1)
              throw libchar::usage_error("E0202", "--delimiter")
                  .says("expected auto, tab, space or one character")
                  .got(text);
            options.delimiter = text;
          },
          "separator of cells: auto, tab, space, or one character (default: auto)")
      .group(csv);
  verb.add_choice("--decimal", options.decimal, {"auto", "point", "comma"}, "decimal sign (default: auto)").group(csv);
  verb.add_choice("--header", options.header, {"auto", "yes", "no"},
                  "whether the first row is a header (default: auto)")
      .group(csv);
  verb.add_choice("--encoding", options.encoding, {"auto", "utf-8", "latin1", "cp1252"},
                  "encoding of the header (default: auto, UTF-8, else Windows-1252)")
      .group(csv);
  add_long_format_options(verb, options);
  verb.add_count("--skip-rows", options.skip_rows, "lines to skip before the header (default: 0)").group(csv);
}

// Flags whose only other value is "no, end with an error", which is the default.
void add_accepting_flag(VerbOptions& verb, const std::string& name, const std::string& word, bool& value,
                        const std::string& help) {
  verb.add_parsed(
          name, word + "|error",
          [&value, name, word](const std::string& text) {
            if (text != word && text != "error")
              throw libchar::usage_error("E0202", name).says("expected {} or error", word).got(text);
            value = text == word;
          },
          help)
      .group("Reading CSV");
}

}  // namespace

void add_reading_options(VerbOptions& verb, Session& session, libchar::ReadOptions& options) {
  verb.add_texts("-c,--channel", options.channels,
                 "channels to read, by name, position (c0, c1…) or pattern ('gyro*'); ! excludes one ('!temp'); repeat "
                 "it or separate by commas (default: all)")
      .separated_by_commas()
      .once_each()
      .one_value_each()
      .value_name("NAME")
      .group("Reading");
  add_reading_options_without_channel(verb, session, options);
}

void add_reading_options_without_channel(VerbOptions& verb, Session& session, libchar::ReadOptions& options,
                                         bool with_format) {
  verb.add_texts("--names", options.names,
                 "names for the channels that are read, in order, where the log has none (default: c0, c1…)")
      .separated_by_commas()
      .one_value_each()
      .value_name("NAME,…")
      .group("Reading");
  verb.add_texts("--units", options.units,
                 "units of the channels that are read, in order, or one for all (default: as in the log)")
      .separated_by_commas()
      .one_value_each()
      .value_name("UNIT,…")
      .group("Reading");
  add_channel_values(verb, options);
  add_time_options(verb, options);
  add_dialect_options(verb, options, with_format);
  verb.add_parsed_each(
          "--missing", "VALUE,…",
          [&options](const std::string& mark) { options.missing.marks.push_back(libchar::parse_number(mark)); },
          "values that mean \"no reading\" in the log, such as -999 (default: none)")
      .group("Reading");
  add_accepting_flag(verb, "--overflow", "nan", options.missing.overflow,
                     "nan: a number out of range counts as missing (default: error)");
  add_accepting_flag(verb, "--bad-rows", "drop", options.missing.bad_rows,
                     "drop: leave out and count rows that cannot be read, at most one in ten (default: error)");
  add_accepting_flag(verb, "--repeated-header", "skip", options.skip_repeated_header,
                     "skip: header lines inside the data are skipped (default: error)");
  verb.add_parsed(
          "--threads", "N",
          [&options](const std::string& text) {
            options.threads = static_cast<int>(libchar::parse_count(text, 0, 4096));
            if (options.threads > 0) libchar::keep_to_threads(options.threads);  // curves and fits as well
          },
          "threads at most (a digest has one more); the result does not depend on it (default: 0 = all cores)")
      .group("Reading");
  verb.add_flag("--strict", session.strict, "a warning about the input ends the run with exit code 3").group("Reading");
}

std::string reading_flags(const libchar::ReadOptions& options, const libchar::LogInfo& info) {
  const libchar::ReadOptions usual;
  std::string flags;
  const auto word = [&](const char* flag, const std::string& value, const std::string& default_value) {
    if (value != default_value) flags += fmt::format(" {} {}", flag, libchar::shell_word(value));
  };
  const auto number = [&](const char* flag, const std::optional<double>& value, const char* unit) {
    if (value) flags += fmt::format(" {} {}{}", flag, libchar::shortest(*value), unit);
  };
  const auto list = [&](const char* flag, const std::vector<std::string>& items) {
    if (!items.empty())
      flags += fmt::format(" {} {}", flag, libchar::shell_word(fmt::format("{}", fmt::join(items, ","))));
  };
  word("--topic", options.topic, usual.topic);
  word("--time-source", options.time_source, usual.time_source);
  word("--msg", options.unsaid.msg, usual.unsaid.msg);
  list("-c", options.channels);
  list("--names", options.names);
  list("--units", options.units);
  list("--scale", options.channel_scale);
  list("--unit", options.channel_unit);
  for (const std::string& where : options.kinds.where) flags += " --where " + libchar::shell_word(where);
  word("--group-by", options.kinds.group_by, usual.kinds.group_by);
  word("--date-order", options.date_order, usual.date_order);
  number("--from", options.from_s, "s");
  number("--to", options.to_s, "s");
  if (options.rate_hz && options.unsaid.rate_uncertainty_hz > 0)
    flags += fmt::format(" --rate {}±{}Hz", libchar::shortest(*options.rate_hz),
                         libchar::shortest(options.unsaid.rate_uncertainty_hz));
  else
    number("--rate", options.rate_hz, "Hz");
  list("--rate", options.unsaid.channel_rate);
  const bool guessed = info.time.unit_guessed && !info.time.column.empty();
  word("--time-column", guessed ? info.time.column : options.time_column, usual.time_column);
  word("--time-unit", guessed ? info.time.unit : options.time_unit, usual.time_unit);
  word("--format", options.format, usual.format);
  word("--preset", options.unsaid.preset, usual.unsaid.preset);
  word("--delimiter", options.delimiter, usual.delimiter);
  word("--decimal", options.decimal, usual.decimal);
  word("--header", options.header, usual.header);
  word("--encoding", options.encoding, usual.encoding);
  if (options.skip_rows != 0) flags += fmt::format(" --skip-rows {}", options.skip_rows);
  std::vector<std::string> marks;
  for (const double mark : options.missing.marks) marks.push_back(libchar::shortest(mark));
  if (!marks.empty()) flags += fmt::format(" --missing={}", fmt::join(marks, ","));
  if (options.missing.overflow) flags += " --overflow nan";
  if (options.missing.bad_rows) flags += " --bad-rows drop";
  if (options.skip_repeated_header) flags += " --repeated-header skip";
  return flags;
}

}  // namespace sensorchar
