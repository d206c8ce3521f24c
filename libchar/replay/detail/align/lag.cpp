// The lag of the largest correlation coefficient (Knapp & Carter, IEEE Trans. ASSP 24 (1976)
// 320–327, without weighting):
//   r(l) = sum_k (s_{k+l} - ms)(x_k - mx) / sqrt(sum (s_{k+l} - ms)^2 sum (x_k - mx)^2)
// over the k at which both samples are there, means over the same k. The correlation of sampled band-limited signals is
// itself band-limited, so between its samples it is interpolated by a windowed sinc (Lanczos, 8 each side), and the top
// of each of its maxima is found by golden section; a parabola through three samples is off by up to a tenth of a
// sample. Long records are searched on means over blocks first, then sample by sample around the best lag.
#include "libchar/replay/detail/align/lag.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "libchar/core/not_known.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/fusion/tilt_angle.hpp"
#include "libchar/replay/detail/judge/mean_uncertainty.hpp"
#include "libchar/replay/detail/plan/plan.hpp"

namespace libchar {
namespace {

constexpr double kMostWork = 2e8;          // products of one search
constexpr std::int64_t kLobes = 8;         // of the interpolation
constexpr std::int64_t kFewestPairs = 10;  // that say anything
constexpr std::int64_t kRadius = 3;        // looked at around the best lag of blocks, in blocks
constexpr double kTie = 1e-3;              // coefficients nearer than this are one

using Series = std::vector<double>;

// About the mean of what is there: products of large offsets would eat the digits.
Series centred(std::span<const double> values, std::size_t count) {
  double sum = 0, seen = 0;
  std::size_t first = 0;
  while (first < count && !std::isfinite(values[first])) ++first;
  if (first == count) return Series(count, kNone);
  const double origin = values[first];
  for (std::size_t k = first; k < count; ++k)
    if (std::isfinite(values[k])) sum += values[k] - origin, ++seen;
  Series out(count, kNone);
  double largest = 0;
  for (std::size_t k = first; k < count; ++k)
    if (std::isfinite(values[k])) {
      out[k] = (values[k] - origin) - sum / seen;
      largest = std::max(largest, std::abs(out[k]));
    }
  // Into +-1: squares of extreme values neither overflow nor vanish. What is left of a constant is rounding.
  if (largest <= 1e-14 * std::abs(origin)) largest = 0;
  for (double& v : out) v = largest > 0 ? v / largest : v * 0;
  return out;
}

struct Pairs {
  double n = 0, s = 0, x = 0, ss = 0, xx = 0, sx = 0;
};

double coefficient(const Series& sensor, const Series& reference, std::int64_t lag, double fewest) {
  const auto count = static_cast<std::int64_t>(sensor.size());
  const std::int64_t from = std::max<std::int64_t>(0, -lag), to = std::min(count, count - lag);
  Pairs p;
  for (std::int64_t k = from; k < to; ++k) {
    const double s = sensor[static_cast<std::size_t>(k + lag)];
    const double x = reference[static_cast<std::size_t>(k)];
    if (std::isnan(s + x)) continue;
    p.n += 1;
    p.s += s;
    p.x += x;
    p.ss += s * s;
    p.xx += x * x;
    p.sx += s * x;
  }
  if (p.n < fewest) return kNone;
  const double ss = p.ss - p.s * p.s / p.n, xx = p.xx - p.x * p.x / p.n;
  if (!(ss > 1e-12 * p.ss) || !(xx > 1e-12 * p.xx)) return kNone;  // constant where they meet
  return std::clamp((p.sx - p.s * p.x / p.n) / std::sqrt(ss * xx), -1.0, 1.0);
}

Series block_means(const Series& values, std::int64_t size) {
  Series out;
  for (std::size_t k = 0; k + static_cast<std::size_t>(size) <= values.size(); k += static_cast<std::size_t>(size)) {
    double sum = 0, seen = 0;
    for (std::size_t i = k; i < k + static_cast<std::size_t>(size); ++i)
      if (!std::isnan(values[i])) sum += values[i], ++seen;
    out.push_back(2 * seen > static_cast<double>(size) ? sum / seen : kNone);
  }
  return out;
}

// Coefficients at the lags from, from + 1, ….
struct Curve {
  std::int64_t from = 0;
  Series r;
  std::int64_t lag(std::size_t i) const { return from + static_cast<std::int64_t>(i); }
};

Curve correlate(const Series& sensor, const Series& reference, std::int64_t from, std::int64_t to, double fewest) {
  Curve curve{from, {}};
  for (std::int64_t lag = from; lag <= to; ++lag) curve.r.push_back(coefficient(sensor, reference, lag, fewest));
  return curve;
}

// Index of the largest coefficient; of none when all are missing.
std::optional<std::size_t> largest(const Curve& curve) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < curve.r.size(); ++i)
    if (!std::isnan(curve.r[i]) && (!best || curve.r[i] > curve.r[*best])) best = i;
  return best;
}

