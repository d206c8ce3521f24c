#include "libchar/log/csv/rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "libchar/core/text.hpp"
#include "libchar/log/csv/columns.hpp"
#include "libchar/log/csv/number.hpp"
#include "libchar/log/csv/stamps.hpp"
#include "libchar/log/csv/vector_rows.hpp"

namespace libchar::csv {
namespace {

class RowParser {
 public:
  RowParser(std::string_view text, const Plan& plan, ParsedChunk& out)
      : begin_(text.data()),
        end_(text.data() + text.size()),
        plan_(plan),
        dialect_(*plan.dialect),
        out_(out) {
    reset();
  }

  void run() {
    const char* p = begin_;
    const char* try_vector = begin_;  // where the fast way may be tried again
    while (p < end_ && !out_.problem) {
      const char* const start = p;
      if (p >= try_vector) {
        p = vector_rows(p);
        // Each try looks some way ahead: a file whose rows are mostly unusual must not pay for
        // that at every one of them.
        try_vector = p + kPatience;
      }
      p = quick_rows(p, std::min(end_, try_vector));
      out_.account.row_bytes += static_cast<std::uint64_t>(p - start);
      if (p == end_) break;
      p = careful_line(p);
      ++line_;
    }
    finish(p);
  }

 private:
  void reset() {
    RowBlock& rows = out_.rows;
    rows.columns.resize(plan_.channels);
    rows.rows = 0;
    rows.line_offset.clear();
    capacity_ = ~std::size_t{0};
    for (auto& column : rows.columns) {
      if (column.size() < 32) column.resize(32);
      capacity_ = std::min(capacity_, column.size());
    }
    if (dialect_.time.column >= 0) {
      if (rows.time_ns.size() < 32) rows.time_ns.resize(32);
      capacity_ = std::min(capacity_, rows.time_ns.size());
    } else {
      rows.time_ns.clear();
    }
    point_at_columns();
    const bool one_number = !dialect_.time.calendar && dialect_.more_time.column < 0;
    for (std::size_t i = 0; one_number && i < kNanoseconds.size(); ++i)
      if (dialect_.time.unit_ns == kNanoseconds[i]) stamp_digits_ = static_cast<int>(i);
    // Of two parts of a stamp the one that stands first in a row sets it, the other is added.
    first_part_ = dialect_.more_time.column >= 0 && dialect_.more_time.column < dialect_.time.column
                      ? Plan::kMoreTime
                      : Plan::kTime;
    line_by_line_ =
        !dialect_.lead.empty() || !dialect_.filters.empty() || dialect_.group_column >= 0;
    for (std::size_t c = 0; c < plan_.target.size(); ++c)  // a number without its unit is an error
      line_by_line_ = line_by_line_ ||
                      (plan_.target[c] != Plan::kSkip && !dialect_.columns[c].cell_unit.empty());
    out_.groups.clear();
    out_.filtered = 0;
    out_.lines = 0;
    out_.problem.reset();
    out_.unended.reset();
    out_.blank = out_.comment = out_.repeated = out_.infinite = out_.mixed_end = out_.overflow =
        out_.too_small = out_.missing = {};
    out_.missing_per_channel.assign(plan_.channels, 0);
    out_.fractional.assign(plan_.channels, 0);
    out_.inexact_integers = 0;
    out_.account = {};
  }

  void point_at_columns() {
    pointers_.resize(plan_.channels);
    for (std::size_t c = 0; c < plan_.channels; ++c) pointers_[c] = out_.rows.columns[c].data();
  }

  void grow() {
    const std::size_t wanted = capacity_ * 2;
    for (auto& column : out_.rows.columns) column.resize(wanted);
    if (dialect_.time.column >= 0) out_.rows.time_ns.resize(wanted);
    capacity_ = wanted;
    point_at_columns();
  }

  void note_line() {
    if (rows_ == capacity_) grow();
    if (!lines_listed_) return;
    out_.rows.line_offset.push_back(static_cast<std::uint32_t>(line_));
  }

  // From here on rows and lines no longer go together.
  void list_lines() {
    if (lines_listed_) return;
    lines_listed_ = true;
    out_.rows.line_offset.resize(rows_);
    for (std::size_t i = 0; i < rows_; ++i)
      out_.rows.line_offset[i] = static_cast<std::uint32_t>(i);
  }

