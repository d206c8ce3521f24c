// The series of means of a long record: blocks and slow means against the noise they are of, and in parts.

#include "libchar/fit/detail/record/mean_series.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "libchar/fit/noise_fit.hpp"
#include "libchar/fit/record/power_sums.hpp"
#include "tests/fit/power_state.hpp"

using namespace libchar;

namespace {

constexpr std::uint64_t kPerMean = 512;
constexpr double kRateHz = 1000;
constexpr std::size_t kMostMeans = std::size_t{1} << 20U;  ///< of 2^29 samples

/// sqrt(512) times means of 512 samples of white noise of deviation 1 and of a walk: of the walk
/// the increments of the means' spacing, and what the mean over the spacing adds to them.
std::vector<double> white_walk_means(std::size_t n, double walk_step, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::vector<double> means(n);
  double walk = 0;
  const double scale = std::sqrt(static_cast<double>(kPerMean));
  for (double& x : means) {
    // End point and mean of a walk over a step: covariance (1, 1/2; 1/2, 1/3) of the step's variance.
    const double a = normal(engine), b = normal(engine);
    const double step = walk_step * scale;
    x = normal(engine) + scale * (walk + step * (0.5 * a + b / std::sqrt(12.0)));
    walk += step * a;
  }
  return means;
}

/// Sum of squares of the bins' relative distances from what they should be, in their standard
/// deviations; the largest bins.
struct Distance {
  double chi2 = 0, bins = 0;
};

Distance distance(const std::vector<PowerBin>& bins, double white, double walk) {
  Distance out;
  for (const PowerBin& bin : bins) {
    if (bin.dof < 8) continue;
    const double model =
        white * bin.unit[static_cast<std::size_t>(Term::white)] + walk * bin.unit[static_cast<std::size_t>(Term::walk)];
    out.chi2 += std::pow(bin.energy / model - 1, 2) * bin.dof / 2;
    out.bins += 1;
  }
  return out;
}

/// Parts of 2^24 samples, as leaves of a log come to be settled; the last may be short and stays.
PowerSums in_parts(const std::vector<double>& means, double shift_of_part) {
  PowerSums all;
  bool first = true;
  for (std::size_t from = 0; from < means.size(); from += kMeansBlock) {
    const std::size_t count = std::min<std::size_t>(kMeansBlock, means.size() - from);
    const double shift = static_cast<double>(from) * shift_of_part;
    PowerRun run{0, count * kPerMean, shift, {}, {}, 0, count * kPerMean};
    for (std::size_t i = 0; i < count; ++i)
      run.means.push_back(means[from + i] - std::sqrt(static_cast<double>(kPerMean)) * shift);
    PowerSums part;
    part.rows = count * kPerMean;
    part.runs.push_back(std::move(run));
    if (count == kMeansBlock) settle_means(part, from * kPerMean);
    first ? void(all = std::move(part)) : join(all, std::move(part));
    first = false;
  }
  return all;
}

std::vector<PowerBin> series_bins(const std::vector<double>& means) {
  return power_bins(powers_of(in_parts(means, 0)), kRateHz);
}

}  // namespace

TEST_CASE("mean series: every coefficient of a long one is there once, slow ones with the whole resolution") {
  const std::size_t n = kMostMeans + 5 * kMeansBlock + 20000;
  const std::vector<PowerBin> bins = series_bins(white_walk_means(n, 0, 2));
  double count = 0, slowest = 1e9;
  for (const PowerBin& bin : bins) {
    count += bin.dof;
    slowest = std::min(slowest, bin.frequency_hz);
  }
  const auto wanted = static_cast<double>(end_of_left(n, kPerMean, PowerPart::kBlock));
  REQUIRE(count == Approx(wanted).epsilon(1e-4));
  REQUIRE(slowest == Approx(kRateHz / (2.0 * static_cast<double>(n * kPerMean))).epsilon(1e-3));
}

