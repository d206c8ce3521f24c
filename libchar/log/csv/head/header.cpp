#include "libchar/log/csv/head/header.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <set>
#include <span>
#include <tuple>
#include <utility>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/csv/head/candidates.hpp"
#include "libchar/log/csv/head/first_lines.hpp"
#include "libchar/log/time/time_column.hpp"

namespace libchar::csv {
namespace {

// Text of the header in UTF-8; nothing when it is not what it is said to be. What is not UTF-8 and
// does not begin with the mark of it was written by an older Windows, as a rule.
std::optional<std::string> decoded(Study& study, const std::string& text) {
  const std::string& encoding = study.options.encoding;
  if (encoding == "latin1") return latin1_to_utf8(text);
  if (encoding == "cp1252") return windows1252_to_utf8(text);
  if (encoding != "auto" && encoding != "utf-8")
    throw usage_error("E0202", "`encoding`")
        .says("unknown encoding")
        .got(encoding)
        .hint("use auto, utf-8, latin1 or cp1252");
  if (first_invalid_utf8(text) == std::string::npos) return text;
  if (encoding == "utf-8" || study.marked_utf8) return std::nullopt;
  auto guessed = windows1252_to_utf8(text);
  if (guessed && !std::exchange(study.encoding_guessed, true))
    study.info.guesses.emplace_back("encoding: the header is not UTF-8 and read as Windows-1252 (`encoding` chooses)");
  return guessed;
}

std::string header_text(Study& study, const Field& field, const Line& line, std::size_t indent) {
  if (field.text.size() > kMaxName)
    throw refusal(study, line, field.offset + indent, "E0305")
        .says("channel name longer than 1024 bytes")
        .got(field.text);
  if (auto text = decoded(study, field.text)) return *text;
  std::size_t invalid = first_invalid_utf8(field.text);
  const bool utf8 = invalid == std::string::npos;  // and read as what was asked for it is no text
  if (utf8)
    for (invalid = 0; windows1252_to_utf8(std::string_view(field.text).substr(invalid, 1));) ++invalid;
  const std::size_t column = field.offset + (field.quoted ? 1 : 0) + indent + invalid;
  throw refusal(study, line, column, "E0302")
      .says("{} Windows-1252: byte 0x{:02X} at offset {}", utf8 ? "not" : "neither UTF-8 nor",
            static_cast<unsigned char>(field.text[invalid]), line.offset + column)
      .got(field.text)
      .hint(utf8 ? "`encoding` auto reads it as UTF-8"
                 : "`encoding` latin1 takes every byte for the character of ISO 8859-1");
}

// "Headers,time,Ax,Ay", "Labels:= acc_x": what stands behind a word that announces names; empty where none does.
std::string_view announced_names(std::string_view text) {
  static constexpr std::array<std::string_view, 6> kWords = {"headers", "header", "labels",
                                                             "columns", "fields", "channels"};
  const std::string lower = ascii_lower(text.substr(0, text.find_first_of(",:=")));
  if (std::find(kWords.begin(), kWords.end(), lower) == kWords.end()) return {};
  text.remove_prefix(lower.size());
  return text.substr(std::min(text.find_first_not_of(",:= "), text.size()));
}

// A delimiter at the end of the first line, or of the first row, that has nothing behind it.
void find_trailing(Study& study) {
  for (std::size_t i = 0; i < study.sample.size() && !study.dialect.lines.trailing_delimiter; ++i) {
    const Line& line = study.sample[i];
    const std::size_t last = line.text.find_last_not_of(' ');
    if (last == std::string_view::npos || line.text[last] != study.dialect.delimiter) continue;
    const Cells fields = cells_in(study.dialect, line.text);
    if (study.dialect.delimiter == ' ' || fields.size() != study.columns + 1 || !fields.back().text.empty() ||
        fields.back().quoted)
      continue;
    study.dialect.lines.trailing_delimiter = true;
    study.info.warnings.add("trailing_delimiter", "lines end with a delimiter: the empty last column is dropped",
                            place_name(line.number, line.lines > 1 ? 1 : fields.back().offset + 1));
  }
}

// OpenSignals of PLUX and BITalino: "# {…"column": ["nSeq", "I1", "A1"],…}" in front of "# EndOfHeader".
bool named_by_open_signals(Study& study) {
  constexpr std::string_view kKey = "\"column\": [";
  const auto& lines = study.comments;
  const auto line = std::find_if(lines.begin(), lines.end(),
                                 [&](const Line& one) { return one.text.find(kKey) != std::string_view::npos; });
  if (study.options.header != "auto" || line == lines.end()) return false;
  const std::size_t from = line->text.find(kKey) + kKey.size(), to = line->text.find(']', from);
  if (to == std::string_view::npos) return false;
  Cells names = split(line->text.substr(from, to - from), ',');
  if (names.size() != study.columns) return false;
  for (const Field& name : names) {
    Column& added = study.dialect.columns.emplace_back();
    added.text = header_text(study, name, *line, from);
    added.line = line->number;
    added.position = from + name.offset + 1;
  }
  study.dialect.has_header = true;
  study.info.dialect.push_back(fmt::format("names in line {}", line->number));
  find_trailing(study);
  return true;
}

// A comment with as many cells as the rows have, which are words.
bool takes_names(Study& study, const Line& line, bool with_time) {
  std::string_view text = line.text;
  text.remove_prefix(std::min(text.find_first_not_of(" \t#%/;"), text.size()));
  const std::string_view announced = announced_names(text);
  if (!announced.empty()) text = announced;
  if (text.empty() || (study.columns < 2 && announced.empty())) return false;
  const Cells names = table_cells(study, text);
  const bool numbers = std::all_of(names.begin(), names.end(), [&](const Field& name) {
    return read_sampled(name.text, study.style()).kind != Cell::bad;
  });
  const bool sentence = std::any_of(names.begin(), names.end(), [](const Field& name) {
    return name.text.starts_with("and ");  // "logging every 3 s, and mode CPM, using device 4"
  });
  const bool time = std::any_of(names.begin(), names.end(), [](const Field& name) { return called_time(name.text); });
  if (names.size() != study.columns || numbers || sentence || (with_time && !time)) return false;
  read_names(study, line, text);
  return true;
}

// EuRoC writes "#timestamp [ns],w_RS_S_x [rad s^-1],…", Gulf Coast Data Concepts ";Headers,
// time,Ax,Ay,Az": the last comment before the data, when it has as many cells; or, with the time, the one before it.
bool named_by_comment(Study& study) {
  if (study.options.header != "auto") return false;
  const std::vector<Line> comments = study.comments;
  bool last = true;
  for (auto line = comments.rbegin(); line != comments.rend(); ++line) {
    const std::size_t from = std::min(line->text.find_first_not_of(" \t#%/;"), line->text.size());
    if (is_ruler(line->text.substr(from))) continue;
    if (takes_names(study, *line, !last)) return true;
    if (!std::exchange(last, false)) return false;
  }
  return false;
}

// Sea-Bird writes "# name 4 = t090C: Temperature [ITS-90, deg C]" in front of its rows, a line for each column.
bool named_one_by_one(Study& study) {
  constexpr std::string_view kKey = "# name ";
  std::vector<const Line*> lines;
  for (const Line& line : study.comments)
    if (line.text.starts_with(fmt::format("{}{} = ", kKey, lines.size()))) lines.push_back(&line);
  if (study.options.header != "auto" || lines.size() != study.columns) return false;
  for (const Line* line : lines) {
    const std::string_view text = line->text;
    const std::size_t from = text.find("= ") + 2, open = text.find('['), close = text.rfind(']');
    Field name{std::string(trimmed(text.substr(from, text.find(':', from) - from)))};
    Column& added = study.dialect.columns.emplace_back();
    added.text = header_text(study, name, *line, from);
    added.line = line->number;
    added.position = from + 1;
    if (open == text.npos || close == text.npos || close < open) continue;
    const std::string_view unit = text.substr(open + 1, close - open - 1);
    added.unit_below = decoded(study, std::string(trimmed(unit.substr(unit.find(',') + 1)))).value_or("");
  }
  study.dialect.has_header = true;
  study.info.dialect.push_back(fmt::format("names in lines {} to {}", lines.front()->number, lines.back()->number));
  return true;
}

// The last line in front of the rows has a name for each column, between other signs than the rows have.
bool named_between_other_signs(Study& study) {
  if (study.options.header != "auto" || study.columns < 2 || study.preamble.empty() || !study.dialect.lead.empty())
    return false;
  const Line& line = study.preamble.back();
  for (const char sign : {';', '\t', ',', '|', ' '}) {
    if (sign == study.dialect.delimiter) continue;
    Cells names = split(line.text, sign);
    if (names.back().text.empty()) names.pop_back();
    if (names.size() != study.columns || std::any_of(names.begin(), names.end(), [&](const Field& name) {
          return cell_kind(name, study.style()) != CellKind::word;
        }))
      continue;
    for (const Field& name : names) {
      Column& added = study.dialect.columns.emplace_back();
      added.text = header_text(study, name, line, 0);
      added.line = line.number;
      added.position = name.offset + 1;
    }
    study.dialect.has_header = true;
    study.dialect.header = std::string(line.text);
    study.info.dialect.push_back(fmt::format("header in line {}, separated by {}", line.number, delimiter_name(sign)));
    find_trailing(study);
    return true;
  }
  return false;
}

// "ax=0.01 ay=0.02", "ax: 0.01, ay: 0.02", "ax: 0.01 ay: 0.02": every cell, or the one in front of it, says its name.
bool named_by_labels(Study& study, const Cells& first) {
  bool any = false;
  for (std::size_t c = 0; c < study.dialect.columns.size(); ++c) {
    const std::string& text = first[c].text;
    const std::string_view before = c > 0 ? std::string_view(first[c - 1].text) : "";
    std::string_view name;
    if (label_length(text) > 0)
      name = std::string_view(text).substr(0, text.find_first_of("=:"));
    else if (before.size() > 1 && (before.back() == ':' || before.back() == '=') &&
             label_length(std::string(before) + "0") > 0)
      name = before.substr(0, before.size() - 1);
    if (name.empty()) continue;
    study.dialect.columns[c].text = decoded(study, std::string(trimmed(name))).value_or("");
    any = true;
  }
  if (any) study.info.dialect.emplace_back("names before the values");
  return any;
}

// "0.005 sec" and "21.3 °C": the unit behind the first number of a column is that of the column.
void take_cell_unit(Study& study, std::string unit, const Line& line, const Field& field, Column& column) {
  const std::string named = name_and_unit(column.text).second;
  const std::string& said = named.empty() ? column.unit_below : named;
  if (!said.empty() && !same_unit(said, unit))
    throw refusal(study, line, field.offset, "E0333")
        .says("a value in {}, and the header says {}", printable(decoded(study, unit).value_or(unit), 20),
              printable(said, 20))
        .got(field.text)
        .hint("mend the one that is wrong");
  if (said.empty()) column.unit_below = decoded(study, unit).value_or("");
  column.cell_unit = std::move(unit);
}

bool find_cell_units(Study& study) {
  bool found = false;
  std::vector<bool> seen(study.dialect.columns.size(), false);
  for (const Line& line : study.sample) {
    if (line.offset < study.dialect.data_offset) continue;
    const Cells row = cells_in(study.dialect, line.text);
    for (std::size_t c = 0; c < std::min(row.size(), seen.size()); ++c) {
      if (seen[c] || read_styled(row[c].text, study.style()).kind == Cell::missing) continue;
      seen[c] = true;
      const auto measured = number_and_unit(row[c].text);
      if (!measured) continue;
      take_cell_unit(study, std::string(measured->unit), line, row[c], study.dialect.columns[c]);
      found = true;
    }
  }
  return found;
}

}  // namespace

// "Date and Time,Light," above "1/5/2024,12:00:00,17": one name for the two, and the last column is left without.
void leave_clock_unnamed(const Study& study, Cells& names) {
  const auto row = std::find_if(study.sample.begin(), study.sample.end(),
                                [&](const Line& line) { return line.offset >= study.dialect.data_offset; });
  if (row == study.sample.end() || names.size() < 3 || !names.back().text.empty()) return;
  const Cells cells = cells_in(study.dialect, row->text);
  for (std::size_t c = 0; c + 2 < std::min(cells.size(), names.size()); ++c)
    if (cell_kind(cells[c], study.style()) == CellKind::date &&
        cell_kind(cells[c + 1], study.style()) == CellKind::clock && !names[c + 1].text.empty() &&
        !called_time(names[c + 1].text)) {
      names.insert(names.begin() + static_cast<std::ptrdiff_t>(c) + 1, Field{"", names[c + 1].offset, false});
      names.pop_back();
      return;
    }
}

/// Names that several sources have ("Gyroscope X" of each Shimmer), but for those of times, get the source before them,
/// from the line above.
void name_by_sources(Study& study, const Line& header) {
  auto& columns = study.dialect.columns;
  if (study.preamble.empty() || study.preamble.back().number + 1 != header.number) return;
  Cells sources = split(study.preamble.back().text, study.dialect.delimiter);
  std::map<std::string, std::size_t> count;
  std::set<std::string> named;
  for (const Column& column : columns) ++count[column.text];
  if (sources.size() != columns.size() || count.size() == columns.size()) return;
  std::vector<std::string> texts;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const bool several = count[columns[c].text] > 1 && !called_time(columns[c].text);
    if (c > 0 && sources[c].text.empty()) sources[c] = sources[c - 1];  // of the columns from there on
    if (several && cell_kind(sources[c], study.style()) != CellKind::word) return;
    texts.push_back(several ? header_text(study, sources[c], study.preamble.back(), 0) + " " + columns[c].text
                            : columns[c].text);
    if (several && !named.insert(texts.back()).second) return;
  }
  for (std::size_t c = 0; c < columns.size(); ++c) columns[c].text = texts[c];
}

