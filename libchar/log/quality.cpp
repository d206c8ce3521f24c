#include "libchar/log/quality.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "libchar/core/error.hpp"
#include "libchar/core/text.hpp"

namespace libchar {
namespace {

constexpr std::size_t kBlock = 4096;
constexpr std::size_t kDistinct = 4096;
constexpr std::uint64_t kSaturatedRun = 3;

// The first kDistinct different values, in a table of open addressing; NaN marks an empty slot.
class DistinctValues {
 public:
  DistinctValues() : slots_(kSlots, kMissing) { values_.reserve(kDistinct); }
  bool full() const { return values_.size() == kDistinct; }
  const std::vector<double>& values() const { return values_; }

  void add(double value) {
    value += 0.0;  // -0 and +0 are one value
    std::size_t slot = (std::bit_cast<std::uint64_t>(value) * 0x9E3779B97F4A7C15U) >> (64 - kBits);
    while (slots_[slot] != value) {
      if (std::isnan(slots_[slot])) {
        slots_[slot] = value;
        values_.push_back(value);
        return;
      }
      slot = (slot + 1) % kSlots;
    }
  }

 private:
  static constexpr int kBits = 13;
  static constexpr std::size_t kSlots = std::size_t{1} << kBits;
  std::vector<double> slots_;
  std::vector<double> values_;
};

// Samples at one extreme (sign = +1: the maximum, -1: the minimum), counted when they stand in runs
// of three or more.
struct Extreme {
  double sign = 1, value = -__builtin_inf();
  std::uint64_t run = 0, in_runs = 0;

  void block(const double* x, std::size_t n, double block_extreme) {
    if (sign * block_extreme < value) {  // nothing here reaches it: nearly every block of noise
      run = 0;
      return;
    }
    for (std::size_t i = 0; i < n; ++i) step(sign * x[i]);
  }
  void step(double v) {
    if (v > value) {
      value = v;
      run = in_runs = 0;
    }
    run = v == value ? run + 1 : 0;
    if (run >= kSaturatedRun) in_runs += run == kSaturatedRun ? run : 1;
  }
};

constexpr std::size_t kLanes = 8;  // independent partial sums: any vector width gives the same bits
using Lanes = double[kLanes];

double fold(const Lanes& lane) {
  return ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
}

// Mean and variance only: sums about the block's first value, blocks merged by Chan's formula
// (core/moments.hpp has all four moments at three times the cost, which a meter that runs on every
// sample need not pay).
struct MeanAndSpread {
  double origin = 0;  // the first value: the mean is kept less that, so that an offset costs no digits
  double n = 0, mean = 0, m2 = 0;

  void block(const double* x, std::size_t count) {
    Lanes sum{}, square{};
    const double shift = x[0];
    if (n == 0) origin = shift;
    const std::size_t whole = count - count % kLanes;
    for (std::size_t i = 0; i < whole; i += kLanes)
      for (std::size_t k = 0; k < kLanes; ++k) sum[k] += x[i + k] - shift;
    for (std::size_t i = whole; i < count; ++i) sum[i % kLanes] += x[i] - shift;
    const double offset = fold(sum) / static_cast<double>(count);
    for (std::size_t i = 0; i < whole; i += kLanes)
      for (std::size_t k = 0; k < kLanes; ++k) {
        const double d = (x[i + k] - shift) - offset;
        square[k] += d * d;
      }
    for (std::size_t i = whole; i < count; ++i) {
      const double d = (x[i] - shift) - offset;
      square[i % kLanes] += d * d;
    }
    const double other = static_cast<double>(count), total = n + other, d = (shift - origin) + offset - mean;
    m2 += fold(square) + d * d * n * other / total;
    mean += d * other / total;
    n = total;
  }
};

// Raw moments of differences: their mean is next to nothing beside their spread, except for
// counters.
struct DifferenceMoments {
  double n = 0, s1 = 0, s2 = 0, s3 = 0, s4 = 0;

