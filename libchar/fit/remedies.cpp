#include "libchar/fit/remedies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "libchar/core/moments.hpp"

namespace libchar {

double spike_alarm(std::uint64_t samples) {
  // Kurtosis of n differences of white noise scatters by sqrt(24/n) times 1.4 for their correlation
  // of -1/2.
  return std::max(
      3.1, 3 + 7 * std::sqrt(24.0 / static_cast<double>(std::max<std::uint64_t>(samples, 1))));
}

double kurtosis_of_differences(std::span<const double> record) {
  Moments moments;
  std::array<double, 4096> piece;
  for (std::size_t t = 1; t < record.size();) {
    const std::size_t n = std::min(piece.size(), record.size() - t);
    for (std::size_t i = 0; i < n; ++i) piece[i] = record[t + i] - record[t + i - 1];
    moments.push(std::span<const double>(piece).first(n));
    t += n;
  }
  return moments.kurtosis();
}

Remedy spikes_remedy(double kurtosis, double alarm, std::uint64_t replaced) {
  return {"spikes",
          fmt::format("kurtosis of differences {:.3g} > {:.3g}", kurtosis, alarm),
          fmt::format("{} samples replaced by the mean of their neighbours", replaced),
          replaced};
}

Remedy lines_remedy(std::uint64_t clipped) {
  return {"lines",
          "coefficients of the spectrum above 32 times the floor around them",
          fmt::format("{} coefficients in and beside spectral lines left out", clipped),
          clipped};
}

}  // namespace libchar
