#include "libchar/fit/record/power_bins.hpp"

#include <algorithm>

#include "libchar/core/numeric/present.hpp"
#include "libchar/fit/detail/band/line_clip.hpp"
#include "libchar/fit/detail/record/pooled_power.hpp"
#include "libchar/fit/detail/record/record_powers.hpp"

namespace libchar {

std::vector<PooledPower> whole_powers(std::span<const double> record) {
  std::vector<PooledPower> powers;
  std::vector<double> segment;
  std::uint64_t gap = 0, samples = 0;
  const auto end_segment = [&] {
    if (segment.size() >= kSmallestTransform)
      powers.push_back(record_power(segment, 1, 1, segment.size()));
    segment.clear();
  };
  while (!record.empty()) {
    const std::size_t run = present_run(record);
    if (run > 0 && gap > std::max(kLongGap, samples / 100)) end_segment();
    gap = run > 0 ? 0 : gap + 1;
    segment.insert(
        segment.end(), record.begin(), record.begin() + static_cast<std::ptrdiff_t>(run));
    samples += run;
    record = record.subspan(std::max<std::size_t>(run, 1));
  }
  end_segment();
  return powers;
}

std::vector<PowerBin> power_bins(std::span<const PooledPower> powers, double rate_hz) {
  std::vector<PowerBin> bins;
  for (const PooledPower& power : powers) append_power_bins(power, rate_hz, {}, bins);
  return bins;
}

std::vector<PowerBin> power_bins(std::span<const double> record, double rate_hz) {
  return power_bins(whole_powers(record), rate_hz);
}

ClippedBins clipped_power_bins(std::span<const PooledPower> powers, double rate_hz) {
  ClippedBins out;
  for (const PooledPower& power : powers) {
    const LineClip clip = clip_lines(power.mean, power.first, power.pooled);
    out.clipped += clip.count;
    append_power_bins(power, rate_hz, clip.clipped, out.bins);
  }
  if (out.clipped > 0) out.all = power_bins(powers, rate_hz);
  return out;
}

}  // namespace libchar
