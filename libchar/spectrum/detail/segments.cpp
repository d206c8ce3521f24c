// Welch's method (P. D. Welch, IEEE Trans. Audio Electroacoust. 15, 1967), segment by segment:
//   P_k = 1/K sum_i |sum_t w_t (x_{iD+t} - trend_i(t)) exp(-2 pi i k t / n)|^2 / (f_s sum w^2)
//   U^2/Hz, two-sided.
// Segments overlap, so their powers are correlated: for white noise by r_j^2, r_j = sum_t w_t
// w_{t+jD} / sum w^2, and the average of K of them has (D. B. Percival and A. T. Walden, Spectral
// Analysis for Physical Applications, 1993, ch. 6.17)
//   nu = 2 K^2 / (K + 2 sum_j p_j r_j^2)   degrees of freedom,
//                                          p_j = number of pairs of segments j apart (K - j
//                                          without gaps).

#include "libchar/spectrum/detail/segments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "libchar/core/numeric/lanes.hpp"
#include "libchar/core/numeric/present.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/process/work.hpp"
#include "libchar/core/refusal.hpp"

namespace libchar::welch_detail {
namespace {

constexpr std::size_t kLanes = 8;  // spelled out, so that every vector width gives the same bits

struct Trend {
  double first = 0;  // subtracted before anything else: it carries the offset
  double mean = 0;   // of what is left
  double slope = 0;  // per sample
};

double folded(const double* lanes) {
  return ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
}

// sum of d_t = x_t - first
LIBCHAR_LANES double sum_about_lanes(const double* x, std::size_t n, double first) {
  double lanes[kLanes] = {};
  std::size_t t = 0;
  for (; t + kLanes <= n; t += kLanes)
    for (std::size_t lane = 0; lane < kLanes; ++lane) lanes[lane] += x[t + lane] - first;
  for (; t < n; ++t) lanes[t % kLanes] += x[t] - first;
  return folded(lanes);
}
constexpr InLanes<sum_about_lanes> sum_about;

// sum of (t - middle) d_t
LIBCHAR_LANES double slope_sum_about_lanes(const double* x, std::size_t n, double first) {
  double lanes[kLanes] = {}, position[kLanes];
  const double middle = static_cast<double>(n - 1) / 2;
  for (std::size_t lane = 0; lane < kLanes; ++lane) position[lane] = static_cast<double>(lane) - middle;
  std::size_t t = 0;
  for (; t + kLanes <= n; t += kLanes)
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      lanes[lane] += position[lane] * (x[t + lane] - first);
      position[lane] += static_cast<double>(kLanes);
    }
  for (; t < n; ++t) lanes[t % kLanes] += (static_cast<double>(t) - middle) * (x[t] - first);
  return folded(lanes);
}
constexpr InLanes<slope_sum_about_lanes> slope_sum_about;

LIBCHAR_LANES void subtract_and_window_lanes(const double* x, const double* w, std::size_t n, double first, double mean,
                                             double* out) {
  for (std::size_t t = 0; t < n; ++t) out[t] = ((x[t] - first) - mean) * w[t];
}
constexpr InLanes<subtract_and_window_lanes> subtract_and_window;

LIBCHAR_LANES void subtract_line_and_window_lanes(const double* x, const double* w, std::size_t n, const Trend& trend,
                                                  double* out) {
  const double first = trend.first, slope = trend.slope;
  const double start = trend.mean - slope * (static_cast<double>(n - 1) / 2);
  for (std::size_t t = 0; t < n; ++t)
    out[t] = ((x[t] - first) - (start + slope * static_cast<double>(static_cast<std::int64_t>(t)))) * w[t];
}
constexpr InLanes<subtract_line_and_window_lanes> subtract_line_and_window;

// interleaved real and imaginary parts
LIBCHAR_LANES void add_power_lanes(const double* bins, std::size_t n, double* power) {
  for (std::size_t k = 0; k < n; ++k) power[k] += bins[2 * k] * bins[2 * k] + bins[2 * k + 1] * bins[2 * k + 1];
}
constexpr InLanes<add_power_lanes> add_power;

LIBCHAR_LANES void add_lanes(const double* from, std::size_t n, double* to) {
  for (std::size_t k = 0; k < n; ++k) to[k] += from[k];
}
constexpr InLanes<add_lanes> add;

// r_lag = sum_t w_t w_{t + lag hop} / sum w^2; by a transform when there are many lags (an overlap near one).
std::vector<double> window_correlation(const std::vector<double>& w, std::size_t hop, std::size_t lags) {
  std::vector<double> r(lags + 1, 0.0);
  const std::size_t n = w.size();
  if (lags <= 32) {
    for (std::size_t lag = 0; lag <= lags; ++lag)
      for (std::size_t t = 0; t + lag * hop < n; ++t) r[lag] += w[t] * w[t + lag * hop];
  } else {
    RealFft fft(2 * n);
    std::fill(fft.input().begin(), fft.input().end(), 0.0);
    std::copy(w.begin(), w.end(), fft.input().begin());
    fft.transform();
    for (auto& bin : fft.coefficients()) bin = std::norm(bin);
    const auto correlation = fft.inverse();
    for (std::size_t lag = 0; lag <= lags; ++lag) r[lag] = correlation[lag * hop];
  }
  const double energy = r[0];
  for (double& value : r) value /= energy;
  return r;
}

// |sum_t w_t w_{t+lag} exp(-2 pi i m t / n)|^2: covariance of the powers m bins apart in two
// segments `lag` samples apart.
double shifted_energy(const std::vector<double>& w, std::size_t lag, std::size_t m,
                      const std::vector<std::complex<double>>& turns) {
  std::complex<double> sum = 0;
  for (std::size_t t = 0, phase = 0; t + lag < w.size(); ++t, phase = (phase + m) % w.size())
    sum += w[t] * w[t + lag] * turns[phase];
  return std::norm(sum);
}

// Correlation of the averaged powers of bins m = 1 … 8 apart. It depends on the shape of the window
// and the overlap, not on the length: a window of at most 1024 values stands for a long one, and
// with very many lags every sixteenth of the overlap is enough.
std::vector<double> neighbour_correlation(Window window, const Layout& layout, std::uint64_t used,
                                          const std::vector<std::uint64_t>& pairs) {
  const std::size_t n = std::min<std::size_t>(layout.segment, 1024), reach = std::min<std::size_t>(8, n / 4);
  const std::vector<double> w = window_values(window, n);
  std::vector<std::complex<double>> turns(n);
  for (std::size_t t = 0; t < n; ++t)
    turns[t] = std::polar(1.0, -2 * std::numbers::pi * static_cast<double>(t) / static_cast<double>(n));
  std::vector<double> covariance(reach + 1, 0.0);
  for (std::size_t m = 0; m <= reach; ++m) covariance[m] = static_cast<double>(used) * shifted_energy(w, 0, m, turns);
  const std::size_t stride = std::max<std::size_t>(1, pairs.size() / 16);
  for (std::size_t lag = stride; lag < pairs.size(); lag += stride) {
    const double weight = 2 * static_cast<double>(pairs[lag]) * static_cast<double>(stride);
    const double shift =
        static_cast<double>(lag * layout.hop) * static_cast<double>(n) / static_cast<double>(layout.segment);
    for (std::size_t m = 0; m <= reach; ++m)
      covariance[m] += weight * shifted_energy(w, clamped_whole<std::size_t>(std::round(shift)), m, turns);
  }
  std::vector<double> correlation;
  for (std::size_t m = 1; m <= reach; ++m) correlation.push_back(covariance[m] / covariance[0]);
  while (!correlation.empty() && correlation.back() < 1e-9) correlation.pop_back();
  return correlation;
}

}  // namespace

