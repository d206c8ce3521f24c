#include "libchar/allan/detail/kernels/present_points.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "libchar/allan/detail/equivalent_dof.hpp"
#include "libchar/allan/detail/kernels/missing_samples.hpp"
#include "libchar/allan/detail/kernels/present_sums.hpp"
#include "libchar/core/text/readable.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kStarts =
    65536;  // a piece; pieces are added in order, whatever the number of threads
constexpr double kWorthSaying = 0.01;

PresentTerms all_terms(const PresentSums& sums, int order, std::uint64_t m, std::uint64_t stride) {
  const std::uint64_t samples = sums.present.size() - 1,
                      span = (static_cast<std::uint64_t>(order) + 1) * m;
  if (span > samples) return {};
  const std::uint64_t ends = samples - span + 1, piece = kStarts / stride * stride + stride;
  std::vector<PresentTerms> parts((ends + piece - 1) / piece);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t k) {
    const std::uint64_t first = k * piece;
    parts[k] = present_terms(sums, order, m, first, std::min(first + piece, ends), stride);
  });
  PresentTerms total;
  for (const PresentTerms& part : parts) total += part;
  return total;
}

double white_dof(DeviationType type, std::uint64_t m, std::uint64_t terms, std::uint64_t stride) {
  return terms == 0 ? 1 : equivalent_dof(type, {1}, m, terms, stride, 1);
}

/// Variance of white noise of variance 1.
double white_unit(const DeviationRow& row, std::uint64_t m) {
  const auto factor = static_cast<double>(m);
  return row.of_sum ? (factor * factor + 1) / (2 * factor * factor * factor) : 1 / factor;
}

MissingSamples octaves_below(const PresentSums& sums, std::uint64_t largest) {
  MissingSamples missing;
  for (std::uint64_t m = 1; m < largest; m *= 2) {
    const PresentTerms terms = all_terms(sums, 1, m, 1);
    const auto factor = static_cast<double>(m);
    const double dof = white_dof(DeviationType::oadev, m, terms.terms, 1);
    missing.add_octave(
        factor, terms, missing.corrected(factor, terms, 2, 1 / factor, dof).variance);
  }
  return missing;
}

}  // namespace

bool of_window_means(const DeviationRow& row) {
  return !row.reflected && row.family == DeviationFamily::differences;
}

std::vector<AllanPoint> points_of_present(std::span<const double> rate,
                                          const DeviationRow& row,
                                          const std::vector<std::uint64_t>& factors,
                                          double dt_s) {
  const PresentSums sums = present_sums(rate);
  const MissingSamples missing = octaves_below(sums, factors.empty() ? 0 : factors.back());
  std::vector<AllanPoint> points(factors.size());
  tbb::parallel_for(std::size_t{0}, factors.size(), [&](std::size_t k) {
    const std::uint64_t m = factors[k];
    const std::uint64_t stride = row.overlapping ? 1 : m;
    const PresentTerms terms =
        row.of_sum ? modified_terms(sums, m) : all_terms(sums, row.order - 1, m, stride);
    if (terms.terms == 0) return;
    const double dof = white_dof(row.type, m, terms.terms, stride);
    const auto found =
        missing.corrected(static_cast<double>(m), terms, row.divisor, white_unit(row, m), dof);
    if (found.variance < 0) return;
    AllanPoint& point = points[k];
    point.m = m;
    point.tau_s = static_cast<double>(m) * dt_s;
    point.terms = terms.terms;
    point.deviation = std::sqrt(static_cast<double>(found.variance)) / sums.scale;
    if (row.as_time) point.deviation *= point.tau_s / std::sqrt(3.0);
    point.inflation = found.inflation;
    point.added = found.added / sums.scale / sums.scale;
  });
  return points;
}

void note_missing(const std::vector<std::uint64_t>& without, AllanCurve& curve) {
  const double share = static_cast<double>(curve.missing) / static_cast<double>(curve.samples);
  if (share > kWorthSaying && of_window_means(deviation_row(curve.type)))
    curve.notes.push_back(percent_text(share) +
                          " of the samples are missing: means are over those that are there, and "
                          "what the others add to the variance is taken off");
  if (without.empty()) return;
  curve.notes.push_back("gaps leave no term at " + std::to_string(without.size()) +
                        " averaging times from " +
                        duration_text(static_cast<double>(without.front()) * curve.dt_s) + " on");
}

}  // namespace libchar
