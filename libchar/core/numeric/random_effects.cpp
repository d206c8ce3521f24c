// Q(s²) = sum_i (y_i - mu(s²))² / (v_i + s²), mu the mean with weights w_i = 1 / (v_i + s²), is chi-square with k - 1
// degrees of freedom at the true s² and falls as s² grows. So Q(s²) = k - 1 gives the spread (Paule & Mandel, J. Res.
// NBS 87 (1982) 377), and its 2.5 and 97.5 % quantiles an exact interval (Viechtbauer, Stat. Med. 26 (2007) 37). Values
// that lie closer together than their uncertainties let expect would give an upper limit of nearly nothing: it is not
// made less than it would be at the median of Q (power-constrained limit, Cowan et al., arXiv:1105.3166). Interval of
// the mean: Hartung & Knapp, Stat. Med. 20 (2001) 3875, not narrower than by the weights alone (Röver et al., BMC Med.
// Res. Methodol. 15 (2015) 99). Outliers by the generalised extreme deviate (Rosner, Technometrics 25 (1983) 165), with
// deleted residuals; its
// tests in a row take half of the probability each (measured: at most .9 % of 2000 lots of 4 to 40 for 1 %). That costs
// the cube of the count: of many values, those far off are taken out together, beginning with those far from the
// median, until who is out and who is in agree with what the values inside let expect; a value's own part in mean and
// spread is taken out to first order there.
#include "libchar/core/numeric/random_effects.hpp"

#include "libchar/core/not_known.hpp"
#include "libchar/core/numeric/distributions.hpp"
#include "libchar/core/numeric/median.hpp"

