#include "libchar/replay/detail/align/reference_track.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libchar/core/refusal.hpp"
#include "libchar/core/units.hpp"
#include "libchar/scene/scene.hpp"

namespace libchar {
namespace {

// A time within this share of a sample is the sample's own: rounding must not ask for a neighbour.
constexpr double kOnSample = 1e-6;

}  // namespace

double ReferenceTrack::at(std::size_t channel, double time_s) const {
  const std::vector<double>& track = values[channel];
  const double place = (time_s - start_s) * rate_hz;
  const double below = std::floor(place + kOnSample);
  if (!(below >= 0) || below >= static_cast<double>(track.size())) return kMissing;
  const auto k = static_cast<std::size_t>(below);
  const double rest = place - below;
  if (rest <= kOnSample) return track[k];
  return k + 1 < track.size() ? between(track[k], track[k + 1], rest, period) : kMissing;
}

double ReferenceTrack::curved(std::size_t channel, double time_s) const {
  const std::vector<double>& y = values[channel];
  const double place = (time_s - start_s) * rate_hz, below = std::floor(place + kOnSample);
  if (period > 0 || !(below >= 1) || below + 2 >= static_cast<double>(y.size())) return at(channel, time_s);
  const auto k = static_cast<std::size_t>(below);
  const double f = place - below;
  const double value = -f * (f - 1) * (f - 2) / 6 * y[k - 1] + (f + 1) * (f - 1) * (f - 2) / 2 * y[k] -
                       (f + 1) * f * (f - 2) / 2 * y[k + 1] + (f + 1) * f * (f - 1) / 6 * y[k + 2];
  return std::isfinite(value) && f > kOnSample ? value : at(channel, time_s);
}

double between(double a, double b, double share, double period) {
  double step = b - a;
  if (period > 0) step -= period * std::round(step / period);
  return a + share * step;
}

double full_turn(const std::string& unit) {
  const auto known = find_unit(unit);
  return 2 * std::numbers::pi / (known && known->quantity == Quantity::angle ? known->to_si : 1);
}

ReferenceTrack read_reference(const Scene& scene, const SceneSource& source, Progress& progress) {
  const SceneReference& reference = *scene.reference;
  ReferenceTrack track;
  if (!reference.recording) {
    track.rate_hz = source.info().rate_hz;
    track.units = source.info().reference_units;
    track.values = source.reference_columns(progress);
    if (scene.tilt) track.period = full_turn(track.units[0]);
    return track;
  }
  ReadOptions reading = reference.reading;
  if (reading.names.empty()) reading.channels = reference.channels;
  Recording read;
  try {
    read = read_recording(*reference.recording, reading, progress);
  } catch (const Error& error) {
    throw of_scene(error, *reference.recording);
  }
  track.rate_hz = read.info.time.rate_hz;
  if (!(track.rate_hz > 0))
    throw input_error("E0901", scene.file)
        .says("the reference {} states no sampling rate", read.info.file)
        .hint("reference: {recording: {file: …, rate_hz: …}}");
  for (const std::string& channel : reference.channels) {
    const std::size_t column = column_of(read.info, channel, scene.file, "reference");
    track.values.push_back(read.samples[column]);
    track.units.push_back(read.info.channels[column].unit);
  }
  if (scene.tilt) track.period = full_turn(track.units[0]);
  // Both clocks count from one epoch when both have stamps; else the logs begin together.
  const LogInfo& recording = source.info().logs.at(0);
  if (read.info.time.start_ns && recording.time.start_ns)
    track.start_s = static_cast<double>(*read.info.time.start_ns - *recording.time.start_ns) * 1e-9;
  track.log = std::move(read.info);
  return track;
}

// With r_j the reference at stamps t_j, T their distance, and s(t) what the sensors say together (noise variance v):
//   instant        r_j = a s(t_j + lag) + b + e
//   mean_before    r_j = a mean of s over [t_j - T, t_j) + lag, and so on
// Each reading is fitted by least squares; its log-likelihood is -n/2 ln(variance of e, less what v
// alone makes), so that a mean does not win by averaging the sensors' noise. v: from the sixth
// difference of s, in which smooth motion hardly shows.

namespace {

constexpr std::size_t kMostReferences = 20000;  // of the reference; those in the middle of a longer one
constexpr std::size_t kFewestReferences = 12;
constexpr double kMostSlowLag_s = 2, kMostLagIntervals = 2;
constexpr std::size_t kMostLags = 2001;
/// Noise that a prediction is made of cannot explain more than this share of its error.
constexpr double kMostNoise = 0.9;
/// Readings closer than this are not told apart: the first of SceneReference::kReadings among them.
constexpr double kApart = 3;

// Sums over any stretch of the level.
class Level {
 public:
  Level(const std::vector<double>& level, double rate_hz) : level_(level), rate_hz_(rate_hz) {
    sums_.resize(level.size() + 1, 0);
    counts_.resize(level.size() + 1, 0);
    for (std::size_t k = 0; k < level.size(); ++k) {
      const bool there = std::isfinite(level[k]);
      sums_[k + 1] = sums_[k] + (there ? level[k] : 0);
      counts_[k + 1] = counts_[k] + (there ? 1 : 0);
    }
  }
  double at(double time_s) const {
    const double place = time_s * rate_hz_, below = std::floor(place);
    if (!(below >= 0) || below + 1 >= static_cast<double>(level_.size())) return kMissing;
    const auto k = static_cast<std::size_t>(below);
    return between(level_[k], level_[k + 1], place - below, 0);
  }
  /// At least half of its samples must be there.
  double mean(double from_s, double to_s) const {
    const double from = std::ceil(from_s * rate_hz_ - 1e-6), to = std::ceil(to_s * rate_hz_ - 1e-6);
    if (!(from >= 0) || to > static_cast<double>(level_.size()) || to <= from) return kMissing;
    const auto a = static_cast<std::size_t>(from), b = static_cast<std::size_t>(to);
    const double count = counts_[b] - counts_[a];
    return 2 * count >= to - from ? (sums_[b] - sums_[a]) / count : kMissing;
  }
  /// Variance of its white noise.
  double noise() const {
    static constexpr double kSixth[] = {1, -6, 15, -20, 15, -6, 1};
    static constexpr double kPower = 924;
    double sum = 0, count = 0;
    for (std::size_t k = 0; k + 6 < level_.size(); ++k) {
      double d = 0;
      for (std::size_t j = 0; j < 7; ++j) d += kSixth[j] * level_[k + j];
      if (std::isfinite(d)) sum += d * d, count += 1;
    }
    return count > 0 ? sum / count / kPower : 0;
  }

