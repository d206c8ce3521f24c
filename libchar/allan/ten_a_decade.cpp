// The overlapping Allan deviation at averaging factor m = r m' of a record is that at m' of its
// means of r samples, with terms that start every r samples instead of every one. For r <= m/8
// neighbouring terms are alike to an eighth of their length. The first begins r/2 samples in: the
// first sample of all is in one of all terms, and would be in r times its share of them.
#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <memory>

#include "libchar/allan/allan_covariance.hpp"
#include "libchar/allan/allan_deviation.hpp"
#include "libchar/core/numeric/whole.hpp"

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
    if (std::any_of(octaves.points.begin(), octaves.points.end(),
                    [&](const AllanPoint& p) { return p.m == in_means * r; }))
      continue;
    if (out[r].empty() || out[r].back() != in_means) out[r].push_back(in_means);
  }
  return out;
}

// Not of a vector: the pages of a long record's means would be written twice.
struct Means {
  std::unique_ptr<double[]> value;
  std::size_t count = 0;
  std::span<const double> all() const { return {value.get(), count}; }
};

/// Means of two, four or eight neighbours: 1/length of the sums of sums of two.
template <std::size_t length>
Means means_of(std::span<const double> values) {
  Means out;
  out.count = values.size() / length;
  out.value = std::make_unique_for_overwrite<double[]>(out.count);
  const double* v = values.data();
  for (std::size_t i = 0; i < out.count; ++i, v += length) {
    double sum = v[0] + v[1];
    if constexpr (length >= 4) sum += v[2] + v[3];
    if constexpr (length == 8) sum += (v[4] + v[5]) + (v[6] + v[7]);
    out.value[i] = sum / static_cast<double>(length);
  }
  return out;
}

/// The same as two times and two again, in as few passes as there may be.
Means means_of(std::size_t length, std::span<const double> values) {
  return length >= 8 ? means_of<8>(values) : length == 4 ? means_of<4>(values) : means_of<2>(values);
}

void add_points(std::span<const double> means, std::uint64_t r, const std::vector<std::uint64_t>& factors,
                const AllanOptions& options, AllanCurve& curve) {
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

std::vector<std::uint64_t> detail::exact_factors(const AllanOptions& options, double dt_s, std::uint64_t samples) {
  AllanCurve none;
  none.dt_s = dt_s;
  none.samples = samples;
  const auto factors = wanted_factors(options, none);
  const auto each = factors.find(1);
  std::vector<std::uint64_t> out = each == factors.end() ? std::vector<std::uint64_t>() : each->second;
  std::erase_if(out, [](std::uint64_t m) { return std::has_single_bit(m); });
  return out;
}

void add_ten_a_decade(std::span<const double> record, const AllanOptions& options, std::uint64_t exact_samples,
                      AllanCurve& octaves, std::span<const AllanPoint> exact) {
  if (octaves.points.empty() || octaves.type != DeviationType::oadev) return;
  const auto factors = wanted_factors(options, octaves);
  Means halves;  // of r samples, half as many as are wanted
  std::uint64_t r = 1;
  for (const auto& [length, in_means] : factors) {
    if (length < kOfLong && record.size() > exact_samples) continue;
    if (length == 1 && !exact.empty() && octaves.missing == 0) {
      octaves.points.insert(octaves.points.end(), exact.begin(), exact.end());
      continue;
    }
    if (length == 1) {
      add_points(record, length, in_means, options, octaves);
      continue;
    }
    if (length <= kOfLong) {  // of the record itself, no second one beside it
      const std::size_t first = detail::in_memory(length / 2);
      const auto from = record.subspan(std::min(first, record.size()));
      add_points(means_of(detail::in_memory(length), from).all(), length, in_means, options, octaves);
      continue;
    }
    while (2 * r < length) {
      const std::size_t step = std::min<std::size_t>(8, detail::in_memory(length / (2 * r)));
      halves = means_of(step, r == 1 ? record : halves.all());
      r *= step;
    }
    const auto from = r == 1 ? record : halves.all();
    add_points(means_of<2>(from.subspan(1)).all(), length, in_means, options, octaves);
  }
  std::sort(octaves.points.begin(), octaves.points.end(),
            [](const AllanPoint& a, const AllanPoint& b) { return a.m < b.m; });
}

}  // namespace libchar