  static constexpr std::size_t kVectorRows =
      1024;  // at a time: their text fits the second-level cache
  static constexpr std::ptrdiff_t kPatience = std::ptrdiff_t{1} << 18U;

  // The fast way of vector_rows.hpp, from p to the first row that it does not take.
  const char* vector_rows(const char* p) {
    const bool crlf = dialect_.line_end == LineEnd::crlf;
    const bool timed = dialect_.time.column >= 0;
    if (dialect_.delimiter == ' ' || dialect_.decimal != '.' || line_by_line_ ||
        (!crlf && dialect_.line_end != LineEnd::lf) || (timed && stamp_digits_ < 0))
      return p;
    std::vector<VectorColumn> columns(plan_.target.size());
    std::vector<char> fractional(plan_.channels, 0);
    while (p < end_) {
      if (rows_ == capacity_) grow();
      for (std::size_t c = 0; c < columns.size(); ++c) {
        const int target = plan_.target[c];
        if (target >= 0) {
          const auto channel = static_cast<std::size_t>(target);
          columns[c] = {.use = VectorColumn::Use::value,
                        .values = pointers_[channel] + rows_,
                        .fractional = &fractional[channel]};
        } else if (target == Plan::kTime) {
          columns[c] = {.use = VectorColumn::Use::stamp,
                        .stamps = out_.rows.time_ns.data() + rows_,
                        .stamp_digits = stamp_digits_};
        }
      }
      const std::size_t wanted = std::min(kVectorRows, capacity_ - rows_);
      const VectorRows taken = parse_vector_rows({p, static_cast<std::size_t>(end_ - p)},
                                                 dialect_.delimiter,
                                                 crlf,
                                                 columns,
                                                 wanted,
                                                 separators_);
      p += taken.consumed;
      if (lines_listed_)
        for (std::size_t i = 0; i < taken.rows; ++i)
          out_.rows.line_offset.push_back(static_cast<std::uint32_t>(line_ + i));
      rows_ += taken.rows;
      line_ += taken.rows;
      quick_rows_ += taken.rows;
      if (taken.rows < wanted) break;
    }
    for (std::size_t c = 0; c < plan_.channels; ++c)
      out_.fractional[c] |= static_cast<std::uint32_t>(fractional[c]);
    return p;
  }

  // Rows of nothing but numbers between delimiters, with the file's line end: nearly all of a file. Stops
  // in front of the first row that is anything else, of which it has changed nothing but scratch.
  const char* quick_rows(const char* p, const char* const end) {
    if (dialect_.delimiter == ' ' || dialect_.line_end == LineEnd::cr ||
        dialect_.line_end == LineEnd::none || line_by_line_)
      return p;
    const std::size_t before = rows_;
    const int* const target = plan_.target.data();
    const std::size_t last = plan_.target.size() - 1;
    const char delimiter = dialect_.delimiter, point = dialect_.decimal;
    const bool crlf = dialect_.line_end == LineEnd::crlf;
    std::uint32_t* const fractional = out_.fractional.data();
    while (p < end) {
      if (rows_ == capacity_) grow();
      double* const* const columns = pointers_.data();
      const std::size_t row = rows_;
      const char* q = p;
      for (std::size_t c = 0;; ++c) {
        const int to = target[c];
        if (to >= 0) {
          bool integer = false;
          q = quick_number(q, point, columns[to][row], integer);
          if (q == nullptr) break;
          if (!integer && fractional[to] == 0) fractional[to] = 1;
        } else if (to == Plan::kTime && stamp_digits_ >= 0) {
          q = quick_stamp(q, point, stamp_digits_, out_.rows.time_ns[row]);
          if (q == nullptr) break;
        } else {
          q = quick_text(q, c, to);
          if (q == nullptr) break;
        }
        if (c == last || *q != delimiter) {
          if (c != last) q = nullptr;
          break;
        }
        ++q;
      }
      // The line end is compared before the end of the chunk is: what stands behind it is readable.
      if (q == nullptr || (crlf ? *q != '\r' || q[1] != '\n' : *q != '\n') || q >= end_) break;
      p = q + (crlf ? 2 : 1);
      ++rows_;
      if (lines_listed_)
        out_.rows.line_offset.push_back(static_cast<std::uint32_t>(line_ + (rows_ - before - 1)));
    }
    quick_rows_ += rows_ - before;
    line_ += rows_ - before;
    return p;
  }

