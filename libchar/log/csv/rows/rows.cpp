#include "libchar/log/csv/rows/rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "libchar/core/text/text.hpp"
#include "libchar/log/csv/head/columns.hpp"
#include "libchar/log/csv/rows/number.hpp"
#include "libchar/log/csv/rows/stamps.hpp"
#include "libchar/log/csv/rows/vector_rows.hpp"

namespace libchar::csv {
namespace {

bool blank(char c) { return c == ' ' || c == '\t'; }
bool ascii_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

/// The rows of a chunk as they are filled.
struct Filling {
  Filling(const Plan& which, ParsedChunk& chunk) : plan(which), dialect(*which.dialect), out(chunk) {
    ParsedChunk empty;
    std::swap(empty.rows, out.rows);  // keeps its memory
    out = std::move(empty);
    out.missing_per_channel.assign(plan.channels, 0);
    out.fractional.assign(plan.channels, 0);
    RowBlock& block = out.rows;
    block.columns.resize(plan.channels);
    block.rows = 0;
    block.line_offset.clear();
    capacity = ~std::size_t{0};
    for (auto& column : block.columns) {
      if (column.size() < 32) column.resize(32);
      capacity = std::min(capacity, column.size());
    }
    if (dialect.time.column >= 0) {
      if (block.time_ns.size() < 32) block.time_ns.resize(32);
      capacity = std::min(capacity, block.time_ns.size());
    } else {
      block.time_ns.clear();
    }
    point_at_columns();
    const bool one_number = !dialect.time.calendar && dialect.more_time.column < 0 && dialect.time.fraction_ns == 0;
    for (std::size_t i = 0; one_number && i < kNanoseconds.size(); ++i)
      if (dialect.time.unit_ns == kNanoseconds[i]) stamp_digits = static_cast<int>(i);
    // Of two parts of a stamp the one that stands first in a row sets it, the other is added.
    first_part =
        dialect.more_time.column >= 0 && dialect.more_time.column < dialect.time.column ? Plan::kMoreTime : Plan::kTime;
    line_by_line = !dialect.lead.empty() || !dialect.filters.empty() || dialect.group_column >= 0;
    for (std::size_t c = 0; c < plan.target.size(); ++c)  // a number without its unit is an error
      line_by_line = line_by_line || (plan.target[c] != Plan::kSkip && !dialect.columns[c].cell_unit.empty());
  }

  void point_at_columns() {
    columns.resize(plan.channels);
    for (std::size_t c = 0; c < plan.channels; ++c) columns[c] = out.rows.columns[c].data();
  }

  void grow() {
    const std::size_t wanted = capacity * 2;
    for (auto& column : out.rows.columns) column.resize(wanted);
    if (dialect.time.column >= 0) out.rows.time_ns.resize(wanted);
    capacity = wanted;
    point_at_columns();
  }

  void note_line() {
    if (rows == capacity) grow();
    if (!lines_listed) return;
    out.rows.line_offset.push_back(static_cast<std::uint32_t>(line));
  }

  // From here on rows and lines no longer go together.
  void list_lines() {
    if (lines_listed) return;
    lines_listed = true;
    out.rows.line_offset.resize(rows);
    for (std::size_t i = 0; i < rows; ++i) out.rows.line_offset[i] = static_cast<std::uint32_t>(i);
  }

  // A stamp, or one of its two parts, into the row at hand.
  StampDefect take_part(std::string_view text, int to, std::size_t& offset) {
    std::int64_t ns = 0;
    const StampPart& part = to == Plan::kTime ? dialect.time : dialect.more_time;
    const StampDefect defect = read_part(text, part, dialect, ns, offset);
    if (defect != StampDefect::none) return defect;
    std::int64_t& stamp = out.rows.time_ns[rows];
    if (to == first_part)
      stamp = ns;
    else if (__builtin_add_overflow(stamp, ns, &stamp))
      return StampDefect::out_of_range;
    return StampDefect::none;
  }