void read_names(Study& study, const Line& line, std::string_view text) {
  Dialect& dialect = study.dialect;
  dialect.has_header = true;
  dialect.header = std::string(text);
  study.info.dialect.push_back(fmt::format("header in line {}", line.number));
  find_trailing(study);
  bool open = false;
  const std::size_t indent = static_cast<std::size_t>(text.data() - line.text.data());
  if (const Cells all = cells_in(dialect, text, &open); open)
    throw refusal(study, line, all.back().offset + indent, "E0306")
        .says("a quote is opened here and never closed in the header");
  Cells fields = table_cells(study, text);
  leave_clock_unnamed(study, fields);
  if (fields.size() > kMaxColumns)
    throw refusal(study, line, 0, "E0305").says("{} columns, the limit is {}", fields.size(), kMaxColumns);
  dialect.lines.few_names = fields.size() < study.columns;
  std::size_t counted = 0, newline = std::string_view::npos;
  std::uint64_t lines = 0;
  for (const Field& field : fields) {
    for (; counted < field.offset; ++counted)
      if (text[counted] == '\n' || text[counted] == '\r') {
        newline = counted;
        lines += text[counted] == '\n';
      }
    Column& added = dialect.columns.emplace_back();
    added.text = header_text(study, field, line, indent);
    added.line = line.number + lines;
    added.position = newline == std::string_view::npos ? field.offset + indent + 1 : field.offset - newline;
  }
  name_by_sources(study, line);
  // "Date; Time; BC1" above rows between blanks
  if (dialect.delimiter == ' ' && std::all_of(dialect.columns.begin(), dialect.columns.end() - 1, [](const Column& c) {
        return c.text.size() > 1 && c.text.ends_with(';');
      }))
    for (Column& column : dialect.columns)
      if (column.text.ends_with(';')) column.text.pop_back();
}

