// P_xy = 1/K sum_i conj(X_i) Y_i, scaled as Welch's density, and the magnitude-squared coherence |P_xy|^2 / (P_xx P_yy)
// (J. S. Bendat, A. G. Piersol, Random Data, 4th ed. 2010, 9.2; G. C. Carter, Proc. IEEE 75 (1987)
// 236). Of independent channels it is beta(1, K - 1) distributed: mean 1/K, below 1 - a^(1/(K-1))
// with probability 1 - a. K is the number of independent segments, half the degrees of freedom of
// the average. Groups of segments are added in order, so that the number of threads changes no bit.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/parallel/parallel.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/spectrum/detail/segments.hpp"
#include "libchar/spectrum/welch.hpp"

namespace libchar {
namespace {

using namespace welch_detail;

constexpr double kFalseAlarm = 0.05;

struct PairSums {
  std::vector<double> first, second;
  std::vector<std::complex<double>> both;
  std::vector<char> used;
  explicit PairSums(std::size_t bins) : first(bins), second(bins), both(bins) {}
  void operator+=(const PairSums& other) {
    for (std::size_t k = 0; k < both.size(); ++k) {
      first[k] += other.first[k];
      second[k] += other.second[k];
      both[k] += other.both[k];
    }
  }
};

/// NaN where either is missing.
std::vector<double> presence(std::span<const double> x, std::span<const double> y) {
  std::vector<double> out(x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) out[i] = std::nan("");
  return out;
}

PairSums pair_sums(std::span<const double> x, std::span<const double> y, const Layout& layout, std::uint64_t first,
                   std::uint64_t last, const WelchOptions& options, const std::vector<double>& window) {
  PairSums out(layout.segment / 2 + 1);
  Periodogram of_x(options, window), of_y(options, window);
  for (std::uint64_t i = first; i < last; ++i) {
    const auto a = of_x.transform(x.data() + i * layout.hop);
    const auto b = of_y.transform(y.data() + i * layout.hop);
    out.used.push_back(!a.empty() && !b.empty() ? 1 : 0);
    if (out.used.back() == 0) continue;
    for (std::size_t k = 0; k < a.size(); ++k) {
      out.first[k] += std::norm(a[k]);
      out.second[k] += std::norm(b[k]);
      out.both[k] += std::conj(a[k]) * b[k];
    }
  }
  return out;
}

void fill_bins(const PairSums& sums, double scale, CrossSpectrum& out) {
  const std::size_t n = detail::in_memory(out.segment);
  const double segments = out.effective_segments;
  for (std::size_t k = 0; k < sums.both.size(); ++k) {
    const bool edge = k == 0 || 2 * k == n;
    const double to_density = scale * (out.sides == Sides::one && !edge ? 2 : 1);
    out.frequency_hz.push_back(static_cast<double>(k) * out.rate_hz / static_cast<double>(n));
    out.density.push_back(sums.both[k] * to_density);
    out.first.push_back(sums.first[k] * to_density);
    out.second.push_back(sums.second[k] * to_density);
    const double product = sums.first[k] * sums.second[k];
    const double coherence = product > 0 ? std::clamp(std::norm(sums.both[k]) / product, 0.0, 1.0) : 0;
    out.coherence.push_back(coherence);
    out.coherence_unbiased.push_back(std::max(0.0, (segments * coherence - 1) / (segments - 1)));
    const double at_most = std::numbers::pi / std::sqrt(3.0);
    out.phase_sd_rad.push_back(
        coherence > 0 ? std::min(at_most, std::sqrt((1 - coherence) / (2 * segments * coherence))) : at_most);
  }
}

}  // namespace

CrossSpectrum cross_spectrum(std::span<const double> x, std::span<const double> y, double rate_hz,
                             const WelchOptions& options) {
  check_options(options);
  check_rate(rate_hz);
  if (x.size() != y.size())
    throw usage_error("E0873")
        .says("a cross spectrum is of two records of one length")
        .got("{} and {} samples", x.size(), y.size());
  CrossSpectrum out;
  const Layout layout = layout_of(choose_segment(presence(x, y), options, out.notes), options.overlap);
  const std::vector<double> window = window_values(options.window, layout.segment);
  const std::size_t count = detail::in_memory(layout.count(x.size()));
  std::vector<PairSums> groups((count + layout.group - 1) / layout.group, PairSums(layout.segment / 2 + 1));
  parallel::for_each(0, groups.size(), [&](std::size_t g) {
    groups[g] = pair_sums(x, y, layout, g * layout.group, std::min<std::uint64_t>(count, (g + 1) * layout.group),
                          options, window);
  });
  PairSums sums(layout.segment / 2 + 1);
  Average average(options, layout);
  for (const PairSums& group : groups) {
    sums += group;
    for (const char used : group.used) average.note_segment(used != 0);
  }
  out.sides = options.sides;
  out.window = options.window;
  out.rate_hz = rate_hz;
  out.segment = layout.segment;
  out.segments = average.used();
  out.dropped = average.dropped();
  if (out.segments < 2)
    throw numeric_error("E0874")
        .says("the coherence of a single segment is 1 whatever the channels are")
        .got("{} segment of {} samples", out.segments, out.segment)
        .hint("give a shorter `segment`");
  out.effective_segments = average.degrees_of_freedom(window) / 2;
  out.significant_coherence = 1 - std::pow(kFalseAlarm, 1 / (out.effective_segments - 1));
  double energy = 0;
  for (const double w : window) energy += w * w;
  fill_bins(sums, 1 / (static_cast<double>(out.segments) * rate_hz * energy), out);
  note_dropped(out.dropped, out.segments, out.notes);
  return out;
}

}  // namespace libchar
