// Parabolic deviation: F. Vernotte, M. Lenczner, P.-Y. Bourgeois, E. Rubiola, "The parabolic variance (PVAR): a wavelet
// variance based on the least-square fit", IEEE Trans. UFFC 63 (2016) 611-623, eq. 8. The frequency in two neighbouring
// windows of m phase points is the slope of the line that fits them best:
//
//   PVAR = 72 / (n m^4 tau^2) sum_i [ sum_{k<m} ((m-1)/2 - k) (x_{i+k} - x_{i+m+k}) ]^2
//
// i = 0 … n - 1, n = N - 2m + 1 (N rate samples; the last phase point is not used, as in
// SigmaTheta). At m = 1 no line fits one point: PVAR(1) is the Allan variance. By running sums of x
// and of k x a term takes a fixed number of operations: O(N) an averaging time.

#include <vector>

#include "libchar/allan/detail/family.hpp"
#include "libchar/core/parallel/parallel.hpp"

namespace libchar {
namespace {

constexpr std::size_t kTermByTerm = 16;  // of so few points sums beat differences of sums

/// sum_k ((m-1)/2 - k) x_{i+k}, window by window.
class Slopes {
 public:
  Slopes(std::span<const double> x, std::size_t m) : x_(x), m_(m) {
    if (m <= kTermByTerm) return;
    sum_.reserve(x.size() + 1);
    moment_.reserve(x.size() + 1);
    double sum = 0, moment = 0;
    for (std::size_t j = 0; j <= x.size(); ++j) {
      sum_.push_back(sum);
      moment_.push_back(moment);
      if (j == x.size()) break;
      sum += x[j];
      moment += static_cast<double>(j) * x[j];
    }
  }
  double at(std::size_t i) const {
    const double middle = static_cast<double>(m_ - 1) / 2;
    if (!sum_.empty())
      return (static_cast<double>(i) + middle) * (sum_[i + m_] - sum_[i]) - (moment_[i + m_] - moment_[i]);
    double slope = 0;
    for (std::size_t k = 0; k < m_; ++k) slope += (middle - static_cast<double>(k)) * x_[i + k];
    return slope;
  }

 private:
  std::span<const double> x_;
  std::size_t m_;
  std::vector<double> sum_, moment_;
};

double squared_slopes(const FamilyInput& input, std::size_t m, std::size_t first, std::size_t count) {
  std::vector<double> x(count + 2 * m);
  local_phase(input, first, x);
  double sum = 0;
  if (m == 1) {
    for (std::size_t i = 0; i < count; ++i) {
      const double d = (x[i + 2] - x[i + 1]) - (x[i + 1] - x[i]);
      sum += d * d;
    }
    return sum;
  }
  const Slopes slopes(x, m);
  for (std::size_t i = 0; i < count; ++i) {
    const double d = slopes.at(i) - slopes.at(i + m);
    sum += d * d;
  }
  return sum;
}

}  // namespace

std::vector<AllanPoint> parabolic_points(const FamilyInput& input, const DeviationRow&,
                                         const std::vector<std::uint64_t>& factors, std::vector<std::string>&) {
  std::vector<AllanPoint> points(factors.size());
  parallel::for_each(0, factors.size(), [&](std::size_t k) {
    const std::size_t m = detail::in_memory(factors[k]);
    FamilySum total;
    for (const IndexRange& s : input.stretches) {
      if (input.points(s) <= 2 * m) continue;
      const FamilySum sum =
          over_blocks(s.begin, input.points(s) - 2 * m, 1, std::max<std::size_t>(512, 2 * m),
                      [&](std::size_t first, std::size_t n) { return squared_slopes(input, m, first, n); });
      total.sum += sum.sum;
      total.terms += sum.terms;
    }
    const auto factor = static_cast<double>(m);
    const double divisor = m == 1 ? 2 : factor * factor * factor * factor / 72;
    points[k] = family_point(input, m, factor * input.dt_s, divisor, total);
  });
  return points;
}

}  // namespace libchar
