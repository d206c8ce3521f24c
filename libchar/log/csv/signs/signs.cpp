#include "libchar/log/csv/signs/signs.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <utility>

#include "libchar/log/csv/line.hpp"
#include "libchar/log/csv/made_text.hpp"
#include "libchar/log/time/calendar.hpp"

namespace libchar::csv {
namespace {

// 'a','it''s': the same in quotes.
class FromApostrophes final : public DecodedText {
 public:
  explicit FromApostrophes(std::function<std::size_t(char*, std::size_t)> stored) : feed_{std::move(stored)} {}

  std::string_view what() const override { return "cells in apostrophes"; }

 private:
  void decode() override {
    done_ = !feed_.more();
    for (; feed_.at < feed_.raw.size(); ++feed_.at) take(feed_.raw[feed_.at]);
    if (done_ && closing_) text_ += '"';
  }

  void take(char c) {
    if (std::exchange(closing_, false)) {
      if (c == '\'') {  // doubled
        text_ += c;
        return;
      }
      text_ += '"';
      open_ = false;
    }
    if (c == '\'' && open_) {
      closing_ = true;
    } else if (c == '\'' && begins_) {
      text_ += '"';
      open_ = true;
    } else {
      text_ += c;
      if (c == '"' && open_) text_ += c;
    }
    begins_ = !open_ && std::string_view(",;\t| \r\n").find(c) != std::string_view::npos;
  }

