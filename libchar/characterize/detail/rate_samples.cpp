#include "libchar/characterize/detail/rate_samples.hpp"

#include <cmath>
#include <limits>

#include "libchar/core/present.hpp"

namespace libchar {

std::span<const double> usable_samples(std::span<const double> samples,
                                       std::vector<double>& scratch,
                                       std::uint64_t& beyond) {
  beyond = count_beyond(samples);
  if (beyond == 0) return samples;
  scratch.assign(samples.begin(), samples.end());
  for (double& x : scratch)
    if (std::abs(x) > kLargestSample) x = std::numeric_limits<double>::quiet_NaN();
  return scratch;
}

std::span<const double> rate_samples(std::span<const double> samples,
                                     const CharacterizeOptions& options,
                                     std::vector<double>& scratch) {
  const double nominal = options.nominal_frequency;
  if (options.data != SampleKind::frequency || nominal == 0) return samples;
  scratch.assign(samples.begin(), samples.end());
  for (double& f : scratch) f = (f - nominal) / nominal;
  return scratch;
}

}  // namespace libchar
