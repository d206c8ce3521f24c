// A step at t0 has the coefficients s_k = -sqrt(2/n) sin(pi k t0/n) / (2 sin(pi k/2n)). With weights W_k = 1 / E c_k^2
// and coefficients r_k of what is not yet explained, for all t0 at once:
//   numerator    sum W s r = -sqrt(2/n) sum_k [W_k r_k / (2 sin)] sin(pi k t0/n)                one sum of sines
//   information  sum W s^2 = 1/2 (sum h - sum_k h_k cos(2 pi k t0/n)),  h = W (2/n) / (2 sin)^2  one inverse FFT
// less what the columns of the regression share with it (one sum of sines each). The numerators of neighbours differ by
// sqrt(2/n) sum W r cos(pi k (t0 + 1/2)/n), whose variance is the mean of W but at the ends: so the threshold knows how
// many independent scores there are. Interval of the place: the likelihood ratio of a change point has P(2 ln L falls
// by > x) = 1 - (1 - exp(-x/2))^2, 7.35 at 95 % (B. Hansen, Econometrica 68, 2000).

#include "libchar/fit/detail/events/scans.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "libchar/fit/detail/events/regression.hpp"
#include "libchar/fit/detail/record/cycles.hpp"
#include "libchar/spectrum/fft.hpp"