 private:
  const std::vector<double>& level_;
  double rate_hz_;
  std::vector<double> sums_, counts_;
};

struct Fit {
  double n = 0, variance = 0;  // of the error, less what the sensors' noise makes
  double lag_s = 0;
  double likelihood() const { return n > 0 ? -0.5 * n * std::log(variance) : -std::numeric_limits<double>::infinity(); }
};

class Readings {
 public:
  Readings(const Level& level, double rate_hz, const ReferenceTrack& track, const std::vector<double>& reference)
      : level_(level),
        reference_(reference),
        start_s_(track.start_s),
        interval_s_(1 / track.rate_hz),
        per_interval_(rate_hz / track.rate_hz),
        noise_(level.noise()) {
    const std::size_t n = reference.size();
    from_ = n > kMostReferences ? (n - kMostReferences) / 2 : 0;
    to_ = std::min(n, from_ + kMostReferences);
  }

  Fit at(const std::string& samples, double lag_s) const {
    double n = 0, sp = 0, sr = 0, pp = 0, rr = 0, pr = 0, r0 = kMissing, p0 = kMissing;
    for (std::size_t j = from_; j < to_; ++j) {
      double r = reference_[j], p = predicted(samples, j, lag_s);
      if (!std::isfinite(r) || !std::isfinite(p)) continue;
      if (std::isnan(r0)) r0 = r, p0 = p;
      r -= r0;
      p -= p0;
      n += 1, sp += p, sr += r, pp += p * p, rr += r * r, pr += p * r;
    }
    if (n < kFewestReferences) return {};
    const double vp = pp / n - sp * sp / n / n, vr = rr / n - sr * sr / n / n, c = pr / n - sp * sr / n / n;
    if (!(vp > 0) || !(vr > 0)) return {};
    const double gain = c / vp, error = std::max(vr - gain * c, 1e-12 * vr);
    const double own = gain * gain * noise_ / (samples == "instant" ? 1 : per_interval_);
    return {n, std::max(error - own, (1 - kMostNoise) * error), lag_s};
  }

