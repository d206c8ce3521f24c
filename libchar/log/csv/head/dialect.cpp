#include "libchar/log/csv/head/dialect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/text/utf8.hpp"
#include "libchar/log/csv/head/candidates.hpp"
#include "libchar/log/csv/head/first_lines.hpp"
#include "libchar/log/csv/head/header.hpp"
#include "libchar/log/csv/head/sample.hpp"
#include "libchar/log/csv/long_table.hpp"
#include "libchar/log/csv/rows/number.hpp"
#include "libchar/log/csv/rows/stamps.hpp"

namespace libchar::csv {
namespace {

// One study of one head; the steps in `understand` call each other's results.
struct Study {
  std::string_view head;
  bool whole;
  const ReadOptions& options;
  LogInfo& info;
  Dialect dialect;
  std::vector<Line> sample;    // lines that are neither blank nor comments
  std::vector<Line> comments;  // before the first of them

  Study(std::string_view first_bytes,
        bool is_whole,
        const ReadOptions& read_options,
        LogInfo& known)
      : head(first_bytes), whole(is_whole), options(read_options), info(known) {}

  [[noreturn]] void fail(const Line& line,
                         std::size_t column,
                         std::string code,
                         std::string what,
                         std::string got = "",
                         std::string hint = "") const {
    throw Error({ErrorKind::input,
                 std::move(code),
                 at(info.file, line.number, column + 1, line.offset + column),
                 std::move(what),
                 std::move(got),
                 std::move(hint)});
  }

  NumberStyle style() const { return {dialect.decimal, dialect.thousands}; }

  // The cells of a line, a stamp in front of them first.
  Cells cells(std::string_view text, bool* open = nullptr) const {
    std::size_t after = 0;
    if (!dialect.lead.empty())
      if (const auto lead = lead_of(text, dialect.lead, after)) {
        Cells out = {*lead};
        for (Field& field : split(text.substr(after), dialect.delimiter, open)) {
          field.offset += after;
          out.push_back(std::move(field));
        }
        return out;
      }
    return split(text, dialect.delimiter, open);
  }

  // Terminals put the time in front of every line: "[12:00:00.123] 1,2", "12:00:00.123 -> 1,2".
  void find_lead() {
    for (const std::string lead : {"]", "->"}) {
      std::size_t found = 0, after = 0;
      for (const Line& line : sample)
        if (const auto field = lead_of(line.text, lead, after))
          found += read_calendar(field->text, DateOrder::day_first) ||
                   read_calendar(field->text, DateOrder::month_first);
      if (found * 4 < sample.size() * 3) continue;
      dialect.lead = lead;
      info.dialect.push_back(fmt::format("stamps in front of the lines, up to {}", lead));
      return;
    }
  }

  // Without a stamp in front.
  std::vector<Line> bare(const std::vector<Line>& lines) const {
    std::vector<Line> out = lines;
    std::size_t after = 0;
    for (Line& line : out)
      if (!dialect.lead.empty() && lead_of(line.text, dialect.lead, after))
        line.text.remove_prefix(after);
    return out;
  }

  // A delimiter that was given, and that leaves every line whole though its lines are no numbers.
  void refuse_wrong_delimiter() const {
    if (options.delimiter == "auto" || columns_ > 1) return;
    const auto odd = std::find_if(sample.begin() + 1, sample.end(), [&](const Line& line) {
      return !all_numeric(split(line.text, dialect.delimiter));
    });
    if (sample.size() < 2 || odd == sample.end()) return;
    const Candidate looks = candidates(sample).front();
    if (looks.columns < 2) return;
    fail(*odd,
         0,
         "E0304",
         fmt::format("with the delimiter {} the line is one field and not a number",
                     delimiter_name(dialect.delimiter)),
         std::string(odd->text),
         fmt::format("the file looks separated by {} ({} columns): leave `delimiter` out",
                     looks.delimiter == ','    ? "commas"
                     : looks.delimiter == ';'  ? "semicolons"
                     : looks.delimiter == '\t' ? "tabs"
                                               : "blanks",
                     looks.columns));
  }

