// Errors of time over an interval tau = m dt (SP 1065, 5.2.17 and 5.2.18; ITU-T G.810), x in
// seconds times the unit of the rate:
//
//   MTIE     max_i ( max x - min x over x_i … x_{i+m} )
//   TIE rms  sqrt( mean_i (x_{i+m} - x_i)^2 )
//
// MTIE: extremes of windows of 2^k points from those of 2^(k-1); a window of any length is two of
// these that overlap. Factors go up, so that two arrays of the record's length do: O(N (log N +
// number of factors)). Maxima are exact, whatever their order.

#include <cmath>
#include <vector>

#include "libchar/allan/detail/family.hpp"
#include "libchar/core/parallel/parallel.hpp"

namespace libchar {
namespace {

/// Phase of the whole record, each stretch from zero on. A sum of two doubles: an offset of the
/// rate is not cancelled here.
std::vector<double> phase_of_stretches(const FamilyInput& input) {
  std::vector<double> x(input.record.size() + (input.data == DataKind::rate ? 1 : 0));
  for (const IndexRange& s : input.stretches) {
    DoubleDouble sum;
    for (std::size_t p = s.begin; p < s.begin + input.points(s); ++p) {
      if (input.data == DataKind::phase)
        x[p] = input.record[p] * input.scale - input.record[s.begin] * input.scale;
      else
        x[p] = sum.high + sum.low;
      if (input.data == DataKind::rate && p < s.end) sum = sum + DoubleDouble{input.record[p] * input.scale, 0};
    }
  }
  return x;
}

class Extremes {
 public:
  explicit Extremes(std::vector<double> x) : high_(x), low_(std::move(x)) {}

  /// Largest span of windows of `points` points that start at begin … end - 1.
  double largest_span(std::size_t points, std::size_t begin, std::size_t end) const {
    const std::size_t shift = points - width_;
    double most = 0;
    for (std::size_t i = begin; i < end; ++i)
      most = std::max(most, std::max(high_[i], high_[i + shift]) - std::min(low_[i], low_[i + shift]));
    return most;
  }
  void widen(std::size_t points) {
    for (; 2 * width_ <= points; width_ *= 2)
      for (std::size_t i = 0; i + width_ < high_.size(); ++i) {
        high_[i] = std::max(high_[i], high_[i + width_]);
        low_[i] = std::min(low_[i], low_[i + width_]);
      }
  }

 private:
  std::vector<double> high_, low_;
  std::size_t width_ = 1;
};

std::vector<AllanPoint> largest_intervals(const FamilyInput& input, const std::vector<std::uint64_t>& factors) {
  std::vector<AllanPoint> points(factors.size());
  Extremes extremes(phase_of_stretches(input));
  for (std::size_t k = 0; k < factors.size(); ++k) {
    const std::size_t m = detail::in_memory(factors[k]);
    extremes.widen(m + 1);
    double most = 0;
    AllanPoint& point = points[k];
    for (const IndexRange& s : input.stretches) {
      if (input.points(s) <= m) continue;
      point.terms += input.points(s) - m;
      most = std::max(most, extremes.largest_span(m + 1, s.begin, s.begin + input.points(s) - m));
    }
    point.m = m;
    point.deviation = most;
  }
  return points;
}

AllanPoint mean_square_interval(const FamilyInput& input, std::size_t m) {
  AllanPoint point;
  point.m = m;
  FamilySum total;
  for (const IndexRange& s : input.stretches) {
    if (input.points(s) <= m) continue;
    const FamilySum sum = over_blocks(s.begin, input.points(s) - m, 1, std::max<std::size_t>(512, m),
                                      [&](std::size_t first, std::size_t count) {
                                        std::vector<double> x(count + m);
                                        local_phase_with_offset(input, first, x);
                                        double squares = 0;
                                        for (std::size_t i = 0; i < count; ++i)
                                          squares += (x[i + m] - x[i]) * (x[i + m] - x[i]);
                                        return squares;
                                      });
    total.sum += sum.sum;
    total.terms += sum.terms;
  }
  point.terms = total.terms;
  if (total.terms > 0) point.deviation = std::sqrt(total.sum / static_cast<double>(total.terms));
  return point;
}

}  // namespace

std::vector<AllanPoint> interval_points(const FamilyInput& input, const DeviationRow& row,
                                        const std::vector<std::uint64_t>& factors, std::vector<std::string>&) {
  std::vector<AllanPoint> points(factors.size());
  if (row.type == DeviationType::mtie) {
    points = largest_intervals(input, factors);
  } else {
    parallel::for_each(0, factors.size(),
                       [&](std::size_t k) { points[k] = mean_square_interval(input, detail::in_memory(factors[k])); });
  }
  for (AllanPoint& point : points) {
    point.tau_s = static_cast<double>(point.m) * input.dt_s;
    point.deviation /= input.scale;
    if (input.data == DataKind::rate) point.deviation *= input.dt_s;
  }
  return points;
}

}  // namespace libchar
