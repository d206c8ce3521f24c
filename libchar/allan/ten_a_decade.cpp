// The overlapping Allan deviation at averaging factor m = r m' of a record is that at m' of its means of r samples, with terms that
// start every r samples instead of every one. For r <= m/8 neighbouring terms are alike to an eighth of their length.
// The first begins r/2 samples in: the first sample of all is in one of all terms, and would be in r times its share of them.
#include "libchar/allan/ten_a_decade.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "libchar/allan/allan_covariance.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kPerMean = 8;  ///< means in an averaging time, at least
constexpr std::uint64_t kOfLong = 8;   ///< the shortest mean of a long record

std::uint64_t mean_length(std::uint64_t m) {
  std::uint64_t r = 1;
  while (m / (2 * r) >= kPerMean) r *= 2;
  return r;
}

// By length of the mean, in means.
std::map<std::uint64_t, std::vector<std::uint64_t>> wanted_factors(const AllanOptions& options,
                                                                   const AllanCurve& octaves) {
  std::map<std::uint64_t, std::vector<std::uint64_t>> out;
  for (int i = 1;; ++i) {
    const double m = std::round(std::pow(10, 0.1 * i));
    if (2 * m > static_cast<double>(octaves.samples)) break;
    const auto whole = static_cast<std::uint64_t>(m);
    const std::uint64_t r = octaves.missing > 0 ? 1 : mean_length(whole);
    const std::uint64_t in_means = (whole + r / 2) / r;
    const double tau = static_cast<double>(in_means * r) * octaves.dt_s;
    if (tau < options.tau_min_s || (options.tau_max_s > 0 && tau > options.tau_max_s)) continue;
    if (std::any_of(octaves.points.begin(), octaves.points.end(), [&](const AllanPoint& p) {
          return p.m == in_means * r;
        }))
      continue;
    if (out[r].empty() || out[r].back() != in_means) out[r].push_back(in_means);
  }
  return out;
}

std::vector<double> means_of_two(std::span<const double> values) {
  std::vector<double> out(values.size() / 2);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = 0.5 * (values[2 * i] + values[2 * i + 1]);
  return out;
}

/// The same as three times two, in one pass.
std::vector<double> means_of_eight(std::span<const double> values) {
  std::vector<double> out(values.size() / 8);
  const double* v = values.data();
  for (std::size_t i = 0; i < out.size(); ++i, v += 8)
    out[i] = 0.125 * (((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7])));
  return out;
}

void add_points(std::span<const double> means,
                std::uint64_t r,
                const std::vector<std::uint64_t>& factors,
                const AllanOptions& options,
                AllanCurve& curve) {
  AllanOptions list;
  list.grid = TauGrid::list;
  list.threads = options.threads;
  const double dt_s = curve.dt_s * static_cast<double>(r);
  for (const std::uint64_t m : factors)
    if (2 * m <= means.size()) list.taus_s.push_back(static_cast<double>(m) * dt_s);
  if (list.taus_s.empty()) return;
  for (AllanPoint point : allan_deviation(means, dt_s, list).points) {
    point.m *= r;
    point.tau_s = static_cast<double>(point.m) * curve.dt_s;
    // As many as the curve's own stride would have had: so its degrees of freedom are counted.
    const std::uint64_t starts = r == 1 ? point.terms : curve.samples - 2 * point.m + 1;
    point.terms = std::max<std::uint64_t>(1, starts / stride_of(curve, point));
    curve.points.push_back(point);
  }
}

}  // namespace

void add_ten_a_decade(std::span<const double> record,
                      const AllanOptions& options,
                      std::uint64_t exact_samples,
                      AllanCurve& octaves) {
  if (octaves.points.empty() || octaves.type != DeviationType::oadev) return;
  const auto factors = wanted_factors(options, octaves);
  std::vector<double> halves;  // means of r samples, half as many as are wanted
  std::uint64_t r = 1;
  for (const auto& [length, in_means] : factors) {
    if (length < kOfLong && record.size() > exact_samples) continue;
    if (length == 1) {
      add_points(record, length, in_means, options, octaves);
      continue;
    }
    while (2 * r < length) {
      const auto before = r == 1 ? record : std::span<const double>(halves);
      const bool eight = length / r >= 16;
      halves = eight ? means_of_eight(before) : means_of_two(before);
      r *= eight ? 8 : 2;
    }
    const auto from = r == 1 ? record : std::span<const double>(halves);
    add_points(means_of_two(from.subspan(1)), length, in_means, options, octaves);
  }
  std::sort(octaves.points.begin(),
            octaves.points.end(),
            [](const AllanPoint& a, const AllanPoint& b) { return a.m < b.m; });
}

}  // namespace libchar