namespace libchar {

// Steps that something outside makes differ in size; those of a trap in a transistor, or of a loose contact, are all
// alike, and up follows down (M. J. Kirton and M. J. Uren, Advances in Physics 38, 1989). The size is the weighted mean
// of the steps' sizes.

namespace {

constexpr int kFewestJumps = 6;
constexpr double kAlike = 0.25;

/// How often a step follows one of its own sign: between these a jump went unfound.
int not_in_turn(std::span<const Event> events) {
  std::vector<std::pair<double, double>> steps;
  for (const Event& event : events)
    if (event.kind == EventKind::step) steps.emplace_back(event.at_s, event.size);
  std::sort(steps.begin(), steps.end());
  int same = 0;
  for (std::size_t i = 1; i < steps.size(); ++i) same += steps[i].second * steps[i - 1].second > 0 ? 1 : 0;
  return same;
}

}  // namespace

std::optional<Telegraph> telegraph_of(std::span<const Event> events, int further, double duration_s) {
  double weight = 0, sum = 0;
  int up = 0, down = 0;
  for (const Event& event : events) {
    if (event.kind != EventKind::step) continue;
    weight += 1 / (event.sd * event.sd);
    sum += std::abs(event.size) / (event.sd * event.sd);
    (event.size > 0 ? up : down) += 1;
  }
  if (up + down < kFewestJumps || std::min(up, down) < 2) return std::nullopt;
  if (4 * not_in_turn(events) > further) return std::nullopt;
  const double size = sum / weight;
  for (const Event& event : events) {
    if (event.kind != EventKind::step) continue;
    const double off = std::abs(std::abs(event.size) - size);
    if (off > 4 * event.sd || off > kAlike * size + 2 * event.sd) return std::nullopt;
  }
  const int jumps = up + down + further;
  return Telegraph{size, 1 / std::sqrt(weight), jumps, duration_s / (jumps + 1)};
}

// A warm-up a exp(-t/tau) begins with the record; of its time constant nothing is known, so that the largest score over
// a grid of tau is judged (scans.hpp). Its coefficients fall as 1/k^2 beyond k = n/(pi tau): what comes after fifty
// times that is left out of the scan.

namespace {

constexpr double kTauStep = 1.25;
constexpr double kLongest = 1.02;  ///< of the record: what takes longer is a ramp and its curvature

std::size_t room_for(double tau, const SeriesGrid& grid) {
  const double n = static_cast<double>(grid.points);
  return static_cast<std::size_t>(std::clamp(50 * n / (std::numbers::pi * tau), 64.0, n - 1));
}

std::vector<double> warm_up_column(double tau, const SeriesGrid& grid) {
  std::vector<double> column(std::min(room_for(tau, grid), grid.points - 1));
  fill_column({EventKind::warm_up, 0, 0, tau}, grid, column);
  return column;
}

/// Standard deviation of the difference of two scores, regression aside.
double distance_between(const std::vector<double>& longer, const std::vector<double>& shorter,
                        std::span<const double> weight) {
  const double both = weighted_product(weight, shorter, longer);
  const double square =
      weighted_product(weight, shorter, shorter) *
      weighted_product(weight, std::span(longer).first(shorter.size()), std::span(longer).first(shorter.size()));
  return std::sqrt(std::max(0.0, 2 - 2 * both / std::sqrt(square)));
}

}  // namespace

WarmUpScan scan_warm_ups(const Regression& beside, const SeriesGrid& grid, std::span<const double> weight) {
  WarmUpScan scan;
  const double n = static_cast<double>(grid.points);
  std::vector<double> before;
  for (double tau = std::max(8.0, n / 1000); tau < kLongest * n; tau *= kTauStep) {
    std::vector<double> column = warm_up_column(tau, grid);
    scan.tau.push_back(tau);
    scan.score.push_back(score_of(beside, column, weight).value());
    if (!before.empty()) scan.distance.push_back(distance_between(before, column, weight));
    if (std::abs(scan.score.back()) > std::abs(scan.score[scan.best])) scan.best = scan.score.size() - 1;
    before = std::move(column);
  }
  return scan;
}

double refined_tau(const WarmUpScan& scan, const Regression& beside, const SeriesGrid& grid,
                   std::span<const double> weight) {
  const auto gain = [&](double log_tau) {
    return std::abs(score_of(beside, warm_up_column(std::exp(log_tau), grid), weight).value());
  };
  const double centre = std::log(scan.tau[scan.best]);
  double low = centre - std::log(kTauStep);
  double high = std::min(centre + std::log(kTauStep), std::log(scan.tau.back()));
  for (int i = 0; i < 8; ++i) {  // thirds: down to a fiftieth of the grid's step
    const double third = (high - low) / 3;
    if (gain(low + third) > gain(high - third))
      high -= third;
    else
      low += third;
  }
  return std::exp(0.5 * (low + high));
}

namespace {

constexpr double kLeastPlace = 1.2, kMostPlace = 5.8;  ///< half periods
constexpr double kFastest = 5.55;                      ///< a best place beyond is the flank of a faster one
constexpr std::size_t kHeadOfCycle = 256;              ///< coefficients: the rest hold a hundred-thousandth of a cycle

CycleScan cycle_at(double place, const Regression& beside, std::size_t points, std::span<const double> weight) {
  const std::size_t head = std::min(kHeadOfCycle, weight.size());
  const detail::SineColumns sines(detail::off_grid(place), points);
  Eigen::MatrixX2d column(head, 2);
  Turning half(sines.half_unit);
  for (std::size_t k = 0; k < head; ++k) {
    half.next();
    column.row(static_cast<Eigen::Index>(k)) = sines.at(k + 1, half.sine, half.cosine);
  }
  const Eigen::Map<const Eigen::VectorXd> w(weight.data(), column.rows()), rest(beside.rest.data(), column.rows());
  const Eigen::MatrixX2d weighted = w.asDiagonal() * column;
  const Eigen::Vector2d numerator = weighted.transpose() * rest;
  Eigen::Matrix2d information = weighted.transpose() * column;
  const Eigen::Vector2d alone = information.diagonal();
  const auto count = static_cast<Eigen::Index>(beside.shape.size());
  Eigen::MatrixX2d cross(count, 2);
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::vector<double>& other = beside.column[static_cast<std::size_t>(i)];
    cross.row(i) = Eigen::Map<const Eigen::RowVectorXd>(other.data(), column.rows()) * weighted;
  }
  if (count > 0) information -= cross.transpose() * beside.covariance * cross;
  CycleScan out{place, 0, 0};
  // What the others explain but for a thousandth is nothing new.
  if (!(information(0, 0) > 1e-3 * alone(0)) || !(information(1, 1) > 1e-3 * alone(1))) return out;
  const double left = 1 - information(0, 1) * information(0, 1) / (information(0, 0) * information(1, 1));
  if (!(left > 1e-6)) return out;
  const Eigen::Vector2d size = information.llt().solve(numerator);
  out.phase = std::atan2(size(1), size(0));
  out.score = std::sqrt(std::max(0.0, size.dot(numerator)));
  return out;
}

}  // namespace

CycleScan scan_cycles(const Regression& beside, const SeriesGrid& grid, std::span<const double> weight, double least) {
  constexpr double kStep = 0.15;
  constexpr double kBetween = 0.95;  ///< a score between two places is hardly more than the larger one
  const auto at = [&](double place) { return cycle_at(place, beside, grid.points, weight); };
  CycleScan best = at(kLeastPlace);
  for (double place = kLeastPlace + kStep; place < kMostPlace; place += kStep)
    if (CycleScan one = at(place); one.score > best.score) best = one;
  if (best.place > kFastest) return {best.place, best.phase, 0};
  if (best.score < kBetween * least) return best;
  double low = std::max(kLeastPlace, best.place - kStep), high = std::min(kMostPlace, best.place + kStep);
  for (int i = 0; i < 12; ++i) {
    const double third = (high - low) / 3;
    if (at(low + third).score > at(high - third).score)
      high -= third;
    else
      low += third;
  }
  const CycleScan between = at(0.5 * (low + high));
  return between.score > best.score ? between : best;
}