  std::string sampled() const {
    return fmt::format("from the first {} line{}", sample.size(), sample.size() == 1 ? "" : "s");
  }

  // Excel's "sep=;" in the first line.
  void take_separator_line() {
    const std::string_view text = sample[0].text;
    if (text.size() != 5 || !text.starts_with("sep=")) return;
    if (options.delimiter == "auto") {
      dialect.delimiter = text[4];
      separator_said_ = true;
    }
    sample.erase(sample.begin());
    if (sample.empty()) no_data();
  }

  char given_decimal() const {
    if (options.decimal == "auto") return 0;
    if (options.decimal == "comma") return ',';
    if (options.decimal == "point") return '.';
    throw Error({ErrorKind::usage,
                 "E0202",
                 "`decimal`",
                 "unknown decimal mark",
                 options.decimal,
                 "use auto, point or comma"});
  }

  void choose_cells() {
    const std::vector<Line> lines = bare(sample);
    const bool given = separator_said_ || options.delimiter != "auto";
    const char delimiter = !given            ? '\0'
                           : separator_said_ ? dialect.delimiter
                                             : named_delimiter(options.delimiter);
    const std::vector<Candidate> all = candidates(lines, delimiter, given_decimal());
    const Candidate& best = all.front();
    columns_ = best.columns + (dialect.lead.empty() ? 0 : 1);
    dialect.decimal = best.decimal;
    dialect.delimiter = best.delimiter;
    if (best.columns < 2 && !given) dialect.delimiter = best.decimal == ',' ? ';' : ',';
    dialect.thousands = thousands_mark(lines, dialect.delimiter, dialect.decimal);
    if (given)
      info.dialect.push_back("delimiter " + delimiter_name(dialect.delimiter) +
                             (separator_said_ ? " (sep= in line 1)" : " (given)"));
    say_cells(all, given);
  }

  void say_cells(const std::vector<Candidate>& all, bool given) {
    const Candidate& best = all.front();
    const std::string name = delimiter_name(dialect.delimiter);
    if (!given && best.columns > 1) info.dialect.push_back("delimiter " + name);
    if (!given && best.columns > 1 && best.delimiter != ',')
      info.guesses.push_back("delimiter: " + name + ", " + sampled());
    if (options.decimal == "auto" && best.decimal == ',')
      info.guesses.push_back("decimal mark: comma, " + sampled());
    if (best.decimal == ',') info.dialect.push_back("decimal comma");
    const auto other = std::find_if(
        all.begin(), all.end(), [&](const Candidate& one) { return one.columns != best.columns; });
    constexpr double kTie = 0.85;
    if (other != all.end() && best.score > 0 && other->score >= kTie * best.score)
      info.guesses.push_back(
          fmt::format("{}; with a decimal {} it could be {} (`delimiter` and `decimal` decide)",
                      plural(best.columns, "column"),
                      other->decimal == ',' ? "comma" : "point",
                      other->columns));
    if (dialect.thousands != 0)
      info.guesses.push_back(
          fmt::format("thousands are separated by {}, {}",
                      dialect.thousands == ' ' ? "blanks" : std::string(1, dialect.thousands),
                      sampled()));
  }

  std::size_t cells_of(const std::vector<Field>& fields) const {
    const bool ends_empty =
        dialect.delimiter != ' ' && fields.back().text.empty() && !fields.back().quoted;
    return fields.size() - (ends_empty && fields.size() == columns_ + 1 ? 1 : 0);
  }

  bool all_numeric(const std::vector<Field>& fields) const {
    return std::all_of(fields.begin(), fields.end(), [&](const Field& f) {
      return read_sampled(f.text, style()).kind != Cell::bad;
    });
  }

