// LabVIEW's measurement files (.lvm; NI, "Specification for the LabVIEW Measurement File"): a header for the file, and
// segments with a header each. X_Columns says where the time stands: in one column, in one for each channel, or
// nowhere, where sample k of channel c is at X0[c] + k Delta_X[c]. Channels with unlike clocks have a column of stamps
// each. Segments, and packets of rows behind blank lines, go on in one table.
#include "libchar/log/csv/lvm_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/log/csv/head/dialect.hpp"
#include "libchar/log/csv/made_text.hpp"
#include "libchar/log/time/calendar.hpp"

namespace libchar::csv {
namespace {

constexpr std::string_view kEndOfHeader = "***End_of_Header***";

using Cells = std::vector<std::string>;

enum class TimeIn { no_column, one_column, a_column_each };

/// What the header of a segment says.
struct Segment {
  std::uint64_t line = 0;
  std::string date, clock, dimension;
  Cells units;
  double channels = 0;
  std::vector<double> x0, delta, samples;
};

class LvmRows final : public MadeText {
 public:
  LvmRows(std::function<std::size_t(char*, std::size_t)> stored, std::string file)
      : from_{std::move(stored)}, file_(std::move(file)) {}
  std::string_view what() const override { return "segments of a LabVIEW measurement file"; }

 protected:
  bool more(std::string& text) override {
    if (line_ == 0 && !read_file_header()) return false;
    for (Cells cells; next(cells);) {
      if (std::all_of(cells.begin(), cells.end(), [](const auto& c) { return c.empty(); })) {
        in_rows_ = false;
        continue;
      }
      // Behind a blank line rows go on (a header for the whole file), or a header follows.
      const bool numbers = cells[0].empty() || parse_double(pointed(cells[0])).has_value();
      if (in_rows_ || (numbers && !clocks_.empty()))
        row(cells, text);
      else
        begin_segment(std::move(cells), text);
      return true;
    }
    return false;
  }

 private:
  [[noreturn]] void refuse(std::string_view what, const std::string& got = "", const std::string& hint = "") const {
    throw input_error("E0340", fmt::format("{}:{}", file_, line_)).says("{}", what).got(got).hint(hint);
  }

  bool read_file_header() {
    for (Cells cells; next(cells);) {
      const std::string value = cells.size() > 1 ? cells[1] : "";
      if (cells[0] == "Separator") separator_ = value.starts_with("Comma") || value == "," ? ',' : '\t';
      if (cells[0].starts_with("Separator,")) separator_ = ',';
      if (cells[0] == "Decimal_Separator") decimal_ = value.empty() ? '.' : value[0];
      if (cells[0] == "X_Columns")
        time_ = value == "No" ? TimeIn::no_column : value == "Multi" ? TimeIn::a_column_each : TimeIn::one_column;
      if (cells[0] == "Time_Pref") absolute_ = value == "Absolute";
      if (cells[0] == kEndOfHeader) return true;
    }
    refuse("ends before ***End_of_Header***");
  }

  /// Up to the names of the columns.
  void begin_segment(Cells cells, std::string& text) {
    Segment segment;
    segment.line = line_;
    bool said = false;
    do {
      said = said || cells[0] == kEndOfHeader;
      if (said || cells[0] == "X_Value") break;
      header_line(cells, segment);
    } while (next(cells));
    if (said && !next(cells)) return;
    if (!segment.dimension.empty() && segment.dimension != "Time")
      refuse("holds values over another quantity than time", segment.dimension, "save the signal itself, over time");
    names(cells, segment, text);
  }

  void header_line(const Cells& cells, Segment& segment) {
    // A column of values each, of which LabVIEW leaves every other one empty where these are columns of stamps.
    const std::size_t each = time_ == TimeIn::a_column_each ? 2 : 1;
    const auto values = [&] {
      Cells out;
      for (std::size_t k = 1; k < cells.size(); k += each) out.push_back(cells[k]);
      return out;
    };
    const std::string value = cells.size() > 1 ? cells[1] : "";
    if (cells[0] == "Date") segment.date = value;
    if (cells[0] == "Time") segment.clock = value;
    if (cells[0] == "X_Dimension") segment.dimension = value;
    if (cells[0] == "Y_Unit_Label") segment.units = values();
    if (cells[0] == "Channels") segment.channels = parse_double(value).value_or(0);
    const auto numbers = [&](std::vector<double>& to) {
      for (const std::string& cell : values())
        if (!cell.empty()) to.push_back(number(cell));
    };
    const bool first = cells[0] == "X0";
    if (first && separator_ == '\t' && value.find(',') != std::string::npos) decimal_ = ',';  // old ones do not say
    if (first) numbers(segment.x0);
    if (cells[0] == "Delta_X") numbers(segment.delta);
    if (cells[0] == "Samples") numbers(segment.samples);
  }