TEST_CASE("mean series: bins of a long one have the expectations of white noise and of a walk") {
  // At level 0 the walk is stronger than the white noise below 1e-4 Hz, in the middle of the blocks' coefficients.
  const double step = 2e-5;
  for (const unsigned seed : {3U, 4U, 5U}) {
    const std::vector<PowerBin> bins = series_bins(white_walk_means(kMostMeans + 3 * kMeansBlock + 12345, step, seed));
    const Distance right = distance(bins, 1 / kRateHz, step * step * kRateHz);
    CAPTURE(seed, right.chi2, right.bins);
    REQUIRE(right.bins > 60);
    REQUIRE(right.chi2 < right.bins + 5 * std::sqrt(2 * right.bins));  // false alarm 1e-6
    const Distance wrong = distance(bins, 1 / kRateHz, 0.6 * step * step * kRateHz);
    REQUIRE(wrong.chi2 > wrong.bins + 5 * std::sqrt(2 * wrong.bins));
  }
}

TEST_CASE("mean series: parts of a long record, each less its own first sample, are the series") {
  const std::vector<double> means = white_walk_means(kMostMeans + 2 * kMeansBlock + 9999, 1e-4, 6);
  const std::vector<PowerBin> whole = series_bins(means);
  const std::vector<PowerBin> parts = power_bins(powers_of(in_parts(means, 1e-6)), kRateHz);
  REQUIRE(parts.size() == whole.size());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    CAPTURE(i, whole[i].frequency_hz);
    REQUIRE(parts[i].dof == whole[i].dof);
    REQUIRE(parts[i].energy == Approx(whole[i].energy).epsilon(1e-9));
  }
}

TEST_CASE("mean series: a part with missing samples is cut into pieces that have the noise's expectations") {
  std::vector<double> means = white_walk_means(40 * kMeansBlock, 2e-5, 7);
  PowerSums all;
  for (std::size_t part = 0; part < 40; ++part) {
    // Some are short by what is missing; one has a gap that is too short for a new segment.
    const std::size_t count = kMeansBlock - (part % 3 == 1 ? 777 * (part % 5) : 0);
    const double* from = &means[part * kMeansBlock];
    PowerSums one;
    const std::size_t cut = part == 9 ? count / 3 : count;
    one.runs.push_back({0, cut * kPerMean, 0, {from, from + cut}, {}, 0, cut * kPerMean});
    if (cut < count)
      one.runs.push_back(
          {5000, (count - cut) * kPerMean, 0, {from + cut, from + count}, {}, 0, (count - cut) * kPerMean});
    settle_means(one, part << 24U);
    REQUIRE(one.runs.size() == 1);
    part == 0 ? void(all = std::move(one)) : join(all, std::move(one));
  }
  const Distance right = distance(power_bins(powers_of(std::move(all)), kRateHz), 1 / kRateHz, 4e-10 * kRateHz);
  CAPTURE(right.chi2, right.bins);
  REQUIRE(right.bins > 100);
  REQUIRE(right.chi2 < right.bins + 5 * std::sqrt(2 * right.bins));
}

TEST_CASE("mean series: a gap longer than a hundredth of what is in front begins a segment of its own") {
  const std::vector<double> means = white_walk_means(kMeansBlock, 0, 8);
  PowerSums sums;
  const std::size_t half = kMeansBlock / 2;
  sums.runs.push_back({0, half * kPerMean, 0, {means.begin(), means.begin() + half}, {}, 0, half * kPerMean});
  sums.runs.push_back({50000, half * kPerMean, 0, {means.begin() + half, means.end()}, {}, 0, half * kPerMean});
  PowerSums later = sums;
  settle_means(sums, 0);
  REQUIRE(sums.runs.size() == 2);
  settle_means(later, std::uint64_t{1} << 30U);
  REQUIRE(later.runs.size() == 1);
  REQUIRE(later.runs[0].slow.size() == kMeansPerBlock);
}

TEST_CASE("mean series: a settled state that was written and read is the same") {
  test::check_power_state(in_parts(white_walk_means(33 * kMeansBlock + 500, 1e-4, 9), 1e-6));
}