void check_options(const WelchOptions& options) {
  if (!(options.overlap >= 0 && options.overlap < 1))
    throw usage_error("E0201", "`overlap`")
        .says("the overlap of segments is a fraction of a segment, from 0 to below 1")
        .got("{}", options.overlap);
  if (options.segment != 0 && (options.segment < kShortestSegment || options.segment > kLongestSegment))
    throw usage_error("E0201", "`segment`")
        .says("a segment has at least {} samples, and at most {}", kShortestSegment, kLongestSegment)
        .got("{}", options.segment);
}

void check_rate(double rate_hz) {
  if (!(rate_hz > 0 && std::isfinite(rate_hz)))
    throw numeric_error("E0402").says("a spectrum needs a finite sampling rate above zero").got("{}", rate_hz);
}

void note_dropped(std::uint64_t dropped, std::uint64_t used, std::vector<std::string>& notes) {
  if (dropped > 0)
    notes.push_back(fmt::format("{} of {} segments touch a missing sample and were dropped", dropped, dropped + used));
}

Layout layout_of(std::uint64_t segment, double overlap) {
  Layout layout;
  layout.segment = static_cast<std::size_t>(segment);
  const double hop = std::round(static_cast<double>(segment) * (1 - overlap));
  layout.hop = std::clamp<std::size_t>(static_cast<std::size_t>(hop), 1, layout.segment);
  layout.group = std::max<std::size_t>(32, (std::size_t{1} << 16U) / layout.segment / 2 * 2);
  return layout;
}

