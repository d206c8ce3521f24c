#include "libchar/log/csv_dialect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "libchar/core/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/log/csv_header.hpp"
#include "libchar/log/csv_number.hpp"

namespace libchar::csv {
namespace {

constexpr std::size_t kSample = 100;  // lines studied

struct Line {
  std::string_view text;
  std::size_t offset = 0;    ///< in the head
  std::uint64_t number = 1;  ///< physical line
  std::size_t after = 0;     ///< offset behind its line end
  std::uint64_t lines = 1;   ///< physical lines it spans (a quoted header may hold newlines)
  LineEnd end = LineEnd::none;
};

// The physical line at `offset`. A line that reaches the end of a head that is not the whole file
// is cut.
Line line_at(std::string_view head, std::size_t offset, std::uint64_t number) {
  Line line;
  line.offset = offset;
  line.number = number;
  const std::size_t end = head.find_first_of("\r\n", offset);
  if (end == std::string_view::npos) {
    line.text = head.substr(offset);
    line.after = head.size();
    return line;
  }
  line.text = head.substr(offset, end - offset);
  const bool pair = head[end] == '\r' && end + 1 < head.size() && head[end + 1] == '\n';
  line.end = pair ? LineEnd::crlf : head[end] == '\r' ? LineEnd::cr : LineEnd::lf;
  line.after = end + (pair ? 2 : 1);
  return line;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

bool numeric(const Field& field, char delimiter, char* mark = nullptr) {
  if (read_cell(field.text, '.').kind != Cell::bad) {
    if (mark != nullptr && field.text.find('.') != std::string::npos) *mark = '.';
    return true;
  }
  if (delimiter == ',' && !field.quoted) return false;
  if (read_cell(field.text, ',').kind == Cell::bad) return false;
  if (mark != nullptr) *mark = ',';
  return true;
}

// How well a delimiter explains the sample: share of lines with the commonest number of cells,
// share of numeric cells.
struct Score {
  char delimiter = ',';
  std::size_t columns = 1;
  double quality = 0;
};

Score score(const std::vector<Line>& lines, char delimiter) {
  std::vector<std::size_t> counts;
  std::size_t cells = 0, numbers = 0;
  for (const Line& line : lines) {
    const auto fields = split(line.text, delimiter);
    std::size_t n = fields.size();
    if (n > 1 && fields.back().text.empty() && !fields.back().quoted && delimiter != ' ') --n;
    counts.push_back(n);
    for (const Field& field : fields) {
      ++cells;
      numbers += numeric(field, delimiter);
    }
  }
  Score result{delimiter, 1, 0};
  if (counts.empty()) return result;
  std::vector<std::size_t> sorted = counts;
  std::sort(sorted.begin(), sorted.end());
  std::size_t best = 0;
  for (std::size_t i = 0; i < sorted.size();) {
    const std::size_t run =
        static_cast<std::size_t>(std::upper_bound(sorted.begin(), sorted.end(), sorted[i]) -
                                 sorted.begin()) -
        i;
    if (run >= best) {
      best = run;
      result.columns = sorted[i];
    }
    i += run;
  }
  const double consistent = static_cast<double>(best) / static_cast<double>(counts.size());
  result.quality =
      result.columns < 2
          ? 0
          : consistent * (0.05 + static_cast<double>(numbers) / static_cast<double>(cells));
  return result;
}

char named_delimiter(const std::string& name) {
  if (name == "tab" || name == "\\t" || name == "\t") return '\t';
  if (name == "space" || name == " ") return ' ';
  if (name.size() == 1 && !is_digit(name[0]) && name[0] != '"' && name[0] != '\r' &&
      name[0] != '\n' && name[0] != '-' && name[0] != '+')
    return name[0];
  throw Error({ErrorKind::usage,
               "",
               "",
               "unknown delimiter",
               name,
               "use auto, tab, space, or one character such as , or ;"});
}

std::string delimiter_name(char delimiter) {
  if (delimiter == '\t') return "tab";
  if (delimiter == ' ') return "blanks";
  return std::string(1, delimiter);
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

  void refuse_other_content() const {
    const auto begins = [&](std::string_view magic) {
      return head.substr(0, magic.size()) == magic;
    };
    const char* what = nullptr;
    const char* hint = "";
    if (head.empty())
      throw Error({ErrorKind::input, "E0322", at(info.file, 1, 1, 0), "the file is empty", "", ""});
    if (begins("\x93NUMPY"))
      what = "content is a NumPy array (NPY), not CSV", hint = "read it with --format npy";
    else if (begins("\x1F\x8B"))
      what = "content is compressed (gzip), not CSV", hint = "unpack it first: gunzip";
    else if (begins("PK\x03\x04"))
      what = "content is a ZIP archive (XLSX or NPZ?), not CSV",
      hint = "unpack it, or export it as CSV";
    else if (begins("\x28\xB5\x2F\xFD"))
      what = "content is compressed (zstd), not CSV", hint = "unpack it first: unzstd";
    else if (begins("BZh"))
      what = "content is compressed (bzip2), not CSV", hint = "unpack it first: bunzip2";
    else if (begins("\xFF\xFE") || begins("\xFE\xFF"))
      what = "content is UTF-16, not UTF-8", hint = "convert it: iconv -f utf-16 -t utf-8";
    else if (begins("\x89HDF"))
      what = "content is HDF5, not CSV", hint = "export it as CSV or .npy";
    if (what != nullptr)
      throw Error({ErrorKind::input, "E0301", at(info.file, 1, 1, 0), what, "", hint});
    if (head.size() >= 4 && ((head[0] == 0) != (head[1] == 0)) &&
        ((head[2] == 0) != (head[3] == 0)) && head[0] == head[2 * (head[0] == 0)])
      throw Error({ErrorKind::input,
                   "E0301",
                   at(info.file, 1, 1, 0),
                   "content is UTF-16, not UTF-8",
                   "",
                   "convert it: iconv -f utf-16 -t utf-8"});
  }

  // Text has next to no control characters; NUL bytes are left to the row parser, which knows logs that a power failure cut.
  void refuse_binary() const {
    std::size_t controls = 0, others = 0, first = 0;
    for (std::size_t i = 0; i < std::min<std::size_t>(head.size(), 4096); ++i) {
      const auto byte = static_cast<unsigned char>(head[i]);
      if (byte == 0) continue;
      const bool control = byte < 0x20 && std::string_view("\t\n\v\f\r\x1A").find(head[i]) == std::string_view::npos;
      if (control && controls++ == 0) first = i;
      ++others;
    }
    if (controls < 2 || controls * 50 < others) return;
    std::size_t line = 1, column = 1;
    for (std::size_t i = 0; i < first; ++i, ++column)
      if (head[i] == '\n') ++line, column = 0;
    throw Error({ErrorKind::input,
                 "E0301",
                 at(info.file, line, column, first),
                 fmt::format("content is binary, not text: {} control characters in the first {} bytes",
                             controls,
                             std::min<std::size_t>(head.size(), 4096)),
                 "",
                 "--format raw with a sidecar reads raw binary (docs: raw binary)"});
  }

  // A delimiter that was given, and that leaves every line whole though its lines are no numbers.
  void refuse_wrong_delimiter() const {
    if (options.delimiter == "auto" || columns_ > 1) return;
    const auto odd = std::find_if(sample.begin() + 1, sample.end(), [&](const Line& line) {
      return !all_numeric(split(line.text, dialect.delimiter));
    });
    if (sample.size() < 2 || odd == sample.end()) return;
    const Score looks = best_score();
    if (looks.columns < 2) return;
    fail(*odd,
         0,
         "E0304",
         fmt::format("with the delimiter {} the line is one field and not a number",
                     delimiter_name(dialect.delimiter)),
         std::string(odd->text),
         fmt::format("the file looks separated by {} ({} columns): leave --delimiter out",
                     looks.delimiter == ',' ? "commas" : looks.delimiter == ';' ? "semicolons" : looks.delimiter == '\t' ? "tabs" : "blanks",
                     looks.columns));
  }

  // Lines to study, comments before the data, and the offset and number of the first line used.
  void collect(std::size_t offset, std::uint64_t number) {
    bool complete_only = !whole;
    while (offset < head.size() && sample.size() < kSample) {
      Line line = line_at(head, offset, number);
      if (line.end == LineEnd::none && complete_only) {
        if (sample.empty())  // else the row parser tells
          fail(line,
               0,
               "E0305",
               "line longer than 1 MiB",
               "",
               "is this a text file with line ends?");
        break;
      }
      const std::string_view text = trimmed(line.text);
      if (sample.empty() && is_comment(text)) {
        comments.push_back(line);
      } else if (!text.empty() && !is_comment(text)) {
        if (sample.empty()) join_quoted_lines(line);
        sample.push_back(line);
      }
      offset = line.after;
      number += line.lines;
    }
  }

  // A header may hold newlines inside quotes: the line goes on until its quotes are closed.
  void join_quoted_lines(Line& line) const {
    const auto open = [](std::string_view text) {
      return std::count(text.begin(), text.end(), '"') % 2 != 0;
    };
    if (!open(line.text)) return;
    Line longer = line;
    while (open(longer.text) && longer.after < head.size() && longer.text.size() < kMaxField) {
      const Line next = line_at(head, longer.after, 0);
      longer.text = head.substr(longer.offset, next.offset + next.text.size() - longer.offset);
      longer.after = next.after;
      longer.end = next.end;
      ++longer.lines;
    }
    if (!open(longer.text)) line = longer;
  }

  std::string sampled() const {
    return fmt::format("from the first {} line{}", sample.size(), sample.size() == 1 ? "" : "s");
  }

  Score best_score() const {
    Score best;
    for (const char candidate : {',', ';', '\t', ' '}) {
      const Score s = score(sample, candidate);
      if (s.quality > best.quality + 1e-9) best = s;
    }
    return best;
  }

  void choose_delimiter() {
    Score best;
    if (options.delimiter != "auto") {
      best = score(sample, named_delimiter(options.delimiter));
      info.dialect.push_back("delimiter " + delimiter_name(best.delimiter) + " (given)");
    } else {
      best = best_score();
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
                   "",
                   "",
                   "unknown decimal mark",
                   options.decimal,
                   "use auto, point or comma"});
    if (mark == 0) {
      std::size_t commas = 0, points = 0;
      for (const Line& line : sample)
        for (const Field& field : split(line.text, dialect.delimiter)) {
          char found = 0;
          if (numeric(field, dialect.delimiter, &found)) {
            commas += found == ',';
            points += found == '.';
          }
        }
      if (commas > points) {
        mark = ',';
        info.guesses.push_back("decimal mark: comma, " + sampled());
      }
    }
    dialect.decimal = mark == 0 ? '.' : mark;
    if (dialect.decimal == ',') info.dialect.push_back("decimal comma");
  }

  std::size_t cells_of(const std::vector<Field>& fields) const {
    const bool ends_empty = fields.size() > 1 && dialect.delimiter != ' ' &&
                            fields.back().text.empty() && !fields.back().quoted;
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
           fmt::format("--skip-rows {} leaves them out", sample[i].number - 1));
    }
  }