namespace libchar {
namespace {

double mean_of(std::span<const double> values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Variance of the mean of values whose spread is known.
double mean_variance(const Weighted& at, std::size_t count) {
  const double scatter = count > 1 ? at.q / static_cast<double>(count - 1) : 1;
  return std::max(1.0, scatter) / at.weights;
}

struct Deleted {
  std::vector<double> y, v;
};

Deleted without(std::span<const double> y, std::span<const double> v, std::size_t index) {
  Deleted out;
  for (std::size_t i = 0; i < y.size(); ++i) {
    if (i == index) continue;
    out.y.push_back(y[i]);
    out.v.push_back(v[i]);
  }
  return out;
}

/// The value that the others let expect least.
Outlier worst_of(std::span<const double> y, std::span<const double> v) {
  Outlier worst;
  const double count = static_cast<double>(y.size());
  for (std::size_t i = 0; i < y.size(); ++i) {
    const Deleted others = without(y, v, i);
    const double spread = random_effects(others.y, others.v).spread;
    const Weighted at = weighted(others.y, others.v, spread * spread);
    const double sd = std::sqrt(v[i] + spread * spread + mean_variance(at, others.y.size()));
    const double t = (y[i] - at.mean) / sd;
    const double tail = 2 * student_tail(std::abs(t), count - 2);
    const double p = std::min(1.0, count * tail);
    if (i == 0 || std::abs(t) > std::abs(worst.deviation)) worst = {i, t, p};
  }
  return worst;
}

/// Up to this many the worst is searched one by one.
constexpr std::size_t kFew = 60;

/// Values at the indices.
Deleted picked(std::span<const double> y, std::span<const double> v, const std::vector<bool>& out) {
  Deleted rest;
  for (std::size_t i = 0; i < y.size(); ++i) {
    if (out[i]) continue;
    rest.y.push_back(y[i]);
    rest.v.push_back(v[i]);
  }
  return rest;
}

/// Those more than five robust standard deviations off the median: what could hide others by its size.
std::vector<bool> far_off(std::span<const double> y, std::span<const double> v) {
  std::vector<double> sorted(y.begin(), y.end());
  const double median = median_in_place(sorted);
  for (std::size_t i = 0; i < y.size(); ++i) sorted[i] = std::abs(y[i] - median);
  const double sd = kMadToSd * median_in_place(sorted);
  std::vector<bool> out(y.size());
  for (std::size_t i = 0; i < y.size(); ++i) out[i] = std::abs(y[i] - median) > 5 * std::sqrt(sd * sd + v[i]);
  return out;
}

/// How far each is from what those inside, without itself, let expect: in standard deviations of that difference.
std::vector<double> deviations(std::span<const double> y, std::span<const double> v, const std::vector<bool>& outside) {
  const Deleted inside = picked(y, v, outside);
  const double spread = random_effects(inside.y, inside.v).spread, square = spread * spread;
  const Weighted at = weighted(inside.y, inside.v, square);
  const double count = static_cast<double>(inside.y.size());
  double slope = 0;  // of Q, with its sign turned
  for (std::size_t i = 0; i < inside.y.size(); ++i) {
    const double off = (inside.y[i] - at.mean) / (inside.v[i] + square);
    slope += off * off;
  }
  std::vector<double> out(y.size());
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double weight = 1 / (v[i] + square), off = y[i] - at.mean;
    if (outside[i]) {
      out[i] = off / std::sqrt(1 / weight + mean_variance(at, inside.y.size()));
      continue;
    }
    const double share = weight / at.weights, own = weight * off * off / (1 - share);
    // Q of the others is less by `own` and wants to be less by 1: the spread that does that. For equal uncertainties it
    // is exact.
    const double less = slope > 0 ? std::max(0.0, square + (1 - own) / slope * (count - 1) / (count - 2)) : square;
    out[i] = off / (1 - share) / std::sqrt(v[i] + less + (v[i] + less) / (1 / weight) / (at.weights * (1 - share)));
  }
  return out;
}

/// The way for many values: O(n log n).
std::vector<Outlier> outliers_of_many(std::span<const double> y, std::span<const double> v, double probability) {
  std::vector<bool> outside = far_off(y, v);
  std::vector<Outlier> out;
  const double count = static_cast<double>(y.size());
  for (int round = 0; round < 20; ++round) {
    const auto inside = static_cast<double>(std::count(outside.begin(), outside.end(), false));
    if (3 * inside < 2 * count) return {};  // a third of them are no outliers but another kind
    const std::vector<double> t = deviations(y, v, outside);
    const double least = -student_quantile(probability / 4 / count, inside - 2);
    std::vector<bool> next(y.size());
    out.clear();
    for (std::size_t i = 0; i < y.size(); ++i) {
      next[i] = std::abs(t[i]) > least;
      if (next[i]) out.push_back({i, t[i], std::min(1.0, count * 2 * student_tail(std::abs(t[i]), inside - 2))});
    }
    if (next == outside) break;
    outside = std::move(next);
  }
  std::sort(out.begin(), out.end(),
            [](const Outlier& a, const Outlier& b) { return std::abs(a.deviation) > std::abs(b.deviation); });
  return out;
}

}  // namespace

RandomEffects random_effects(std::span<const double> y, std::span<const double> v) {
  RandomEffects out;
  out.count = y.size();
  const double dof = static_cast<double>(y.size()) - 1;
  if (y.size() < 2) {
    const double half = kNormal95 * std::sqrt(v[0]);
    out.mean = y[0];
    out.mean_ci95 = {y[0] - half, y[0] + half};
    out.spread = kNone;
    out.spread_ci95 = {kNone, kNone};
    return out;
  }
  const double scale = mean_of(v);
  const auto q = [&](double square) { return weighted(y, v, square).q; };
  const double q0 = q(0), median = chi_square_quantile(0.5, dof), weights = weighted(y, v, 0).weights;
  const auto constrained = [&](double square) {
    return q0 >= median ? q(square) : median * weighted(y, v, square).weights / weights;
  };
  const double square = falls_to(q, dof, scale);
  out.spread = std::sqrt(square);
  out.spread_ci95 = {std::sqrt(falls_to(q, chi_square_quantile(0.975, dof), scale)),
                     std::sqrt(falls_to(constrained, chi_square_quantile(0.025, dof), scale))};
  out.p = chi_square_tail(q0, dof);
  const Weighted at = weighted(y, v, square);
  out.mean = at.mean;
  const double half = student_quantile(0.975, dof) * std::sqrt(mean_variance(at, y.size()));
  out.mean_ci95 = {at.mean - half, at.mean + half};
  return out;
}

std::vector<Outlier> find_outliers(std::span<const double> value, std::span<const double> variance,
                                   double probability) {
  if (value.size() > kFew) return outliers_of_many(value, variance, probability);
  std::vector<Outlier> out;
  std::size_t last = 0;
  std::vector<double> y(value.begin(), value.end()), v(variance.begin(), variance.end());
  std::vector<std::size_t> index(y.size());
  for (std::size_t i = 0; i < index.size(); ++i) index[i] = i;
  while (y.size() >= kFewestForOutliers && 3 * (out.size() + 1) <= value.size()) {
    const Outlier worst = worst_of(y, v);
    out.push_back({index[worst.index], worst.deviation, worst.p});
    if (worst.p < probability / 2) last = out.size();
    const Deleted rest = without(y, v, worst.index);
    y = rest.y;
    v = rest.v;
    index.erase(index.begin() + static_cast<std::ptrdiff_t>(worst.index));
  }
  // Two of them hide each other until one is out: all up to the last that stands out then are outliers.
  out.resize(last);
  for (Outlier& one : out) one.p = std::min(one.p, probability);
  return out;
}

}  // namespace libchar
