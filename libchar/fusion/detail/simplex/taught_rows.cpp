#include "libchar/fusion/detail/simplex/taught_rows.hpp"

#include <algorithm>
#include <numeric>

#include "libchar/fusion/algorithm.hpp"

namespace libchar::fusion {
namespace {

constexpr std::size_t kTail = 4096;

}  // namespace

RecentPast::RecentPast(std::size_t sensors, std::size_t lags)
    : sensors_(sensors), lags_(lags), room_(lag(lags - 1) + 1), ring_(room_ * sensors) {}

void RecentPast::push(const double* y) {
  const double* const before = seen_ > 0 ? at(0) : nullptr;
  ++seen_;
  double* const to = ring_.data() + (seen_ - 1) % room_ * sensors_;
  for (std::size_t i = 0; i < sensors_; ++i) {
    if (usable(y[i]))
      to[i] = y[i];
    else
      to[i] = before != nullptr ? before[i] : 0;
  }
}

void RecentPast::copy_to(double* out) const {
  std::copy_n(at(0), sensors_, out);
  for (std::size_t j = 0; j < lags_; ++j) std::copy_n(at(lag(j)), sensors_, out + (j + 1) * sensors_);
}

double SensorSet::centre(const double* y) const {
  double first = 0, sum = 0, count = 0;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i] == 0) continue;
    if (count == 0) first = y[i];
    sum += y[i] - first;
    ++count;
  }
  return first + sum / count;
}

double SensorSet::fill(const double* past, double* z) const {
  const std::size_t n = used.size();
  const double c = centre(past);
  *z++ = c;
  for (std::size_t i = 0; i < n; ++i) *z++ = used[i] != 0 ? past[i] - c : 0;
  for (std::size_t j = 0; j < lags; ++j) *z++ = c - centre(past + (j + 1) * n);
  return c;
}

bool SensorSet::complete(const double* y) const {
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i] != 0 && !usable(y[i])) return false;
  return true;
}

TaughtRows::TaughtRows(std::size_t sensors, std::size_t lags, std::size_t most_rows, std::int64_t expected,
                       std::uint64_t seed)
    : sensors_(sensors),
      width_((lags + 1) * sensors),
      most_early_(most_rows * 3 / 4),
      most_late_(most_rows - most_rows * 3 / 4),
      most_tail_(std::min<std::size_t>(kTail, static_cast<std::size_t>(expected) / 4 + 1)),
      late_from_(expected - expected / 4),
      tail_(most_tail_ * (sensors + 2)),
      choice_(~seed) {}

void TaughtRows::keep(Reservoir& in, const RecentPast& past, double truth, double estimate) {
  const std::size_t most = &in == &late_ ? most_late_ : most_early_;
  std::size_t place = static_cast<std::size_t>(in.seen++);
  if (in.kept < most) {
    in.rows.resize(++in.kept * (width_ + 2));
    in.when.push_back(0);
  } else {
    place = static_cast<std::size_t>(0.5 * (choice_() + 1) * static_cast<double>(in.seen));
    if (place >= most) return;
  }
  in.when[place] = seen_;
  double* const to = in.rows.data() + place * (width_ + 2);
  past.copy_to(to);
  to[width_] = truth;
  to[width_ + 1] = estimate;
}

void TaughtRows::add(const RecentPast& past, double truth, double estimate) {
  const bool late = seen_ >= late_from_;
  if (past.full()) keep(late ? late_ : early_, past, truth, estimate);
  if (late && past.full()) {
    double* const to = tail_.data() + tail_at_ * (sensors_ + 2);
    std::vector<double> all(past.width());
    past.copy_to(all.data());
    std::copy_n(all.data(), sensors_, to);
    to[sensors_] = truth;
    to[sensors_ + 1] = estimate;
    tail_at_ = (tail_at_ + 1) % most_tail_;
    tail_kept_ = std::min(tail_kept_ + 1, most_tail_);
  }
  ++seen_;
}

const double* TaughtRows::tail_row(std::size_t k) const {
  const std::size_t first = tail_kept_ < most_tail_ ? 0 : tail_at_;
  return tail_.data() + (first + k) % most_tail_ * (sensors_ + 2);
}

void TaughtRows::sort(Reservoir& in) const {
  std::vector<std::size_t> order(in.kept);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return in.when[a] < in.when[b]; });
  std::vector<double> sorted;
  sorted.reserve(in.rows.size());
  const auto width = static_cast<std::ptrdiff_t>(width_ + 2);
  for (const std::size_t k : order) {
    const auto from = in.rows.begin() + static_cast<std::ptrdiff_t>(k) * width;
    sorted.insert(sorted.end(), from, from + width);
  }
  in.rows = std::move(sorted);
  in.when.clear();
}

void TaughtRows::put_in_order() {
  sort(early_);
  sort(late_);
}

void TaughtRows::release() {
  early_ = late_ = {};
  tail_kept_ = 0;
}

}  // namespace libchar::fusion