  const Plan& plan;
  const Dialect& dialect;
  ParsedChunk& out;
  std::vector<double*> columns;
  std::size_t rows = 0, capacity = 0;
  std::uint64_t line = 0;
  int stamp_digits = -1;  // the time unit is 10^this ns
  int first_part = Plan::kTime;
  bool lines_listed = false, line_by_line = false;
};

/// Rows of nothing but numbers: nearly all of a file.
class QuickRows {
 public:
  QuickRows(Filling& to, std::string_view text) : to_(to), end_(text.data() + text.size()), try_vector_(text.data()) {}

  // As many rows as are plain numbers, from p on; at the first that is anything else it stops,
  // having changed nothing but scratch.
  const char* take(const char* p) {
    if (p >= try_vector_) {
      p = vector_rows(p);
      // Each try looks some way ahead: a file whose rows are mostly unusual must not pay for that at every one of them.
      try_vector_ = p + kPatience;
    }
    return quick_rows(p, std::min(end_, try_vector_));
  }
  std::uint64_t taken() const { return taken_; }

 private:
  static constexpr std::size_t kVectorRows = 1024;  // at a time: their text fits the second-level cache
  static constexpr std::ptrdiff_t kPatience = std::ptrdiff_t{1} << 18U;

  // The fast way of vector_rows.hpp, from p to the first row that it does not take.
  const char* vector_rows(const char* p) {
    const bool crlf = to_.dialect.line_end == LineEnd::crlf;
    const bool timed = to_.dialect.time.column >= 0;
    if (to_.dialect.delimiter == ' ' || to_.dialect.decimal != '.' || to_.line_by_line ||
        (!crlf && to_.dialect.line_end != LineEnd::lf) || (timed && to_.stamp_digits < 0))
      return p;
    std::vector<VectorColumn> columns(to_.plan.target.size());
    std::vector<char> fractional(to_.plan.channels, 0);
    while (p < end_) {
      if (to_.rows == to_.capacity) to_.grow();
      for (std::size_t c = 0; c < columns.size(); ++c) {
        const int target = to_.plan.target[c];
        if (target >= 0) {
          const auto channel = static_cast<std::size_t>(target);
          columns[c] = {.use = VectorColumn::Use::value,
                        .values = to_.columns[channel] + to_.rows,
                        .fractional = &fractional[channel]};
        } else if (target == Plan::kTime) {
          columns[c] = {.use = VectorColumn::Use::stamp,
                        .stamps = to_.out.rows.time_ns.data() + to_.rows,
                        .stamp_digits = to_.stamp_digits};
        }
      }
      const std::size_t wanted = std::min(kVectorRows, to_.capacity - to_.rows);
      const VectorRows taken = parse_vector_rows({p, static_cast<std::size_t>(end_ - p)}, to_.dialect.delimiter, crlf,
                                                 columns, wanted, separators_);
      p += taken.consumed;
      if (to_.lines_listed)
        for (std::size_t i = 0; i < taken.rows; ++i)
          to_.out.rows.line_offset.push_back(static_cast<std::uint32_t>(to_.line + i));
      to_.rows += taken.rows;
      to_.line += taken.rows;
      taken_ += taken.rows;
      if (taken.rows < wanted) break;
    }
    for (std::size_t c = 0; c < to_.plan.channels; ++c)
      to_.out.fractional[c] |= static_cast<std::uint32_t>(fractional[c]);
    return p;
  }

