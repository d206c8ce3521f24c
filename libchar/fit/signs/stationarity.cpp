// A record of 128 pieces, eight in each of sixteen stretches; v the Allan variance of a piece at an
// octave that fits it sixteen times,
//   F = 8 var(mean of ln v of a stretch) / mean of (var of ln v within a stretch),
//   F(15, 112) where nothing changes slowly:
// analysis of variance, whose own scatter within a stretch serves heavy tails and whatever else
// chance does quickly. Longer averaging times, of whole stretches: Bartlett's test of equal
// variances (Proc. R. Soc. A 160, 1937) with the degrees of freedom f_i of each variance,
//   T = f ln(sum f_i v_i / f) - sum f_i ln v_i,   T / (1 + (sum 1/f_i - 1/f) / 45)  chi-square of 15,   f = sum f_i,
// divided by how much more than in Gaussian noise ln v scatters at the longest octave of the pieces
// (where that is half as much again, nothing is said of longer ones). Averaging times that are too
// long for sixteen stretches: of four, which hold them eight times. At .003 over the number of
// octaves, three in a thousand steady records are called unsteady, or fewer.
#include "libchar/fit/signs/stationarity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/numeric/distributions.hpp"
#include "libchar/core/numeric/present.hpp"
#include "libchar/core/numeric/random_effects.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/fit/curve/shaped_curves.hpp"
#include "libchar/fit/fit_result.hpp"
#include "libchar/fit/record/record_sums.hpp"
#include "libchar/fit/signs/event.hpp"

