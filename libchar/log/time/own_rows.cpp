#include <algorithm>
#include <cmath>

#include "libchar/core/numeric/median.hpp"
#include "libchar/log/time/grid.hpp"
#include "libchar/log/time/recent_stamps.hpp"

namespace libchar {
namespace {

constexpr std::size_t kRows = 1025, kMostRows = std::size_t{1} << 18U;  // looked at
constexpr std::size_t kKept = 4;                                        // at least
constexpr std::size_t kLearnt = 12;                                     // where there are as many
constexpr double kLeastBlank = 20;                                      // one row in so many, or
constexpr std::size_t kFewBlank = 3;                                    // steps over blanks that are none
constexpr std::size_t kRowsForFew = 8192;                               // looked at for these

}  // namespace

bool blank_row(const RowBlock& rows, std::size_t row) {
  return std::all_of(rows.columns.begin(), rows.columns.end(),
                     [&](const auto& column) { return std::isnan(column[row]); });
}

bool keeps_own_clock(std::vector<double> steps, std::vector<double> over_blanks, double blank_share) {
  constexpr std::size_t kFew = 10;  // of so few steps all have to be alike
  constexpr double kNone = 1.25;    // usual steps: over such a blank nothing is missing
  const bool few = kLeastBlank * blank_share < 1;
  if (over_blanks.size() < (few ? kFewBlank : 1)) return false;
  const double usual = median_in_place(steps, Middle::lower);
  const auto share = [&](const auto& holds) {
    return static_cast<double>(std::count_if(steps.begin(), steps.end(), holds)) / static_cast<double>(steps.size());
  };
  const double over_blank = median_in_place(over_blanks, Middle::lower);
  if (!(usual > 0) || !(over_blank > 0) || over_blank > (few ? kNone : 1.5) * usual) return false;
  if (steps.size() < kFew) return share([&](double step) { return std::fabs(step - usual) <= 0.25 * usual; }) == 1;
  return share([&](double step) { return step <= 0.55 * usual; }) <= 0.1;
}

bool OwnRows::decide(const RowBlock& rows) {
  for (std::size_t i = 0; i < rows.rows && !decided_; ++i) {
    const bool is_blank = blank_row(rows, i);
    if (!is_blank) {
      if (kept_ > 0) {
        const double step = step_between(last_, rows.time_ns[i]);
        steps_.push_back(step);
        if (last_blank_) over_blanks_.push_back(step);
      }
      last_ = rows.time_ns[i];
      ++kept_;
    }
    last_blank_ = is_blank;
    ++rows_;
    const bool unsure = !over_blanks_.empty() && over_blanks_.size() < kFewBlank && rows_ < kRowsForFew;
    if ((rows_ >= kRows && kept_ >= kLearnt && !unsure) || rows_ >= kMostRows) judge();
  }
  return decided_;
}

void OwnRows::decide_at_end() {
  if (!decided_) judge();
}

void OwnRows::judge() {
  decided_ = true;
  apart_ = kept_ >= kKept && keeps_own_clock(std::move(steps_), std::move(over_blanks_),
                                             static_cast<double>(rows_ - kept_) / static_cast<double>(rows_));
}

namespace {

/// Of each channel: fewer of very many.
std::size_t steps_kept(std::size_t channels) {
  constexpr std::size_t kValues = std::size_t{1} << 21U, kFew = 64;
  return std::max(kFew, kValues / std::max<std::size_t>(channels, 1));
}

}  // namespace

void ChannelClocks::look(const RowBlock& rows, std::size_t from, std::size_t to) {
  constexpr std::size_t kLook = 65536, kSteps = 1024;
  const std::size_t most = steps_kept(rows.columns.size());
  const auto enough = [&](const Values& channel) {
    return channel.steps.size() >= std::min(most, channel.over_blanks.size() < kFewBlank ? kRowsForFew : kSteps);
  };
  channels_.resize(rows.columns.size());
  const std::size_t end = std::min(to, from + kLook - std::min(rows_, kLook));
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    Values& channel = channels_[c];
    for (std::size_t i = from; i < end && !enough(channel); ++i) {
      ++channel.rows;
      if (std::isnan(rows.columns[c][i])) {
        channel.blank = true;
        continue;
      }
      const std::int64_t now = rows.time_ns.empty() ? static_cast<std::int64_t>(rows_ + i - from) : rows.time_ns[i];
      if (channel.count++ > 0) {
        channel.steps.push_back(step_between(channel.last, now));
        if (channel.blank) channel.over_blanks.push_back(channel.steps.back());
      }
      channel.last = now;
      channel.blank = false;
    }
  }
  rows_ += end - from;
}