  void names(const Cells& cells, const Segment& segment, std::string& text) {
    const std::size_t each = time_ == TimeIn::a_column_each ? 2 : 1;
    const std::size_t end = !cells.empty() && cells.back() == "Comment" ? cells.size() - 1 : cells.size();
    Cells channels;
    for (std::size_t k = 1; k < end; k += each) channels.push_back(cells[k]);
    const auto last = std::find_if(channels.rbegin(), channels.rend(), [](const auto& c) { return !c.empty(); });
    const auto named = static_cast<std::size_t>(channels.rend() - last);
    channels.resize(std::max(named, std::min(channels.size(), clamped_whole<std::size_t>(segment.channels))));
    in_rows_ = true;
    row_ = 0;
    const bool first = channels_.empty();
    if (!first && channels != channels_)
      refuse("a segment has other channels than the first", cells.back(),
             fmt::format("`head -n {0} FILE > first.lvm` and `sed {1},{0}d FILE > other.lvm` make two files of it",
                         segment.line - 1, first_line_));
    segment_ = segment;
    segment_.x0.resize(std::max<std::size_t>(channels.size(), 1), segment.x0.empty() ? 0 : segment.x0.back());
    segment_.delta.resize(segment_.x0.size(), segment.delta.empty() ? 0 : segment.delta.back());
    start_s_ = start_of(segment);
    if (!first) return;
    first_start_s_ = start_s_;
    first_line_ = segment.line;
    channels_ = channels;
    if (channels_.empty() || channels_.size() >= kMaxColumns / 2) refuse("names no channels");
    find_clocks();
    header(text);
  }

  /// The channels that are a column of stamps anew: the first, and each with a clock unlike that of the one before.
  void find_clocks() {
    clocks_ = {0};
    const auto written = time_ == TimeIn::a_column_each ? rows_ahead() : std::vector<Cells>{};
    const auto unlike = [&](std::size_t c, std::size_t other) {
      const auto differs = [&](const std::vector<double>& values) { return values[c] != values[other]; };
      const bool none = time_ == TimeIn::no_column && c < segment_.samples.size() && segment_.samples[c] == 0;
      return !none && ((time_ == TimeIn::no_column && (differs(segment_.x0) || differs(segment_.delta))) ||
                       std::any_of(written.begin(), written.end(), [&](const Cells& row) {
                         return 2 * c < row.size() && !row[2 * c].empty() && row[2 * c] != row[2 * other];
                       }));
    };
    for (std::size_t c = 1; c < channels_.size() && time_ != TimeIn::one_column; ++c) {
      if (!unlike(c, c - 1)) continue;
      clocks_.push_back(c);
      if (unlike(c, 0)) others_.push_back(c);
    }
  }

  void header(std::string& text) const {
    for (std::size_t c = 0, clock = 0; c < channels_.size(); ++c) {
      if (c > 0) text += ',';
      if (clock < clocks_.size() && clocks_[clock] == c) {
        text += "X_Value";
        if (std::find(others_.begin(), others_.end(), c) != others_.end()) text += fmt::format("_{}", c + 1);
        text += ',';
        ++clock;
      }
      const std::string unit = c < segment_.units.size() ? segment_.units[c] : "";
      const std::string name = channels_[c].empty() ? fmt::format("Untitled {}", c) : channels_[c];
      add_quoted(text, unit.empty() || name.ends_with(']') ? name : name + " [" + unit + "]");
    }
    text += '\n';
  }

  void row(Cells& cells, std::string& text) {
    const std::size_t n = channels_.size();
    const std::size_t each = time_ == TimeIn::a_column_each ? 2 : 1;
    cells.resize(each * n + (each == 1 ? 1 : 0));  // a comment may follow
    for (std::size_t c = 0, clock = 0; c < n; ++c) {
      if (c > 0) text += ',';
      const bool anew = clock < clocks_.size() && clocks_[clock] == c;
      std::string& cell = cells[each * c + 1];
      if (anew) {
        ++clock;
        const bool none = clocks_.size() > 1 && cell.empty();  // a shorter column ends before
        if (!none) text += shortest(stamp(cells, c));
        text += ',';
      } else if (each == 2 && !cells[2 * c].empty() && cells[2 * c] != cells[2 * clocks_[clock - 1]]) {
        refuse("channels whose clocks agree at first have clocks of their own", cells[2 * c],
               "save the file again with one time column (X Columns: One Only)");
      }
      if (decimal_ != '.') std::replace(cell.begin(), cell.end(), decimal_, '.');
      if (cell.find_first_of(",\"") == std::string::npos)
        text += cell;
      else
        add_quoted(text, cell);
    }
    ++row_;
    text += '\n';
  }