void read_units(Study& study, const Line& line) {
  const Cells fields = table_cells(study, line.text);
  for (std::size_t c = 0; c < std::min(fields.size(), study.dialect.columns.size()); ++c) {
    std::string_view unit = fields[c].text;
    if (unit.size() > 2 && ((unit.front() == '(' && unit.back() == ')') || (unit.front() == '[' && unit.back() == ']')))
      unit = trimmed(unit.substr(1, unit.size() - 2));
    static constexpr std::array<std::string_view, 8> kNone = {"TS",  "RN",  "Sequence", "f64",
                                                              "f32", "i64", "i32",      "str"};
    if (std::find(kNone.begin(), kNone.end(), unit) == kNone.end() && unit.size() <= 40)
      study.dialect.columns[c].unit_below = decoded(study, std::string(unit)).value_or("");
  }
  study.info.dialect.push_back(fmt::format("units in line {}", line.number));
}

void do_without_names(Study& study) {
  if (named_one_by_one(study) || named_by_open_signals(study) || named_by_comment(study) ||
      named_between_other_signs(study))
    return;
  const Line& first = study.sample[0];
  // What looks like the end of the first rows may be a column that is filled further on.
  const Cells all = cells_in(study.dialect, first.text);
  if (all.size() > table_cells(study, first.text).size() && !filled_cells(study, {study.columns}, 1)[0].empty())
    ++study.columns;
  const Cells fields = table_cells(study, first.text);
  for (const Field& field : fields) study.dialect.columns.emplace_back().position = field.offset + 1;
  const bool labelled = named_by_labels(study, fields);
  find_trailing(study);
  study.info.dialect.push_back("no header");
  if (study.options.header == "auto" && !labelled)
    study.info.warnings.add("no_header", "no header line: the columns are named c0, c1… and the first line is data",
                            place_name(first.number, 1));
}