  // With the header said to be there or not, lines in front of it have to be skipped by hand.
  void refuse_preamble() const {
    if (cells_of(cells(sample[0].text)) == columns_) return;
    for (std::size_t i = 1; i < sample.size(); ++i) {
      const auto fields = cells(sample[i].text);
      if (cells_of(fields) != columns_) continue;
      if (i == 1 && all_numeric(fields))
        return;  // a header with too few or too many names: told at the first row
      fail(sample[0],
           0,
           "E0303",
           fmt::format("{} line(s) before the table do not fit its {} columns",
                       sample[i].number - 1,
                       columns_),
           "",
           fmt::format("`skip_rows` {} leaves them out", sample[i].number - 1));
    }
  }

  // The cells of all lines of the sample, those of an empty end taken off.
  std::vector<Cells> sample_cells() const {
    std::vector<Cells> out;
    out.reserve(sample.size());
    for (const Line& line : sample) {
      out.push_back(cells(line.text));
      out.back().resize(cells_of(out.back()));
      fit_names(out.back(), line.text);
    }
    return out;
  }

  TableStart table_start() const {
    if (options.header == "yes") return {1, 0, {}};
    if (options.header == "no") return {0, {}, {}};
    const std::vector<Cells> lines = sample_cells();
    std::vector<Cells> body;
    for (std::size_t i = lines.size() / 2; i < lines.size(); ++i)
      if (lines[i].size() == columns_) body.push_back(lines[i]);
    return find_table_start(lines, column_kinds(body, columns_, style()), style());
  }

  void choose_header() {
    if (options.header != "auto" && options.header != "yes" && options.header != "no")
      throw Error({ErrorKind::usage,
                   "E0202",
                   "`header`",
                   "unknown header option",
                   options.header,
                   "use auto, yes or no"});
    if (options.header != "auto") refuse_preamble();
    const TableStart start = table_start();
    const std::size_t first = start.names ? *start.names : start.data;
    preamble_.assign(sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(first));
    if (first > 0)
      info.dialect.push_back(
          fmt::format("{} in front of the table left out", plural(first, "line")));
    const std::optional<Line> units =
        start.units ? std::optional(sample[*start.units]) : std::nullopt;
    const Line last_head = sample[start.data > 0 ? start.data - 1 : 0];
    sample.erase(sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(first));
    if (!start.names) {
      without_names();
      return;
    }
    use_header(sample[0],
               sample[0].text,
               sample[0].offset,
               last_head.after,
               last_head.number + last_head.lines);
    if (units) use_units(*units);
    sample.erase(sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(start.data - first));
  }

  void use_units(const Line& line) {
    const Cells fields = cells(line.text);
    for (std::size_t c = 0; c < std::min(fields.size(), dialect.columns.size()); ++c) {
      std::string_view unit = fields[c].text;
      if (unit.size() > 2 && ((unit.front() == '(' && unit.back() == ')') ||
                              (unit.front() == '[' && unit.back() == ']')))
        unit = trimmed(unit.substr(1, unit.size() - 2));
      if (unit != "TS" && unit != "RN" && unit != "Sequence" && unit.size() <= 40)
        dialect.columns[c].unit_below = decoded(std::string(unit)).value_or("");
    }
    info.dialect.push_back(fmt::format("units in line {}", line.number));
  }

  // Gyroflow's .gcsv holds counts: gx, gy, gz and ax, ay, az.
  void find_count_units() {
    for (const Line& line : preamble_)
      for (const auto& [key, axes, unit] :
           {std::tuple("gscale", 'g', "rad/s"), std::tuple("ascale", 'a', "g")})
        if (const auto count = stated_count(line.text, key))
          for (Column& column : dialect.columns)
            if (column.text.size() == 2 && column.text[0] == axes)
              column.unit_below = fmt::format("{} {}", shortest(*count), unit);
  }

