// Median of the K periodograms P_i of Welch's segments (B. Allen and others, "FINDCHIRP", Phys.
// Rev. D 85 (2012) 122006, app. B). A power with two degrees of freedom is exponentially
// distributed; the k-th smallest of K has (A. Rényi, 1953)
//
//   E = sum_{i=K-k+1}^{K} 1/i,   Var = sum_{i=K-k+1}^{K} 1/i^2,
//
// so that the median of K = 2p + 1 is biased by 1 - 1/2 + 1/3 - … + 1/K, and that of K = 2p, the mean of the middle
// two, by the sum to K - 1. f = 0 and Nyquist, with one degree of freedom, are divided by the same. Independence is
// assumed for bias and variance; overlap counts as it does in the mean.

#include <algorithm>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/parallel/parallel.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/spectrum/detail/segments.hpp"
#include "libchar/spectrum/welch.hpp"

namespace libchar {
namespace {

using namespace welch_detail;

constexpr double kMostPowerBytes = 2147483648.0;

/// Variance of the median over its squared mean.
double median_spread(std::uint64_t count) {
  const std::uint64_t p = count / 2;
  double variance = 0;
  for (std::uint64_t i = count - p + (count % 2 == 0 ? 1 : 0); i <= count; ++i)
    variance += 1 / (static_cast<double>(i) * static_cast<double>(i));
  // The next one is larger by an independent 1/p of an exponential: half of it.
  if (count % 2 == 0) variance += 0.25 / (static_cast<double>(p) * static_cast<double>(p));
  const double mean = expected_median(count);
  return variance / (mean * mean);
}

double median_of(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return (*middle + *std::max_element(values.begin(), middle)) / 2;
}

}  // namespace

double expected_median(std::uint64_t count) {
  const std::uint64_t last = count % 2 == 1 ? count : count - 1;
  double sum = 0;
  for (std::uint64_t i = last; i >= 1; --i) sum += (i % 2 == 1 ? 1.0 : -1.0) / static_cast<double>(i);
  return sum;
}

Spectrum median_welch(std::span<const double> record, double rate_hz, const WelchOptions& options) {
  check_options(options);
  check_rate(rate_hz);
  std::vector<std::string> notes;
  const Layout layout = layout_of(choose_segment(record, options, notes), options.overlap);
  const std::size_t segments = detail::in_memory(layout.count(record.size())), bins = layout.segment / 2 + 1;
  if (static_cast<double>(segments) * static_cast<double>(bins) * sizeof(double) > kMostPowerBytes)
    throw usage_error("E0872", "`average`")
        .says("a median takes the powers of all {} segments of {} bins at once, which are more than 2 GiB", segments,
              bins)
        .hint("give less `overlap`, or read less with `from_s`, `to_s`");
  const std::vector<double> window = window_values(options.window, layout.segment);
  std::vector<std::vector<double>> powers(segments);
  parallel::for_each(0, segments, [&](std::size_t i) {
    Periodogram periodogram(options, window);
    std::vector<double> power(bins, 0.0);
    if (periodogram.add(record.data() + i * layout.hop, power.data())) powers[i] = std::move(power);
  });
  Average average(options, layout);
  for (const auto& power : powers) average.note_segment(!power.empty());
  std::erase_if(powers, [](const auto& power) { return power.empty(); });
  const auto used = static_cast<double>(powers.size());
  // What `Average` divides by their number is a sum.
  std::vector<double> sum(bins);
  parallel::for_each(0, bins, [&](std::size_t k) {
    std::vector<double> of_bin;
    for (const auto& power : powers) of_bin.push_back(power[k]);
    sum[k] = median_of(of_bin) / expected_median(powers.size()) * used;
  });
  average.add_group(std::move(sum));
  average.note_samples(record);
  Spectrum spectrum = average.spectrum(window, rate_hz);
  const double efficiency = 1 / used / median_spread(powers.size());
  for (double& dof : spectrum.dof) dof *= efficiency;
  spectrum.notes = std::move(notes);
  note_dropped(spectrum.dropped, spectrum.segments, spectrum.notes);
  return spectrum;
}

}  // namespace libchar