/// What a phone's app writes without a unit: columns of a file, of any file where it is "".
struct PhoneUnit {
  std::string_view file, columns, unit;
};

// Sensor Logger writes a file for each sensor, whose name says which (its page of units, awesome-sensor-logger). Its
// uncalibrated accelerometer is in g or m/s^2.
constexpr PhoneUnit kSensorLogger[] = {{"accelerometer", "x y z", "m/s^2"},
                                       {"totalacceleration", "x y z", "m/s^2"},
                                       {"gravity", "x y z", "m/s^2"},
                                       {"gyroscope", "x y z", "rad/s"},
                                       {"gyroscopeuncalibrated", "x y z", "rad/s"},
                                       {"magnetometer", "x y z", "uT"},
                                       {"magnetometeruncalibrated", "x y z", "uT"},
                                       {"orientation", "pitch roll yaw", "rad"},
                                       {"wristmotion", "rotationRateX rotationRateY rotationRateZ", "rad/s"},
                                       {"barometer", "pressure", "hPa"},
                                       {"barometer", "relativeAltitude", "m"},
                                       {"location", "altitude horizontalAccuracy verticalAccuracy", "m"},
                                       {"location", "speed speedAccuracy", "m/s"},
                                       {"location", "latitude longitude bearing bearingAccuracy", "deg"}};