  // "0.005 sec" and "21.3 °C": the unit behind the first number of a column is that of the column.
  void find_cell_units() {
    bool found = false;
    std::vector<bool> seen(dialect.columns.size(), false);
    for (const Line& line : sample) {
      if (line.offset < dialect.data_offset) continue;
      const Cells row = cells(line.text);
      for (std::size_t c = 0; c < std::min(row.size(), seen.size()); ++c) {
        if (seen[c] || read_styled(row[c].text, style()).kind == Cell::missing) continue;
        seen[c] = true;
        const auto measured = number_and_unit(row[c].text);
        if (!measured) continue;
        take_cell_unit(std::string(measured->unit), line, row[c], dialect.columns[c]);
        found = true;
      }
    }
    if (found) info.dialect.emplace_back("units behind the numbers");
  }

  void take_cell_unit(std::string unit, const Line& line, const Field& field, Column& column) {
    const std::string named = name_and_unit(column.text).second;
    const std::string& said = named.empty() ? column.unit_below : named;
    if (!said.empty() && !same_unit(said, unit))
      fail(line,
           field.offset,
           "E0333",
           fmt::format("a value in {}, and the header says {}",
                       printable(decoded(unit).value_or(unit), 20),
                       printable(said, 20)),
           field.text,
           "mend the one that is wrong");
    if (said.empty()) column.unit_below = decoded(unit).value_or("");
    column.cell_unit = std::move(unit);
  }

  void without_names() {
    const Line& first = sample[0];
    const auto fields = cells(first.text);
    dialect.data_offset = first.offset;
    dialect.first_data_line = first.number;
    if (options.header == "auto" && columns_ > 1 && !comments.empty() && header_in_comment())
      return;
    if (cells_of(fields) < fields.size() && !filled_cells(columns_, 1).empty()) ++columns_;
    const std::size_t count = cells_of(fields);
    for (std::size_t i = 0; i < count; ++i)
      dialect.columns.emplace_back().position = fields[i].offset + 1;
    name_by_labels();
    dialect.trailing_delimiter = fields.size() > count;
    if (dialect.trailing_delimiter) warn_trailing(first, fields.back().offset);
    info.dialect.push_back("no header");
    if (options.header == "auto" && !labelled_)
      info.warnings.add("no_header",
                        "no header line: the columns are named c0, c1… and the first line is data",
                        place_name(first.number, 1));
  }

  // "ax=0.01 ay=0.02", "ax: 0.01, ay: 0.02", "ax: 0.01 ay: 0.02": every cell, or the one in front of it, says its name.
  void name_by_labels() {
    const Cells first = cells(sample[0].text);
    for (std::size_t c = 0; c < dialect.columns.size(); ++c) {
      const std::string& text = first[c].text;
      const std::size_t length = label_length(text);
      const std::string_view before = c > 0 ? std::string_view(first[c - 1].text) : "";
      std::string_view name;
      if (length > 0)
        name = std::string_view(text).substr(0, text.find_first_of("=:"));
      else if (before.size() > 1 && (before.back() == ':' || before.back() == '=') &&
               label_length(std::string(before) + "0") > 0)
        name = before.substr(0, before.size() - 1);
      if (name.empty()) continue;
      dialect.columns[c].text = decoded(std::string(trimmed(name))).value_or("");
      labelled_ = true;
    }
    if (labelled_) info.dialect.emplace_back("names in front of the values");
  }

  // EuRoC writes "#timestamp [ns],w_RS_S_x [rad s^-1],…": the last comment before the data, when it
  // has as many cells.
  bool header_in_comment() {
    const Line& line = comments.back();
    std::string_view text = line.text;
    constexpr std::string_view kHeaders = "headers,";  // of Gulf Coast Data Concepts
    std::size_t sign = text.find_first_not_of(" \t#%/;");
    if (sign == std::string_view::npos) return false;
    text.remove_prefix(sign);
    if (ascii_lower(text.substr(0, kHeaders.size())) == kHeaders) {
      sign += kHeaders.size();
      text.remove_prefix(kHeaders.size());
    }
    auto fields = cells(text);
    if (cells_of(fields) != columns_ || all_numeric(fields)) return false;
    const std::size_t data = dialect.data_offset;
    const std::uint64_t data_line = dialect.first_data_line;
    use_header(line, text, line.offset + sign, data, data_line);
    return true;
  }

