#include "libchar/fusion/detail/fault/fault_isolation.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "libchar/fusion/algorithm.hpp"

namespace libchar::fusion {
namespace {

constexpr double kImpossible = std::numeric_limits<double>::infinity();

/// What weighted means of h_i x leave over: sums for the normal equations.
struct NormalSums {
  double matrix[kMaxStates][kMaxStates] = {};
  double right[kMaxStates] = {};
  double squares = 0;

  void add(double value, double weight, const Eigen::MatrixXd& h, int sensor, int r) {
    for (int a = 0; a < r; ++a) {
      const double wh = weight * h(sensor, a);
      right[a] += wh * value;
      for (int b = 0; b <= a; ++b) matrix[a][b] += wh * h(sensor, b);
    }
    squares += weight * value * value;
  }
  /// squares - right' matrix^-1 right by Cholesky; infinite when the input is not determined.
  double left(int r) {
    double explained = 0;
    for (int a = 0; a < r; ++a) {
      const double own = matrix[a][a];
      for (int b = 0; b < a; ++b) {
        for (int c = 0; c < b; ++c) matrix[a][b] -= matrix[a][c] * matrix[b][c];
        matrix[a][b] /= matrix[b][b];
        matrix[a][a] -= matrix[a][b] * matrix[a][b];
        right[a] -= matrix[a][b] * right[b];
      }
      if (!(matrix[a][a] > 1e-9 * own)) return kImpossible;
      matrix[a][a] = std::sqrt(matrix[a][a]);
      right[a] /= matrix[a][a];
      explained += right[a] * right[a];
    }
    return std::max(squares - explained, 0.0);
  }
};

/// Chi square of a consistent set: false once in some 1e5.
bool agrees(double misfit, double freedom) { return misfit <= freedom + 4 * std::sqrt(2 * freedom) + 8; }

}  // namespace

struct FaultIsolation::Sums {
  NormalSums means, slopes;
  int sensors = 0;
};

bool Isolation::consistent() const { return agrees(misfit, freedom); }

FaultIsolation::FaultIsolation(const Eigen::MatrixXd& h, std::size_t sensors)
    : h_(h), inputs_(static_cast<int>(h.cols())) {
  suspects_.reserve(sensors);
  tried_.reserve(std::size_t{1} << static_cast<unsigned>(kMostSuspects));
}

void FaultIsolation::add(Sums& sums, const WindowEvidence& e, int sensor) const {
  if (!(e.mean_weight > 0)) return;
  sums.means.add(e.mean, e.mean_weight, h_, sensor, inputs_);
  sums.slopes.add(e.slope, e.slope_weight, h_, sensor, inputs_);
  ++sums.sensors;
}

double FaultIsolation::left_over(const Sums& sums) const {
  Sums copy = sums;
  const double means = copy.means.left(inputs_);
  // An input that stands still has no slopes: nothing to contradict.
  const double slopes = copy.slopes.left(inputs_);
  return means + (slopes < kImpossible ? slopes : 0);
}

Isolation FaultIsolation::isolate(const std::vector<WindowEvidence>& evidence, const int* index, int m) {
  suspects_.clear();
  const auto of = [&](int k) -> const WindowEvidence& { return evidence[static_cast<std::size_t>(index[k])]; };
  for (int k = 0; k < std::min(m, 64); ++k) suspects_.push_back(k);
  std::stable_sort(suspects_.begin(), suspects_.end(), [&](int a, int b) { return of(a).suspicion > of(b).suspicion; });
  if (suspects_.size() > kMostSuspects) suspects_.resize(kMostSuspects);
  const auto count = static_cast<unsigned>(suspects_.size());
  std::uint64_t named = 0;
  for (const int k : suspects_) named |= std::uint64_t{1} << static_cast<unsigned>(k);
  Sums rest;
  for (int k = 0; k < m; ++k)
    if (k >= 64 || (named >> static_cast<unsigned>(k) & 1U) == 0) add(rest, of(k), index[k]);

  const int most = std::min(m / 2, m - inputs_ - 1);
  tried_.clear();
  Isolation result;
  result.cost = result.other_cost = kImpossible;
  for (std::uint64_t bits = 0; bits < std::uint64_t{1} << count; ++bits) {
    if (std::popcount(bits) > most) continue;
    Sums sums = rest;
    std::uint64_t set = 0;
    for (unsigned s = 0; s < count; ++s) {
      const int k = suspects_[s];
      if ((bits >> s & 1U) != 0)
        set |= std::uint64_t{1} << static_cast<unsigned>(k);
      else
        add(sums, of(k), index[k]);
    }
    const double misfit = left_over(sums);
    const double cost = misfit / 2 + kPrice * std::popcount(bits);
    tried_.push_back({cost, misfit, set});
    if (bits == 0) result.cost_of_none = cost;
    if (cost < result.cost) {
      result.cost = cost;
      result.best = set;
      result.misfit = misfit;
      result.freedom = 2.0 * std::max(sums.sensors - inputs_, 0);
    }
  }
  result.certain = result.best;
  const int size = std::popcount(result.best);
  for (const auto& [cost, misfit, set] : tried_) {
    // The other half, when it agrees with itself, may be the healthy one whatever its chi square.
    const bool other_half =
        2 * size == m && (set & result.best) == 0 && std::popcount(set) == size && agrees(misfit, result.freedom);
    if (cost < result.cost + kDoubt || other_half) result.certain &= set;
    if ((set & result.best) == 0 && set != 0 && cost < result.other_cost) {
      result.other_cost = cost;
      result.other = set;
    }
  }
  return result;
}

}  // namespace libchar::fusion