Periodogram::Periodogram(const WelchOptions& options, const std::vector<double>& window)
    : detrend_(options.detrend), window_(window), fft_(window.size()) {}

bool Periodogram::add(const double* x, double* power) {
  const auto bins = transform(x);
  if (bins.empty()) return false;
  add_power(reinterpret_cast<const double*>(bins.data()), bins.size(), power);
  return true;
}

std::span<const std::complex<double>> Periodogram::transform(const double* x) {
  const std::size_t n = window_.size();
  const double length = static_cast<double>(n);
  Trend trend;
  const double sum = sum_about(x, n, x[0]);
  if (!std::isfinite(sum)) return {};
  double* in = fft_.input().data();
  if (detrend_ != Detrend::none) {
    trend.first = x[0];
    trend.mean = sum / length;
  }
  if (detrend_ == Detrend::linear) {
    trend.slope = slope_sum_about(x, n, x[0]) * 12 /
                  (length * (length * length - 1));  // sum of (t - middle)^2 = n (n^2 - 1) / 12
    subtract_line_and_window(x, window_.data(), n, trend, in);
  } else {
    subtract_and_window(x, window_.data(), n, trend.first, trend.mean, in);
  }
  return fft_.transform();
}

Average::Average(const WelchOptions& options, const Layout& layout) : options_(options), layout_(layout) {
  const std::size_t lags = (layout.segment - 1) / layout.hop;
  recent_.assign(lags, 0);
  pairs_.assign(lags + 1, 0);
}

void Average::add_group(const std::vector<double>& power) {
  if (power_.empty())
    power_ = power;
  else
    add(power.data(), power.size(), power_.data());
}

void Average::add_group(std::vector<double>&& power) {
  if (power_.empty())
    power_ = std::move(power);
  else
    add_group(std::as_const(power));
}

void Average::note_segment(bool used) {
  const std::size_t lags = recent_.size();
  if (used)
    for (std::size_t lag = 1; lag <= lags; ++lag) pairs_[lag] += recent_[(next_ + lags - lag) % lags] != 0;
  if (lags > 0) {
    recent_[next_] = used;
    next_ = (next_ + 1) % lags;
  }
  if (begin_.size() < lags) begin_.push_back(used ? 1 : 0);
  ++(used ? used_ : dropped_);
}

Average::Average(const WelchOptions& options, const Layout& layout, const WelchSums& sums) : Average(options, layout) {
  power_ = sums.power;
  pairs_ = sums.pairs;
  begin_ = sums.begin;
  used_ = sums.used;
  dropped_ = sums.dropped;
  first_ = sums.first;
  moves_ = sums.moves;
  moves_little_ = sums.moves_little;
  const std::size_t lags = recent_.size();
  for (const unsigned char used : sums.end) {
    recent_[next_] = static_cast<char>(used);
    next_ = (next_ + 1) % lags;
  }
}

WelchSums Average::sums() const {
  WelchSums out;
  out.power = power_;
  out.pairs = pairs_;
  out.begin = begin_;
  out.used = used_;
  out.dropped = dropped_;
  out.first = first_;
  out.moves = moves_;
  out.moves_little = moves_little_;
  const std::size_t lags = recent_.size();
  for (std::size_t back = begin_.size(); back > 0; --back)
    out.end.push_back(recent_[(next_ + lags - back) % lags] != 0 ? 1 : 0);
  return out;
}

