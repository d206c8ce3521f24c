#include "libchar/allan/detail/tau_grid.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "libchar/allan/detail/family.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kDenseUpTo = 1000;  // every m
constexpr double kDensePerDecade = 200;     // beyond
constexpr double kTheoReach = 0.75;         // of the record

/// Largest m that leaves one term.
std::uint64_t largest_factor(const DeviationRow& row, std::uint64_t samples) {
  std::uint64_t m = samples + 1;
  if (row.family == DeviationFamily::differences && !row.reflected)
    m = samples / static_cast<std::uint64_t>(row.order) + 1;
  while (m > 0 && row.span(m) > samples) --m;
  return m;
}

std::vector<std::uint64_t> regular_grid(TauGrid grid, std::uint64_t largest) {
  std::vector<std::uint64_t> factors;
  if (grid == TauGrid::octave)
    for (std::uint64_t m = 1; m <= largest; m *= 2) factors.push_back(m);
  if (grid == TauGrid::decade)
    for (std::uint64_t decade = 1; decade <= largest; decade *= 10)
      for (const std::uint64_t m : {decade, 2 * decade, 4 * decade})
        if (m <= largest) factors.push_back(m);
  if (grid == TauGrid::all)
    for (std::uint64_t m = 1; m <= largest; ++m) factors.push_back(m);
  if (grid == TauGrid::dense) {
    for (std::uint64_t m = 1; m <= std::min(largest, kDenseUpTo); ++m) factors.push_back(m);
    for (double k = 1;; ++k) {
      const double m =
          std::round(static_cast<double>(kDenseUpTo) * std::pow(10, k / kDensePerDecade));
      if (m > static_cast<double>(largest)) break;
      factors.push_back(static_cast<std::uint64_t>(m));
    }
  }
  return factors;
}

std::vector<std::uint64_t> listed(const std::vector<double>& taus,
                                  double dt_s,
                                  double largest,
                                  std::vector<std::string>& notes) {
  std::vector<std::uint64_t> factors;
  std::uint64_t too_long = 0, moved = 0;
  for (const double tau : taus) {
    if (!(tau > 0) || !std::isfinite(tau))
      throw Error({ErrorKind::usage,
                   "E0201",
                   "`taus_s`",
                   "an averaging time must be a positive number of seconds",
                   shortest(tau)});
    const double m = std::max(1.0, std::round(tau / dt_s));
    moved += std::abs(m * dt_s / tau - 1) > 1e-6 ? 1 : 0;
    if (m > largest)
      ++too_long;
    else
      factors.push_back(static_cast<std::uint64_t>(m));
  }
  if (too_long > 0)
    notes.push_back(std::to_string(too_long) +
                    " of the listed averaging times left out: longer than the record allows (" +
                    duration_text(largest * dt_s) + ")");
  if (moved > 0)
    notes.push_back(
        std::to_string(moved) +
        " of the listed averaging times moved to the nearest multiple of the sampling interval (" +
        duration_text(dt_s) + ")");
  return factors;
}

/// How the numbers of a grid, in samples, become averaging factors of a statistic of the Theo
/// family: Theo1 has even factors from 10 on, and averaging times of three quarters of them. A
/// regular grid of Theo1 is of its factors; a list, and TheoH's grids, which begin with Allan's
/// factors, are of averaging times.
class TheoGrid {
 public:
  TheoGrid(const DeviationRow& row, TauGrid grid, std::uint64_t samples)
      : of_factors_(grid != TauGrid::list && row.type != DeviationType::theoh),
        allan_up_to_(row.type == DeviationType::theoh ? last_allan_factor(samples) : 0),
        samples_(samples) {}
  /// A number of the grid, over its averaging time in samples.
  double stretch() const { return of_factors_ ? 1 / kTimeOfFactor : 1; }
  double time(std::uint64_t factor) const {
    return static_cast<double>(factor) * (factor <= allan_up_to_ ? 1 : kTimeOfFactor);
  }
  std::vector<std::uint64_t> factors(const std::vector<std::uint64_t>& grid) const {
    std::vector<std::uint64_t> out;
    for (const std::uint64_t n : grid) {
      if (n <= allan_up_to_) {
        out.push_back(n);
        continue;
      }
      const std::uint64_t factor = of_factors_ ? n / 2 * 2 : theo_factor(static_cast<double>(n));
      if (factor >= kSmallest && factor <= samples_) out.push_back(factor);
    }
    return out;
  }

 private:
  static constexpr double kTimeOfFactor = 0.75;
  static constexpr std::uint64_t kSmallest = 10;
  bool of_factors_;
  std::uint64_t allan_up_to_, samples_;
};

}  // namespace

std::vector<std::uint64_t> averaging_factors(const AllanOptions& options,
                                             double dt_s,
                                             std::uint64_t samples,
                                             std::vector<std::string>& notes) {
  const double duration = static_cast<double>(samples) * dt_s;
  const DeviationRow& row = deviation_row(options.type);
  std::optional<TheoGrid> theo;
  if (row.family == DeviationFamily::theo) theo.emplace(row, options.grid, samples);
  const double tau_max =
      options.tau_max_s > 0 ? options.tau_max_s : duration * (theo ? kTheoReach : 0.5);
  // A hair of slack: tau_max and tau_min are decimal numbers, the multiples of dt are not.
  const double slack = 1 + 1e-9;
  double reach = std::max(1.0, std::floor(tau_max / dt_s * slack * (theo ? theo->stretch() : 1)));
  reach = std::min(reach, static_cast<double>(largest_factor(row, samples)));
  std::vector<std::uint64_t> factors =
      options.grid == TauGrid::list ? listed(options.taus_s, dt_s, reach, notes)
                                    : regular_grid(options.grid, static_cast<std::uint64_t>(reach));
  if (theo) factors = theo->factors(factors);
  std::sort(factors.begin(), factors.end());
  factors.erase(std::unique(factors.begin(), factors.end()), factors.end());
  std::erase_if(factors, [&](std::uint64_t m) {
    return (theo ? theo->time(m) : static_cast<double>(m)) * dt_s * slack < options.tau_min_s;
  });
  return factors;
}

}  // namespace libchar