  // A column that is not wanted, or stamps that are no numbers in a unit of a power of ten.
  const char* quick_text(const char* p, std::size_t column, int to) {
    const char* const start = p;
    while (p < end_ && *p != dialect_.delimiter && *p != '\n' && *p != '\r' && *p != '"') ++p;
    if (p == end_ || *p == '"' || p - start > static_cast<std::ptrdiff_t>(kMaxField))
      return nullptr;
    if (column == 0 &&
        (p == start || *start == '#' || *start == '%' || *start == '/' || blank(*start)))
      return nullptr;
    std::size_t offset = 0;
    if (to != Plan::kSkip &&
        take_part(trimmed({start, static_cast<std::size_t>(p - start)}), to, offset) !=
            StampDefect::none)
      return nullptr;
    return p;
  }

  // A stamp, or one of its two parts, into the row at hand.
  StampDefect take_part(std::string_view text, int to, std::size_t& offset) {
    std::int64_t ns = 0;
    const StampPart& part = to == Plan::kTime ? dialect_.time : dialect_.more_time;
    const StampDefect defect = read_part(text, part, dialect_, ns, offset);
    if (defect != StampDefect::none) return defect;
    std::int64_t& stamp = out_.rows.time_ns[rows_];
    if (to == first_part_)
      stamp = ns;
    else if (__builtin_add_overflow(stamp, ns, &stamp))
      return StampDefect::out_of_range;
    return StampDefect::none;
  }

  // Any line, looked at byte by byte.
  const char* careful_line(const char* start) {
    const char* stop = start;
    while (stop < end_ && *stop != '\n' && *stop != '\r') ++stop;
    const char* after = stop;
    LineEnd kind = LineEnd::none;
    if (stop < end_) {
      const bool pair = *stop == '\r' && stop + 1 < end_ && stop[1] == '\n';
      kind = pair ? LineEnd::crlf : *stop == '\r' ? LineEnd::cr : LineEnd::lf;
      after = stop + (pair ? 2 : 1);
    }
    const std::string_view line(start, static_cast<std::size_t>(stop - start));
    const auto bytes = static_cast<std::uint64_t>(after - start);
    line_start_ = start;
    if (const std::size_t nul = line.find('\0');
        line.size() > kMaxLine && nul != std::string_view::npos) {
      fail("E0308",
           "NUL bytes between the rows",
           "",
           "a damaged file: copy it again, or read the part before with `to_s`",
           nul);
      return after;
    }
    if (line.size() > kMaxLine) {
      fail("E0305", "line longer than 1 MiB", "", "is this a text file with line ends?", 0);
      return after;
    }
    if (kind != LineEnd::none && kind != dialect_.line_end)
      out_.mixed_end.add(line_, line.size() + 1);
    if (line.find_first_not_of(" \t") == std::string_view::npos) {
      out_.blank.add(line_, 1);
      out_.account.blank_bytes += bytes;
      list_lines();
    } else if (is_comment(line)) {
      out_.comment.add(line_, 1);
      out_.account.comment_bytes += bytes;
      list_lines();
    } else if (dialect_.has_header && line == dialect_.header) {
      if (!plan_.skip_repeated_header) {
        fail("E0309",
             "the header line again, a row of numbers was expected (concatenated logs?)",
             std::string(line),
             "`skip_repeated_header` counts it and goes on",
             0);
        return after;
      }
      out_.repeated.add(line_, 1);
      out_.account.header_bytes += bytes;
      list_lines();
    } else if (!wanted(line)) {
      leave_out(bytes);
    } else if (careful_row(line)) {
      out_.account.row_bytes += bytes;
      note_line();
      ++rows_;
      // A closing quote or a delimiter shows that the last cell is whole.
      if (kind == LineEnd::none && line.back() != '"' && line.back() != dialect_.delimiter)
        out_.unended = Spot{line_, line.size() + 1};
    }
    return after;
  }

  void fail(
      std::string code, std::string what, std::string got, std::string hint, std::size_t column) {
    out_.problem = RowProblem{
        {ErrorKind::input, std::move(code), "", std::move(what), std::move(got), std::move(hint)},
        {line_, column + 1},
        static_cast<std::uint64_t>(line_start_ - begin_) + column};
  }

  struct Span {
    std::size_t from = 0, to = 0;  // the trimmed cell
    std::size_t start = 0;         // of the field (its quote)
    std::size_t next = 0;          // where the next field starts
    bool last = false, ok = true;
  };