  Feed feed_;
  bool open_ = false, closing_ = false, begins_ = true;
};

constexpr std::string_view kBar = "\xE2\x94\x82";   // of "│ 0.1 │ 0.2 │"
constexpr std::string_view kMark = "\xEF\xBB\xBF";  // of a file that was opened anew for each line
constexpr std::size_t kWeekday = 5;                 // bytes of "Sun, "
constexpr std::string_view kOpen = "[({", kClose = "])}";
constexpr std::array<std::string_view, 3> kBlanks = {"\xC2\xA0", "\xE2\x80\xAF", "\xE2\x80\x89"};

bool digit(std::string_view text, std::size_t at) { return at < text.size() && text[at] >= '0' && text[at] <= '9'; }
bool one_of(std::string_view set, char c) { return set.find(c) != std::string_view::npos; }

// "[0.05, 1.5],": where what stands inside begins and ends, the same twice for a line of another kind.
std::pair<std::size_t, std::size_t> inside(std::string_view line) {
  std::size_t from = line.find_first_not_of(" \t"), to = line.size();
  if (from == std::string_view::npos || !one_of(kOpen, line[from])) return {};
  while (from < to && (one_of(kOpen, line[from]) || line[from] == ' ')) ++from;
  while (to > from && one_of("])},; \t", line[to - 1])) --to;
  const std::string_view text = line.substr(from, to - from);
  const bool closed = line.find_first_of(kClose, to) != std::string_view::npos;
  const bool number = digit(text, 0) || (one_of("+-.", text.empty() ? ' ' : text[0]) && text.size() > 1);
  return closed && number && text.find_first_of("[](){}'\"") == std::string_view::npos
             ? std::pair(from, to)
             : std::pair<std::size_t, std::size_t>();
}

// Where "*5C" begins at the end of a line, npos where none does.
std::size_t checksum_at(std::string_view line) {
  constexpr std::size_t kLong = 3;
  const std::size_t at = line.size() < kLong + 1 || line[0] != '$' ? line.size() : line.size() - kLong;
  return at < line.size() && line[at] == '*' &&
                 line.find_first_not_of("0123456789ABCDEFabcdef", at + 1) == std::string_view::npos
             ? at
             : std::string_view::npos;
}

// "1.5D+03": is the D at this place the exponent's?
bool exponent_at(std::string_view line, std::size_t at) {
  if (at == 0 || (line[at] != 'D' && line[at] != 'd') || (!digit(line, at - 1) && line[at - 1] != '.')) return false;
  const bool sign = at + 1 < line.size() && one_of("+-", line[at + 1]);
  std::size_t end = at + (sign ? 2 : 1), digits = 0, from = at;
  for (; digit(line, end); ++end) ++digits;
  while (from > 0 && (digit(line, from - 1) || line[from - 1] == '.')) --from;
  return digits > 0 && digits < 4 && line.substr(from, at - from).find('.') != std::string_view::npos &&
         (end == line.size() || !std::isalnum(static_cast<unsigned char>(line[end])));
}

// A blank of typesetting between three digits and the digits before them; its bytes, 0 for none.
std::size_t thin_blank_at(std::string_view line, std::size_t at) {
  const std::string_view rest = line.substr(at);
  for (const std::string_view blank : kBlanks)
    if (rest.starts_with(blank) && at > 0 && digit(line, at - 1) && digit(rest, blank.size()) &&
        digit(rest, blank.size() + 2) && !digit(rest, blank.size() + 3))
      return blank.size();
  return 0;
}

// Where "Sun, " begins in front of "22 Nov 2026 12:00:00 +0000" (RFC 2822) without quotes, npos where none does.
std::size_t weekday_at(std::string_view line) {
  for (std::size_t at = line.find(", "); at != std::string_view::npos; at = line.find(", ", at + 1)) {
    const bool begins = at >= 3 && (at == 3 || one_of(",;\t", line[at - 4]));
    if (!begins || !digit(line, at + 2)) continue;
    const std::string_view date = line.substr(at - 3, line.find_first_of(",;\t\"", at + 2) - (at - 3));
    const auto stamp = read_calendar(date);
    if (stamp && stamp->date && stamp->clock && read_calendar(date.substr(kWeekday))) return at - 3;
  }
  return std::string_view::npos;
}

// SLIST of seismology ("TIMESERIES …, 20 sps, …, SLIST, …"), AT2 of PEER ("NPTS= 4096, DT= .005 SEC"), K-NET
// ("Sampling Freq(Hz) 100Hz", "Scale Factor …"): the samples of one channel stand beside and below each other.
bool lists_samples(std::string_view front) {
  constexpr std::size_t kHeader = 1024;
  const std::string_view head = front.substr(0, kHeader), first = head.substr(0, head.find('\n'));
  const auto says = [&](std::string_view text) { return head.find(text) != head.npos; };
  return (first.starts_with("TIMESERIES ") && first.find(" SLIST,") != first.npos) ||
         (says("TIME SERIES IN UNITS OF") && says("NPTS") && says("DT")) ||
         (first.starts_with("Origin") && says("\nSampling Freq(Hz)") && says("\nScale Factor"));
}

std::string without_colours(std::string line) {
  for (std::size_t at = line.find("\x1B["); at != std::string::npos; at = line.find("\x1B[", at))
    line.erase(at, line.find_first_not_of("0123456789;", at + 2) - at + 1);
  return line;
}

class FromSigns final : public CleanedLines {
 public:
  using CleanedLines::CleanedLines;

  std::string_view what() const override {
    return signs_.colours     ? "codes of a terminal's colours"
           : signs_.brackets  ? "lines in brackets"
           : signs_.checksums ? "lines with a checksum"
           : signs_.boxes     ? "tables drawn in boxes"
           : signs_.exponents ? "exponents of Fortran"
           : signs_.weekdays  ? "days of the week before dates"
           : signs_.marks     ? "byte-order marks in the lines"
           : signs_.listed    ? "samples that follow each other in a line"
                              : "blanks of typesetting";
  }

 private:
  void begin(std::string_view front) override { signs_ = signs_of(front); }