  Fit best_lag(const std::string& samples) const {
    const double most_s = std::max(kMostSlowLag_s, kMostLagIntervals * interval_s_);
    const double step_s = std::max(interval_s_ / per_interval_, 2 * most_s / static_cast<double>(kMostLags - 1));
    Fit best;
    const auto steps = static_cast<int>(most_s / step_s);
    for (int k = -steps; k <= steps; ++k)
      if (const Fit one = at(samples, k * step_s); one.likelihood() > best.likelihood()) best = one;
    // Lags of whole steps smooth the noise alike; between them the variance is a parabola near its least. A mean is one
    // of whole samples.
    const double before = at(samples, best.lag_s - step_s).variance, after = at(samples, best.lag_s + step_s).variance;
    const double bend = before - 2 * best.variance + after;
    if (samples != "instant" || !(std::min(before, after) > best.variance)) return best;
    best.lag_s += step_s * (before - after) / bend / 2;
    best.variance =
        std::max(best.variance - (before - after) * (before - after) / bend / 8, (1 - kMostNoise) * best.variance);
    return best;
  }

 private:
  double predicted(const std::string& samples, std::size_t j, double lag_s) const {
    const double stamp_s = start_s_ + lag_s + static_cast<double>(j) * interval_s_;
    if (samples == "instant") return level_.at(stamp_s);
    const double from_s = stamp_s + interval_start(samples) * interval_s_;
    return level_.mean(from_s, from_s + interval_s_);
  }

  const Level& level_;
  const std::vector<double>& reference_;
  double start_s_, interval_s_, per_interval_, noise_;
  std::size_t from_ = 0, to_ = 0;
};

}  // namespace

double interval_start(const std::string& samples) {
  return samples == "mean_before" ? -1 : samples == "mean_centred" ? -0.5 : 0;
}

SlowReading read_slowly(const SlowQuestion& question, const std::vector<double>& level, double rate_hz,
                        const ReferenceTrack& track, const std::vector<double>& reference) {
  const bool open = question.samples == "estimate";
  SlowReading out{open ? std::string(SceneReference::kReadings[0]) : question.samples, question.lag_s, 0};
  if (!open && !question.estimate_lag) return out;
  const Level sums(level, rate_hz);
  const Readings readings(sums, rate_hz, track, reference);
  Fit best;
  double next = best.likelihood();
  for (const std::string_view one : SceneReference::kReadings) {
    const std::string samples(one);
    if (!open && samples != question.samples) continue;
    // A mean over another interval is the same mean with another lag.
    if (open && question.estimate_lag && interval_start(samples) != 0) continue;
    const Fit fit = question.estimate_lag ? readings.best_lag(samples) : readings.at(samples, question.lag_s);
    if (fit.likelihood() > best.likelihood() + (std::isfinite(best.likelihood()) ? kApart : 0)) {
      next = best.likelihood();
      best = fit;
      out.samples = samples;
    } else {
      next = std::max(next, fit.likelihood());
    }
  }
  if (!std::isfinite(best.likelihood())) return out;
  out.lag_s = best.lag_s;
  out.margin = std::isfinite(next) ? best.likelihood() - next : 0;
  return out;
}

}  // namespace libchar