  void block(const double* d, std::size_t count) {
    Lanes a1{}, a2{}, a3{}, a4{};
    const std::size_t whole = count - count % kLanes;
    for (std::size_t i = 0; i < whole; i += kLanes)
      for (std::size_t k = 0; k < kLanes; ++k) {
        const double v = d[i + k], q = v * v;
        a1[k] += v;
        a2[k] += q;
        a3[k] += q * v;
        a4[k] += q * q;
      }
    for (std::size_t i = whole; i < count; ++i) {
      const double v = d[i], q = v * v;
      a1[i % kLanes] += v;
      a2[i % kLanes] += q;
      a3[i % kLanes] += q * v;
      a4[i % kLanes] += q * q;
    }
    s1 += fold(a1);
    s2 += fold(a2);
    s3 += fold(a3);
    s4 += fold(a4);
  }
  double kurtosis() const {
    if (n < 4 || !(s2 > 0)) return 3;
    const double m = s1 / n, v = s2 / n - m * m;
    const double fourth = s4 / n - 4 * m * s3 / n + 6 * m * m * s2 / n - 3 * m * m * m * m;
    // A ramp leaves only rounding here, and squares of huge or tiny values leave the range of a
    // double.
    if (!(v > 1e-9 * (s2 / n)) || !std::isfinite(fourth) || !std::isnormal(v * v)) return 3;
    return fourth / (v * v);
  }
};

void extremes(const double* x, std::size_t count, double& low, double& high) {
  Lanes l, h;
  for (std::size_t k = 0; k < kLanes; ++k) l[k] = h[k] = x[0];
  const std::size_t whole = count - count % kLanes;
  for (std::size_t i = 0; i < whole; i += kLanes)
    for (std::size_t k = 0; k < kLanes; ++k) {
      l[k] = x[i + k] < l[k] ? x[i + k] : l[k];
      h[k] = x[i + k] > h[k] ? x[i + k] : h[k];
    }
  for (std::size_t i = whole; i < count; ++i) {
    l[0] = std::min(l[0], x[i]);
    h[0] = std::max(h[0], x[i]);
  }
  low = *std::min_element(l, l + kLanes);
  high = *std::max_element(h, h + kLanes);
}

// The common step of values that lie on a grid, by Euclid's algorithm with a tolerance; nothing
// when there is none.
std::optional<double> grid_step(std::vector<double> values) {
  if (values.size() < 2) return std::nullopt;
  std::sort(values.begin(), values.end());
  const double range = values.back() - values.front();
  const double largest = std::max(std::fabs(values.front()), std::fabs(values.back()));
  double least = range;
  for (std::size_t i = 1; i < values.size(); ++i)
    least = std::min(least, values[i] - values[i - 1]);
  // Values printed with few decimals stand up to a few percent of a step off their grid.
  const double tolerance = std::max(0.04 * least, 8 * largest * 0x1p-52);
  if (least <= 16 * largest * 0x1p-52) return std::nullopt;
  double step = least;
  for (std::size_t i = 1; i < values.size(); ++i) {
    double a = values[i] - values[i - 1], b = step;
    for (int round = 0; b > tolerance && round < 64; ++round) {
      double rest = std::fmod(a, b);
      if (b - rest < tolerance) rest = 0;
      a = b;
      b = rest;
    }
    step = a;
    if (step < 0.2 * least || step < 4 * tolerance) return std::nullopt;
  }
  // Refine by least squares through the origin of the grid, widening the stretch so that no step is
  // miscounted.
  for (std::size_t used = 2; used <= values.size();
       used = used == values.size() ? used + 1 : std::min(used * 2, values.size())) {
    double kk = 0, kv = 0;
    for (std::size_t i = 1; i < used; ++i) {
      const double v = values[i] - values[0], k = std::round(v / step);
      kk += k * k;
      kv += k * v;
    }
    if (kk > 0) step = kv / kk;
  }
  for (const double v : values) {
    const double k = (v - values[0]) / step;
    if (std::fabs(k - std::round(k)) > 0.1) return std::nullopt;
  }
  return step;
}

// 0.05000000000000027 → 0.05: the least number of digits that stands within the grid's own
// uncertainty.
double tidy(double step) {
  for (int digits = 1; digits < 16; ++digits) {
    const auto rounded = parse_double(fmt::format("{:.{}e}", step, digits - 1));
    if (rounded && std::fabs(*rounded - step) <= 1e-7 * step) return *rounded;
  }
  return step;
}

}  // namespace

struct QualityMeter::State {
  MeanAndSpread values;
  DifferenceMoments differences;
  DistinctValues distinct;
  Extreme top{1}, bottom{-1};
  std::uint64_t missing = 0, run = 0, longest_run = 0;
  double previous = 0, minimum = __builtin_inf(), maximum = -__builtin_inf();
  bool joined = false;  // previous is the sample right before
  bool float32 = true;
  bool any_fraction = false;
  double block[kBlock];
  bool starts[kBlock];  // sample i does not follow sample i-1 directly (missing samples between)
  std::size_t used = 0;
  bool any_start = false;

