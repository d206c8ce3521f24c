#include "libchar/log/csv/dialect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/units.hpp"
#include "libchar/core/utf8.hpp"
#include "libchar/log/csv/content.hpp"
#include "libchar/log/csv/delimiter.hpp"
#include "libchar/log/csv/header.hpp"
#include "libchar/log/csv/number.hpp"
#include "libchar/log/csv/sample.hpp"
#include "libchar/log/time/time_column.hpp"

namespace libchar::csv {
namespace {

// "2024-01-01…", "12:30…"
bool calendar(std::string_view text) {
  const auto digits = [&](std::size_t from, std::size_t n) {
    for (std::size_t i = from; i < from + n; ++i)
      if (i >= text.size() || !is_digit(text[i])) return false;
    return true;
  };
  return (digits(0, 4) && text.size() > 7 && (text[4] == '-' || text[4] == '/') && digits(5, 2)) ||
         (digits(0, 2) && text.size() > 5 && text[2] == ':' && digits(3, 2));
}

std::vector<std::vector<Field>> first_rows(const Dialect& dialect, const std::vector<Line>& lines) {
  std::vector<std::vector<Field>> rows;
  for (const Line& line : lines)
    if (line.offset >= dialect.data_offset) rows.push_back(split(line.text, dialect.delimiter));
  return rows;
}

FirstValues first_values(const std::vector<std::vector<Field>>& rows,
                         std::size_t column,
                         char decimal) {
  FirstValues first;
  for (const auto& row : rows) {
    if (column >= row.size()) continue;
    const std::string& text = row[column].text;
    const Cell cell = read_cell(text, decimal);
    if (cell.kind == Cell::value) first.values.push_back(cell.number);
    first.integers = first.integers && text.find_first_of(".,eE") == std::string::npos;
  }
  return first;
}

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