  // The same number by number: delimiters between them, and the file's line end.
  const char* quick_rows(const char* p, const char* const end) {
    if (to_.dialect.delimiter == ' ' || to_.dialect.line_end == LineEnd::cr || to_.dialect.line_end == LineEnd::none ||
        to_.line_by_line)
      return p;
    const std::size_t before = to_.rows;
    const int* const target = to_.plan.target.data();
    const std::size_t last = to_.plan.target.size() - 1;
    const char delimiter = to_.dialect.delimiter, point = to_.dialect.decimal;
    const bool crlf = to_.dialect.line_end == LineEnd::crlf;
    std::uint32_t* const fractional = to_.out.fractional.data();
    while (p < end) {
      if (to_.rows == to_.capacity) to_.grow();
      double* const* const columns = to_.columns.data();
      const std::size_t row = to_.rows;
      const char* q = p;
      for (std::size_t c = 0;; ++c) {
        const int to = target[c];
        if (to >= 0) {
          bool integer = false;
          q = quick_number(q, point, columns[to][row], integer);
          if (q == nullptr) break;
          if (!integer && fractional[to] == 0) fractional[to] = 1;
        } else if (to == Plan::kTime && to_.stamp_digits >= 0) {
          q = quick_stamp(q, point, to_.stamp_digits, to_.out.rows.time_ns[row]);
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
      ++to_.rows;
      if (to_.lines_listed)
        to_.out.rows.line_offset.push_back(static_cast<std::uint32_t>(to_.line + (to_.rows - before - 1)));
    }
    taken_ += to_.rows - before;
    to_.line += to_.rows - before;
    return p;
  }

  // A column that is not wanted, or stamps that are no numbers in a unit of a power of ten.
  const char* quick_text(const char* p, std::size_t column, int to) {
    const char* const start = p;
    while (p < end_ && *p != to_.dialect.delimiter && *p != '\n' && *p != '\r' && *p != '"') ++p;
    if (p == end_ || *p == '"' || p - start > static_cast<std::ptrdiff_t>(kMaxField)) return nullptr;
    if (column == 0 &&
        (p == start || *start == '#' || *start == '%' || *start == '/' || *start == ';' || blank(*start)))
      return nullptr;
    std::size_t offset = 0;
    if (to != Plan::kSkip &&
        to_.take_part(trimmed({start, static_cast<std::size_t>(p - start)}), to, offset) != StampDefect::none)
      return nullptr;
    return p;
  }

  Filling& to_;
  const char* end_;
  const char* try_vector_;  // where the fast way may be tried again
  std::vector<std::uint32_t> separators_;
  std::uint64_t taken_ = 0;
};

/// Any line, cell by cell, with the reasons why one cannot be read.
class CarefulLines {
 public:
  CarefulLines(Filling& to, std::string_view text) : to_(to), begin_(text.data()), end_(text.data() + text.size()) {}

  const char* take(const char* start) {
    const bool behind = to_.out.footer.has_value();
    const std::size_t rows = to_.rows;
    const char* const after = take_line(start);
    if (behind && (to_.out.problem || to_.rows > rows)) {  // rows go on: that line was none of what ends a file
      to_.out.problem = std::exchange(to_.out.footer, {});
      to_.rows = rows;
    }
    return after;
  }

 private:
  // ",,,": a row with stamps that has nothing, not even its stamp.
  bool empty_row(std::string_view line) const {
    return line[0] == to_.dialect.delimiter && to_.dialect.time.column >= 0 &&
           line.find_first_not_of(to_.dialect.delimiter) == std::string_view::npos;
  }

  const char* take_line(const char* start) {
    const char* stop = start;
    while (stop < end_ && *stop != '\n' && *stop != '\r') ++stop;
    std::uint64_t more_lines = 0;
    if (to_.dialect.lines.quotes && std::count(start, stop, '"') % 2 != 0) stop = end_of_row(start, stop, more_lines);
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
    if (const std::size_t nul = line.find('\0'); line.size() > kMaxLine && nul != std::string_view::npos) {
      fail("E0308", "NUL bytes between the rows", "",
           "a damaged file: copy it again, or read the part before with `to_s`", nul);
      return after;
    }
    if (line.size() > kMaxLine) {
      fail("E0305", "line longer than 1 MiB", "", "is this a text file with line ends?", 0);
      return after;
    }
    if (kind != LineEnd::none && kind != to_.dialect.line_end) to_.out.mixed_end.add(to_.line, line.size() + 1);
    if (line.find_first_not_of(" \t") == std::string_view::npos || empty_row(line)) {
      to_.out.blank.add(to_.line, 1);
      to_.out.account.blank_bytes += bytes;
      to_.list_lines();
    } else if (is_comment(line, to_.dialect.lines.semicolon_comments)) {
      to_.out.comment.add(to_.line, 1);
      to_.out.account.comment_bytes += bytes;
      to_.list_lines();
    } else if (to_.dialect.has_header && line == to_.dialect.header) {
      if (!to_.plan.skip_repeated_header) {
        fail("E0309", "the header line again, a row of numbers was expected (concatenated logs?)", std::string(line),
             "`skip_repeated_header` counts it and goes on", 0);
        return after;
      }
      to_.out.repeated.add(to_.line, 1);
      to_.out.account.header_bytes += bytes;
      to_.list_lines();
    } else if (!wanted(line) || (to_.plan.several_clocks && of_another_clock(line))) {
      leave_out(bytes);
    } else if (row_or_drop(line, bytes, kind != LineEnd::none)) {
      to_.out.account.row_bytes += bytes;
      to_.note_line();
      ++to_.rows;
      // A closing quote or a delimiter shows that the last cell is whole.
      if (kind == LineEnd::none && line.back() != '"' && line.back() != to_.dialect.delimiter)
        to_.out.unended = Spot{to_.line, line.size() + 1};
    }
    to_.line += more_lines;
    return after;
  }

  // Behind quoted cells that hold line ends.
  const char* end_of_row(const char* start, const char* stop, std::uint64_t& more_lines) {
    const std::string_view rest(start, static_cast<std::size_t>(end_ - start));
    const char* const end = start + row_end(rest, 0, to_.dialect.delimiter);
    more_lines = static_cast<std::uint64_t>(std::count(stop, end, to_.dialect.line_end == LineEnd::cr ? '\r' : '\n'));
    if (more_lines > 0) to_.list_lines();
    return end;
  }

  void fail(std::string code, std::string what, std::string got, std::string hint, std::size_t column) {
    to_.out.problem =
        RowProblem{{ErrorKind::input, std::move(code), "", std::move(what), std::move(got), std::move(hint)},
                   {to_.line, column + 1},
                   static_cast<std::uint64_t>(line_start_ - begin_) + column};
  }

  struct Span {
    std::size_t from = 0, to = 0;  // the trimmed cell
    std::size_t start = 0;         // of the field (its quote)
    std::size_t next = 0;          // where the next field starts
    bool last = false, ok = true;
  };

  bool ends(char c) const { return to_.dialect.delimiter == ' ' ? blank(c) : c == to_.dialect.delimiter; }

  // The stamp that a terminal put in front of the line.
  bool lead_field(std::string_view line, Span& span) const {
    std::size_t after = 0;
    const auto lead = lead_of(line, to_.dialect.lead, after);
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
    if (i == 0 && !to_.dialect.lead.empty() && lead_field(line, span)) return span;
    const auto pad = [&](std::size_t k) { return k < line.size() && blank(line[k]) && !ends(line[k]); };
    if (to_.dialect.delimiter == ' ')
      while (i < line.size() && blank(line[i])) ++i;
    while (pad(i)) ++i;
    span.start = i;
    if (i < line.size() && line[i] == '"') {
      std::size_t close = line.find('"', i + 1);
      while (close < line.size() - 1 && line[close + 1] == '"') close = line.find('"', close + 2);
      if (close == std::string_view::npos) {
        fail("E0306", "a quote is opened here and not closed in this line", std::string(line.substr(i)), "", i);
        span.ok = false;
        return span;
      }
      span.from = i + 1;
      span.to = close;
      i = close + 1;
      if (i < line.size() && !ends(line[i]) && !blank(line[i])) {
        fail("E0306", "text after a closing quote, a delimiter was expected", std::string(line.substr(span.start)), "",
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
    while (span.to > span.from && (blank(line[span.to - 1]) || line[span.to - 1] == '\n' || line[span.to - 1] == '\r'))
      --span.to;
    if (to_.dialect.delimiter == ' ')
      while (i + 1 < line.size() && blank(line[i + 1])) ++i;
    span.last = i >= line.size() || (to_.dialect.delimiter == ' ' && i + 1 >= line.size());
    span.next = i + 1;
    if (i - span.start > kMaxField) {
      fail("E0305", fmt::format("field longer than 128 KiB ({} bytes)", i - span.start),
           std::string(line.substr(span.start, 60)), "", span.start);
      span.ok = false;
    }
    return span;
  }

  void leave_out(std::uint64_t bytes) {
    if (to_.out.problem) return;
    if (to_.out.footer) return fail("E0327", "rows of another kind", "", "", 0);
    ++to_.out.filtered;
    to_.out.account.filtered_bytes += bytes;
    to_.list_lines();
  }

  // What programs write below a table: "Average,1.2", "(2500 rows)", "*** END OF DATA ***".
  bool like_footer(std::string_view line) const {
    const std::string_view text = trimmed(line);
    std::size_t letters = 0, most = 0;
    for (const char c : text) most = std::max(most, letters = ascii_letter(c) ? letters + 1 : 0);
    constexpr std::size_t kWord = 3;
    if (most < kWord) return false;
    const bool sign = text[0] == '-' || text[0] == '+' || text[0] == '.' || text[0] == '"';
    const bool digit = is_digit(text[sign && text.size() > 1 ? 1 : 0]);
    return !digit || (to_.dialect.delimiter != ' ' && line.find(to_.dialect.delimiter) == std::string_view::npos);
  }

  // Such a line, of which no cell was read, is a problem only if a row follows.
  void may_end(std::string_view line, const Account& before, std::uint64_t bytes) {
    Account& account = to_.out.account;
    if (!like_footer(line) || account.values != before.values || account.missing != before.missing ||
        account.rejected != before.rejected || account.stamps != before.stamps)
      return;
    account = before;
    account.comment_bytes += bytes;
    if (!to_.out.footer) to_.out.footer = std::move(to_.out.problem);
    to_.out.problem.reset();
    to_.out.footers.add(to_.line, 1);
    to_.list_lines();
  }

  // The end of the file is in the middle of this row: as with lines of words, a table has to come before it.
  void cut_off(const RowNotes& before, std::uint64_t bytes) {
    static_cast<RowNotes&>(to_.out) = before;
    to_.out.groups.resize(std::min(to_.out.groups.size(), to_.rows));
    to_.out.account.comment_bytes += bytes;
    to_.out.cut = Spot{to_.line, to_.out.problem->spot.column};
    if (!to_.out.footer) to_.out.footer = std::move(to_.out.problem);
    to_.out.problem.reset();
    to_.list_lines();
  }

  // A row that cannot be read is dropped where that is asked for; without stamps its instant stays,
  // as one of missing samples.
  bool row_or_drop(std::string_view line, std::uint64_t bytes, bool ended) {
    if (!to_.plan.drop_bad_rows) {
      const Account known = to_.out.account;
      const std::optional<RowNotes> notes = ended ? std::nullopt : std::optional<RowNotes>(to_.out);
      if (careful_row(line)) return true;
      if (std::string& hint = to_.out.problem->problem.hint; hint.empty())
        hint = "`drop_bad_rows` leaves out and counts rows that cannot be read";
      if (notes && !like_footer(line) && split(line, to_.dialect.delimiter).size() < to_.plan.target.size())
        cut_off(*notes, bytes);
      else
        may_end(line, known, bytes);
      return false;
    }
    RowNotes before = to_.out;
    if (careful_row(line)) return true;
    const std::uint64_t at = to_.out.problem->spot.column;
    static_cast<RowNotes&>(to_.out) = std::move(before);
    to_.out.problem.reset();
    to_.out.groups.resize(std::min(to_.out.groups.size(), to_.rows));
    to_.out.bad.add(to_.line, at);
    const bool instant = to_.dialect.time.column < 0 && to_.out.groups.empty() && has_number(line);
    if (instant)
      miss_row();
    else
      to_.out.account.filtered_bytes += bytes;
    if (!instant) to_.list_lines();
    return instant;
  }

  bool has_number(std::string_view line) const {
    const auto fields = split(line, to_.dialect.delimiter);
    return std::any_of(fields.begin(), fields.end(), [&](const Field& field) {
      return read_cell(field.text, to_.dialect.decimal).kind == Cell::value;
    });
  }

  void miss_row() {
    Account& account = to_.out.account;
    for (std::size_t c = 0; c < to_.plan.channels; ++c) {
      to_.columns[c][to_.rows] = kMissing;
      ++to_.out.missing_per_channel[c];
    }
    account.cells += to_.plan.target.size();
    account.missing += to_.plan.channels;
    account.unread += to_.plan.target.size() - to_.plan.channels;
  }

  // One table goes on where another one beside it has ended: neither a stamp nor a value of its own.
  bool of_another_clock(std::string_view line) const {
    const std::vector<Field> cells = split(line, to_.dialect.delimiter);
    bool empty = true;
    for (std::size_t c = 0; c < to_.plan.target.size() && empty; ++c)
      if (to_.plan.target[c] != Plan::kSkip && to_.dialect.columns[c].own_clock.empty())
        empty = c < cells.size() && trimmed(cells[c].text).empty();
    return empty;
  }

  // Does the row have the values that are asked for? Notes its group.
  bool wanted(std::string_view line) {
    if (to_.dialect.filters.empty() && to_.dialect.group_column < 0) return true;
    Span span;
    std::size_t i = 0;
    const int columns = static_cast<int>(to_.plan.target.size());
    for (int c = 0; c < columns && !span.last; ++c, i = span.next) {
      span = field(line, i);
      if (!span.ok) return false;
      const std::string_view text = line.substr(span.from, span.to - span.from);
      for (const RowFilter& filter : to_.dialect.filters)
        if (filter.column == c && text != filter.value) {
          if (filter.must) refuse_kind(text, span, filter);
          return false;
        }
      if (c == to_.dialect.group_column && !note_group(text, span)) return false;
    }
    return true;
  }

  void refuse_kind(std::string_view text, const Span& span, const RowFilter& filter) {
    const std::string& name = to_.dialect.columns[static_cast<std::size_t>(filter.column)].name;
    fail("E0327", fmt::format("rows of another kind begin: {} was {} before", name, filter.value), std::string(text),
         fmt::format("`where` {} reads these, `group_by` {} makes channels of each, `channels` '!{}' reads all rows",
                     shell_word(name + "=" + filter.value), shell_word(name), name),
         span.start);
  }

  bool note_group(std::string_view text, const Span& span) {
    const auto at = std::find(to_.dialect.groups.begin(), to_.dialect.groups.end(), text);
    if (at == to_.dialect.groups.end()) {
      fail("E0332",
           fmt::format("a value of the column of `group_by` that the first {} do not have",
                       plural(to_.dialect.groups.size(), "value")),
           std::string(text), "`where` reads one of them", span.start);
      return false;
    }
    to_.out.groups.resize(to_.rows);
    to_.out.groups.push_back(static_cast<std::uint32_t>(at - to_.dialect.groups.begin()));
    return true;
  }

  bool careful_row(std::string_view line) {
    const std::size_t count = to_.plan.target.size();
    if (to_.rows == to_.capacity) to_.grow();
    std::size_t i = 0;
    Span span;
    for (std::size_t c = 0; c < count; ++c) {
      span = field(line, i);
      if (!span.ok) return false;
      if (!cell(line, span, c)) return false;
      ++to_.out.account.cells;
      if (c + 1 < count && span.last) {
        fail("E0304", fmt::format("{} field{}, {} expected", c + 1, c == 0 ? "" : "s", count), std::string(line),
             few_hint(line), line.size());
        return false;
      }
      i = span.next;
    }
    if (span.last) return true;
    const Span extra = field(line, i);
    if (!extra.ok) return false;
    if (to_.dialect.lines.trailing_delimiter && extra.last && extra.from == extra.to) return true;
    std::size_t fields = count + 1;
    for (Span s = extra; s.ok && !s.last; ++fields) s = field(line, s.next);
    to_.out.problem.reset();  // a quote problem in the fields that are too many says less than their number
    fail("E0304", fmt::format("{} fields, {} expected", fields, count), std::string(line), many_hint(fields), i);
    return false;
  }

  std::string many_hint(std::size_t fields) const {
    const std::size_t count = to_.plan.target.size();
    if (to_.dialect.lines.trailing_delimiter && fields == count + 1)
      return fmt::format(
          "the lines before end with '{}' and nothing after it, which makes no column: name the columns in a header "
          "line{}",
          to_.dialect.delimiter, to_.dialect.has_header ? ", this one too" : "");
    if (fields == 2 * count && to_.dialect.delimiter == ',')
      return "are these decimal commas? write the file with another delimiter, such as ;";
    if (to_.dialect.lines.few_names)
      return fmt::format("line {} has no name for each column: name them all there, or `skip_rows` {} leaves it out",
                         to_.dialect.columns[0].line, to_.dialect.columns[0].line);
    return fmt::format("`drop_bad_rows` leaves such rows out; `delimiter`, if '{}' does not separate the fields",
                       to_.dialect.delimiter);
  }

  std::string few_hint(std::string_view line) const {
    for (const char other : {';', '\t', ','})
      if (other != to_.dialect.delimiter && other != to_.dialect.decimal && line.find(other) != std::string_view::npos)
        return "`delimiter`, if the guess is wrong; `skip_rows`, if the table starts later";
    return "";
  }

  bool cell(std::string_view line, const Span& span, std::size_t c) {
    const int target = to_.plan.target[c];
    std::string_view text = line.substr(span.from, span.to - span.from);
    if (target == Plan::kSkip) {
      ++to_.out.account.unread;
      return true;
    }
    if (!to_.dialect.columns[c].cell_unit.empty() && !take_off_unit(text, span, to_.dialect.columns[c].cell_unit))
      return false;
    return target < 0 ? stamp(text, span, target) : value(text, span, static_cast<std::size_t>(target));
  }

  // "0.005 sec" → "0.005" in a column of seconds. What is no number with a known unit is left as it is.
  bool take_off_unit(std::string_view& text, const Span& span, const std::string& unit) {
    const auto measured = number_and_unit(text);
    if (measured && same_unit(measured->unit, unit)) {
      text = measured->number;
      return true;
    }
    const bool bare = read_cell(text, to_.dialect.decimal).kind == Cell::value;
    if (!measured && !bare) return true;
    fail("E0333",
         bare ? fmt::format("a value without a unit, those before it are in {}", unit)
              : fmt::format("a value in {}, those before it are in {}", measured->unit, unit),
         std::string(text), "export the column with one unit, or with plain numbers", span.start);
    return false;
  }

  bool stamp(std::string_view text, const Span& span, int to) {
    std::size_t offset = 0;
    switch (to_.take_part(text, to, offset)) {
      case StampDefect::none:
        ++to_.out.account.stamps;
        return true;
      case StampDefect::missing:
        fail("E0313", "missing time stamp", std::string(text),
             "`drop_bad_rows` leaves such rows out, `time_column` none and `rate_hz` HZ ignore the stamps", span.start);
        break;
      case StampDefect::malformed: {
        if ((to == Plan::kTime ? to_.dialect.time : to_.dialect.more_time).calendar) {
          fail("E0321", "no date or clock time like those before it", std::string(text),
               read_calendar(text) ? "`date_order` day, month or year says which number of 05/01/24 comes first" : "",
               span.start);
          break;
        }
        const Cell why = read_cell(text, to_.dialect.decimal);
        fail("E0311",
             fmt::format("{} in the time column", why.kind == Cell::bad ? why.reason : "a number was expected"),
             std::string(text),
             "`drop_bad_rows` leaves such rows out; `time_column` none, `rate_hz` HZ and `channels` without the column "
             "do without it",
             span.from + (why.kind == Cell::bad ? why.offset : offset));
        break;
      }
      case StampDefect::out_of_range:
        fail("E0314", "time stamp does not fit 64-bit nanoseconds (a wild stamp, or the wrong `time_unit`?)",
             std::string(text), "`drop_bad_rows` leaves such rows out, `time_unit` s|ms|us|ns", span.start);
        break;
    }
    return false;
  }

  bool value(std::string_view text, const Span& span, std::size_t channel) {
    double& out = to_.columns[channel][to_.rows];
    const Cell cell = read_styled(text, {to_.dialect.decimal, to_.dialect.thousands});
    switch (cell.kind) {
      case Cell::value:
        out = cell.number;
        to_.out.fractional[channel] |= cell.integer ? 0U : 1U;
        to_.out.inexact_integers += cell.inexact_integer;
        if (cell.too_small) to_.out.too_small.add(to_.line, span.start + 1);
        ++to_.out.account.values;
        return true;
      case Cell::infinite:
        to_.out.infinite.add(to_.line, span.start + 1);
        break;
      case Cell::out_of_range:
        if (!to_.plan.overflow_as_missing) {
          fail("E0312", "number out of range", std::string(text), "`overflow_as_missing` counts it as missing",
               span.start);
          return false;
        }
        to_.out.overflow.add(to_.line, span.start + 1);
        break;
      case Cell::missing:
        to_.out.missing.add(to_.line, span.start + 1);
        break;
      case Cell::bad:
        fail("E0311", cell.reason, std::string(text), bad_hint(text, channel),
             span.from == span.to || cell.offset == 0 ? span.start : span.from + cell.offset);
        return false;
    }
    out = kMissing;
    ++to_.out.missing_per_channel[channel];
    ++(cell.kind == Cell::missing ? to_.out.account.missing : to_.out.account.rejected);
    return true;
  }

  std::string bad_hint(std::string_view text, std::size_t channel) const {
    if (text.starts_with("\xE2\x88\x92")) return "sed 's/\xE2\x88\x92/-/g' FILE writes '-'";
    if (to_.dialect.decimal == '.' && read_cell(text, ',').kind == Cell::value)
      return "`decimal` comma, if ',' is the decimal mark";
    if (to_.dialect.decimal == ',' && read_cell(text, '.').kind == Cell::value)
      return "`decimal` point, if '.' is the decimal mark";
    if (text.starts_with("0x") || text.starts_with("0X")) return kHexadecimal;
    const bool word = !text.empty() && std::none_of(text.begin(), text.end(), [](char c) { return is_digit(c); });
    const auto column = std::find(to_.plan.target.begin(), to_.plan.target.end(), static_cast<int>(channel));
    return fmt::format("`drop_bad_rows` leaves such rows out, `channels` '!{}' the column{}",
                       to_.dialect.columns[static_cast<std::size_t>(column - to_.plan.target.begin())].name,
                       word ? "; `skip_rows`, if the table starts later" : "");
  }

  Filling& to_;
  const char *begin_, *end_;
  const char* line_start_ = nullptr;
};

// Every byte and cell of the chunk, those of the quick rows included.
void account_for(Filling& to, std::uint64_t quick, std::uint64_t consumed) {
  const Plan& plan = to.plan;
  Account& account = to.out.account;
  const std::uint64_t stamps = (to.dialect.time.column >= 0 ? 1 : 0) + (to.dialect.more_time.column >= 0 ? 1 : 0);
  account.cells += quick * plan.target.size();
  account.values += quick * plan.channels;
  account.stamps += quick * stamps;
  account.unread += quick * (plan.target.size() - plan.channels - stamps);
  account.bytes = to.out.problem ? account.row_bytes + account.blank_bytes + account.comment_bytes +
                                       account.header_bytes + account.filtered_bytes
                                 : consumed;
}

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
  Filling to(plan, out);
  QuickRows quick(to, text);
  CarefulLines careful(to, text);
  const char* p = text.data();
  const char* const end = p + text.size();
  while (p < end && !out.problem) {
    const char* const start = p;
    if (!out.footer) p = quick.take(p);
    out.account.row_bytes += static_cast<std::uint64_t>(p - start);
    if (p == end) break;
    p = careful.take(p);
    ++to.line;
  }
  out.rows.rows = to.rows;
  out.lines = to.line;
  account_for(to, quick.taken(), static_cast<std::uint64_t>(p - text.data()));
}

}  // namespace libchar::csv
