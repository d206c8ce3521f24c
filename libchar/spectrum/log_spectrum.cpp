// Spectra on a logarithmic frequency axis.
//
// Averaging M bins of nu_k degrees of freedom each whose powers are correlated by c_m, m bins
// apart:
//   variance / level^2 = (1/M^2) sum_{k,l} c_|k-l| 2 / sqrt(nu_k nu_l),      nu = 2 / that.
//
// A long record is cut into octaves of eight: each level low-passes and keeps every eighth sample
// of the level before, so that all levels together cost 8/7 of the first, and Welch's method with
// short segments is enough at each.

#include "libchar/spectrum/log_spectrum.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "libchar/core/lanes.hpp"
#include "libchar/spectrum/spectrum.hpp"
#include "libchar/spectrum/welch.hpp"

namespace libchar {
namespace {

bool is_root(Scaling scaling) {
  return scaling == Scaling::lsd || scaling == Scaling::ls;
}

// All but the bins, which may be as many as a record has samples.
Spectrum without_bins(const Spectrum& s) {
  Spectrum out;
  out.sides = s.sides;
  out.scaling = s.scaling;
  out.window = s.window;
  out.rate_hz = s.rate_hz;
  out.segment = s.segment;
  out.segments = s.segments;
  out.dropped = s.dropped;
  out.enbw_hz = s.enbw_hz;
  out.notes = s.notes;
  return out;
}

double power_of(const Spectrum& s, std::size_t i) {
  return is_root(s.scaling) ? s.value[i] * s.value[i] : s.value[i];
}

double averaged_dof(const Spectrum& s, std::size_t begin, std::size_t end) {
  const double count = static_cast<double>(end - begin);
  double variance = 0;
  // All bins but the first and last of a spectrum have the same degrees of freedom.
  const bool same = std::all_of(s.dof.begin() + static_cast<std::ptrdiff_t>(begin),
                                s.dof.begin() + static_cast<std::ptrdiff_t>(end),
                                [&](double dof) { return dof == s.dof[begin]; });
  if (same) {
    double terms = count;
    for (std::size_t m = 1; m <= s.neighbour_correlation.size() && begin + m < end; ++m)
      terms += 2 * (count - static_cast<double>(m)) * s.neighbour_correlation[m - 1];
    return s.dof[begin] * count * (count / terms);
  }
  for (std::size_t k = begin; k < end; ++k) {
    variance += 2 / s.dof[k];
    for (std::size_t m = 1; m <= s.neighbour_correlation.size() && k + m < end; ++m)
      variance += 2 * s.neighbour_correlation[m - 1] * 2 / std::sqrt(s.dof[k] * s.dof[k + m]);
  }
  return 2 * count * count / variance;
}

// Logarithmic bins numbered from `low`, `per_e` of them for each factor e.
struct LogAxis {
  double low = 1, per_e = 1;
  double log_low = std::log(low);
  long bin(double log_f) const {
    return static_cast<long>(std::floor((log_f - log_low) * per_e + 1e-9));
  }
};

LogAxis axis_of(double low, double high, std::size_t bins) {
  // The highest frequency belongs to the last bin.
  return {low, static_cast<double>(bins) / std::max(std::log(high / low) * (1 + 1e-6), 1e-12)};
}

// Appends the average of every logarithmic bin of `s` whose frequencies lie in [from, to), divided
// by `response(f)`.
template <typename Response>
void append_averages(const Spectrum& s,
                     const LogAxis& axis,
                     double from,
                     double to,
                     const Response& response,
                     Spectrum& out) {
  std::size_t begin = 0;
  while (begin < s.value.size() && (s.frequency_hz[begin] <= 0 || s.frequency_hz[begin] < from))
    ++begin;
  while (begin < s.value.size() && s.frequency_hz[begin] < to) {
    const double first_log = std::log(s.frequency_hz[begin]);
    const long bin = axis.bin(first_log);
    double power = power_of(s, begin) / response(s.frequency_hz[begin]), log_f = first_log;
    std::size_t end = begin + 1;
    for (; end < s.value.size() && s.frequency_hz[end] < to; ++end) {
      const double here = std::log(s.frequency_hz[end]);
      if (axis.bin(here) != bin) break;
      power += power_of(s, end) / response(s.frequency_hz[end]);
      log_f += here;
    }
    const double count = static_cast<double>(end - begin);
    out.frequency_hz.push_back(end == begin + 1 ? s.frequency_hz[begin] : std::exp(log_f / count));
    out.value.push_back(is_root(s.scaling) ? std::sqrt(power / count) : power / count);
    out.dof.push_back(averaged_dof(s, begin, end));
    begin = end;
  }
}

constexpr double kEverything = 1e300;
constexpr auto kFlat = [](double) { return 1.0; };

// Decimation by eight: a low-pass of 80 taps (Kaiser window, 80 dB) that passes the lower half of
// the new band and stops what would fold onto it. What is left of its slope is divided out.
constexpr std::size_t kStep = 8, kTaps = 80;

double bessel_i0(double x) {
  double term = 1, sum = 1;
  for (int k = 1; term > 1e-18 * sum; ++k) {
    term *= x / (2 * k) * (x / (2 * k));
    sum += term;
  }
  return sum;
}

std::array<double, kTaps> low_pass() {
  constexpr double beta = 0.1102 * (80 - 8.7),
                   middle = (kTaps - 1) / 2.0;  // Kaiser's rule for 80 dB
  std::array<double, kTaps> taps{};
  double sum = 0;
  for (std::size_t j = 0; j < kTaps; ++j) {
    const double t = static_cast<double>(j) - middle, x = t / (middle + 0.5);
    taps[j] = std::sin(std::numbers::pi * t / kStep) / (std::numbers::pi * t) *
              bessel_i0(beta * std::sqrt(1 - x * x));
    sum += taps[j];
  }
  for (double& tap : taps) tap /= sum;
  return taps;
}

// |H|^2 at f cycles per sample of the level before.
double response_of(const std::array<double, kTaps>& taps, double f) {
  std::complex<double> sum = 0;
  for (std::size_t j = 0; j < kTaps; ++j)
    sum += taps[j] * std::polar(1.0, -2 * std::numbers::pi * f * static_cast<double>(j));
  return std::norm(sum);
}

// The average under the taps that fall on present samples; missing when those carry less than three
// quarters of the weight.
double average_of_present(const double* x, const std::array<double, kTaps>& taps, double shift) {
  double sum = 0, weight = 0;
  for (std::size_t j = 0; j < kTaps; ++j)
    if (std::isfinite(x[j])) {
      sum += taps[j] * (x[j] - shift);
      weight += taps[j];
    }
  return weight >= 0.75 ? sum / weight : std::nan("");
}

LIBCHAR_WIDE_LANES void filter(
    const double* x, std::size_t count, const double* taps, double shift, double* out) {
  for (std::size_t i = 0; i < count; ++i) {
    const double* here = x + i * kStep;
    double lanes[kStep] = {};
    for (std::size_t j = 0; j < kTaps; j += kStep)
      for (std::size_t lane = 0; lane < kStep; ++lane)
        lanes[lane] += taps[j + lane] * (here[j + lane] - shift);
    out[i] = ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) +
             ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
  }
}

std::vector<double> decimated(std::span<const double> x, const std::array<double, kTaps>& taps) {
  double shift = 0;
  for (const double v : x)
    if (std::isfinite(v)) {
      shift = v;
      break;
    }
  std::vector<double> out((x.size() - kTaps) / kStep + 1);
  filter(x.data(), out.size(), taps.data(), shift, out.data());
  for (std::size_t i = 0; i < out.size(); ++i)
    if (!std::isfinite(out[i])) out[i] = average_of_present(x.data() + i * kStep, taps, shift);
  return out;
}

struct Level {
  Spectrum spectrum;
  double from = 0, to = kEverything;
};

// Level j serves the frequencies from a quarter of the next level's rate to a quarter of its own;
// the first goes up to Nyquist.
std::vector<Level> levels_of(std::span<const double> record,
                             double rate_hz,
                             Sides sides,
                             const std::array<double, kTaps>& taps) {
  constexpr std::size_t kLast = std::size_t{1} << 18U;  // shorter records are not cut any further
  WelchOptions options;
  options.sides = sides;
  std::vector<Level> levels;
  std::vector<double> owned;
  double rate = rate_hz;
  for (std::span<const double> x = record;; rate /= static_cast<double>(kStep)) {
    const double to = levels.empty() ? kEverything : rate / 4;
    if (x.size() < kLast) {
      Spectrum lowest = welch(x, rate, options);
      // The window smears the removed mean over the first bin.
      const double from = 1.5 * rate / static_cast<double>(lowest.segment);
      levels.push_back({std::move(lowest), from, to});
      return levels;
    }
    WelchOptions brief = options;
    brief.segment = 4096;
    levels.push_back({welch(x, rate, brief), rate / (4 * static_cast<double>(kStep)), to});
    std::vector<double> next = decimated(x, taps);
    owned = std::move(next);
    x = owned;
  }
}

}  // namespace