  bool blank(char c) const { return c == ' ' || c == '\t'; }
  bool ends(char c) const { return dialect_.delimiter == ' ' ? blank(c) : c == dialect_.delimiter; }

  // The stamp that a terminal put in front of the line.
  bool lead_field(std::string_view line, Span& span) const {
    std::size_t after = 0;
    const auto lead = lead_of(line, dialect_.lead, after);
    if (!lead) return false;
    span.start = span.from = lead->offset;
    span.to = lead->offset + lead->text.size();
    span.next = after;
    span.last = after >= line.size();
    return true;
  }

  // The field that starts at i.
  Span field(std::string_view line, std::size_t i) {
    Span span;
    if (i == 0 && !dialect_.lead.empty() && lead_field(line, span)) return span;
    const auto pad = [&](std::size_t k) {
      return k < line.size() && blank(line[k]) && !ends(line[k]);
    };
    if (dialect_.delimiter == ' ')
      while (i < line.size() && blank(line[i])) ++i;
    while (pad(i)) ++i;
    span.start = i;
    if (i < line.size() && line[i] == '"') {
      const std::size_t close = line.find('"', i + 1);
      if (close == std::string_view::npos) {
        fail("E0306",
             "a quote is opened here and not closed in this line",
             std::string(line.substr(i)),
             "",
             i);
        span.ok = false;
        return span;
      }
      span.from = i + 1;
      span.to = close;
      i = close + 1;
      if (i < line.size() && !ends(line[i]) && !blank(line[i])) {
        fail("E0306",
             "text after a closing quote, a delimiter was expected",
             std::string(line.substr(span.start)),
             "",
             i);
        span.ok = false;
        return span;
      }
      while (pad(i)) ++i;
    } else {
      span.from = i;
      while (i < line.size() && !ends(line[i])) ++i;
      span.to = i;
    }
    while (span.from < span.to && blank(line[span.from])) ++span.from;
    while (span.to > span.from && blank(line[span.to - 1])) --span.to;
    if (dialect_.delimiter == ' ')
      while (i + 1 < line.size() && blank(line[i + 1])) ++i;
    span.last = i >= line.size() || (dialect_.delimiter == ' ' && i + 1 >= line.size());
    span.next = i + 1;
    if (i - span.start > kMaxField) {
      fail("E0305",
           fmt::format("field longer than 128 KiB ({} bytes)", i - span.start),
           std::string(line.substr(span.start, 60)),
           "",
           span.start);
      span.ok = false;
    }
    return span;
  }

  void leave_out(std::uint64_t bytes) {
    if (out_.problem) return;
    ++out_.filtered;
    out_.account.filtered_bytes += bytes;
    list_lines();
  }

  // Does the row have the values that are asked for? Notes its group.
  bool wanted(std::string_view line) {
    if (dialect_.filters.empty() && dialect_.group_column < 0) return true;
    Span span;
    std::size_t i = 0;
    const int columns = static_cast<int>(plan_.target.size());
    for (int c = 0; c < columns && !span.last; ++c, i = span.next) {
      span = field(line, i);
      if (!span.ok) return false;
      const std::string_view text = line.substr(span.from, span.to - span.from);
      for (const RowFilter& filter : dialect_.filters)
        if (filter.column == c && text != filter.value) {
          if (filter.must) refuse_kind(text, span, filter);
          return false;
        }
      if (c == dialect_.group_column && !note_group(text, span)) return false;
    }
    return true;
  }

  void refuse_kind(std::string_view text, const Span& span, const RowFilter& filter) {
    const std::string& name = dialect_.columns[static_cast<std::size_t>(filter.column)].name;
    fail("E0327",
         fmt::format("rows of another kind begin: {} was {} before", name, filter.value),
         std::string(text),
         fmt::format("`where` {}={} reads the rows before, `group_by` {} makes channels of each",
                     name,
                     filter.value,
                     name),
         span.start);
  }

  bool note_group(std::string_view text, const Span& span) {
    const auto at = std::find(dialect_.groups.begin(), dialect_.groups.end(), text);
    if (at == dialect_.groups.end()) {
      fail("E0332",
           fmt::format("a value of the column of `group_by` that the first {} do not have",
                       plural(dialect_.groups.size(), "value")),
           std::string(text),
           "`where` reads one of them",
           span.start);
      return false;
    }
    out_.groups.resize(rows_);
    out_.groups.push_back(static_cast<std::uint32_t>(at - dialect_.groups.begin()));
    return true;
  }

