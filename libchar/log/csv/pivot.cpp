#include "libchar/log/csv/pivot.hpp"

#include <algorithm>

namespace libchar::csv {

Pivot::Pivot(std::size_t channels, std::size_t groups, bool timed, bool cycles)
    : channels_(channels),
      groups_(groups),
      timed_(timed),
      cycles_(cycles || !timed),
      values_(channels * groups, kMissing),
      filled_(groups, false) {}

void Pivot::begin(RowBlock& out) {
  out.rows = 0;
  out.columns.resize(channels_ * groups_);
  for (auto& column : out.columns) column.clear();
  out.time_ns.clear();
  out.line_offset.clear();
  out.first_line = line_;
}

void Pivot::emit(RowBlock& out) {
  for (std::size_t c = 0; c < values_.size(); ++c) out.columns[c].push_back(values_[c]);
  if (timed_) out.time_ns.push_back(stamp_);
  out.line_offset.push_back(static_cast<std::uint32_t>(line_ - out.first_line));
  ++out.rows;
  std::fill(values_.begin(), values_.end(), kMissing);
  std::fill(filled_.begin(), filled_.end(), false);
  any_ = false;
}

void Pivot::widen(RowBlock& block, const std::vector<std::uint32_t>& groups) {
  RowBlock out;
  if (!any_) line_ = block.first_line;
  begin(out);
  for (std::size_t i = 0; i < block.rows; ++i) {
    const std::uint32_t group = groups[i];
    const std::int64_t stamp = timed_ ? block.time_ns[i] : 0;
    if (any_ && (filled_[group] || (!cycles_ && stamp != stamp_))) emit(out);
    if (!any_) {
      any_ = true;
      stamp_ = stamp;
      line_ = block.first_line + (block.line_offset.empty() ? i : block.line_offset[i]);
    }
    filled_[group] = true;
    for (std::size_t c = 0; c < channels_; ++c)
      values_[group * channels_ + c] = block.columns[c][i];
  }
  block = std::move(out);
}

bool Pivot::flush(RowBlock& block) {
  if (!any_) return false;
  begin(block);
  emit(block);
  return true;
}

}  // namespace libchar::csv