  void choose_header() {
    const Line& first = sample[0];
    const auto fields = split(first.text, dialect.delimiter);
    if (options.header != "auto" && options.header != "yes" && options.header != "no")
      throw Error({ErrorKind::usage,
                   "",
                   "",
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
      throw Error(
          {ErrorKind::usage, "", "", "unknown encoding", options.encoding, "use utf-8 or latin1"});
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
           "--encoding latin1 reads names written in ISO 8859-1");
    if (field.text.size() > kMaxName)
      fail(line, field.offset + indent, "E0305", "channel name longer than 1024 bytes", field.text);
    return field.text;
  }

  void run() {
    refuse_other_content();
    refuse_binary();
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
    collect(offset, number);
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
    std::vector<std::vector<Field>> rows;
    for (std::size_t i = 0; i < sample.size(); ++i)
      if (sample[i].offset >= dialect.data_offset && rows.size() < kSample)
        rows.push_back(split(sample[i].text, dialect.delimiter));
    choose_time(dialect, rows, options, info);
    for (const Line& line : comments)
      if (!info.time.from_stamps && info.time.rate_hz == 0 && dialect.time_column < 0)
        read_rate_comment(line.text, info);
  }

 private:
  std::size_t columns_ = 1;
};

}  // namespace

std::string at(const std::string& file,
               std::uint64_t line,
               std::uint64_t column,
               std::uint64_t byte) {
  return fmt::format("{}:{}:{} (byte {})", file, line, column, byte);
}

