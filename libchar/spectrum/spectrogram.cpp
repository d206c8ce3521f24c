// Short-time spectra: the periodograms whose mean is Welch's spectrum, segments.cpp.

#include <algorithm>
#include <cmath>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/parallel/parallel.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/spectrum/detail/segments.hpp"
#include "libchar/spectrum/welch.hpp"

namespace libchar {
namespace {

using namespace welch_detail;

constexpr double kMostCellBytes = 2147483648.0;

void check_cells(std::uint64_t samples, const Layout& layout) {
  if (layout.segment > samples)
    throw usage_error("E0875", "`segment`")
        .says("a segment of {} samples is longer than the record of {}", layout.segment, samples)
        .hint("the longest that fits has {}", samples);
  const double cells = static_cast<double>(layout.count(samples)) * static_cast<double>(layout.segment / 2 + 1);
  if (cells * sizeof(double) > kMostCellBytes)
    throw usage_error("E0875", "`segment`")
        .says("the spectrogram would take more than 2 GiB")
        .hint("give less `overlap`, or read less with `from_s`, `to_s`");
}

}  // namespace

Spectrogram spectrogram(std::span<const double> record, double rate_hz, const WelchOptions& options) {
  check_options(options);
  check_rate(rate_hz);
  const std::uint64_t quarter = std::max<std::uint64_t>(kShortestSegment, record.size() / 4);
  const Layout layout = layout_of(options.segment == 0 ? quarter : options.segment, options.overlap);
  check_cells(record.size(), layout);
  const std::vector<double> window = window_values(options.window, layout.segment);
  double amplitude = 0, energy = 0;
  for (const double w : window) {
    amplitude += w;
    energy += w * w;
  }
  const bool density = options.scaling == Scaling::psd || options.scaling == Scaling::lsd;
  const bool root = options.scaling == Scaling::lsd || options.scaling == Scaling::ls;
  const double scale = 1 / (density ? rate_hz * energy : amplitude * amplitude);
  Spectrogram out{options.sides, options.scaling, options.window, rate_hz, layout.segment, {}, {}, {}};
  const std::size_t bins = layout.segment / 2 + 1;
  for (std::size_t k = 0; k < bins; ++k)
    out.frequency_hz.push_back(static_cast<double>(k) * rate_hz / static_cast<double>(layout.segment));
  out.value.resize(detail::in_memory(layout.count(record.size())));
  for (std::size_t i = 0; i < out.value.size(); ++i)
    out.time_s.push_back((static_cast<double>(i * layout.hop) + static_cast<double>(layout.segment) / 2) / rate_hz);
  parallel::for_each(0, out.value.size(), [&](std::size_t i) {
    Periodogram periodogram(options, window);
    std::vector<double> power(bins, 0.0);
    if (!periodogram.add(record.data() + i * layout.hop, power.data())) return;
    for (std::size_t k = 0; k < bins; ++k) {
      const bool edge = k == 0 || 2 * k == layout.segment;
      power[k] *= scale * (options.sides == Sides::one && !edge ? 2 : 1);
      if (root) power[k] = std::sqrt(power[k]);
    }
    out.value[i] = std::move(power);
  });
  return out;
}

}  // namespace libchar