  /// Of a channel, in a segment or packet that begins again behind what came before.
  double stamp(const Cells& cells, std::size_t channel) {
    const double x0 = segment_.x0[channel], delta = segment_.delta[channel];
    const double x = time_ == TimeIn::no_column    ? x0 + static_cast<double>(row_) * delta
                     : time_ == TimeIn::one_column ? number(cells[0])
                                                   : number(cells[2 * channel]);
    if (channel == 0) {
      if (row_ == 0) shift_s_ = 0;
      if (row_ == 0 && any_ && x <= last_x_) shift_s_ = std::max(start_s_ - first_start_s_, 0.0);
      const bool again = row_ == 0 || x == x0;  // each packet, under one header, from X0 on
      if (any_ && again && x + shift_s_ <= last_x_) shift_s_ = last_x_ + delta - x;
      any_ = true;
      last_x_ = x + shift_s_;
    }
    constexpr double kFrom1904 = 2082844800;  // to 1970
    return x + shift_s_ - (absolute_ && segment_.x0[0] > kFrom1904 ? kFrom1904 : 0);
  }

  /// What of the segment is at hand.
  std::vector<Cells> rows_ahead() {
    constexpr std::size_t kAhead = std::size_t{1} << 15U;
    while (from_.raw.size() - from_.at < kAhead && from_.more()) {
    }
    std::vector<Cells> out;
    for (std::size_t at = from_.at; at < from_.raw.size();) {
      const std::size_t end = from_.raw.find(from_.line_end, at);
      if (end == std::string::npos) break;
      out.push_back(cells_of(std::string_view(from_.raw).substr(at, end - at)));
      if (out.back().size() < 2 || out.back()[0].empty()) return out;
      at = end + 1;
    }
    return out;
  }

  std::string pointed(std::string cell) const {
    if (decimal_ != '.') std::replace(cell.begin(), cell.end(), decimal_, '.');
    return cell;
  }

  double number(const std::string& cell) const {
    const auto value = parse_double(pointed(cell));
    if (!value) refuse("a number was expected", cell);
    return *value;
  }

  /// "2026/11/22" and "12:00:00,5": seconds since 1970.
  static double start_of(const Segment& segment) {
    std::string text = segment.date + " " + segment.clock;
    std::replace(text.begin(), text.end(), ',', '.');
    const auto start = read_calendar(text, DateOrder::year_first);
    return start ? static_cast<double>(start->ns) / 1e9 : 0;
  }

  /// What stands in special blocks is nobody's.
  bool next(Cells& cells) {
    std::string line;
    for (bool special = false; from_.line(line, kMaxLine);) {
      ++line_;
      if (line.size() > kMaxLine) refuse("a line of more than a MiB");
      special = special || line.starts_with("***Start_Special***");
      if (!special) {
        cells = cells_of(line);
        return true;
      }
      special = !line.starts_with("***End_Special***");
    }
    return false;
  }

  Cells cells_of(std::string_view line) const {
    Cells cells;
    while (line.ends_with('\r')) line.remove_suffix(1);
    for (std::size_t from = 0; from <= line.size();) {
      const std::size_t to = std::min(line.find(separator_, from), line.size());
      cells.emplace_back(line.substr(from, to - from));
      from = to + 1;
    }
    return cells;
  }

  Feed from_;
  std::string file_;
  std::uint64_t line_ = 0, first_line_ = 0, row_ = 0;  // of the segment
  bool in_rows_ = false, any_ = false, absolute_ = false;
  char separator_ = '\t', decimal_ = '.';
  TimeIn time_ = TimeIn::one_column;
  Cells channels_;
  Segment segment_;                  // that is read; a value for each channel
  std::vector<std::size_t> clocks_;  // channels behind a column of stamps
  std::vector<std::size_t> others_;  // those of them whose stamps are not the first channel's
  double start_s_ = 0, first_start_s_ = 0, shift_s_ = 0, last_x_ = 0;
};

}  // namespace

bool is_lvm(std::string_view front) { return front.starts_with("LabVIEW Measurement"); }

std::unique_ptr<Unpacker> open_lvm_rows(std::function<std::size_t(char*, std::size_t)> stored,
                                        const std::string& file) {
  return std::make_unique<LvmRows>(std::move(stored), file);
}

}  // namespace libchar::csv