double lanczos(double x) {
  if (x == 0) return 1;
  if (std::abs(x) >= kLobes) return 0;
  const double a = std::numbers::pi * x, b = a / static_cast<double>(kLobes);
  return std::sin(a) / a * std::sin(b) / b;
}

// The curve around one of its samples.
class Peak {
 public:
  Peak(const Curve& curve, std::size_t at) {
    for (std::int64_t i = -kLobes; i <= kLobes; ++i) {
      const auto k = static_cast<std::int64_t>(at) + i;
      const bool there = k >= 0 && k < std::ssize(curve.r);
      const double r = there ? curve.r[static_cast<std::size_t>(k)] : kNone;
      around_[static_cast<std::size_t>(i + kLobes)] = std::isnan(r) ? curve.r[at] : r;
    }
  }
  double at(double offset) const {
    double sum = 0, weights = 0;
    for (std::int64_t i = -kLobes; i <= kLobes; ++i) {
      const double w = lanczos(offset - static_cast<double>(i));
      sum += w * around_[static_cast<std::size_t>(i + kLobes)];
      weights += w;
    }
    return sum / weights;
  }
  /// Top of the curve within one sample: golden section.
  double top() const {
    constexpr double kGolden = 0.6180339887498949;
    double low = -1, high = 1, a = high - kGolden * 2, b = low + kGolden * 2;
    double at_a = at(a), at_b = at(b);
    while (high - low > 1e-7) {
      if (at_a > at_b) {
        high = b, b = a, at_b = at_a;
        a = high - kGolden * (high - low), at_a = at(a);
      } else {
        low = a, a = b, at_a = at_b;
        b = low + kGolden * (high - low), at_b = at(b);
      }
    }
    return (low + high) / 2;
  }

 private:
  std::array<double, 2 * kLobes + 1> around_;
};

struct Top {
  double lag, correlation;
};

// The tops of all local maxima within +-most that may be the highest.
std::vector<Top> tops(const Curve& curve, std::int64_t most, double best) {
  std::vector<Top> found;
  for (std::size_t i = 1; i + 1 < curve.r.size(); ++i) {
    const double r = curve.r[i];
    if (std::abs(curve.lag(i)) > most || !(r > 0) || !(r >= best / 2)) continue;
    if (curve.r[i - 1] > r || curve.r[i + 1] > r) continue;
    const Peak peak(curve, i);
    const double offset = peak.top();
    found.push_back({static_cast<double>(curve.lag(i)) + offset, std::min(1.0, peak.at(offset))});
  }
  return found;
}

}  // namespace