  void push(std::span<const double> samples);
  void process();
  void runs(const double* x, std::size_t n);
};

void QualityMeter::State::push(std::span<const double> samples) {
  for (std::size_t done = 0; done < samples.size();) {
    const std::size_t n = std::min(kBlock - used, samples.size() - done);
    const double* const x = samples.data() + done;
    int absent = 0;
    for (std::size_t i = 0; i < n; ++i) absent |= x[i] != x[i];
    if (absent == 0) {
      std::memcpy(block + used, x, n * sizeof(double));
      std::memset(starts + used, 0, n);
      starts[used] = !joined;
      any_start |= !joined;
      joined = true;
      used += n;
    } else {
      for (std::size_t i = 0; i < n; ++i) {
        if (std::isnan(x[i])) {
          ++missing;
          joined = false;
          continue;
        }
        starts[used] = !joined;
        any_start |= !joined;
        block[used++] = x[i];
        joined = true;
      }
    }
    done += n;
    if (used == kBlock) process();
  }
}

void QualityMeter::State::process() {
  if (used == 0) return;
  const std::size_t n = used;
  values.block(block, n);
  double low = 0, high = 0;
  extremes(block, n, low, high);
  minimum = std::min(minimum, low);
  maximum = std::max(maximum, high);
  double difference[kBlock];
  difference[0] = block[0] - previous;
  for (std::size_t i = 1; i < n; ++i) difference[i] = block[i] - block[i - 1];
  runs(difference, n);
  std::size_t breaks = 0;
  for (std::size_t i = 0; any_start && i < n; ++i)
    if (starts[i]) {
      difference[i] = 0;
      ++breaks;
    }
  differences.block(difference, n);
  differences.n += static_cast<double>(n - breaks);
  top.block(block, n, high);
  bottom.block(block, n, low);
  if (float32) {
    int wide = 0;
    for (std::size_t i = 0; i < n; ++i)
      wide |= static_cast<double>(static_cast<float>(block[i])) != block[i];
    float32 = wide == 0;
  }
  for (std::size_t i = 0; i < n && !distinct.full(); ++i) distinct.add(block[i]);
  previous = block[n - 1];
  used = 0;
  any_start = false;
}

// Runs of one value: differences of exactly zero in a row, plus one; a missing sample ends a run.
void QualityMeter::State::runs(const double* difference, std::size_t n) {
  int zeros = 0;
  for (std::size_t i = 0; i < n; ++i) zeros += difference[i] == 0;
  if (zeros == 0) {
    run = 1;
    longest_run = std::max<std::uint64_t>(longest_run, 1);
    return;
  }
  for (std::size_t i = 0; i < n; ++i) {
    run = difference[i] == 0 && !starts[i] ? run + 1 : 1;
    longest_run = std::max(longest_run, run);
  }
}

QualityMeter::QualityMeter() : state_(std::make_unique<State>()) {}
QualityMeter::~QualityMeter() = default;
QualityMeter::QualityMeter(QualityMeter&&) noexcept = default;
QualityMeter& QualityMeter::operator=(QualityMeter&&) noexcept = default;

void QualityMeter::push(std::span<const double> samples) {
  state_->push(samples);
}

namespace {

void suggest(ChannelQuality& q) {
  auto& s = q.suggestions;
  const double share = q.samples > 0 ? 1.0 / static_cast<double>(q.samples) : 0;
  if (q.samples == 0) {
    s.emplace_back("no value at all: check that the channel is switched on");
    return;
  }
  if (q.samples >= 16 && q.distinct_values == 1)
    s.emplace_back("constant: nothing to characterize");
  if (q.samples >= 16 && q.distinct_values > 1 && q.distinct_values <= 3)
    s.push_back(
        fmt::format("{} distinct values: quantization-limited, record with more gain or resolution",
                    q.distinct_values));
  else if (q.samples >= 16 && q.resolution && q.standard_deviation < 0.5 * *q.resolution &&
           q.distinct_values > 1)
    s.push_back(
        fmt::format("standard deviation is {:.2g} of the resolution: quantization hides the noise, "
                    "record with more gain",
                    q.standard_deviation / *q.resolution));
  if (q.saturated > 0 && q.distinct_values > 3)
    s.push_back(
        fmt::format("{} samples ({:.2g} %) stand at the end of the range ({:g} or {:g}): "
                    "saturated, use a larger full scale",
                    q.saturated,
                    100 * static_cast<double>(q.saturated) * share,
                    q.minimum,
                    q.maximum));
  if (q.longest_stuck >= 100 && q.distinct_values > 16)
    s.push_back(
        fmt::format("one value {} times in a row: the sensor or the link hung", q.longest_stuck));
  if (q.samples >= 1000 && q.difference_kurtosis > 10)
    s.push_back(
        fmt::format("kurtosis of differences {:.3g} (3 for Gaussian noise): spikes or movement, "
                    "look for outliers",
                    q.difference_kurtosis));
  if (q.float32 && q.samples >= 16 && q.distinct_values > 16 && q.standard_deviation > 0 &&
      q.float32_step > 0.5 * q.standard_deviation)
    s.push_back(
        fmt::format("32-bit floats step by {:.3g} here, which is {:.2g} of the standard deviation: "
                    "subtract the offset before storing",
                    q.float32_step,
                    q.float32_step / q.standard_deviation));
}

}  // namespace

ChannelQuality QualityMeter::finish() const {
  State state = *state_;
  state.process();
  ChannelQuality q;
  q.samples = static_cast<std::uint64_t>(state.values.n);
  q.missing = state.missing;
  if (q.samples > 0) {
    q.mean = state.values.origin + state.values.mean;
    if (q.samples > 1) q.standard_deviation = std::sqrt(state.values.m2 / (state.values.n - 1));
    q.minimum = state.minimum;
    q.maximum = state.maximum;
  }
  q.distinct_values = state.distinct.values().size();
  q.longest_stuck = state.longest_run;
  if (state.top.value > -state.bottom.value) q.saturated = state.top.in_runs + state.bottom.in_runs;
  q.difference_kurtosis = state.differences.kurtosis();
  q.float32 = q.samples > 0 && state.float32;
  const auto largest = static_cast<float>(std::max(std::fabs(q.minimum), std::fabs(q.maximum)));
  if (std::isfinite(largest))
    q.float32_step =
        static_cast<double>(std::nextafter(largest, HUGE_VALF)) - static_cast<double>(largest);
  if (const auto step = grid_step(state.distinct.values()); step && q.samples >= 4) {
    const bool format_only = q.float32 && *step <= 1.01 * q.float32_step && q.distinct_values > 16;
    if (!format_only) q.resolution = tidy(*step);
  }
  suggest(q);
  return q;
}

void quality_warnings(const Channel& channel, const ChannelQuality& quality, Warnings& warnings) {
  if (quality.samples >= 16 && quality.distinct_values > 1 && quality.distinct_values <= 3)
    warnings.add("quantization_limited",
                 "channels with three or fewer distinct values: limited by their resolution",
                 fmt::format("{} has {}", channel.name, quality.distinct_values));
}

void require_samples(const LogInfo& info, std::uint64_t needed, const std::string& purpose) {
  if (info.samples >= needed) return;
  throw Error({ErrorKind::numeric,
               "E0401",
               info.first_line > 0 ? fmt::format("{}:{}:1", info.file, info.first_line) : info.file,
               fmt::format("{} sample{}, {} needs at least {}",
                           info.samples,
                           info.samples == 1 ? "" : "s",
                           purpose,
                           needed),
               "",
               ""});
}

}  // namespace libchar