  void warn_trailing(const Line& line, std::size_t column) {
    info.warnings.add(
        "trailing_delimiter",
        "lines end with a delimiter: the empty last column is dropped",
        place_name(
            line.number,
            line.text.substr(0, column).find('\n') == std::string_view::npos ? column + 1 : 1));
  }

  void use_header(const Line& line,
                  std::string_view text,
                  std::size_t text_offset,
                  std::size_t data_offset,
                  std::uint64_t data_line) {
    dialect.has_header = true;
    dialect.header = std::string(text);
    dialect.data_offset = data_offset;
    dialect.first_data_line = data_line;
    info.dialect.push_back(fmt::format("header in line {}", line.number));
    bool open = false;
    auto fields = cells(text, &open);
    const std::size_t indent = text_offset - line.offset;
    if (open)
      fail(line,
           fields.back().offset + indent,
           "E0306",
           "a quote is opened here and never closed in the header");
    // The trailing delimiter may stand in the header, in the rows, or in both.
    const bool empty_last = fields.size() > 1 && fields.back().text.empty() &&
                            !fields.back().quoted && dialect.delimiter != ' ';
    bool rows_have_last = false, rows_end_empty = sample.size() > 1;
    for (std::size_t i = 1; i < sample.size(); ++i) {
      const auto row = cells(sample[i].text);
      rows_have_last =
          rows_have_last || (row.size() >= fields.size() && !row[fields.size() - 1].text.empty());
      rows_end_empty = rows_end_empty && row.size() == fields.size() + 1 && row.back().text.empty();
    }
    if (empty_last && !rows_have_last) {
      warn_trailing(line, fields.back().offset + indent);
      fields.pop_back();
      dialect.trailing_delimiter = true;
    } else if (rows_end_empty && dialect.delimiter != ' ') {
      warn_trailing(sample[1], cells(sample[1].text).back().offset);
      dialect.trailing_delimiter = true;
    }
    fit_names(fields, text);
    if (fields.size() > kMaxColumns)
      fail(
          line, 0, "E0305", fmt::format("{} columns, the limit is {}", fields.size(), kMaxColumns));
    std::size_t counted = 0, newline = std::string_view::npos;
    std::uint64_t lines = 0;
    for (const Field& field : fields) {
      for (; counted < field.offset; ++counted)
        if (text[counted] == '\n' || text[counted] == '\r') {
          newline = counted;
          lines += text[counted] == '\n';
        }
      const std::size_t column =
          newline == std::string_view::npos ? field.offset + indent : field.offset - newline - 1;
      Column& added = dialect.columns.emplace_back();
      added.text = header_text(field, line, indent);
      added.line = line.number + lines;
      added.position = column + 1;
    }
  }

  // Text of the header in UTF-8; nothing when it is not what it is said to be. What is not UTF-8 and does not begin with the mark of it
  // was written by an older Windows, as a rule.
  std::optional<std::string> decoded(const std::string& text) {
    const std::string& encoding = options.encoding;
    if (encoding == "latin1") return latin1_to_utf8(text);
    if (encoding == "cp1252") return windows1252_to_utf8(text);
    if (encoding != "auto" && encoding != "utf-8")
      throw Error({ErrorKind::usage,
                   "E0202",
                   "`encoding`",
                   "unknown encoding",
                   encoding,
                   "use auto, utf-8, latin1 or cp1252"});
    if (first_invalid_utf8(text) == std::string::npos) return text;
    if (encoding == "utf-8" || marked_utf8_) return std::nullopt;
    auto guessed = windows1252_to_utf8(text);
    if (guessed && !std::exchange(encoding_guessed_, true))
      info.guesses.emplace_back(
          "encoding: the header is not UTF-8 and read as Windows-1252 (`encoding` chooses)");
    return guessed;
  }

