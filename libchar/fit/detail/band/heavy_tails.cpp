// Whittle's likelihood takes periodogram ordinates for independent. Of white noise of excess kurtosis g they share 2 + g instead of 2:
// with theta = N^2 and n samples
//   var(ln theta) = var of the likelihood + g / n
// (D. R. Brillinger, "Time Series: Data Analysis and Theory", 1981, theorem 5.10.1:
// covariance of spectral averages = Gaussian part + fourth cumulant / n). Differences of white noise have half its excess kurtosis. Slower
// terms have weights that do not see white noise, so that theirs stays.
#include "libchar/fit/detail/band/heavy_tails.hpp"

#include <fmt/format.h>

#include <cmath>

#include "libchar/core/text/readable.hpp"
#include "libchar/fit/remedies.hpp"

namespace libchar {

void widen_for_tails(double difference_kurtosis, std::uint64_t samples, NoiseFit& fit) {
  if (!(difference_kurtosis > spike_alarm(samples))) return;
  constexpr auto kWhite = static_cast<std::size_t>(Term::white);
  Coefficient& white = fit.term[kWhite];
  double& variance = fit.covariance[kWhite][kWhite];
  if (!white.value || !(variance > 0)) return;
  const double more = 2 * (difference_kurtosis - 3) / static_cast<double>(samples);
  const double wider = std::sqrt((variance + more) / variance);
  variance += more;
  white.relative_sd *= wider;
  white.ci95.high = *white.value * std::pow(white.ci95.high / *white.value, wider);
  white.ci95.low = *white.value * std::pow(std::max(white.ci95.low, 0.0) / *white.value, wider);
  if (wider > 1.05)
    fit.findings.push_back(finding(
        "heavy_tails",
        fmt::format("The samples have heavier tails than Gaussian noise (kurtosis of differences "
                    "{} instead of 3): the interval of N is {} times as wide for it.",
                    brief_text(difference_kurtosis),
                    brief_text(wider, 2))));
}

}  // namespace libchar