Score ramp_score(const Regression& beside, const SeriesGrid& grid, std::span<const double> weight) {
  std::vector<double> column(grid.points - 1);
  fill_column({EventKind::ramp}, grid, column);
  return score_of(beside, column, weight);
}

// The look-elsewhere effect. With d_i the standard deviation of the difference of neighbouring scores, Q the normal
// tail, phi its density:
//   rough    P(max > u) <= Q(u) + sum_i u phi(u) (d_i^2 / 2) nu(u d_i),
//            nu(x) = (2/x) (Phi(x/2) - 1/2) / ((x/2) Phi(x/2) + phi(x/2))
//            (D. Siegmund, Sequential Analysis, 1985; D. Siegmund and B. Yakir, The Statistics of Gene Mapping, 2007):
//            scores whose correlation falls linearly with distance, looked at in steps; far apart (x large) it is
//            Bonferroni's sum.
//   smooth   P(max > u) <= Q(u) + sum_i min(Q(u), a_i phi(u) / sqrt(2 pi)), a_i = 2 asin(d_i / 2): the length of the
//            curve that the scores' directions draw on the sphere (H. Hotelling, American Journal of Mathematics 61,
//            1939), and Bonferroni.
// Twice that for both signs. No constant of these is fitted: the threshold follows from the number of scores and from
// the model.