  std::string header_text(const Field& field, const Line& line, std::size_t indent) {
    if (field.text.size() > kMaxName)
      fail(line, field.offset + indent, "E0305", "channel name longer than 1024 bytes", field.text);
    if (auto text = decoded(field.text)) return *text;
    const std::size_t invalid = first_invalid_utf8(field.text);
    const std::size_t column = field.offset + (field.quoted ? 1 : 0) + indent +
                               (invalid == std::string::npos ? 0 : invalid);
    fail(line,
         column,
         "E0302",
         fmt::format("neither UTF-8 nor Windows-1252: byte 0x{:02X} at offset {}",
                     static_cast<unsigned char>(field.text[invalid]),
                     line.offset + column),
         field.text,
         "`encoding` latin1 takes every byte for the character of ISO 8859-1");
  }

  // LabVIEW names a column of comments that its rows do not have; R names no column of row numbers, which they do; names with commas in
  // them are known by the blanks behind those.
  void fit_names(Cells& fields, std::string_view text) const {
    if (options.header != "auto" || fields.size() == columns_) return;
    if (fields.size() == columns_ + 1 && fields.back().text == "Comment") fields.pop_back();
    if (fields.size() + 1 == columns_ && sample.size() > 1 &&
        std::all_of(fields.begin(), fields.end(), [](const Field& f) { return f.quoted; }) &&
        cells(sample[1].text)[0].quoted)
      fields.insert(fields.begin(), Field{"", 0, true});
    const auto joined = [&](const Field& field) {
      return field.offset > 0 && text[field.offset - 1] == ' ';
    };
    if (dialect.delimiter != ',' || fields.size() < columns_ ||
        columns_ + std::count_if(fields.begin(), fields.end(), joined) != fields.size())
      return;
    Cells out;
    for (const Field& field : fields)
      if (joined(field))
        out.back().text += ", " + field.text;
      else
        out.push_back(field);
    fields = std::move(out);
  }

  // Words, dates that are not the time, counts of the rows and columns with nothing in them are no channels.
  void leave_out() {
    std::vector<std::string> words, dates, counts;
    for (std::size_t c = 0; c < dialect.columns.size(); ++c) {
      Column& column = dialect.columns[c];
      const ColumnKind kind = c < kinds_.size() ? kinds_[c] : ColumnKind::number;
      const std::string name = column.name.empty() ? fmt::format("c{}", c) : column.name;
      const bool unnamed = dialect.has_header && (column.text.empty() || column.text == "#" ||
                                                  column.text.starts_with("Unnamed: "));
      const auto by_it = [&](const RowFilter& filter) {
        return filter.column == static_cast<int>(c) && !filter.must;
      };
      if (std::any_of(dialect.filters.begin(), dialect.filters.end(), by_it) ||
          static_cast<int>(c) == dialect.group_column) {
        column.left_out = true;
        continue;
      }
      const bool stamp = static_cast<int>(c) == dialect.time.column ||
                         static_cast<int>(c) == dialect.more_time.column;
      std::vector<std::string>* why = nullptr;
      if (stamp)
        continue;
      else if (kind == ColumnKind::text)
        why = &words;
      else if (kind == ColumnKind::calendar || kind == ColumnKind::date ||
               kind == ColumnKind::clock)
        why = &dates;
      else if (unnamed && (kind == ColumnKind::empty || (c == 0 && counts_rows(c))))
        why = &counts;
      if (why == nullptr && column.unnamed)
        info.warnings.add("unnamed_column",
                          "columns without a name are named by their position, c0, c1…",
                          place_name(column.line, column.position));
      if (why == nullptr) continue;
      column.left_out = true;
      why->push_back(name);
    }
    say_left_out("columns of words", words);
    say_left_out("columns of dates", dates);
    say_left_out("columns without a name that count the rows or hold nothing", counts);
  }

  void say_left_out(std::string_view what, const std::vector<std::string>& names) const {
    if (!names.empty())
      info.dialect.push_back(fmt::format("left out {}: {}", what, first_names(names)));
  }