bool is_comment(std::string_view line) {
  line = trimmed(line);
  return !line.empty() && (line[0] == '#' || line[0] == '%' || line.substr(0, 2) == "//");
}

std::vector<Field> split(std::string_view line, char delimiter, bool* open_quote) {
  std::vector<Field> fields;
  const auto blank = [](char c) { return c == ' ' || c == '\t'; };
  const auto pad = [&](char c) { return blank(c) && (c != delimiter || delimiter == ' '); };
  const auto is_end = [&](char c) { return delimiter == ' ' ? blank(c) : c == delimiter; };
  std::size_t i = 0;
  for (;;) {
    while (i < line.size() && pad(line[i])) ++i;
    if (delimiter == ' ' && i == line.size() && !fields.empty()) break;
    Field field;
    field.offset = i;
    if (i < line.size() && line[i] == '"') {
      field.quoted = true;
      for (++i;; ++i) {
        if (i >= line.size()) {
          if (open_quote != nullptr) *open_quote = true;
          break;
        }
        if (line[i] == '"') {
          if (i + 1 >= line.size() || line[i + 1] != '"') break;
          ++i;
        }
        field.text += line[i];
      }
      i = std::min(i + 1, line.size());
      field.text = std::string(trimmed(field.text));
      while (i < line.size() && pad(line[i]) && !is_end(line[i])) ++i;
      for (; i < line.size() && !is_end(line[i]); ++i) field.text += line[i];
    } else {
      const std::size_t start = i;
      while (i < line.size() && !is_end(line[i])) ++i;
      field.text = std::string(trimmed(line.substr(start, i - start)));
    }
    fields.push_back(std::move(field));
    if (i >= line.size()) break;
    ++i;  // the delimiter
  }
  return fields;
}

Dialect understand(std::string_view head, bool whole, const ReadOptions& options, LogInfo& info) {
  Study study(head, whole, options, info);
  study.run();
  return study.dialect;
}

}  // namespace libchar::csv