void Average::join(const std::vector<double>& power, std::span<const char> straddling, const WelchSums& later) {
  for (const char used : straddling) note_segment(used != 0);
  if (!power.empty()) add_group(power);
  if (!later.power.empty()) add_group(later.power);
  const std::size_t lags = recent_.size();
  const auto before = [&](std::size_t back) { return recent_[(next_ + lags - back) % lags] != 0; };
  for (std::size_t i = 0; i < later.begin.size(); ++i)
    for (std::size_t lag = i + 1; lag <= lags; ++lag) pairs_[lag] += later.begin[i] != 0 && before(lag - i) ? 1 : 0;
  for (std::size_t lag = 1; lag <= lags; ++lag) pairs_[lag] += later.pairs[lag];
  for (std::size_t i = 0; i < later.begin.size() && begin_.size() < lags; ++i) begin_.push_back(later.begin[i]);
  for (const unsigned char used : later.end) {
    recent_[next_] = static_cast<char>(used);
    next_ = (next_ + 1) % lags;
  }
  used_ += later.used;
  dropped_ += later.dropped;
  const double first = later.first;
  note_samples({&first, 1});
  moves_ = moves_ || later.moves;
  moves_little_ = moves_little_ || later.moves_little;
}

void Average::note_samples(std::span<const double> samples) {
  constexpr double kSquareFits = 1e-140;
  for (auto y = samples.begin(); y != samples.end() && !moves_; ++y) {
    if (std::isnan(first_)) first_ = *y;
    const double apart = std::abs(*y - first_);
    moves_ = apart > kSquareFits;
    moves_little_ = moves_little_ || apart > 0;
  }
}

void Average::check_powers() const {
  constexpr double kSmallest = 1e-290;  // below it digits are missing
  double largest = 0;
  for (const double p : power_) largest = std::max(largest, std::isfinite(p) ? p : HUGE_VAL);
  if (std::isfinite(largest) && (largest >= kSmallest || moves_ || !moves_little_)) return;
  throw numeric_error("E0420")
      .says("the squares of the samples do not fit into a double (deviations from 10⁻¹⁰⁰ to 10¹⁰⁰ do)")
      .hint("give them in another unit");
}

double Average::degrees_of_freedom(const std::vector<double>& window) const {
  const double count = static_cast<double>(used_);
  // Of the Hann window with itself half its length away: 1/6.
  const auto r =
      window.empty() ? std::vector<double>{1, 1.0 / 6} : window_correlation(window, layout_.hop, recent_.size());
  double correlated = count;
  for (std::size_t lag = 1; lag < r.size(); ++lag) correlated += 2 * static_cast<double>(pairs_[lag]) * r[lag] * r[lag];
  return 2 * count * (count / correlated);
}

Spectrum Average::spectrum(const std::vector<double>& window, double rate_hz) const {
  check_powers();
  count_work(WorkKind::segments, used_ + dropped_);
  const std::size_t n = layout_.segment;
  const double count = static_cast<double>(used_);
  double amplitude = 0, energy = 0;
  for (const double w : window) {
    amplitude += w;
    energy += w * w;
  }
  if (window.empty()) {  // sums over the periodic Hann window
    amplitude = static_cast<double>(n) / 2;
    energy = 3 * static_cast<double>(n) / 8;
  }
  Spectrum out;
  out.sides = options_.sides;
  out.scaling = options_.scaling;
  out.window = options_.window;
  out.rate_hz = rate_hz;
  out.segment = n;
  out.segments = used_;
  out.dropped = dropped_;
  out.enbw_hz = rate_hz * energy / (amplitude * amplitude);
  out.neighbour_correlation = neighbour_correlation(options_.window, layout_, used_, pairs_);

  const double dof = degrees_of_freedom(window);

  const bool density = options_.scaling == Scaling::psd || options_.scaling == Scaling::lsd;
  const bool root = options_.scaling == Scaling::lsd || options_.scaling == Scaling::ls;
  const double scale = 1 / (count * (density ? rate_hz * energy : amplitude * amplitude));
  const auto put = [&](std::size_t k, double sign) {
    // DC and Nyquist: real, one degree of freedom, and no other side to add
    const bool edge = k == 0 || 2 * k == n;
    const double power = power_[k] * scale * (options_.sides == Sides::one && !edge ? 2 : 1);
    out.frequency_hz.push_back(sign * static_cast<double>(k) * rate_hz / static_cast<double>(n));
    out.value.push_back(root ? std::sqrt(power) : power);
    out.dof.push_back(edge ? dof / 2 : dof);
  };
  const std::size_t bins = options_.sides == Sides::two ? n + 1 : n / 2 + 1;
  out.frequency_hz.reserve(bins);
  out.value.reserve(bins);
  out.dof.reserve(bins);
  if (options_.sides == Sides::two)
    for (std::size_t k = (n - 1) / 2; k > 0; --k) put(k, -1);
  for (std::size_t k = 0; k <= n / 2; ++k) put(k, 1);
  return out;
}