  bool counts_rows(std::size_t column) const {
    std::optional<double> last;
    for (const Cells& row : rows_) {
      if (column >= row.size()) return false;
      const Cell cell = read_cell(row[column].text, '.');
      if (cell.kind != Cell::value || !cell.integer || (last && cell.number != *last + 1))
        return false;
      if (!last && cell.number != 0 && cell.number != 1) return false;
      last = cell.number;
    }
    return rows_.size() > 2;
  }

  // Of all rates that comments and preamble state, where they are one.
  std::optional<double> stated_rate() const {
    std::optional<double> rate;
    for (const auto* lines : {&comments, &preamble_})
      for (const Line& line : *lines)
        if (const auto stated = stated_rate_hz(line.text)) {
          if (rate && *rate != *stated) return std::nullopt;
          rate = stated;
        }
    return rate;
  }

  std::optional<double> stated_tick() const {
    for (const Line& line : preamble_)
      if (const auto stated = stated_count(line.text, "tscale")) return stated;
    return std::nullopt;
  }

  // The rows that are studied: the first ones, of those that are asked for.
  void gather_rows() {
    dialect.filters = filters_of(options, dialect, info);
    if (dialect.filters.empty()) {
      for (const Line& line : sample)
        if (line.offset >= dialect.data_offset) rows_.push_back(cells(line.text));
      return;
    }
    std::size_t offset = dialect.data_offset;
    while (offset < head.size() && rows_.size() < kSample) {
      const Line line = line_at(head, offset, 0);
      offset = line.after;
      Cells row = cells(line.text);
      if (std::all_of(dialect.filters.begin(), dialect.filters.end(), [&](const RowFilter& filter) {
            const auto column = static_cast<std::size_t>(filter.column);
            return column < row.size() && row[column].text == filter.value;
          }))
        rows_.push_back(std::move(row));
    }
  }

  // The cells of a column with something in them, as far as the head goes: rows of one cell.
  std::vector<Cells> filled_cells(std::size_t column, std::size_t most) const {
    std::vector<Cells> out;
    for (std::size_t offset = dialect.data_offset; offset < head.size() && out.size() < most;) {
      const Line line = line_at(head, offset, 0);
      offset = line.after;
      if (offset == head.size() && !whole) break;  // may be cut
      if (is_comment(line.text, dialect.lines.semicolon_comments)) continue;
      const auto cell = cell_at(line.text, column, dialect.delimiter);
      if (cell && read_cell(cell->text, '.').kind != Cell::missing) out.push_back({*cell});
    }
    return out;
  }

  // Columns that are empty in the first rows may have words, or numbers, further on.
  void find_kinds() {
    constexpr std::size_t kEnough = 8;
    kinds_ = column_kinds(rows_, dialect.columns.size(), style());
    for (std::size_t c = 0; c < kinds_.size() && rows_.size() >= kSample / 2; ++c)
      if (kinds_[c] == ColumnKind::empty && dialect.lead.empty()) {
        std::vector<Cells> later = filled_cells(c, kEnough);
        if (!later.empty()) later.push_back({Field{}});
        kinds_[c] = column_kinds(later, 1, style())[0];
      }
  }

  void choose_time() {
    gather_rows();
    find_kinds();
    if (rows_.empty() && !options.where.empty())
      throw Error({ErrorKind::usage,
                   "E0328",
                   info.file,
                   "no row has the value that is asked for",
                   options.where.front(),
                   "values are compared letter by letter"});
    if (!kinds_.empty() && std::all_of(kinds_.begin(), kinds_.end(), [](ColumnKind kind) {
          return kind == ColumnKind::text;
        }))
      fail(sample[0],
           0,
           "E0326",
           "no column holds numbers",
           std::string(sample[0].text),
           "`delimiter` says what separates the cells, `skip_rows` where the table begins");
    refuse_curve();
    const auto rate = stated_rate();
    const auto whole_head = [this](std::size_t column) {
      return filled_cells(column, std::numeric_limits<std::size_t>::max());
    };
    choose_stamps(
        {rows_, kinds_, style(), rate, stated_tick(), whole_head}, options, dialect, info);
    choose_groups(rows_, options, dialect, info);
    refuse_long_table(rows_, kinds_, options, dialect, info);
    leave_out();
    if (!rate || dialect.time.column >= 0 || info.time.rate_hz > 0) return;
    info.time.rate_hz = *rate;
    info.dialect.push_back(fmt::format(
        "rate {} Hz from {}", shortest(*rate), comments.empty() ? "the preamble" : "a comment"));
  }