constexpr PhoneUnit kPhysicsToolbox[] = {{"", "gFx gFy gFz TgF gFTotal", "g"},
                                         {"", "ax ay az aT", "m/s^2"},
                                         {"", "wx wy wz", "rad/s"},
                                         {"", "Bx By Bz", "uT"},
                                         {"", "p", "hPa"}};

void find_units_of_phone(Study& study) {
  auto& columns = study.dialect.columns;
  const auto has_column = [&](std::string_view text) {
    return std::any_of(columns.begin(), columns.end(), [&](const Column& column) { return column.text == text; });
  };
  const bool logger = has_column("seconds_elapsed"),
             toolbox = !logger && (has_column("gFx") || (has_column("az") && has_column("aT")) ||
                                   (has_column("ax") && has_column("wx") && has_column("Bx")));
  if (!logger && !toolbox) return;
  const std::string stem = ascii_lower(std::filesystem::path(study.info.file).stem().string());
  std::vector<std::string_view> said;
  for (const PhoneUnit& row : logger ? std::span<const PhoneUnit>(kSensorLogger) : std::span(kPhysicsToolbox))
    for (Column& column : columns) {
      if (row.file != (logger ? stem : "") || column.text.empty() || column.text.find(' ') != std::string::npos ||
          (" " + std::string(row.columns) + " ").find(" " + column.text + " ") == std::string::npos)
        continue;
      column.unit_below = row.unit;
      if (std::find(said.begin(), said.end(), row.unit) == said.end()) said.push_back(row.unit);
    }
  if (!said.empty())
    study.info.guesses.push_back(fmt::format("units: {}, those of {} (`units` says otherwise)", fmt::join(said, ", "),
                                             logger ? "Sensor Logger in a file of this name" : "Physics Toolbox"));
}