namespace {

double overshoot(double x) {
  if (x < 1e-6) return 1;
  const double half = x / 2, below = 1 - normal_tail(half);
  return 2 / x * (below - 0.5) / (half * below + normal_density(half));
}

/// u with exceedance(u) = alpha of a decreasing function.
template <typename Exceedance>
double bisect(const Exceedance& exceedance, double alpha) {
  double low = 0, high = 40;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (exceedance(middle) > alpha ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Distances in sixteen classes an octave: a class is at most two per cent from its members.
struct DistanceClasses {
  static constexpr int kOctaves = 48, kClasses = 16;
  std::array<double, kOctaves * kClasses + 1> count{};

  explicit DistanceClasses(std::span<const double> distance) {
    for (const double d : distance) {
      if (!(d > 0)) continue;
      const double octaves = std::clamp(std::log2(d) + kOctaves - 1, 0.0, double{kOctaves});
      count[static_cast<std::size_t>(octaves * kClasses + 0.5)] += 1;
    }
  }
  static double distance_of(std::size_t i) { return std::exp2(static_cast<double>(i) / kClasses - (kOctaves - 1)); }
};

}  // namespace

double normal_tail(double u) { return 0.5 * std::erfc(u / std::numbers::sqrt2); }

double normal_density(double u) { return std::exp(-0.5 * u * u) / std::sqrt(2 * std::numbers::pi); }

double rough_threshold(std::span<const double> distance, double alpha, double each) {
  const DistanceClasses classes(distance);
  const auto exceedance = [&](double u) {
    double sum = 0;
    for (std::size_t i = 0; i < classes.count.size(); ++i) {
      if (classes.count[i] == 0) continue;
      const double d = DistanceClasses::distance_of(i);
      sum += each * classes.count[i] * d * d / 2 * overshoot(u * d);
    }
    return 2 * (normal_tail(u) + u * normal_density(u) * sum);
  };
  return bisect(exceedance, alpha);
}

double smooth_threshold(std::span<const double> distance, double alpha) {
  const auto exceedance = [&](double u) {
    double sum = normal_tail(u);
    const double arc = normal_density(u) / std::sqrt(2 * std::numbers::pi);
    for (const double d : distance) sum += std::min(normal_tail(u), 2 * std::asin(std::min(1.0, d / 2)) * arc);
    return 2 * sum;
  };
  return bisect(exceedance, alpha);
}

namespace {

using std::numbers::pi;

constexpr double kPlaceDrop = 7.35;

/// 1 / (2 sin(pi k / 2n)) for k = 1..n-1 at [k-1].
std::vector<double> half_cosecants(std::size_t n) {
  std::vector<double> cosecant(n - 1);
  Turning half(pi / (2 * static_cast<double>(n)));
  for (double& value : cosecant) {
    half.next();
    value = 0.5 / half.sine;
  }
  return cosecant;
}

/// sum_k W_k s_k(t) x_k for every t.
std::vector<double> products(SineSums& sines, std::span<const double> weight, std::span<const double> cosecant,
                             std::span<const double> x) {
  const std::span<double> input = sines.input();
  const double scale = -std::sqrt(2 / static_cast<double>(input.size()));
  for (std::size_t k = 1; k < input.size(); ++k) input[k] = scale * weight[k - 1] * x[k - 1] * cosecant[k - 1];
  const std::span<const double> sums = sines.transform();
  return {sums.begin(), sums.end()};
}

/// [t]: sum W s^2 of a step at t. h is folded onto k <= n/2: cos(2 pi k t/n) is the same at n - k.
std::vector<double> step_information(std::span<const double> weight, std::span<const double> cosecant) {
  const std::size_t n = weight.size() + 1;
  RealFft fft(n);
  const auto bins = fft.coefficients();
  std::fill(bins.begin(), bins.end(), 0.0);
  double sum = 0;
  for (std::size_t k = 1; k < n; ++k) {
    const double h = 2 / static_cast<double>(n) * weight[k - 1] * cosecant[k - 1] * cosecant[k - 1];
    sum += h;
    bins[std::min(k, n - k)] += 2 * k == n ? h : h / 2;
  }
  const std::span<const double> cosines = fft.inverse();
  std::vector<double> information(n);
  for (std::size_t t = 0; t < n; ++t) information[t] = 0.5 * (sum - cosines[t]);
  return information;
}

/// What the columns already hold of a step at every place is taken from its information.
void subtract_shared(const Regression& beside, const std::vector<std::vector<double>>& cross,
                     std::vector<double>& information) {
  std::vector<double> shared(information.size(), 0.0);
  for (std::size_t i = 0; i < cross.size(); ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      const double times =
          (i == j ? 1 : 2) * beside.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      for (std::size_t t = 0; t < shared.size(); ++t) shared[t] += times * cross[i][t] * cross[j][t];
    }
  for (std::size_t t = 0; t < information.size(); ++t) {
    const double left = information[t] - shared[t];
    information[t] = left > 0.01 * information[t] ? left : 0;
  }
}

}  // namespace

StepScan scan_steps(const Regression& beside, std::span<const double> weight, std::size_t points, std::size_t margin) {
  const std::vector<double> cosecant = half_cosecants(points);
  SineSums sines(points);
  std::vector<double> information = step_information(weight, cosecant);
  double step = 0;
  for (const double w : weight) step += w / static_cast<double>(points);
  StepScan scan;
  for (std::size_t t = margin; t + 1 + margin < points; t += StepScan::kEvery) {
    const double both = std::sqrt(information[t] * information[t + 1]);
    const double shared = 0.5 * (information[t] + information[t + 1] - step);
    scan.distance.push_back(std::sqrt(std::max(0.0, 2 - 2 * shared / both)));
  }
  std::vector<std::vector<double>> cross;
  for (const std::vector<double>& column : beside.column) cross.push_back(products(sines, weight, cosecant, column));
  subtract_shared(beside, cross, information);
  scan.score = products(sines, weight, cosecant, beside.rest);
  for (std::size_t t = 0; t < points; ++t) {
    const bool looked_at = t >= margin && t + margin < points && information[t] > 0;
    scan.score[t] = looked_at ? scan.score[t] / std::sqrt(information[t]) : 0;
    if (std::abs(scan.score[t]) > std::abs(scan.score[scan.best])) scan.best = t;
  }
  return scan;
}

Interval step_place(const StepScan& scan, double at, std::size_t margin) {
  const std::size_t last = scan.score.size() - 1;
  const auto middle = std::min(last, static_cast<std::size_t>(at));
  const std::size_t reach = std::max<std::size_t>(margin, 8);
  std::size_t top = middle;
  for (std::size_t t = middle - std::min(middle, reach); t <= std::min(last, middle + reach); ++t)
    if (std::abs(scan.score[t]) > std::abs(scan.score[top])) top = t;
  const double best = scan.score[top], limit = best * best - kPlaceDrop;
  const auto in = [&](std::size_t t) { return scan.score[t] * best > 0 && scan.score[t] * scan.score[t] >= limit; };
  // Far away another step may stand: only what is joined to this place, but for dips shorter than the reach.
  std::size_t low = top, high = top;
  for (std::size_t t = top; t > 0 && low - t < reach; --t)
    if (in(t)) low = t;
  for (std::size_t t = top; t <= last && t - high < reach; ++t)
    if (in(t)) high = t;
  return {static_cast<double>(low), static_cast<double>(high)};
}

}  // namespace libchar
