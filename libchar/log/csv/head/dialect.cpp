#include "libchar/log/csv/head/dialect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/csv/head/candidates.hpp"
#include "libchar/log/csv/head/first_lines.hpp"
#include "libchar/log/csv/head/header.hpp"
#include "libchar/log/csv/head/other_content.hpp"
#include "libchar/log/csv/head/sample.hpp"
#include "libchar/log/csv/head/study.hpp"
#include "libchar/log/csv/long_table.hpp"
#include "libchar/log/csv/rows/stamps.hpp"
#include "libchar/log/time/time_column.hpp"

namespace libchar::csv {
namespace {

// Lines.

void read_lines(Study& study) {
  std::size_t offset = 0;
  std::uint64_t number = 1;
  if (study.head.starts_with("\xEF\xBB\xBF")) {
    offset = 3;
    study.marked_utf8 = true;
    study.info.dialect.emplace_back("UTF-8 byte-order mark");
  }
  const std::uint64_t skipped = study.options.skip_rows;
  for (std::uint64_t i = 0; i < skipped && offset < study.head.size(); ++i) {
    const Line line = line_at(study.head, offset, number);
    number += line.lines;
    offset = line.after;
  }
  if (skipped > 0) study.info.dialect.push_back(fmt::format("{} lines skipped", skipped));
  Sample found = sample_lines(study.head, study.whole, offset, number, study.info.file);
  study.dialect.lines.semicolon_comments = found.semicolon_comments;
  study.sample = std::move(found.lines);
  study.comments = std::move(found.comments);
  study.later_comments = std::move(found.later_comments);
}

// Excel's "sep=;" in the first line; 0 where there is none.
char take_separator_line(Study& study) {
  if (study.sample.empty()) return 0;
  const std::string_view text = study.sample[0].text;
  if (text.size() != 5 || !text.starts_with("sep=")) return 0;
  study.sample.erase(study.sample.begin());
  return text[4];
}

void refuse_no_data(const Study& study) {
  if (!study.sample.empty()) return;
  throw input_error("E0322", at(study.info.file, 1, 1, 0))
      .says("no data: the file holds only blank lines and comments");
}

// "12:00:00.50 34,1305", "12:00:00.52 28,1302": of decimal numbers the digits behind the comma would change with those
// in front of it.
bool commas_divide(const std::vector<Line>& lines) {
  constexpr std::size_t kFewest = 10, kUnlike = 4;
  std::set<std::string_view> fronts, first_digits;
  std::size_t found = 0;
  for (const Line& line : lines) {
    const std::string_view text = trimmed(line.text);
    const std::size_t blank = text.rfind(' '), comma = text.find(',', std::min(blank, text.size()));
    if (comma == std::string_view::npos) continue;
    const std::string_view front = text.substr(blank + 1, comma - blank - 1), rest = text.substr(comma + 1);
    if (rest.size() < 2 || rest.find_first_not_of("0123456789") != rest.npos ||
        front.find_first_not_of("+-0123456789") != front.npos)
      return false;
    fronts.insert(front);
    first_digits.insert(rest.substr(0, 1));
    ++found;
  }
  return found >= kFewest && fronts.size() >= kUnlike && first_digits.size() == 1 && !first_digits.contains("0");
}

// Terminals and loggers put the time in front of every line: "[12:00:00.123] 1,2", "I (12345) tag: 1,2".
void find_lead(Study& study) {
  for (const std::string_view one : {"=", "]", "->", ")", ",", " "}) {
    const std::string lead(one == " " && commas_divide(study.sample) ? kDivided : one);
    std::size_t found = 0, after = 0;
    for (const Line& line : study.sample)
      if (const auto field = lead_of(line.text, lead, after); field && after < line.text.size())
        found += one == " " || read_calendar(field->text) ||
                 ((lead == "=" || lead == "]" || lead == ")") && read_cell(field->text, '.').kind == Cell::value);
    if (found * 4 < study.sample.size() * 3) continue;
    study.dialect.lead = lead;
    study.info.dialect.push_back(fmt::format("stamps before the lines, up to {}", lead == "="  ? "the first name"
                                                                                  : one == " " ? "the first cell"
                                                                                               : lead));
    return;
  }
}

// Cells.

char given_decimal(const ReadOptions& options) {
  if (options.decimal == "auto") return 0;
  if (options.decimal == "comma") return ',';
  if (options.decimal == "point") return '.';
  throw usage_error("E0202", "`decimal`")
      .says("unknown decimal mark")
      .got(options.decimal)
      .hint("use auto, point or comma");
}

// That of the options, or of the file itself; 0 where neither says one.
char given_delimiter(Study& study, char separator) {
  const bool given = study.options.delimiter != "auto";
  const char delimiter = given ? named_delimiter(study.options.delimiter) : separator;
  if (delimiter != 0)
    study.info.dialect.push_back("delimiter " + delimiter_name(delimiter) + (given ? " (given)" : " (sep= in line 1)"));
  return delimiter;
}

// What was found out of cells, and what else it could be.
void say_cells(Study& study, const std::vector<Candidate>& all, bool given) {
  LogInfo& info = study.info;
  const Candidate& best = all.front();
  const std::string sampled = "from the first " + plural(study.sample.size(), "line");
  const std::string name = delimiter_name(study.dialect.delimiter);
  if (!given && best.columns > 1) info.dialect.push_back("delimiter " + name);
  if (!given && best.columns > 1 && best.delimiter != ',')
    info.guesses.push_back(fmt::format("delimiter: {}, {}", name, sampled));
  if (study.options.decimal == "auto" && best.decimal == ',') info.guesses.push_back("decimal mark: comma, " + sampled);
  if (best.decimal == ',') info.dialect.emplace_back("decimal comma");
  constexpr double kTie = 0.7;
  for (const Candidate& other : all) {
    if (other.columns == best.columns || other.score <= 0 || other.score < kTie * best.score) continue;
    info.guesses.push_back(fmt::format("{}; with a decimal {} it could be {} (`delimiter` and `decimal` decide)",
                                       plural(best.columns, "column"), other.decimal == ',' ? "comma" : "point",
                                       other.columns));
    break;
  }
  if (const char mark = study.dialect.thousands; mark != 0)
    info.guesses.push_back(
        fmt::format("thousands are separated by {}, {}", mark == ' ' ? "blanks" : std::string(1, mark), sampled));
}

// A delimiter that was given, and that leaves every line whole though its lines are no numbers.
void refuse_wrong_delimiter(const Study& study, const std::vector<Line>& lines) {
  if (study.options.delimiter == "auto" || study.columns > 1 || lines.size() < 2) return;
  const auto odd = std::find_if(lines.begin() + 1, lines.end(), [&](const Line& line) {
    const Cells cells = split(line.text, study.dialect.delimiter);
    return cell_kind(cells[0], study.style()) > CellKind::number;
  });
  const Candidate looks = candidates(lines).front();
  if (odd == lines.end() || looks.columns < 2) return;
  throw refusal(study, *odd, 0, "E0304")
      .says("with the delimiter {} the line is one field and not a number", delimiter_name(study.dialect.delimiter))
      .got(std::string(odd->text))
      .hint("the file looks separated by {} ({} columns): leave `delimiter` out", delimiter_name(looks.delimiter),
            looks.columns);
}

void choose_cells(Study& study, char separator) {
  std::vector<Line> lines = study.sample;
  std::size_t after = 0;
  for (Line& line : lines)
    if (!study.dialect.lead.empty() && lead_of(line.text, study.dialect.lead, after)) line.text.remove_prefix(after);
  const char given = given_delimiter(study, separator);
  const std::vector<Candidate> all = candidates(lines, given, given_decimal(study.options));
  const Candidate& best = all.front();
  study.columns = best.columns + (study.dialect.lead.empty() ? 0 : 1);
  study.dialect.decimal = best.decimal;
  study.dialect.delimiter = best.delimiter;
  if (best.columns < 2 && given == 0)
    study.dialect.delimiter = best.decimal == ',' || best.delimiter == ';' ? ';' : ',';
  study.dialect.thousands = thousands_mark(lines, study.dialect.delimiter, best.decimal);
  say_cells(study, all, given != 0);
  refuse_wrong_delimiter(study, lines);
}

// Where the table begins.

// "Table Mountain, CO" above rows of twelve numbers between blanks: words of a sentence, of which none is a time.
bool is_title(const Study& study, const Cells& names) {
  return study.dialect.delimiter == ' ' && study.dialect.lead.empty() && names.size() + 1 < study.columns &&
         std::none_of(names.begin(), names.end(), [](const Field& field) { return called_time(field.text); });
}

TableStart table_start(const Study& study) {
  std::vector<Cells> lines, body;
  for (const Line& line : study.sample) lines.push_back(table_cells(study, line.text));
  constexpr std::size_t kCells = 2048, kFewest = 8;  // of the last lines, which say the kinds as well
  const std::size_t most = std::max(kFewest, kCells / std::max<std::size_t>(study.columns, 1));
  for (std::size_t i = std::max(lines.size() / 2, lines.size() - std::min(lines.size(), most)); i < lines.size(); ++i)
    if (lines[i].size() == study.columns) body.push_back(lines[i]);
  TableStart start = find_table_start(lines, column_kinds(body, study.columns, study.style()), study.style());
  if (study.options.header == "no") return {start.data, {}, {}};
  if (study.options.header == "yes" && !start.names) return {start.data + 1, start.data, {}};
  if (start.names && is_title(study, lines[*start.names])) start.names.reset();
  return start;
}

void choose_header(Study& study) {
  const std::string& option = study.options.header;
  if (option != "auto" && option != "yes" && option != "no")
    throw usage_error("E0202", "`header`").says("unknown header option").got(option).hint("use auto, yes or no");
  if (option == "auto" &&
      (named_by_daemon(study) || begins_with_rate(study) || named_by_signal_express(study) || named_by_yokogawa(study)))
    return;
  TableStart start = table_start(study);
  const std::vector<Line> lines = study.sample;
  if (!start.names) start.data = std::min(start.data, lines.size() - 1);
  const std::size_t first = start.names.value_or(start.data);
  const auto place = [](std::size_t i) { return static_cast<std::ptrdiff_t>(i); };
  study.preamble.assign(lines.begin(), lines.begin() + place(first));
  study.sample.erase(study.sample.begin(), study.sample.begin() + place(first));
  if (first > 0) study.info.dialect.push_back(fmt::format("{} before the table left out", plural(first, "line")));
  const Line& above = lines[start.data - (start.names ? 1 : 0)];
  study.dialect.data_offset = start.names ? above.after : above.offset;
  study.dialect.first_data_line = above.number + (start.names ? above.lines : 0);
  for (const Line& line : study.later_comments)
    if (line.offset < study.dialect.data_offset) study.comments.push_back(line);
  if (!start.names) return do_without_names(study);
  read_names(study, lines[first], lines[first].text);
  if (start.units) read_units(study, lines[*start.units]);
  study.sample.erase(study.sample.begin(), study.sample.begin() + place(start.data - first));
}

// Columns.

bool counts_rows(const Study& study, std::size_t column) {
  std::optional<double> last;
  for (const Cells& row : study.rows) {
    if (column >= row.size()) return false;
    const Cell cell = read_cell(row[column].text, '.');
    if (cell.kind != Cell::value || !cell.integer || (last && cell.number != *last + 1)) return false;
    if (!last && cell.number != 0 && cell.number != 1) return false;
    last = cell.number;
  }
  return study.rows.size() > 2;
}

enum class LeftOut { none, chosen, words, dates, clocks, others, counts };

// Words, dates that are not the time, counts of the rows and columns with nothing in them are no channels, nor are
// stamps of others (`clocks`: their names).
LeftOut why_left_out(const Study& study, const std::set<std::string_view>& clocks, std::size_t c) {
  const Dialect& dialect = study.dialect;
  const Column& column = dialect.columns[c];
  const int index = static_cast<int>(c);
  const ColumnKind kind = c < study.kinds.size() ? study.kinds[c] : ColumnKind::number;
  const bool filter = std::any_of(dialect.filters.begin(), dialect.filters.end(),
                                  [&](const RowFilter& one) { return one.column == index && !one.must; });
  if (filter || index == dialect.group_column) return LeftOut::chosen;
  if (index == dialect.time.column || index == dialect.more_time.column) return LeftOut::none;
  if (kind == ColumnKind::text) return LeftOut::words;
  if (kind == ColumnKind::calendar || kind == ColumnKind::date || kind == ColumnKind::clock) return LeftOut::dates;
  if (clocks.count(column.name) > 0) return LeftOut::others;
  if (column.clock) return LeftOut::clocks;
  const bool unnamed =
      dialect.has_header && (column.text.empty() || column.text == "#" || column.text.starts_with("Unnamed: "));
  const bool counts = kind == ColumnKind::empty || (c == 0 && counts_rows(study, c));
  const bool led = c == 0 && !dialect.lead.empty() && kind == ColumnKind::empty;
  return led || (unnamed && counts) ? LeftOut::counts : LeftOut::none;
}

void leave_out(Study& study) {
  std::map<LeftOut, std::vector<std::string>> names;
  std::set<std::string_view> clocks;
  for (const Column& column : study.dialect.columns)
    if (!column.own_clock.empty()) clocks.insert(column.own_clock);
  for (std::size_t c = 0; c < study.dialect.columns.size(); ++c) {
    Column& column = study.dialect.columns[c];
    const LeftOut why = why_left_out(study, clocks, c);
    column.left_out = why != LeftOut::none;
    names[why].push_back(column.name.empty() ? fmt::format("c{}", c) : column.name);
    if (why == LeftOut::none && column.unnamed && static_cast<int>(c) != study.dialect.time.column &&
        static_cast<int>(c) != study.dialect.more_time.column)
      study.info.warnings.add("unnamed_column", "columns without a name are named by their position, c0, c1…",
                              place_name(column.line, column.position));
  }
  for (const auto& [why, what] :
       {std::pair(LeftOut::words, "columns of words"), std::pair(LeftOut::dates, "columns of dates"),
        std::pair(LeftOut::clocks, "columns that repeat the clock"),
        std::pair(LeftOut::others, "stamps of channels behind them"),
        std::pair(LeftOut::counts, "columns without a name that count the rows or hold nothing")})
    if (!names[why].empty())
      study.info.dialect.push_back(fmt::format("left out {}: {}", what, first_names(names[why])));
}

// Of all rates that comments and preamble state, where they are one.
std::optional<double> stated_rate(const Study& study) {
  std::optional<double> rate = study.rate_hz;
  for (const auto* lines : {&study.comments, &study.preamble})
    for (const Line& line : *lines)
      if (const auto stated = stated_rate_hz(line.text)) {
        if (rate && *rate != *stated) return std::nullopt;
        rate = stated;
      }
  return rate;
}

std::optional<double> stated_tick(const Study& study) {
  for (const Line& line : study.preamble)
    if (const auto stated = stated_count(line.text, "tscale")) return stated;
  return std::nullopt;
}

// The rows that are studied: the first ones, of those that are asked for.
void gather_rows(Study& study) {
  study.dialect.filters = filters_of(study.options, study.dialect, study.info);
  const auto& filters = study.dialect.filters;
  std::size_t most = kSample;
  if (filters.empty()) {
    for (const Line& line : study.sample)
      if (line.offset >= study.dialect.data_offset) study.rows.push_back(cells_in(study.dialect, line.text));
    if (study.options.kinds.group_by.empty()) return;
    most = 64 * kSample;
  }
  const std::vector<Cells> first = std::exchange(study.rows, {});
  std::size_t offset = study.dialect.data_offset;
  while (offset < study.head.size() && study.rows.size() < most) {
    const Line line = line_at(study.head, offset, 0);
    offset = line.after;
    Cells row = cells_in(study.dialect, line.text);
    if (std::all_of(filters.begin(), filters.end(), [&](const RowFilter& filter) {
          const auto column = static_cast<std::size_t>(filter.column);
          return column < row.size() && row[column].text == filter.value;
        }))
      study.rows.push_back(std::move(row));
  }
  if (study.rows.empty())
    throw usage_error("E0328", study.info.file)
        .says("no row has the value that is asked for")
        .got(study.options.kinds.where.front())
        .hint("values are compared letter by letter");
  if (filters.empty() && !more_groups(first, study.rows, study.options, study.dialect, study.info)) study.rows = first;
}

// All columns hold words; or all but that of the stamps, and they are numbers in another notation.
void refuse_words(const Study& study) {
  const auto hexadecimal = [](const auto& field) {
    return field.text.starts_with("0x") || field.text.starts_with("0X");
  };
  const bool any = !study.rows.empty() && std::any_of(study.rows[0].begin(), study.rows[0].end(), hexadecimal);
  const bool but_time = any && study.options.channels.empty();
  bool words = !study.kinds.empty();
  for (std::size_t c = 0; c < study.kinds.size(); ++c)
    words = words && (study.kinds[c] == ColumnKind::text || (but_time && called_time(study.dialect.columns[c].text)));
  if (!words) return;
  throw refusal(study, study.sample[0], 0, "E0326")
      .says("no column holds numbers")
      .got(std::string(study.sample[0].text))
      .hint(any ? kHexadecimal : "`delimiter` says what separates the cells, `skip_rows` where the table begins");
}

// Columns that are empty in the first rows may have words, or numbers, further on.
void find_kinds(Study& study) {
  constexpr std::size_t kEnough = 8;
  study.kinds = column_kinds(study.rows, study.dialect.columns.size(), study.style());
  std::vector<std::size_t> empty;
  for (std::size_t c = 0; c < study.kinds.size() && study.rows.size() >= kSample / 4; ++c)
    if (study.kinds[c] == ColumnKind::empty) empty.push_back(c);
  std::vector<std::vector<Cells>> later = filled_cells(study, empty, kEnough);
  for (std::size_t k = 0; k < empty.size(); ++k) {
    if (!later[k].empty()) later[k].push_back({Field{}});
    study.kinds[empty[k]] = column_kinds(later[k], 1, study.style())[0];
  }
  for (std::size_t c = 0; c < study.kinds.size(); ++c)
    if (study.dialect.columns[c].words) study.kinds[c] = ColumnKind::text;
  refuse_words(study);
}

// "1.30, 1.31, 1.29, …": the samples of one channel, as instruments send them.
void refuse_one_row(const Study& study) {
  constexpr std::size_t kMany = 100;
  if (!study.whole || study.sample.size() != 1 || study.dialect.has_header || study.columns < kMany) return;
  throw refusal(study, study.sample[0], 0, "E0326")
      .says("one row of {} numbers, which are samples of one channel", study.columns)
      .hint("write each into a line: tr '{}' '\\n' < FILE > log.csv", study.dialect.delimiter);
}

// Words in front of averaging times or frequencies: a table of curves, whose rows are no samples.
void refuse_curve(const Study& study) {
  static constexpr std::array<std::string_view, 5> kAbscissas = {"tau", "tau_s", "averaging_time_s", "frequency_hz",
                                                                 "freq_hz"};
  const auto abscissa = [](const std::string& name) {
    return std::find(kAbscissas.begin(), kAbscissas.end(), ascii_lower(name)) != kAbscissas.end();
  };
  const auto& columns = study.dialect.columns;
  if (std::find(study.kinds.begin(), study.kinds.end(), ColumnKind::text) != study.kinds.end() &&
      study.options.channels.empty() && std::any_of(columns.begin(), columns.end(), [&](const Column& column) {
        return abscissa(column.name) || abscissa(column.text);
      }))
    throw refusal(study, study.sample[0], 0, "E0326")
        .says("a table of curves, not of samples: words before averaging times or frequencies")
        .got(std::string(study.sample[0].text))
        .hint("`channels` reads only the columns named there");
}

// Without a rate: what the lines in front of the table say of one, for whoever types it.
void say_facts_of_time(Study& study) {
  std::vector<std::string> said;
  for (const auto* lines : {&study.comments, &study.preamble})
    for (const Line& line : *lines)
      if (speaks_of_time(line.text)) said.push_back(fmt::format("\"{}\"", printable(line.text, 80)));
  if (!said.empty() && !study.options.rate_hz)
    study.info.guesses.push_back("no rate in what the lines before the table say: " + first_names(said));
}

void choose_time(Study& study) {
  LogInfo& info = study.info;
  const auto rate = stated_rate(study);
  constexpr std::size_t kMostLooks = 64;  // each reads the whole head, and a wide table has many columns like clocks
  const auto all_cells = [&study, looks = std::size_t{0}](std::size_t column) mutable {
    if (++looks > kMostLooks) return std::vector<Cells>();
    std::vector<Cells> all = filled_cells(study, {column}, std::numeric_limits<std::size_t>::max())[0];
    for (Cells& cells : cells_further_on(study, column)) all.push_back(std::move(cells));
    return all;
  };
  choose_stamps({study.rows, study.kinds, study.style(), rate, stated_tick(study), all_cells}, study.options,
                study.dialect, info);
  std::optional<Stretches> places;
  const RowsOfFile all = [&]() -> const Stretches& {
    if (!places) places = stretches_of(study);
    return *places;
  };
  choose_groups(study.rows, all, study.options, study.dialect, info);
  refuse_long_table(study.rows, all, study.kinds, study.options, study.dialect, info);
  if (study.dialect.time.column >= 0 && rate) info.time.rate_hz = *rate;  // decides what the stamps leave open
  if (study.dialect.time.column >= 0 || info.time.rate_hz > 0) return;
  if (!rate) return say_facts_of_time(study);
  info.time.rate_hz = *rate;
  info.dialect.push_back(
      fmt::format("rate {} Hz from {}", shortest(*rate), study.comments.empty() ? "the preamble" : "a comment"));
}

}  // namespace

Dialect understand(std::string_view head, bool whole, const ReadOptions& options, LogInfo& info) {
  refuse_other_content(head, info.file);
  Study study{.head = head, .whole = whole, .options = options, .info = info};
  read_lines(study);
  const char separator = take_separator_line(study);
  refuse_no_data(study);
  take_scope_settings(study);
  take_rate_of_nexus(study);
  study.dialect.line_end = (study.comments.empty() ? study.sample : study.comments)[0].end;
  find_lead(study);
  choose_cells(study, separator);
  choose_header(study);
  study.dialect.lines.quotes = head.find('"', study.dialect.data_offset) != std::string_view::npos;
  find_other_units(study);
  name_columns(study.dialect, info);
  gather_rows(study);
  find_kinds(study);
  refuse_curve(study);
  refuse_one_row(study);
  choose_time(study);
  leave_out(study);
  return study.dialect;
}

}  // namespace libchar::csv