  void clean(std::string& line) override {
    if (signs_.listed) return one_below_the_other(line);
    if (signs_.marks && line.starts_with(kMark)) line.erase(0, kMark.size());
    for (std::size_t at = signs_.boxes ? line.find(kBar) : line.npos; at != line.npos; at = line.find(kBar, at))
      line.replace(at, kBar.size(), "|");
    if (signs_.colours) line = without_colours(std::move(line));
    if (const auto [from, to] = inside(line); signs_.brackets && to > 0) {
      std::fill(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(from), ' ');
      line.erase(to);
    }
    if (const std::size_t sum = checksum_at(line); signs_.checksums && sum != std::string::npos) line.erase(sum);
    if (const std::size_t day = signs_.weekdays ? weekday_at(line) : std::string::npos; day != std::string::npos)
      line.erase(day, kWeekday);
    for (std::size_t at = 0; at < line.size(); ++at) {
      if (signs_.exponents && exponent_at(line, at)) line[at] = 'E';
      if (const std::size_t bytes = signs_.typeset ? thin_blank_at(line, at) : 0; bytes > 0)
        line.replace(at, bytes, " ");
    }
  }

  static void one_below_the_other(std::string& line) {
    if (line.find_first_not_of("0123456789+-.eE \t") != line.npos) return;
    std::string out;
    for (std::size_t at = line.find_first_not_of(" \t"); at < line.size(); at = line.find_first_not_of(" \t", at)) {
      const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
      out.append(out.empty() ? "" : "\n").append(line, at, end - at);
      at = end;
    }
    line = std::move(out);
  }

  Signs signs_;
};

}  // namespace

bool in_apostrophes(std::string_view front) {
  const std::string_view line = front.substr(0, front.find_first_of("\r\n"));
  const auto signs = static_cast<std::size_t>(std::count(line.begin(), line.end(), '\''));
  return line.size() < front.size() && line.starts_with('\'') && line.ends_with('\'') && signs >= 4 && signs % 2 == 0;
}

std::unique_ptr<Unpacker> open_apostrophes(std::function<std::size_t(char*, std::size_t)> stored) {
  return std::make_unique<FromApostrophes>(std::move(stored));
}

Signs signs_of(std::string_view front) {
  constexpr std::size_t kFewest = 3;
  std::size_t lines = 0, brackets = 0, checksums = 0, exponents = 0, colours = 0, weekdays = 0, boxes = 0, marks = 0;
  Signs out;
  out.listed = lists_samples(front);
  for (std::size_t end = front.find('\n'); end != std::string_view::npos; end = front.find('\n')) {
    std::string_view line = front.substr(0, end);
    front.remove_prefix(end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    ++lines;
    colours += line.find("\x1B[") != std::string_view::npos ? 1 : 0;
    brackets += inside(line).second > 0 ? 1 : 0;
    boxes += line.starts_with(kBar) ? 1 : 0;
    marks += line.starts_with(kMark) ? 1 : 0;
    weekdays += weekday_at(line) != std::string_view::npos ? 1 : 0;
    checksums += checksum_at(line) != std::string_view::npos && !line.starts_with("$G") ? 1 : 0;
    for (std::size_t at = 0; at < line.size(); ++at) {
      if (line[at] == 'D' || line[at] == 'd') exponents += exponent_at(line, at) ? 1 : 0;
      if (static_cast<unsigned char>(line[at]) >= 0x80) out.typeset = out.typeset || thin_blank_at(line, at) > 0;
    }
  }
  const auto most = [&](std::size_t n) { return n >= kFewest && 4 * n >= 3 * lines; };
  out.brackets = most(brackets);
  out.checksums = most(checksums);
  out.weekdays = most(weekdays);
  out.boxes = boxes >= kFewest;
  out.marks = marks >= kFewest;
  out.exponents = exponents >= kFewest;
  out.colours = colours >= kFewest;
  return out;
}

std::unique_ptr<Unpacker> open_signs(std::function<std::size_t(char*, std::size_t)> stored) {
  return std::make_unique<FromSigns>(std::move(stored));
}

}  // namespace libchar::csv