  bool careful_row(std::string_view line) {
    const std::size_t count = plan_.target.size();
    if (rows_ == capacity_) grow();
    std::size_t i = 0;
    Span span;
    for (std::size_t c = 0; c < count; ++c) {
      span = field(line, i);
      if (!span.ok) return false;
      if (!cell(line, span, c)) return false;
      ++out_.account.cells;
      if (c + 1 < count && span.last) {
        fail("E0304",
             fmt::format("{} field{}, {} expected", c + 1, c == 0 ? "" : "s", count),
             std::string(line),
             few_hint(line),
             line.size());
        return false;
      }
      i = span.next;
    }
    if (span.last) return true;
    const Span extra = field(line, i);
    if (!extra.ok) return false;
    if (dialect_.trailing_delimiter && extra.last && extra.from == extra.to) return true;
    std::size_t fields = count + 1;
    for (Span s = extra; s.ok && !s.last; ++fields) s = field(line, s.next);
    out_.problem
        .reset();  // a quote problem in the fields that are too many says less than their number
    fail("E0304",
         fmt::format("{} fields, {} expected", fields, count),
         std::string(line),
         many_hint(fields),
         i);
    return false;
  }

  std::string many_hint(std::size_t fields) const {
    const std::size_t count = plan_.target.size();
    if (dialect_.trailing_delimiter && fields == count + 1)
      return fmt::format(
          "the lines before end with '{}' and nothing behind it, which makes no column: name the "
          "columns in a header line{}",
          dialect_.delimiter,
          dialect_.has_header ? ", this one too" : "");
    if (fields == 2 * count && dialect_.delimiter == ',')
      return "are these decimal commas? write the file with another delimiter, such as ;";
    return fmt::format("`delimiter`, if '{}' does not separate the fields", dialect_.delimiter);
  }

  std::string few_hint(std::string_view line) const {
    for (const char other : {';', '\t', ','})
      if (other != dialect_.delimiter && line.find(other) != std::string_view::npos)
        return "`delimiter`, if the guess is wrong; `skip_rows`, if the table starts later";
    return "";
  }

  bool cell(std::string_view line, const Span& span, std::size_t c) {
    const int target = plan_.target[c];
    std::string_view text = line.substr(span.from, span.to - span.from);
    if (target == Plan::kSkip) {
      ++out_.account.unread;
      return true;
    }
    if (!dialect_.columns[c].cell_unit.empty() &&
        !take_off_unit(text, span, dialect_.columns[c].cell_unit))
      return false;
    return target < 0 ? stamp(text, span, target)
                      : value(text, span, static_cast<std::size_t>(target));
  }

  // "0.005 sec" → "0.005" in a column of seconds. What is no number with a known unit is left as it is.
  bool take_off_unit(std::string_view& text, const Span& span, const std::string& unit) {
    const auto measured = number_and_unit(text);
    if (measured && same_unit(measured->unit, unit)) {
      text = measured->number;
      return true;
    }
    const bool bare = read_cell(text, dialect_.decimal).kind == Cell::value;
    if (!measured && !bare) return true;
    fail("E0333",
         bare ? fmt::format("a value without a unit, those before it are in {}", unit)
              : fmt::format("a value in {}, those before it are in {}", measured->unit, unit),
         std::string(text),
         "export the column with one unit, or with plain numbers",
         span.start);
    return false;
  }

  bool stamp(std::string_view text, const Span& span, int to) {
    std::size_t offset = 0;
    switch (take_part(text, to, offset)) {
      case StampDefect::none:
        ++out_.account.stamps;
        return true;
      case StampDefect::missing:
        fail("E0313",
             "missing time stamp",
             std::string(text),
             "`time_column` none and `rate_hz` HZ ignore the stamps",
             span.start);
        break;
      case StampDefect::malformed: {
        if ((to == Plan::kTime ? dialect_.time : dialect_.more_time).calendar) {
          fail("E0321",
               "no date or clock time like those before it",
               std::string(text),
               "`date_order` day or month says which number of 05/01/2024 is the day",
               span.start);
          break;
        }
        const Cell why = read_cell(text, dialect_.decimal);
        fail("E0311",
             fmt::format("{} in the time column",
                         why.kind == Cell::bad ? why.reason : "a number was expected"),
             std::string(text),
             "",
             span.from + (why.kind == Cell::bad ? why.offset : offset));
        break;
      }
      case StampDefect::out_of_range:
        fail("E0314",
             "time stamp does not fit 64-bit nanoseconds (a wild stamp, or the wrong `time_unit`?)",
             std::string(text),
             "`time_unit` s|ms|us|ns",
             span.start);
        break;
    }
    return false;
  }