void find_other_units(Study& study) {
  find_units_of_phone(study);
  if (find_cell_units(study)) study.info.dialect.emplace_back("units after the numbers");
  // Gyroflow's .gcsv holds counts: gx, gy, gz and ax, ay, az.
  for (const Line& line : study.preamble)
    for (const auto& [key, axes, unit] : {std::tuple("gscale", 'g', "rad/s"), std::tuple("ascale", 'a', "g")})
      if (const auto count = stated_count(line.text, key))
        for (Column& column : study.dialect.columns)
          if (column.text.size() == 2 && column.text[0] == axes)
            column.unit_below = fmt::format("{} {}", shortest(*count), unit);
}

std::string place_name(std::uint64_t line, std::uint64_t column) {
  return column <= 1 ? fmt::format("line {}", line) : fmt::format("line {}, column {}", line, column);
}

void name_columns(Dialect& dialect, LogInfo& info) {
  std::map<std::string, std::set<std::string_view>> texts;  // of a name
  for (Column& column : dialect.columns) {
    std::tie(column.name, column.unit) = name_and_unit(column.text);
    if (column.unit.empty()) column.unit = column.unit_below;
    texts[column.name].insert(trimmed(column.text));
  }
  std::set<std::string> seen;
  std::map<std::string, int> numbers;  // put behind a name
  for (std::size_t i = 0; i < dialect.columns.size(); ++i) {
    Column& column = dialect.columns[i];
    if (!dialect.has_header) continue;
    if (column.name.empty()) {
      column.name = fmt::format("c{}", i);
      column.unnamed = true;
    } else if (texts[column.name].size() > 1) {
      column.name = std::string(trimmed(column.text));  // acc_g beside acc_mg: the full texts differ
    }
    if (std::string_view("=+-@\t\r").find(column.name[0]) != std::string_view::npos)
      info.warnings.add(
          "formula_name",
          "channel names that a spreadsheet would run as a formula: kept, and prefixed with ' in CSV that is written",
          place_name(column.line, column.position));
    if (printable(column.name).find("\\u{") != std::string::npos ||
        printable(column.name).find("\\x") != std::string::npos)
      info.warnings.add("control_in_name",
                        "channel names with invisible or direction-changing characters: shown escaped",
                        place_name(column.line, column.position));
    if (seen.insert(column.name).second) continue;
    // "X[s],EMG,X[s],ACC" of Delsys: its names are clear in pairs.
    if (unit_behind({column.text, column.unit_below}) == 0 && !called_time(column.text))
      info.warnings.add("doubled_name", "columns repeat the name of an earlier one: a number was appended",
                        place_name(column.line, column.position));
    const std::string name = column.name;
    while (!seen.insert(column.name).second) column.name = fmt::format("{}_{}", name, ++numbers[name] + 1);
  }
}

}  // namespace libchar::csv