  // Words in front of averaging times or frequencies: a table of curves, whose rows are no samples.
  void refuse_curve() const {
    static constexpr std::array<std::string_view, 5> kAbscissas = {
        "tau", "tau_s", "averaging_time_s", "frequency_hz", "freq_hz"};
    const bool words = std::find(kinds_.begin(), kinds_.end(), ColumnKind::text) != kinds_.end();
    const bool curve =
        std::any_of(dialect.columns.begin(), dialect.columns.end(), [](const auto& column) {
          const std::string name = ascii_lower(column.name);
          return std::find(kAbscissas.begin(), kAbscissas.end(), name) != kAbscissas.end() ||
                 std::find(kAbscissas.begin(), kAbscissas.end(), ascii_lower(column.text)) !=
                     kAbscissas.end();
        });
    if (words && curve && options.channels.empty())
      fail(sample[0],
           0,
           "E0326",
           "a table of curves, not of samples: words in front of averaging times or frequencies",
           std::string(sample[0].text),
           "`channels` reads only the columns named there");
  }

  [[noreturn]] void no_data() const {
    throw Error({ErrorKind::input,
                 "E0322",
                 at(info.file, 1, 1, 0),
                 "no data: the file holds only blank lines and comments"});
  }

  void run() {
    refuse_other_content(head, info.file);
    std::size_t offset = 0;
    std::uint64_t number = 1;
    if (head.substr(0, 3) == "\xEF\xBB\xBF") {
      offset = 3;
      marked_utf8_ = true;
      info.dialect.emplace_back("UTF-8 byte-order mark");
    }
    for (std::uint64_t i = 0; i < options.skip_rows && offset < head.size(); ++i) {
      const Line line = line_at(head, offset, number);
      number += line.lines;
      offset = line.after;
    }
    if (options.skip_rows > 0)
      info.dialect.push_back(fmt::format("{} lines skipped", options.skip_rows));
    Sample found = sample_lines(head, whole, offset, number, info.file);
    dialect.lines.semicolon_comments = found.semicolon_comments;
    sample = std::move(found.lines);
    comments = std::move(found.comments);
    if (sample.empty()) no_data();
    dialect.line_end = (comments.empty() ? sample[0] : comments[0]).end;
    take_separator_line();
    find_lead();
    choose_cells();
    refuse_wrong_delimiter();
    choose_header();
    if (dialect.columns.size() > kMaxColumns)
      fail(sample[0],
           0,
           "E0305",
           fmt::format("{} columns, the limit is {}", dialect.columns.size(), kMaxColumns));
    dialect.lines.quotes = head.find('"', dialect.data_offset) != std::string_view::npos;
    find_cell_units();
    find_count_units();
    name_columns(dialect, info);
    choose_time();
  }

 private:
  std::size_t columns_ = 1;
  bool separator_said_ = false, labelled_ = false;
  bool marked_utf8_ = false, encoding_guessed_ = false;
  std::vector<Line> preamble_;
  std::vector<Cells> rows_;  // the first ones
  std::vector<ColumnKind> kinds_;
};

}  // namespace

Dialect understand(std::string_view head, bool whole, const ReadOptions& options, LogInfo& info) {
  Study study(head, whole, options, info);
  study.run();
  return study.dialect;
}

}  // namespace libchar::csv
