#pragma once
// What the simplex keeps of its learning window, and what its network sees of an instant:
//
//   z = [ c_k,  y_i - c_k for each sensor,  c_k - c_(k-l) for lags l = 1, 4, 16 … ],   target t_k - c_k
//
// c is the mean of the sensors in use, so z is the sensors and their recent past, in a form in which small
// differences between sensors keep their digits.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "libchar/fusion/detail/simplex/network_fit.hpp"
#include "libchar/fusion/detail/uniform.hpp"

namespace libchar::fusion {

/// Samples of one instant and of those before it at the lags, a value a sensor each; lags rise.
class RecentPast {
 public:
  RecentPast(std::size_t sensors, std::size_t lags);
  /// A missing sample is held: what it was before.
  void push(const double* y);
  void forget() { seen_ = 0; }
  /// As far back as the longest lag.
  bool full() const { return seen_ > lag(lags_ - 1); }
  /// Present, then lag by lag: (lags + 1) x sensors values.
  void copy_to(double* out) const;
  std::size_t sensors() const { return sensors_; }
  std::size_t lags() const { return lags_; }
  std::size_t width() const { return (lags_ + 1) * sensors_; }
  static std::size_t lag(std::size_t j) { return std::size_t{1} << (2 * j); }

 private:
  const double* at(std::size_t back) const { return ring_.data() + (seen_ - 1 - back) % room_ * sensors_; }
  std::size_t sensors_, lags_, room_;
  std::size_t seen_ = 0;
  std::vector<double> ring_;
};

/// Which sensors a network sees, and its inputs from `RecentPast::copy_to`.
struct SensorSet {
  std::vector<char> used;
  std::size_t lags = 0;
  std::size_t inputs() const { return 1 + used.size() + lags; }
  /// Mean of the sensors in use of one instant.
  double centre(const double* y) const;
  /// Returns c_k.
  double fill(const double* past, double* z) const;
  bool complete(const double* y) const;
};

/// The learning window: two reservoirs (Vitter 1985) in order of time, the later one held out, and its last instants
/// as they followed each other.
class TaughtRows {
 public:
  /// Of a window of `expected` instants the last quarter is held out.
  TaughtRows(std::size_t sensors, std::size_t lags, std::size_t most_rows, std::int64_t expected, std::uint64_t seed);
  /// The past with its newest instant, the truth and the baseline's estimate of it; NaN: none.
  void add(const RecentPast& past, double truth, double estimate);
  /// The time of an instant without a truth has passed.
  void skip() { ++seen_; }
  void put_in_order();
  void release();

  std::size_t training() const { return early_.kept; }
  std::size_t held_out() const { return late_.kept; }
  std::size_t tail() const { return tail_kept_; }
  const double* past(std::size_t k) const { return row(k); }
  double truth(std::size_t k) const { return row(k)[width_]; }
  double estimate(std::size_t k) const { return row(k)[width_ + 1]; }
  /// The k-th of the last instants: samples, truth, the baseline's estimate.
  const double* tail_row(std::size_t k) const;
  std::size_t sensors() const { return sensors_; }

 private:
  struct Reservoir {
    std::vector<double> rows;
    std::vector<std::int64_t> when;
    std::size_t kept = 0;
    std::int64_t seen = 0;
  };
  void keep(Reservoir& in, const RecentPast& past, double truth, double estimate);
  void sort(Reservoir& in) const;
  const double* row(std::size_t k) const {
    const bool late = k >= early_.kept;
    return (late ? late_ : early_).rows.data() + (late ? k - early_.kept : k) * (width_ + 2);
  }

  std::size_t sensors_, width_, most_early_, most_late_, most_tail_;
  std::int64_t late_from_, seen_ = 0;
  Reservoir early_, late_;
  std::vector<double> tail_;
  std::size_t tail_kept_ = 0, tail_at_ = 0;
  Uniform choice_;
};

/// The rows as a set of sensors sees them.
struct RowsOfSet final : FitRows {
  const TaughtRows* rows = nullptr;
  const SensorSet* set = nullptr;
  double row(std::size_t k, double* input) const override { return rows->truth(k) - set->fill(rows->past(k), input); }
};

}  // namespace libchar::fusion
