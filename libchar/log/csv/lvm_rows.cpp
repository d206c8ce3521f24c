// LabVIEW's measurement files (.lvm; NI, "Specification for the LabVIEW Measurement File"): a header for the file, and
// segments with a header each. X_Columns says where the time stands: in one column, in one for each channel, or
// nowhere, where sample k is at X0 + k Delta_X. Segments go on in one table.
#include "libchar/log/csv/lvm_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/log/csv/head/dialect.hpp"
#include "libchar/log/csv/made_text.hpp"

namespace libchar::csv {
namespace {

constexpr std::string_view kEndOfHeader = "***End_of_Header***";

using Cells = std::vector<std::string>;

enum class TimeIn { no_column, one_column, a_column_each };

class LvmRows final : public MadeText {
 public:
  LvmRows(std::function<std::size_t(char*, std::size_t)> stored, std::string file)
      : from_{std::move(stored)}, file_(std::move(file)) {}
  std::string_view what() const override { return "segments of a LabVIEW measurement file"; }

 protected:
  bool more(std::string& text) override {
    if (line_ == 0 && !read_file_header()) return false;
    for (Cells cells; next(cells);) {
      const bool blank = std::all_of(cells.begin(), cells.end(), [](const auto& c) { return c.empty(); });
      if (blank) {
        in_rows_ = false;
      } else if (!in_rows_) {
        begin_segment(std::move(cells), text);
        return true;
      } else {
        row(cells, text);
        return true;
      }
    }
    return false;
  }

 private:
  [[noreturn]] void refuse(std::string_view what, const std::string& got = "") const {
    throw input_error("E0340", fmt::format("{}:{}", file_, line_)).says("{}", what).got(got);
  }

  bool read_file_header() {
    for (Cells cells; next(cells);) {
      const std::string value = cells.size() > 1 ? cells[1] : "";
      if (cells[0] == "Separator") separator_ = value.starts_with("Comma") || value == "," ? ',' : '\t';
      if (cells[0].starts_with("Separator,")) separator_ = ',';
      if (cells[0] == "Decimal_Separator") decimal_ = value.empty() ? '.' : value[0];
      if (cells[0] == "X_Columns")
        time_ = value == "No" ? TimeIn::no_column : value == "Multi" ? TimeIn::a_column_each : TimeIn::one_column;
      if (cells[0] == kEndOfHeader) return true;
    }
    refuse("ends before ***End_of_Header***");
  }

  /// Up to the names of the columns.
  void begin_segment(Cells cells, std::string& text) {
    Cells units;
    do {
      if (cells[0] == kEndOfHeader) break;
      cells.resize(std::max<std::size_t>(cells.size(), 2));
      if (cells[0] == "Time") clock_s_ = clock_of(cells[1]);
      if (cells[0] == "X0") x0_ = number(cells[1]);
      if (cells[0] == "Delta_X") delta_ = number(cells[1]);
      if (cells[0] == "Y_Unit_Label") units = {cells.begin() + 1, cells.end()};
      if (cells[0] == "X_Value") return names(cells, units, text);
    } while (next(cells));
    if (!next(cells)) return;
    names(cells, units, text);
  }

  void names(const Cells& cells, const Cells& units, std::string& text) {
    Cells channels;
    for (const std::string& name : cells)
      if (!name.empty() && name != "X_Value" && name != "Comment") channels.push_back(name);
    in_rows_ = true;
    row_ = 0;
    const bool first = channels_.empty();
    if (!first && channels != channels_) refuse("a segment has other channels than the first", cells.back());
    if (first) first_clock_s_ = clock_s_;
    shift_s_ = 0;
    if (!first) return;
    channels_ = channels;
    if (channels_.empty() || channels_.size() >= kMaxColumns) refuse("names no channels");
    text += "X_Value";
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      text += ',';
      const std::size_t at = time_ == TimeIn::a_column_each ? 2 * c : c;
      const std::string unit = at < units.size() ? units[at] : "";
      add_quoted(text, unit.empty() || channels_[c].ends_with(']') ? channels_[c] : channels_[c] + " [" + unit + "]");
    }
    text += '\n';
  }

  void row(Cells& cells, std::string& text) {
    const std::size_t n = channels_.size();
    const bool each = time_ == TimeIn::a_column_each;
    const std::size_t width = each ? 2 * n : n + 1;
    // A comment may follow; with a column of time for each channel a shorter one ends before.
    cells.resize(width);
    double x = time_ == TimeIn::no_column ? x0_ + static_cast<double>(row_) * delta_ : number(cells[0]);
    for (std::size_t c = 1; each && c < n; ++c)
      if (!cells[2 * c].empty() && std::fabs(number(cells[2 * c]) - x) > 1e-9 * std::max(1.0, std::fabs(x)))
        throw input_error("E0340", fmt::format("{}:{}", file_, line_))
            .says("channels have clocks of their own")
            .got(cells[2 * c])
            .hint("save the file again with one time column (X Columns: One Only)");
    if (row_ == 0 && any_ && x <= last_x_) shift_s_ = std::max(clock_s_ - first_clock_s_, 0.0);
    if (row_ == 0 && any_ && x + shift_s_ <= last_x_) shift_s_ = last_x_ + delta_ - x;
    ++row_;
    any_ = true;
    x += shift_s_;
    last_x_ = x;
    text += shortest(x);
    for (std::size_t c = 0; c < n; ++c) {
      std::string& cell = cells[each ? 2 * c + 1 : c + 1];
      if (decimal_ != '.') std::replace(cell.begin(), cell.end(), decimal_, '.');
      text += ',';
      if (cell.find_first_of(",\"") == std::string::npos)
        text += cell;
      else
        add_quoted(text, cell);
    }
    text += '\n';
  }

  double number(std::string cell) const {
    if (decimal_ != '.') std::replace(cell.begin(), cell.end(), decimal_, '.');
    const auto value = parse_double(cell);
    if (!value) refuse("a number was expected", cell);
    return *value;
  }

  /// "12:00:00.5": seconds of the day.
  double clock_of(std::string text) const {
    std::replace(text.begin(), text.end(), ',', '.');
    double sum = 0;
    for (std::size_t at = 0; at <= text.size();) {
      const std::size_t end = std::min(text.find(':', at), text.size());
      sum = 60 * sum + parse_double(text.substr(at, end - at)).value_or(0);
      at = end + 1;
    }
    return sum;
  }

  bool next(Cells& cells) {
    std::string line;
    if (!from_.line(line, kMaxLine)) return false;
    ++line_;
    if (line.size() > kMaxLine) refuse("a line of more than a MiB");
    cells.clear();
    for (std::size_t from = 0; from <= line.size();) {
      const std::size_t to = std::min(line.find(separator_, from), line.size());
      cells.emplace_back(line.substr(from, to - from));
      from = to + 1;
    }
    return true;
  }

  Feed from_;
  std::string file_;
  std::uint64_t line_ = 0, row_ = 0;  // of the segment
  bool in_rows_ = false, any_ = false;
  char separator_ = '\t', decimal_ = '.';
  TimeIn time_ = TimeIn::one_column;
  Cells channels_;
  double x0_ = 0, delta_ = 0, clock_s_ = 0, first_clock_s_ = 0, shift_s_ = 0, last_x_ = 0;
};

}  // namespace

bool is_lvm(std::string_view front) { return front.starts_with("LabVIEW Measurement"); }

std::unique_ptr<Unpacker> open_lvm_rows(std::function<std::size_t(char*, std::size_t)> stored,
                                        const std::string& file) {
  return std::make_unique<LvmRows>(std::move(stored), file);
}

}  // namespace libchar::csv