Spectrum Average::finish(const std::vector<double>& window, double rate_hz, std::uint64_t samples) const {
  if (used_ == 0)
    throw numeric_error("E0401")
        .says(
            "a spectrum with segments of {} samples needs as many without a missing one; none was found in {} samples",
            layout_.segment, samples)
        .hint("choose a shorter segment");
  Spectrum out = spectrum(window, rate_hz);
  note_dropped(out.dropped, out.segments, out.notes);
  return out;
}

namespace {

struct Run {
  std::uint64_t begin = 0, end = 0;
};

// Stretches without a missing sample.
std::vector<Run> present_runs(std::span<const double> record) {
  std::vector<Run> runs;
  const std::size_t n = record.size();
  for (std::size_t i = 0; i < n;) {
    while (i < n && !std::isfinite(record[i])) ++i;
    const std::size_t begin = i;
    i += finite_run(record.subspan(i));
    if (i > begin) runs.push_back({begin, i});
  }
  return runs;
}

std::uint64_t usable_segments(const std::vector<Run>& runs, const Layout& layout) {
  std::uint64_t count = 0;
  for (const Run& run : runs) {
    const std::uint64_t begin = (run.begin + layout.hop - 1) / layout.hop * layout.hop;
    if (begin + layout.segment <= run.end) count += (run.end - layout.segment - begin) / layout.hop + 1;
  }
  return count;
}

std::uint64_t longest(const std::vector<Run>& runs) {
  std::uint64_t length = 0;
  for (const Run& run : runs) length = std::max(length, run.end - run.begin);
  return length;
}

}  // namespace

std::uint64_t choose_segment(std::span<const double> record, const WelchOptions& options,
                             std::vector<std::string>& notes) {
  const std::uint64_t n = record.size();
  const bool given = options.segment != 0;
  const std::uint64_t wanted = given ? options.segment : std::max(kShortestSegment, n / 4);
  std::uint64_t segment = std::min(wanted, n);
  const std::vector<Run> runs = present_runs(record);
  // Half-overlapping quarters are seven; with that many the dropped ones are not missed.
  const std::uint64_t possible = segment >= kShortestSegment ? layout_of(segment, options.overlap).count(n) : 0;
  const std::uint64_t enough = given ? 1 : std::min<std::uint64_t>(possible, 7);
  while (segment >= kShortestSegment && usable_segments(runs, layout_of(segment, options.overlap)) < enough)
    segment /= 2;
  if (segment < kShortestSegment) {
    // Halving may step over a last chance: any run of eight.
    if (usable_segments(runs, layout_of(kShortestSegment, options.overlap)) == 0)
      throw numeric_error("E0401").says(
          "a spectrum needs at least {} consecutive samples; the longest stretch without a missing one has {}",
          kShortestSegment, longest(runs));
    segment = kShortestSegment;
  }
  if (segment < wanted)
    notes.push_back(
        fmt::format("the segment was shortened from {} to {} samples: {}", wanted, segment,
                    n < wanted ? "the record has no more" : "too few longer ones are without a missing sample"));
  return segment;
}

}  // namespace libchar::welch_detail

namespace libchar {

namespace {

// Halves from here on are of a record that has the memory for itself: 64 MB and more for each of
// seven arrays, wanted for its spectrum next.
constexpr std::size_t kNotKept = std::size_t{1} << 23U;

}  // namespace

WelchWorkspace::State::Piece WelchWorkspace::State::take(std::size_t segment) {
  const std::lock_guard lock(mutex_);
  if (!idle_.empty() && 2 * idle_.back().halves.half() == segment) {
    Piece piece = std::move(idle_.back());
    idle_.pop_back();
    return piece;
  }
  idle_.clear();  // of another length: not needed any more
  HalfSegments halves(segment, &pools);
  auto sums = halves.zero_sums();
  return {std::move(halves), std::move(sums)};
}

void WelchWorkspace::State::give_back(Piece piece) {
  if (piece.halves.half() >= kNotKept) return;
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(piece));
}

WelchWorkspace::WelchWorkspace() : state_(detail::hidden<State>()) {}

}  // namespace libchar