  bool value(std::string_view text, const Span& span, std::size_t channel) {
    double& out = pointers_[channel][rows_];
    const Cell cell = read_styled(text, {dialect_.decimal, dialect_.thousands});
    switch (cell.kind) {
      case Cell::value:
        out = cell.number;
        out_.fractional[channel] |= cell.integer ? 0U : 1U;
        out_.inexact_integers += cell.inexact_integer;
        if (cell.too_small) out_.too_small.add(line_, span.start + 1);
        ++out_.account.values;
        return true;
      case Cell::infinite:
        out_.infinite.add(line_, span.start + 1);
        break;
      case Cell::out_of_range:
        if (!plan_.overflow_as_missing) {
          fail("E0312",
               "number out of range",
               std::string(text),
               "`overflow_as_missing` counts it as missing",
               span.start);
          return false;
        }
        out_.overflow.add(line_, span.start + 1);
        break;
      case Cell::missing:
        out_.missing.add(line_, span.start + 1);
        break;
      case Cell::bad:
        fail("E0311",
             cell.reason,
             std::string(text),
             bad_hint(text),
             span.from == span.to || cell.offset == 0 ? span.start : span.from + cell.offset);
        return false;
    }
    out = kMissing;
    ++out_.missing_per_channel[channel];
    ++(cell.kind == Cell::missing ? out_.account.missing : out_.account.rejected);
    return true;
  }

  std::string bad_hint(std::string_view text) const {
    if (dialect_.decimal == '.' && read_cell(text, ',').kind == Cell::value)
      return "`decimal` comma, if ',' is the decimal mark";
    if (dialect_.decimal == ',' && read_cell(text, '.').kind == Cell::value)
      return "`decimal` point, if '.' is the decimal mark";
    const bool word =
        !text.empty() && std::none_of(text.begin(), text.end(), [](char c) { return is_digit(c); });
    return word ? "`channels` reads only the columns named there; `skip_rows`, if the table starts "
                  "later"
                : "";
  }

  void finish(const char* p) {
    RowBlock& rows = out_.rows;
    rows.rows = rows_;
    out_.lines = line_;
    const std::uint64_t stamps =
        (dialect_.time.column >= 0 ? 1 : 0) + (dialect_.more_time.column >= 0 ? 1 : 0);
    out_.account.cells += quick_rows_ * plan_.target.size();
    out_.account.values += quick_rows_ * plan_.channels;
    out_.account.stamps += quick_rows_ * stamps;
    out_.account.unread += quick_rows_ * (plan_.target.size() - plan_.channels - stamps);
    const std::uint64_t consumed = static_cast<std::uint64_t>(p - begin_);
    out_.account.bytes = consumed;
    if (out_.problem)
      out_.account.bytes = out_.account.row_bytes + out_.account.blank_bytes +
                           out_.account.comment_bytes + out_.account.header_bytes +
                           out_.account.filtered_bytes;
  }

  const char* begin_;
  const char* end_;
  const Plan& plan_;
  const Dialect& dialect_;
  ParsedChunk& out_;
  std::vector<double*> pointers_;
  std::size_t rows_ = 0, capacity_ = 0;
  int stamp_digits_ = -1;  // the time unit is 10^this ns
  std::uint64_t line_ = 0, quick_rows_ = 0;
  std::vector<std::uint32_t> separators_;
  const char* line_start_ = nullptr;
  bool lines_listed_ = false, line_by_line_ = false;
  int first_part_ = Plan::kTime;
};

}  // namespace

void Account::add(const Account& o) {
  bytes += o.bytes;
  row_bytes += o.row_bytes;
  filtered_bytes += o.filtered_bytes;
  blank_bytes += o.blank_bytes;
  comment_bytes += o.comment_bytes;
  header_bytes += o.header_bytes;
  cells += o.cells;
  values += o.values;
  missing += o.missing;
  rejected += o.rejected;
  unread += o.unread;
  stamps += o.stamps;
}

void parse_rows(std::string_view text, const Plan& plan, ParsedChunk& out) {
  RowParser(text, plan, out).run();
}

}  // namespace libchar::csv