LagEstimate estimate_lag(std::span<const double> sensor, std::span<const double> reference, double rate_hz,
                         double most_s) {
  const std::size_t count = std::min(sensor.size(), reference.size());
  LagEstimate result;
  if (count < kFewestPairs || !(rate_hz > 0) || !(most_s >= 0)) return result;
  const Series s = centred(sensor, count), x = centred(reference, count);
  const std::size_t half = count / 2;
  const auto most = static_cast<std::int64_t>(std::min(std::floor(most_s * rate_hz + 1e-9), static_cast<double>(half)));
  double common = 0;
  for (std::size_t k = 0; k < count; ++k) common += std::isnan(s[k] + x[k]) ? 0 : 1;
  const double fewest = std::max<double>(kFewestPairs, common / 4);

  std::int64_t from = -most, to = most;
  const double work = static_cast<double>(count) * static_cast<double>(2 * most + 1);
  const auto block = clamped_whole<std::int64_t>(std::ceil(std::sqrt(work / kMostWork)));
  if (block > 1) {
    const Curve coarse = correlate(block_means(s, block), block_means(x, block), -most / block - 1, most / block + 1,
                                   fewest / static_cast<double>(block));
    const auto at = largest(coarse);
    if (!at) return result;
    const std::int64_t centre = coarse.lag(*at);
    from = std::max(from, (centre - kRadius) * block);
    to = std::min(to, (centre + kRadius) * block);
  }
  // Beyond the range too: a maximum is one only beside smaller neighbours.
  const Curve curve = correlate(s, x, from - kLobes, to + kLobes, fewest);
  const auto highest = largest(curve);
  if (!highest) return result;
  const double largest_sampled = curve.r[*highest];
  const std::vector<Top> all = tops(curve, most, largest_sampled);
  double best = 0;
  for (const Top& top : all) best = std::max(best, top.correlation);
  if (best < largest_sampled - kTie) return result;  // it grows towards the end of the range
  const Top* chosen = nullptr;
  for (const Top& top : all)
    if (top.correlation >= best - kTie && (!chosen || std::abs(top.lag) < std::abs(chosen->lag))) chosen = &top;
  if (!chosen) return result;
  return {chosen->lag / rate_hz, chosen->correlation};
}

// By how much the sensors lag the reference: the lag at which the sensors' mean and the reference
// look most alike; for a tilt, the rate and the slope of the reference angle.

namespace {

constexpr std::size_t kBlock = 4096;
constexpr std::int64_t kMostInstants = 200000;
constexpr double kMostLag_s = 2;
/// Below it two signals have too little in common for their lag to mean anything.
constexpr double kLeastCorrelation = 0.5;

struct Pair {
  std::vector<double> sensor, reference;
};

Pair series(const Scene& scene, const Instants& instants, std::int64_t from, std::int64_t to, Progress& progress) {
  Pair out;
  double before = kMissing;
  instants.pass(from, to, kBlock, progress, [&](const InstantBlock& b) {
    for (Eigen::Index k = 0; k < b.samples.cols(); ++k) {
      if (scene.tilt) {
        out.sensor.push_back(b.samples(static_cast<Eigen::Index>(scene.tilt->gyroscope), k));
        out.reference.push_back(fusion::wrapped(b.truth(0, k) - before));
        before = b.truth(0, k);
      } else {
        out.sensor.push_back(b.samples.col(k).mean());
        out.reference.push_back(b.truth(0, k));
      }
    }
  });
  return out;
}

}  // namespace

double find_lag(const Scene& scene, const Instants& instants, const TimeWindow& window, Progress& progress) {
  const std::int64_t from = instants.instant_at(window.from_s);
  const std::int64_t to = std::min(instants.instant_at(window.to_s), from + kMostInstants);
  const Pair pair = series(scene, instants, from, to, progress);
  const double rate_hz = instants.info().rate_hz;
  const double most_s = std::min(kMostLag_s, static_cast<double>(to - from) / rate_hz / 4);
  LagEstimate found = estimate_lag(pair.sensor, pair.reference, rate_hz, most_s);
  // A difference of two samples stands in the middle between them, the rate at its own instant.
  if (scene.tilt) found.lag_s += 0.5 / rate_hz;
  if (!(found.correlation >= kLeastCorrelation))
    throw numeric_error("E0908", scene.file)
        .says("reference.lag_s: sensors and reference are too little alike to tell a lag")
        .got("estimate")
        .hint("give lag_s as a number of seconds");
  return found.lag_s;
}