Spectrum log_binned(const Spectrum& spectrum, std::size_t bins) {
  Spectrum out = without_bins(spectrum);
  const auto first =
      std::upper_bound(spectrum.frequency_hz.begin(), spectrum.frequency_hz.end(), 0.0);
  if (first == spectrum.frequency_hz.end() || bins == 0) return out;
  append_averages(spectrum,
                  axis_of(*first, spectrum.frequency_hz.back(), bins),
                  *first,
                  kEverything,
                  kFlat,
                  out);
  return out;
}

Spectrum log_frequency_spectrum(std::span<const double> record,
                                double rate_hz,
                                Sides sides,
                                std::size_t bins) {
  const auto taps = low_pass();
  const std::vector<Level> levels = levels_of(record, rate_hz, sides, taps);
  Spectrum out = without_bins(levels.back().spectrum);
  const LogAxis axis = axis_of(levels.back().from, rate_hz / 2, std::max<std::size_t>(bins, 1));
  for (std::size_t j = levels.size(); j-- > 0;) {
    const auto response = [&](double f) {
      double product = 1, rate = rate_hz;
      for (std::size_t i = 0; i < j; ++i, rate /= static_cast<double>(kStep))
        product *= response_of(taps, f / rate);
      return product;
    };
    append_averages(levels[j].spectrum, axis, levels[j].from, levels[j].to, response, out);
  }
  return out;
}

}  // namespace libchar
