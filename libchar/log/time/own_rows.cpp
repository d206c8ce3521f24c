#include <algorithm>
#include <cmath>

#include "libchar/core/numeric/median.hpp"
#include "libchar/log/time/grid.hpp"
#include "libchar/log/time/recent_stamps.hpp"

namespace libchar {
namespace {

constexpr std::size_t kRows = 1025, kMostRows = std::size_t{1} << 18U;  // looked at
constexpr std::size_t kKept = 4;                                        // at least

bool blank(const RowBlock& rows, std::size_t row) {
  return std::all_of(rows.columns.begin(), rows.columns.end(), [&](const auto& column) {
    return std::isnan(column[row]);
  });
}

}  // namespace

bool OwnRows::decide(const RowBlock& rows) {
  for (std::size_t i = 0; i < rows.rows && !decided_; ++i) {
    const bool is_blank = blank(rows, i);
    if (!is_blank) {
      behind_blank_ += last_blank_ && !kept_.empty();
      kept_.push_back(rows.time_ns[i]);
    }
    last_blank_ = is_blank;
    ++rows_;
    if ((rows_ >= kRows && kept_.size() >= kKept) || rows_ >= kMostRows) judge();
  }
  return decided_;
}

void OwnRows::decide_at_end() {
  if (!decided_) judge();
}

// Values missing at random leave steps of one, two, three intervals; a clock has one step.
void OwnRows::judge() {
  decided_ = true;
  std::vector<double> steps;
  for (std::size_t i = 1; i < kept_.size(); ++i)
    steps.push_back(step_between(kept_[i - 1], kept_[i]));
  if (kept_.size() < kKept || 20 * (rows_ - kept_.size()) < rows_ ||
      10 * behind_blank_ < 3 * kept_.size())
    return;
  const double usual = median_in_place(steps, Middle::lower);
  const auto near =
      static_cast<std::size_t>(std::count_if(steps.begin(), steps.end(), [&](double step) {
        return std::fabs(step - usual) <= 0.25 * usual;
      }));
  apart_ = usual > 0 && 10 * near >= 9 * steps.size();
}

std::size_t leave_out_blank_rows(RowBlock& rows) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < rows.rows; ++i)
    if (!blank(rows, i)) kept.push_back(i);
  const std::size_t left_out = rows.rows - kept.size();
  if (left_out == 0) return 0;
  if (rows.line_offset.empty() && rows.first_line > 0)
    for (std::size_t i = 0; i < rows.rows; ++i)
      rows.line_offset.push_back(static_cast<std::uint32_t>(i));
  const auto compact = [&](auto& values) {
    if (values.empty()) return;
    for (std::size_t k = 0; k < kept.size(); ++k) values[k] = values[kept[k]];
  };
  compact(rows.time_ns);
  compact(rows.line_offset);
  for (auto& column : rows.columns) compact(column);
  rows.rows = kept.size();
  return left_out;
}

}  // namespace libchar