// d_k = x_ref,k - sum_i h_i y_i,k / sum_i h_i^2 over the sensors that are there;   offset = mean of d
// Of a tilt d_k = wrapped(angle_ref,k - atan2(x_k, z_k)), about the first of them. The interval is
// that of the mean of at most kMostBatches batch means: what is slower than a batch is all in them.

namespace {

constexpr std::size_t kOffsetBlock = 4096, kMostBatches = 8192;

// Means of so many consecutive values that there are never too many of them.
class BatchMeans {
 public:
  void push(double value) {
    sum_ += value;
    if (++filled_ < size_) return;
    means_.push_back(sum_ / static_cast<double>(size_));
    sum_ = 0;
    filled_ = 0;
    if (means_.size() < kMostBatches) return;
    for (std::size_t k = 0; 2 * k + 1 < means_.size(); ++k) means_[k] = 0.5 * (means_[2 * k] + means_[2 * k + 1]);
    means_.resize(means_.size() / 2);
    size_ *= 2;
  }
  const std::vector<double>& means() const { return means_; }
  /// Of all values, those of an unfinished batch too.
  double mean() const {
    double sum = sum_;
    for (const double m : means_) sum += m * static_cast<double>(size_);
    return sum / static_cast<double>(count());
  }
  std::size_t count() const { return means_.size() * size_ + filled_; }

 private:
  std::vector<double> means_;
  double sum_ = 0;
  std::size_t size_ = 1, filled_ = 0;
};

double sensors_say(const Scene& scene, const Eigen::VectorXd& h, const Eigen::MatrixXd& samples, Eigen::Index k) {
  if (scene.tilt)
    return std::atan2(samples(static_cast<Eigen::Index>(scene.tilt->accelerometer_x), k),
                      samples(static_cast<Eigen::Index>(scene.tilt->accelerometer_z), k));
  double sum = 0, weight = 0;
  for (Eigen::Index i = 0; i < h.size(); ++i)
    if (std::isfinite(samples(i, k))) {
      sum += h[i] * samples(i, k);
      weight += h[i] * h[i];
    }
  return weight > 0 ? sum / weight : kMissing;
}

Refusal offset_refusal(const Scene& scene, const std::string& what) {
  return input_error("E0913", scene.file).says("reference.offset: " + what).got("estimate");
}

}  // namespace

OffsetEstimate find_reference_offset(const Scene& scene, const Instants& instants, std::int64_t from, std::int64_t to,
                                     Progress& progress) {
  if (instants.info().input_names.size() != 1)
    throw offset_refusal(scene,
                         fmt::format("there are {} true inputs, and one is needed", instants.info().input_names.size()))
        .hint("give the offset as a number");
  const Eigen::MatrixXd rows = observations(scene, 1);
  const Eigen::VectorXd h = rows.size() == 0 ? Eigen::VectorXd::Ones(static_cast<Eigen::Index>(scene.sensors.size()))
                                             : Eigen::VectorXd(rows.col(0));
  BatchMeans differences;
  double origin = kMissing;
  instants.pass(from, to, kOffsetBlock, progress, [&](const InstantBlock& b) {
    for (Eigen::Index k = 0; k < b.samples.cols(); ++k) {
      double d = b.truth(0, k) - sensors_say(scene, h, b.samples, k);
      if (!std::isfinite(d)) continue;
      if (std::isnan(origin)) origin = d;
      d -= origin;
      differences.push(scene.tilt ? fusion::wrapped(d) : d);
    }
  });
  if (differences.count() < 2)
    throw offset_refusal(scene, "hardly any instant has both reference and sensors")
        .hint("its stamps, its lag or its gaps put it elsewhere");
  const MeanUncertainty known = mean_uncertainty(differences.means());
  const double offset = origin + differences.mean();
  return {scene.tilt ? fusion::wrapped(offset) : offset, known.reach95, known.long_memory};
}

}  // namespace libchar