namespace libchar {
namespace {

constexpr std::size_t kStretches = 16, kPiecesEach = 8, kPieces = kStretches * kPiecesEach;
constexpr std::size_t kFewStretches = 4;  ///< for averaging times that are too long for sixteen
constexpr std::uint64_t kWindows = 16;    ///< averaging times in what is looked at, at least
constexpr std::uint64_t kFewWindows = 8;  ///< the same of the few
constexpr std::size_t kShortest = 8192;   ///< samples
constexpr double kUnsteady = 0.003, kNoticeable = 0.05;
constexpr double kMostMissing = 0.1;
constexpr double kTooHeavy = 1.5;  ///< excess of scatter: single samples carry whole stretches
constexpr double kNoMean = std::numeric_limits<double>::quiet_NaN();

/// ln of the Allan variance of every stretch at an octave, and the test of it.
struct OctaveTest {
  StretchSpread spread;
  std::vector<double> log_variance;  ///< of a stretch: mean of the logarithms of its pieces
  std::vector<double> deviation;     ///< of a stretch
  double within = 0;                 ///< variance of ln v of a piece within its stretch
};

using Curves = std::vector<AllanCurve>;

Curves curves_of(std::span<const double> values, std::size_t parts, double dt_s) {
  Curves curves;
  const std::size_t length = values.size() / parts;
  for (std::size_t part = 0; part < parts; ++part)
    curves.push_back(pyramid_deviation(values.subspan(part * length, length), dt_s));
  return curves;
}

/// The point of an averaging factor; null where there is none, or nothing varies.
const AllanPoint* point_of(const AllanCurve& curve, std::uint64_t m) {
  for (const AllanPoint& point : curve.points)
    if (point.m == m) return point.deviation > 0 ? &point : nullptr;
  return nullptr;
}

/// A record as the test sees it.
struct Tested {
  std::uint64_t samples = 0;
  double dt_s = 0;
  /// Allan deviations of the pieces at an averaging factor; empty: one of them has none
  std::function<std::vector<double>(std::uint64_t m)> pieces;
  std::function<AllanCurve()> curve_of_piece;  ///< of one of them, or of any record as long
  std::span<const double> means;
  std::uint64_t per_mean = 1;  ///< samples
};

/// n (1 - r)/(1 + r), r the correlation of neighbours.
double independent_among(const std::vector<double>& level) {
  const auto n = static_cast<double>(level.size());
  const double mean = mean_present(level);
  double power = 0, product = 0;
  for (std::size_t i = 0; i < level.size(); ++i) {
    power += (level[i] - mean) * (level[i] - mean);
    if (i > 0) product += (level[i] - mean) * (level[i - 1] - mean);
  }
  const double r = power > 0 ? std::clamp(product / power + 1 / n, 0.0, 0.9) : 0;
  return std::max(1.0, n * (1 - r) / (1 + r));
}

std::optional<OctaveTest> test_pieces(const Tested& record, std::uint64_t m) {
  const std::vector<double> deviations = record.pieces(m);
  if (deviations.empty()) return std::nullopt;
  OctaveTest test;
  test.spread.stretches = kStretches;
  test.spread.tau_s = static_cast<double>(m) * record.dt_s;
  test.log_variance.assign(kStretches, 0.0);
  double within = 0, mean = 0;
  for (std::size_t s = 0; s < kStretches; ++s) {
    std::array<double, kPiecesEach> y{};
    double variance = 0;
    for (std::size_t i = 0; i < kPiecesEach; ++i) {
      const double deviation = deviations[s * kPiecesEach + i];
      y[i] = 2 * std::log(deviation);
      test.log_variance[s] += y[i] / kPiecesEach;
      variance += deviation * deviation / kPiecesEach;
    }
    test.deviation.push_back(std::sqrt(variance));
    for (const double value : y) within += (value - test.log_variance[s]) * (value - test.log_variance[s]);
    mean += test.log_variance[s] / kStretches;
  }
  double between = 0;
  for (const double value : test.log_variance) between += (value - mean) * (value - mean);
  constexpr double kBetween = kStretches - 1, kWithin = kPieces - kStretches;
  within /= kWithin;
  between *= kPiecesEach / kBetween;
  if (!(within > 0)) return std::nullopt;
  test.within = within;
  test.spread.p = fisher_tail(between / within, kBetween, kWithin);
  test.spread.relative_sd = 0.5 * std::sqrt(std::max(0.0, between - within) / kPiecesEach);
  test.spread.independent = independent_among(test.log_variance);
  return test;
}

std::optional<OctaveTest> test_stretches(const Curves& stretches, std::uint64_t m, double inflation) {
  OctaveTest test;
  test.spread.stretches = stretches.size();
  std::vector<double> variances;
  double dof = 0, pooled = 0, sum = 0, inverse = 0, first = 0;
  for (const AllanCurve& curve : stretches) {
    const AllanPoint* point = point_of(curve, m);
    if (point == nullptr || !(point->edf > 2)) return std::nullopt;
    test.spread.tau_s = point->tau_s;
    const double y = 2 * std::log(point->deviation), own = point->edf / inflation;
    if (test.log_variance.empty()) first = y;  // variances of 1e-40 stay in range
    test.log_variance.push_back(y);
    test.deviation.push_back(point->deviation);
    variances.push_back(2 / own);
    dof += own;
    inverse += 1 / own;
    sum += own * y;
    pooled += own * std::exp(y - first);
  }
  const double t = dof * (first + std::log(pooled / dof)) - sum;
  const double free = static_cast<double>(stretches.size() - 1);
  test.spread.p = chi_square_tail(t / (1 + (inverse - 1 / dof) / (3 * free)), free);
  test.spread.relative_sd = 0.5 * random_effects(test.log_variance, variances).spread;
  test.spread.independent = independent_among(test.log_variance);
  return test;
}

/// Means of `r` values; missing where half of them are.
std::vector<double> means_of(std::span<const double> values, std::size_t r) {
  std::vector<double> means;
  for (std::size_t i = 0; i + r <= values.size(); i += r) {
    const auto part = values.subspan(i, r);
    const PresentMean mean = present_mean(part);
    means.push_back(2 * mean.count > r ? mean.mean : kNoMean);
  }
  return means;
}

/// Degrees of freedom of every point; stretches without missing samples have the same.
void add_dof(std::vector<AllanCurve>& curves, const NoiseFit& fit) {
  const AllanCurve* whole = nullptr;
  for (AllanCurve& curve : curves) {
    if (curve.missing > 0 || whole == nullptr)
      add_fit_intervals(curve, fit);
    else
      for (std::size_t i = 0; i < curve.points.size(); ++i) curve.points[i].edf = whole->points[i].edf;
    if (curve.missing == 0) whole = &curve;
  }
}

/// Curves of the stretches from a record's means of r samples, at the averaging factors of the record.
Curves coarse_curves(std::span<const double> means, std::size_t stretches, std::uint64_t r, double dt_s,
                     const NoiseFit& fit) {
  Curves curves = curves_of(means, stretches, dt_s * static_cast<double>(r));
  for (AllanCurve& curve : curves) {
    curve.dt_s = dt_s;
    curve.samples *= r;
    curve.missing *= r;
    for (AllanPoint& point : curve.points) point.m *= r;
  }
  add_dof(curves, fit);
  return curves;
}

/// How many times more than in Gaussian noise ln v scatters at this octave of the pieces: heavy tails.
double excess_scatter(const Tested& record, double within, std::uint64_t m, const NoiseFit& fit) {
  AllanCurve curve = record.curve_of_piece();
  add_fit_intervals(curve, fit);
  for (AllanPoint& point : curve.points) point.deviation = 1;
  const AllanPoint* point = point_of(curve, m);
  return point != nullptr && point->edf > 0 ? std::max(1.0, within * point->edf / 2) : 1;
}

std::vector<OctaveTest> octaves_of(const Tested& record, const NoiseFit& fit) {
  std::vector<OctaveTest> tests;
  const auto keep = [&](std::optional<OctaveTest> test) {
    if (test) tests.push_back(*test);
  };
  std::uint64_t m = 1;
  for (; m * kWindows <= record.samples / kPieces; m *= 2) keep(test_pieces(record, m));
  const double inflation = tests.empty() ? 1 : excess_scatter(record, tests.back().within, m / 2, fit);
  if (inflation > kTooHeavy) return tests;
  // From eight means on a pyramid's terms start often enough.
  std::vector<double> means(record.means.begin(), record.means.end());
  std::uint64_t r = record.per_mean;
  for (const auto& [parts, windows] : {std::pair{kStretches, kWindows}, std::pair{kFewStretches, kFewWindows}}) {
    const std::uint64_t before = r;
    r = std::max(before, m / 8);
    if (r > before) means = means_of(means, detail::in_memory(r / before));
    const Curves stretches = coarse_curves(means, parts, r, record.dt_s, fit);
    for (; m * windows <= record.samples / parts; m *= 2) keep(test_stretches(stretches, m, inflation));
  }
  return tests;
}

void describe_clearest(const OctaveTest& clearest, double duration_s, Stationarity& out) {
  const std::vector<double>& deviation = clearest.deviation;
  const auto [low, high] = std::minmax_element(deviation.begin(), deviation.end());
  double squares = 0;  // about the largest: squares of 1e-200 stay in range
  for (const double d : deviation) squares += (d / *high) * (d / *high);
  const double whole = *high * std::sqrt(squares / static_cast<double>(deviation.size()));
  out.clearest_tau_s = clearest.spread.tau_s;
  out.stretch_s = duration_s / static_cast<double>(deviation.size());
  const auto stretch = [&](std::vector<double>::const_iterator at) {
    const auto s = static_cast<double>(at - deviation.begin());
    return Interval{s * out.stretch_s, (s + 1) * out.stretch_s};
  };
  out.largest_s = stretch(high);
  out.smallest_s = stretch(low);
  out.largest = *high / whole;
  out.smallest = *low / whole;
}

std::string sentence_of(const Stationarity& found, double limit) {
  double first = 0, last = 0, there = 0;
  for (const StretchSpread& s : found.spread) {
    if (s.tau_s == found.clearest_tau_s) there = s.relative_sd;
    if (!(s.p < limit)) continue;
    if (first == 0) first = s.tau_s;
    last = s.tau_s;
  }
  return fmt::format(
      "The noise is not the same throughout: at an averaging time of {}, the Allan deviations of {} stretches vary by "
      "{} % (1 sd) more than chance explains: from {} times that of the whole recording ({} to {} s) to {} times ({} "
      "to {} s){}. "
      "Another recording may differ as much.",
      duration_text(found.clearest_tau_s), duration_text(found.stretch_s), number_text(100 * there, 2),
      number_text(found.smallest, 3), place_text(found.smallest_s.low), place_text(found.smallest_s.high),
      number_text(found.largest, 3), place_text(found.largest_s.low), place_text(found.largest_s.high),
      last > first ? fmt::format("; the same at other averaging times between {} and {}", duration_text(first),
                                 duration_text(last))
                   : "");
}

Stationarity test(const Tested& record, const NoiseFit& fit) {
  Stationarity out;
  const double size = static_cast<double>(record.samples);
  if (record.samples < kShortest || static_cast<double>(fit.samples) < (1 - kMostMissing) * size) return out;
  std::vector<OctaveTest> tests;
  try {
    tests = octaves_of(record, fit);
  } catch (const Error& error) {
    // A piece that is missing as a whole has no curve.
    if (error.problem().kind != ErrorKind::numeric) throw;
    return out;
  }
  if (tests.empty()) return out;
  out.tested = true;
  const double limit = kUnsteady / static_cast<double>(tests.size());
  const OctaveTest* clearest = &tests[0];
  for (const OctaveTest& test : tests) {
    out.spread.push_back(test.spread);
    if (test.spread.p < clearest->spread.p) clearest = &test;
    if (!(test.spread.p < limit)) continue;
    out.steady = false;
    out.noticeable |= test.spread.relative_sd > kNoticeable;
  }
  if (out.steady) return out;
  describe_clearest(*clearest, size * record.dt_s, out);
  out.sentence = sentence_of(out, limit);
  return out;
}

/// Without what drifts put there; NaN where a step is in the piece.
double without_events(double variance, std::span<const Event> events, double first, double length, double m,
                      double rate_hz) {
  std::vector<Event> drifts;
  for (const Event& event : events) {
    const double at = event.at_s * rate_hz;
    if (event.kind == EventKind::step && at > first - 1 && at < first + length + 1) return kNoMean;
    if (event.kind != EventKind::step) drifts.push_back(event);
  }
  const double middle = first + 0.5 * length;
  const double d = event_mean(drifts, rate_hz, middle, m) - event_mean(drifts, rate_hz, middle - m, m);
  const double left = variance - 0.5 * d * d;
  return left > 0 ? left : kNoMean;
}

/// A piece that has none gets the mean of the others of its stretch.
void fill_missing(std::vector<double>& variance) {
  for (std::size_t s = 0; s < kStretches; ++s) {
    const std::span<double> stretch(variance.data() + s * kPiecesEach, kPiecesEach);
    const double mean = mean_present(stretch);
    for (double& v : stretch)
      if (std::isnan(v)) v = mean;
  }
}

}  // namespace

Stationarity test_stationarity(std::span<const double> record, double rate_hz, const NoiseFit& fit) {
  if (record.size() < kShortest) return {};
  Tested tested{record.size(), 1 / rate_hz, {}, {}, record, 1};
  std::optional<Curves> curves;
  tested.pieces = [&](std::uint64_t m) {
    if (!curves) curves = curves_of(record, kPieces, 1 / rate_hz);
    std::vector<double> deviations;
    for (const AllanCurve& curve : *curves) {
      const AllanPoint* point = point_of(curve, m);
      if (point == nullptr) return std::vector<double>();
      deviations.push_back(point->deviation);
    }
    return deviations;
  };
  tested.curve_of_piece = [&] { return curves->front(); };
  return test(tested, fit);
}

Stationarity test_stationarity(const FittedSums& sums, std::span<const Event> events, double rate_hz,
                               const NoiseFit& fit) {
  std::vector<double> means = sums.means.means();
  const auto per_mean = static_cast<double>(sums.means.per_mean());
  if (!events.empty())
    for (std::size_t i = 0; i < means.size(); ++i)
      means[i] -= event_mean(events, rate_hz, static_cast<double>(i) * per_mean, per_mean);
  const std::uint64_t samples = sums.means.samples();
  Tested tested{samples, 1 / rate_hz, {}, {}, means, sums.means.per_mean()};
  tested.curve_of_piece = [&] {
    const std::uint64_t length = std::max(sums.pieces.shortest, samples / kPieces);
    return pyramid_deviation(std::vector<double>(detail::in_memory(length)), 1 / rate_hz);
  };
  tested.pieces = [&](std::uint64_t m) {
    const auto octave = static_cast<std::size_t>(std::bit_width(m)) - 1;
    if (octave >= sums.pieces.variance.size()) return std::vector<double>();
    std::vector<double> each = sums.pieces.variance[octave];
    const std::size_t together = each.size() / kPieces;
    if (together == 0) return std::vector<double>();
    const auto length = static_cast<double>(sums.pieces.length(octave));
    for (std::size_t i = 0; i < each.size() && !events.empty(); ++i)
      each[i] =
          without_events(each[i], events, static_cast<double>(i) * length, length, static_cast<double>(m), rate_hz);
    std::vector<double> variance;
    for (std::size_t i = 0; i < kPieces; ++i)
      variance.push_back(mean_present(std::span(each).subspan(i * together, together)));
    fill_missing(variance);
    for (double& v : variance) {
      if (!(v > 0)) return std::vector<double>();
      v = std::sqrt(v);
    }
    return variance;
  };
  return test(tested, fit);
}

StretchSpread detail::spread_at(const Stationarity& stationarity, double tau_s) {
  if (stationarity.steady) return {};
  const auto away = [&](const StretchSpread& s) { return std::abs(std::log(s.tau_s / tau_s)); };
  return *std::min_element(stationarity.spread.begin(), stationarity.spread.end(),
                           [&](const StretchSpread& a, const StretchSpread& b) { return away(a) < away(b); });
}

double spread_reach(const Stationarity& stationarity, double tau_s) {
  const StretchSpread nearest = detail::spread_at(stationarity, tau_s);
  if (!(nearest.relative_sd > 0)) return 0;
  const auto n = static_cast<double>(nearest.stretches);
  const double student = student_quantile(0.975, n - 1);
  return student * std::sqrt(1 + 1 / n) * nearest.relative_sd;
}

}  // namespace libchar
