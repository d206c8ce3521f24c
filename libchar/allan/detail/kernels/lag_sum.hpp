#pragma once
// Sums over millions of lags of a function that is smooth except at a few known points.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace libchar {

/// sum_{k = low}^{high} f(k), k integer, f analytic between the (real) breakpoints and evaluable at real k a few lags
/// away from them. Lags within kExact of a breakpoint are added one by one; in between, panels that double in length
/// away from the breakpoints are integrated by Gauss-Legendre and the integral turned into the sum by the
/// Euler-Maclaurin formula in its midpoint form, sum = integral_{a-1/2}^{b+1/2} f - [f'(b+1/2) - f'(a-1/2)]/24 + … The
/// value type needs += and a product with a double. The cost grows with the logarithm of the number of lags only.
template <typename Value, typename Function>
class LagSum {
 public:
  LagSum(const Function& f, double low, double high) : f_(f), low_(low), high_(high) {}

  Value over(std::vector<double> breakpoints) {
    std::sort(breakpoints.begin(), breakpoints.end());
    double from = low_;
    for (const double b : breakpoints) {
      if (b <= from) continue;
      if (b >= high_) break;
      const double to = std::floor(b);
      segment(from, to);
      from = to + 1;
    }
    segment(from, high_);
    return sum_;
  }

 private:
  static constexpr double kExact = 16;

  void add_each(double from, double to) {
    for (double k = from; k <= to; ++k) sum_ += f_(k);
  }

  void segment(double from, double to) {
    if (to - from < 6 * kExact) return add_each(from, to);
    const double a = from + kExact, b = to - kExact;
    add_each(from, a - 1);
    add_each(b + 1, to);
    sum_ += (f_(b + 1) * -1.0) * (1.0 / 24);
    sum_ += f_(b) * (1.0 / 24);
    sum_ += f_(a) * (1.0 / 24);
    sum_ += (f_(a - 1) * -1.0) * (1.0 / 24);
    panels(a - 0.5, b + 0.5);
  }

  void panels(double left, double right) {
    double length = kExact;
    for (; right - left > 3 * length; length *= 2) {
      panel(left, left + length);
      panel(right - length, right);
      left += length;
      right -= length;
    }
    const double middle = (left + right) / 2;
    panel(left, middle);
    panel(middle, right);
  }

  void panel(double a, double b) {
    static constexpr std::array<double, 4> kNode = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                                    0.9602898564975363};
    static constexpr std::array<double, 4> kWeight = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                                      0.1012285362903763};
    const double centre = (a + b) / 2, half = (b - a) / 2;
    for (std::size_t i = 0; i < kNode.size(); ++i) {
      sum_ += f_(centre - half * kNode[i]) * (half * kWeight[i]);
      sum_ += f_(centre + half * kNode[i]) * (half * kWeight[i]);
    }
  }

  const Function& f_;
  double low_, high_;
  Value sum_{};
};

template <typename Value, typename Function>
Value lag_sum(const Function& f, double low, double high, std::vector<double> breakpoints) {
  return LagSum<Value, Function>(f, low, high).over(std::move(breakpoints));
}

}  // namespace libchar