  // A delimiter that was given, and that leaves every line whole though its lines are no numbers.
  void refuse_wrong_delimiter() const {
    if (options.delimiter == "auto" || columns_ > 1) return;
    const auto odd = std::find_if(sample.begin() + 1, sample.end(), [&](const Line& line) {
      return !all_numeric(split(line.text, dialect.delimiter));
    });
    if (sample.size() < 2 || odd == sample.end()) return;
    const Score looks = best_score(sample);
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

  void choose_delimiter() {
    Score best;
    if (options.delimiter != "auto") {
      best = score(sample, named_delimiter(options.delimiter));
      info.dialect.push_back("delimiter " + delimiter_name(best.delimiter) + " (given)");
    } else {
      best = best_score(sample);
      if (best.columns > 1) {
        info.dialect.push_back("delimiter " + delimiter_name(best.delimiter));
        if (best.delimiter != ',')
          info.guesses.push_back("delimiter: " + delimiter_name(best.delimiter) + ", " + sampled());
      }
    }
    dialect.delimiter = best.delimiter;
    columns_ = best.columns;
  }

  void choose_decimal() {
    char mark = 0;
    if (options.decimal == "comma")
      mark = ',';
    else if (options.decimal == "point")
      mark = '.';
    else if (options.decimal != "auto")
      throw Error({ErrorKind::usage,
                   "E0202",
                   "`decimal`",
                   "unknown decimal mark",
                   options.decimal,
                   "use auto, point or comma"});
    if (mark == 0) {
      mark = decimal_mark(sample, dialect.delimiter);
      if (mark == ',') info.guesses.push_back("decimal mark: comma, " + sampled());
    }
    dialect.decimal = mark;
    if (dialect.decimal == ',') info.dialect.push_back("decimal comma");
  }

  std::size_t cells_of(const std::vector<Field>& fields) const {
    const bool ends_empty =
        dialect.delimiter != ' ' && fields.back().text.empty() && !fields.back().quoted;
    return fields.size() - (ends_empty && fields.size() == columns_ + 1 ? 1 : 0);
  }

  bool all_numeric(const std::vector<Field>& fields) const {
    return std::all_of(fields.begin(), fields.end(), [&](const Field& f) {
      return read_cell(f.text, dialect.decimal).kind != Cell::bad;
    });
  }

  // Lines in front that do not fit the table: say how many to skip rather than guess what they
  // mean.
  void refuse_preamble() const {
    if (cells_of(split(sample[0].text, dialect.delimiter)) == columns_) return;
    for (std::size_t i = 1; i < sample.size(); ++i) {
      const auto fields = split(sample[i].text, dialect.delimiter);
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

  void choose_header() {
    const Line& first = sample[0];
    const auto fields = split(first.text, dialect.delimiter);
    if (options.header != "auto" && options.header != "yes" && options.header != "no")
      throw Error({ErrorKind::usage,
                   "E0202",
                   "`header`",
                   "unknown header option",
                   options.header,
                   "use auto, yes or no"});
    const bool named =
        options.header == "yes" || (options.header == "auto" && !all_numeric(fields));
    if (named) {
      use_header(first, first.text, first.offset, first.after, first.number + first.lines);
      return;
    }
    dialect.data_offset = first.offset;
    dialect.first_data_line = first.number;
    if (options.header == "auto" && columns_ > 1 && !comments.empty() && header_in_comment())
      return;
    const std::size_t count = cells_of(fields);
    for (std::size_t i = 0; i < count; ++i)
      dialect.columns.push_back({"", "", "", 0, fields[i].offset + 1});
    dialect.trailing_delimiter = fields.size() > count;
    if (dialect.trailing_delimiter) warn_trailing(first, fields.back().offset);
    info.dialect.push_back("no header");
    if (options.header == "auto")
      info.warnings.add("no_header",
                        "no header line: the columns are named c0, c1… and the first line is data",
                        place_name(first.number, 1));
  }

  // EuRoC writes "#timestamp [ns],w_RS_S_x [rad s^-1],…": the last comment before the data, when it
  // has as many cells.
  bool header_in_comment() {
    const Line& line = comments.back();
    std::string_view text = line.text;
    const std::size_t sign = text.find_first_not_of(" \t#%/");
    if (sign == std::string_view::npos) return false;
    text.remove_prefix(sign);
    auto fields = split(text, dialect.delimiter);
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
    auto fields = split(text, dialect.delimiter, &open);
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
      const auto row = split(sample[i].text, dialect.delimiter);
      rows_have_last =
          rows_have_last || (row.size() >= fields.size() && !row[fields.size() - 1].text.empty());
      rows_end_empty = rows_end_empty && row.size() == fields.size() + 1 && row.back().text.empty();
    }
    if (empty_last && !rows_have_last) {
      warn_trailing(line, fields.back().offset + indent);
      fields.pop_back();
      dialect.trailing_delimiter = true;
    } else if (rows_end_empty && dialect.delimiter != ' ') {
      warn_trailing(sample[1], split(sample[1].text, dialect.delimiter).back().offset);
      dialect.trailing_delimiter = true;
    }
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
      dialect.columns.push_back(
          {"", "", header_text(field, line, indent), line.number + lines, column + 1});
    }
  }

  std::string header_text(const Field& field, const Line& line, std::size_t indent) const {
    if (options.encoding == "latin1") return latin1_to_utf8(field.text);
    if (options.encoding != "utf-8")
      throw Error({ErrorKind::usage,
                   "E0202",
                   "`encoding`",
                   "unknown encoding",
                   options.encoding,
                   "use utf-8 or latin1"});
    const std::size_t bad = first_invalid_utf8(field.text);
    const std::size_t column =
        field.offset + (field.quoted ? 1 : 0) + indent + (bad == std::string::npos ? 0 : bad);
    if (bad != std::string::npos)
      fail(line,
           column,
           "E0302",
           fmt::format("invalid UTF-8: byte 0x{:02X} at offset {}",
                       static_cast<unsigned char>(field.text[bad]),
                       line.offset + column),
           field.text,
           "`encoding` latin1 reads names written in ISO 8859-1");
    if (field.text.size() > kMaxName)
      fail(line, field.offset + indent, "E0305", "channel name longer than 1024 bytes", field.text);
    return field.text;
  }

  void choose_time() {
    const auto rows = first_rows(dialect, sample);
    TableFront table;
    for (const Column& column : dialect.columns) table.columns.push_back({column.text, ""});
    table.named = dialect.has_header;
    table.text = true;
    table.first_values = [&](std::size_t column) {
      return first_values(rows, column, dialect.decimal);
    };
    const auto index = find_time_column(table, options, info);
    if (!index) return;
    refuse_calendar(rows, *index);
    dialect.time_column = static_cast<int>(*index);
    dialect.time_unit_ns = find_time_unit(table, *index, options, info);
    const std::string& name = dialect.columns[*index].name;
    info.time.column = name.empty() ? fmt::format("c{}", *index) : name;
  }

  void refuse_calendar(const std::vector<std::vector<Field>>& rows, std::size_t column) const {
    if (rows.empty() || column >= rows[0].size() || !calendar(rows[0][column].text)) return;
    throw Error(
        {ErrorKind::input,
         "E0321",
         fmt::format("{}:{}:{}", info.file, dialect.first_data_line, rows[0][column].offset + 1),
         "calendar dates and clock times are not read as stamps, a number was expected",
         rows[0][column].text,
         "`time_column` none and `rate_hz` HZ with `channels` leave the column out, or convert "
         "it to seconds"});
  }

  void run() {
    refuse_other_content(head, info.file);
    std::size_t offset = 0;
    std::uint64_t number = 1;
    if (head.substr(0, 3) == "\xEF\xBB\xBF") {
      offset = 3;
      info.dialect.emplace_back("UTF-8 byte-order mark");
    }
    for (std::uint64_t i = 0; i < options.skip_rows && offset < head.size(); ++i) {
      const Line line = line_at(head, offset, number++);
      offset = line.after;
    }
    if (options.skip_rows > 0)
      info.dialect.push_back(fmt::format("{} lines skipped", options.skip_rows));
    Sample found = sample_lines(head, whole, offset, number, info.file);
    sample = std::move(found.lines);
    comments = std::move(found.comments);
    if (sample.empty())
      throw Error({ErrorKind::input,
                   "E0322",
                   at(info.file, 1, 1, 0),
                   "no data: the file holds only blank lines and comments",
                   "",
                   ""});
    dialect.line_end = (comments.empty() ? sample[0] : comments[0]).end;
    choose_delimiter();
    choose_decimal();
    refuse_wrong_delimiter();
    refuse_preamble();
    choose_header();
    if (dialect.columns.size() > kMaxColumns)
      fail(sample[0],
           0,
           "E0305",
           fmt::format("{} columns, the limit is {}", dialect.columns.size(), kMaxColumns));
    name_columns(dialect, info);
    choose_time();
    for (const Line& line : comments)
      if (!info.time.from_stamps && info.time.rate_hz == 0 && dialect.time_column < 0)
        read_rate_comment(line.text, info);
  }

 private:
  std::size_t columns_ = 1;
};

}  // namespace

Dialect understand(std::string_view head, bool whole, const ReadOptions& options, LogInfo& info) {
  Study study(head, whole, options, info);
  study.run();
  return study.dialect;
}

}  // namespace libchar::csv