double ChannelClocks::every(std::size_t channel) const {
  if (channel >= channels_.size()) return 1;
  const Values& of = channels_[channel];
  const auto rows = static_cast<double>(of.rows), count = static_cast<double>(of.count);
  if (of.steps.size() < kKept) return 1;
  return keeps_own_clock(of.steps, of.over_blanks, (rows - count) / rows) ? rows / count : 1;
}

namespace {

/// Keeps these rows of the block.
void keep_rows(RowBlock& rows, const std::vector<std::size_t>& kept) {
  if (rows.line_offset.empty() && rows.first_line > 0)
    for (std::size_t i = 0; i < rows.rows; ++i) rows.line_offset.push_back(static_cast<std::uint32_t>(i));
  const auto compact = [&](auto& values) {
    if (values.empty()) return;
    for (std::size_t k = 0; k < kept.size(); ++k) values[k] = values[kept[k]];
  };
  compact(rows.time_ns);
  compact(rows.line_offset);
  for (auto& column : rows.columns) compact(column);
  rows.rows = kept.size();
}

}  // namespace

std::size_t leave_out_blank_rows(RowBlock& rows) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < rows.rows; ++i)
    if (!blank_row(rows, i)) kept.push_back(i);
  const std::size_t left_out = rows.rows - kept.size();
  if (left_out > 0) keep_rows(rows, kept);
  return left_out;
}

bool CopiedRows::as_before(const RowBlock& rows, std::size_t row, const Before& before) const {
  const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  for (std::size_t c = 0; c < rows.columns.size(); ++c)
    if (!same(rows.columns[c][row], row > 0 ? rows.columns[c][row - 1] : before.values[c])) return false;
  return !rows.columns.empty();
}

void CopiedRows::keep_last(const RowBlock& rows, Before& before) {
  if (rows.rows == 0) return;
  before.any = true;
  before.stamp = rows.time_ns[rows.rows - 1];
  before.values.clear();
  for (const auto& column : rows.columns) before.values.push_back(column[rows.rows - 1]);
}

void CopiedRows::look(const RowBlock& rows) {
  constexpr std::size_t kPairs = 1024;
  const std::size_t seen = one_stamp_.all + unlike_.all;
  for (std::size_t i = 0; i < rows.rows && seen + i <= kPairs; ++i) {
    if (i == 0 && !looked_at_.any) continue;
    Pairs& pairs = rows.time_ns[i] == (i > 0 ? rows.time_ns[i - 1] : looked_at_.stamp) ? one_stamp_ : unlike_;
    ++pairs.all;
    pairs.alike += as_before(rows, i, looked_at_) ? 1 : 0;
  }
  keep_last(rows, looked_at_);
}

// Pairs of one stamp are copies where nearly all have the same values, and others so rarely that it is no chance. Where
// none of the first rows are a pair, those that come later are copies if values hardly ever stay.
void CopiedRows::decide() {
  constexpr double kNearlyAll = 0.95, kHardlyEver = 0.02, kAtTimes = 0.5, kNoChance = 1e-4;
  constexpr std::size_t kFewest = 8, kSome = 3;
  const auto share = [](const Pairs& pairs) {
    return static_cast<double>(pairs.alike) / static_cast<double>(std::max<std::size_t>(pairs.all, 1));
  };
  const double stay = share(unlike_);
  const bool change = unlike_.all >= kFewest && stay <= kHardlyEver;
  const bool no_chance =
      unlike_.all >= kSome && stay <= kAtTimes && std::pow(stay, static_cast<double>(one_stamp_.all)) < kNoChance;
  any_ = one_stamp_.all == 0 ? change : share(one_stamp_) >= kNearlyAll && (change || no_chance);
}

CopiedRows::Left CopiedRows::leave_out(RowBlock& rows) {
  Left left;
  if (!any_) return left;
  std::vector<std::size_t> kept;
  const auto copy = [&](std::size_t i) {
    return (i > 0 || passed_.any) && rows.time_ns[i] == (i > 0 ? rows.time_ns[i - 1] : passed_.stamp) &&
           as_before(rows, i, passed_);
  };
  std::size_t i = 0;
  while (i < rows.rows && !copy(i)) ++i;
  left.first = i;
  const bool some = i < rows.rows;
  if (some) {
    for (std::size_t k = 0; k < rows.rows; ++k)
      if (k < i || !copy(k)) kept.push_back(k);
    left.count = rows.rows - kept.size();
  }
  keep_last(rows, passed_);
  if (some) keep_rows(rows, kept);
  return left;
}

}  // namespace libchar
