#include "libchar/allan/detail/kernels/present_points.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/allan/detail/anchored_phase.hpp"
#include "libchar/allan/detail/equivalent_dof.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/parallel/parallel.hpp"
#include "libchar/core/text/readable.hpp"

namespace libchar {
namespace {

// Running sums over what is present of a record with missing samples.
// Sums in long double: their rounding, 2^-64 of the sum, stays below that of a sample even where a
// record of 10^7 samples drifts by 10^6 standard deviations.

struct PresentSums {
  double scale = 1;  ///< power of two by which all was multiplied
  std::vector<long double>
      sum;  ///< of the samples present before each, less the first of the record; one more than samples
  std::vector<std::uint64_t> present;  ///< how many these are
};

PresentSums present_sums(std::span<const double> record) {
  PresentSums sums;
  sums.scale = balancing_scale(record);
  sums.sum.reserve(record.size() + 1);
  sums.present.reserve(record.size() + 1);
  long double sum = 0, origin = 0;
  std::uint64_t present = 0;
  sums.sum.push_back(0);
  sums.present.push_back(0);
  for (const double value : record) {
    if (std::isfinite(value)) {
      const long double scaled = static_cast<long double>(value) * sums.scale;
      if (present == 0) origin = scaled;
      sum += scaled - origin;
      ++present;
    }
    sums.sum.push_back(sum);
    sums.present.push_back(present);
  }
  return sums;
}

struct Window {
  double mean = 0, present = 0;
};

Window window(const PresentSums& sums, std::size_t begin, std::size_t m) {
  const auto present = static_cast<double>(sums.present[begin + m] - sums.present[begin]);
  return {static_cast<double>(sums.sum[begin + m] - sums.sum[begin]) / present, present};
}

// Terms with starts first, first + stride, … < last: differences of `order` of neighbouring
// windows' means, order 1 (Allan) or 2 (Hadamard), of windows of m samples that the record holds.
PresentTerms present_terms(const PresentSums& sums, int order, std::size_t m, std::size_t first, std::size_t last,
                           std::size_t stride) {
  const auto factor = static_cast<double>(m);
  double squares = 0, shortfall = 0, imbalance = 0;
  PresentTerms total;
  for (std::size_t i = first; i < last; i += stride) {
    const Window a = window(sums, i, m), b = window(sums, i + m, m);
    const double uneven = (b.present - a.present) / factor;
    imbalance += uneven * uneven;
    ++total.starts;
    if (!has_mean(a.present, factor) || !has_mean(b.present, factor)) continue;
    double d = b.mean - a.mean, less = 1 / a.present + 1 / b.present - 2 / factor;
    if (order == 2) {
      const Window c = window(sums, i + 2 * m, m);
      if (!has_mean(c.present, factor)) continue;
      d = (c.mean - b.mean) - d;
      less = 1 / a.present + 4 / b.present + 1 / c.present - 6 / factor;
    }
    squares += d * d;
    shortfall += less;
    ++total.terms;
  }
  total.squares = static_cast<long double>(squares);
  total.shortfall = static_cast<long double>(shortfall);
  total.imbalance = static_cast<long double>(imbalance);
  return total;
}

// Every term of the modified variance: the mean of the Allan terms at m starts in a row, all of which there must be.
PresentTerms modified_terms(const PresentSums& sums, std::size_t m) {
  const std::size_t samples = sums.present.size() - 1;
  if (3 * m > samples + 1) return {};
  const auto factor = static_cast<double>(m);
  const double of_white = (factor * factor + 1) / (2 * factor * factor);
  // Running sums over the last m starts, from the first where all are there: u, and what it lacks.
  std::vector<double> d(samples - 2 * m + 1), less(d.size());
  std::size_t in_a_row = 0;
  long double sum = 0, lacks = 0, squares = 0, shortfall = 0;
  PresentTerms total;
  for (std::size_t k = 0; k < d.size(); ++k) {
    const Window a = window(sums, k, m), b = window(sums, k + m, m);
    if (!has_mean(a.present, factor) || !has_mean(b.present, factor)) {
      in_a_row = 0;
      sum = lacks = 0;
      continue;
    }
    d[k] = b.mean - a.mean;
    less[k] = 1 / a.present + 1 / b.present - 2 / factor;
    sum += static_cast<long double>(d[k]);
    lacks += static_cast<long double>(less[k]);
    if (in_a_row == m) {
      sum -= static_cast<long double>(d[k - m]);
      lacks -= static_cast<long double>(less[k - m]);
    } else {
      ++in_a_row;
    }
    if (in_a_row < m) continue;
    squares += sum * sum;
    shortfall += lacks;
    ++total.terms;
  }
  const auto wide = static_cast<long double>(factor);
  total.squares = squares / wide / wide;
  total.shortfall = shortfall / wide * static_cast<long double>(of_white);
  return total;
}

constexpr std::size_t kStarts = 65536;  // a piece; pieces are added in order, whatever the number of threads
constexpr double kWorthSaying = 0.01;

PresentTerms all_terms(const PresentSums& sums, int order, std::size_t m, std::size_t stride) {
  const std::size_t samples = sums.present.size() - 1, span = (static_cast<std::size_t>(order) + 1) * m;
  if (span > samples) return {};
  const std::size_t ends = samples - span + 1, piece = kStarts / stride * stride + stride;
  std::vector<PresentTerms> parts((ends + piece - 1) / piece);
  parallel::for_each(0, parts.size(), [&](std::size_t k) {
    const std::size_t first = k * piece;
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
  for (std::size_t m = 1; m < largest; m *= 2) {
    const PresentTerms terms = all_terms(sums, 1, m, 1);
    const auto factor = static_cast<double>(m);
    const double dof = white_dof(DeviationType::oadev, m, terms.terms, 1);
    missing.add_octave(factor, terms, missing.corrected(factor, terms, 2, 1 / factor, dof).variance);
  }
  return missing;
}

}  // namespace

bool of_window_means(const DeviationRow& row) { return !row.reflected && row.family == DeviationFamily::differences; }

std::vector<AllanPoint> points_of_present(std::span<const double> rate, const DeviationRow& row,
                                          const std::vector<std::uint64_t>& factors, double dt_s) {
  const PresentSums sums = present_sums(rate);
  const MissingSamples missing = octaves_below(sums, factors.empty() ? 0 : factors.back());
  std::vector<AllanPoint> points(factors.size());
  parallel::for_each(0, factors.size(), [&](std::size_t k) {
    const std::size_t m = detail::in_memory(factors[k]);
    const std::size_t stride = row.overlapping ? 1 : m;
    const PresentTerms terms = row.of_sum ? modified_terms(sums, m) : all_terms(sums, row.order - 1, m, stride);
    if (terms.terms == 0) return;
    const double dof = white_dof(row.type, m, terms.terms, stride);
    const auto found = missing.corrected(static_cast<double>(m), terms, row.divisor, white_unit(row, m), dof);
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
                          " of the samples are missing: means are over those that are there, and what the others add "
                          "to the variance is taken off");
  if (without.empty()) return;
  curve.notes.push_back("gaps leave no term at " + std::to_string(without.size()) + " averaging times from " +
                        duration_text(static_cast<double>(without.front()) * curve.dt_s) + " on");
}

// Windows A and B of m samples, a and b of them present, each more than m/2; d = the difference of
// their means over what is present; n terms:
//
//   E sum d^2 / (2 n) = sigma^2(m) + c S^2(m),     c = sum (1/a + 1/b - 2/m) / (2 n),
//
// c S^2 being what the missing samples add. For samples missing at random S^2 is the variance
// within a window of m, whatever the noise (simple random sampling, Cochran 1977, theorem 2.2),
// which is a sum over the octaves below m (Haar): S^2 = m/(m-1) sum sigma^2(2^j)/2. For gaps of any
// length each octave counts with the Allan variance A of the indicator "present" there,
//
//   S^2(m) = sum 2^j A(2^j) sigma^2(2^j) / sum A(2^j),     2^j < m:
//
// white noise has 2^j sigma^2(2^j) = its variance at every octave, so it is exact for white noise and any gaps; samples
// missing independently have A ~ 2^-j, which is the sum above. Between octaves S^2 is interpolated as a power of m.
// Third differences: weights 1, -2, 1 of the windows, so c = sum (1/a + 4/b + 1/c - 6/m) / (6 n). Modified: d is the
// mean of the Allan terms at m starts in a row, all of which there must be, and c that of theirs times (m^2+1)/(2 m^2),
// as white noise has it.
//
// v = sum d^2 / (2 n) - c S^2 has the scatter of the whole for what is left, and few degrees of freedom may leave less
// than nothing. In white noise sum d^2 / (2 n) / (1 + c m) is as good and does neither. So both are weighted: w for the
// latter, 1 - w for the former, w = 1 / (1 + (z/2)^4), z the distance in standard deviations from what white noise of
// this S^2 would give (Wilson & Hilferty 1931). Noise bluer than white (z < -4) of which c S^2 leaves less than two
// standard deviations is hidden, and so it is at longer times.

void PresentTerms::operator+=(const PresentTerms& other) {
  squares += other.squares;
  shortfall += other.shortfall;
  imbalance += other.imbalance;
  terms += other.terms;
  starts += other.starts;
}

long double MissingSamples::spread(double m) const {
  if (spread_.empty()) return 0;
  const double at = std::clamp(std::log2(m) - 1, 0.0, static_cast<double>(spread_.size() - 1));
  const auto low = static_cast<std::size_t>(at);
  const double rest = at - static_cast<double>(low);
  if (rest == 0 || !(spread_[low] > 0)) return spread_[low];
  return spread_[low] * std::pow(static_cast<double>(spread_[low + 1] / spread_[low]), rest);
}

namespace {

/// A mean square over its expectation, of so many degrees of freedom, in standard deviations.
double deviate(double ratio, double dof) {
  const double variance = 2 / (9 * dof);
  return (std::cbrt(ratio) - (1 - variance)) / std::sqrt(variance);
}

}  // namespace

MissingSamples::Corrected MissingSamples::corrected(double m, const PresentTerms& terms, double divisor, double unit,
                                                    double dof) const {
  if (terms.terms == 0) return {};
  const long double count = static_cast<long double>(divisor) * static_cast<long double>(terms.terms);
  const long double before = terms.squares / count, c = terms.shortfall / count;
  const long double spread_here = spread(m), white = 1 + c / static_cast<long double>(unit);
  const long double less = before - c * spread_here;
  if (c == 0 || before == 0 || !(spread_here > 0)) return {before / white, 1, 0};
  const long double expected = spread_here * white * static_cast<long double>(unit);
  const double z = deviate(static_cast<double>(before / expected), dof);
  constexpr double kBluer = -4, kToldApart = 2;
  const bool bluer = z < kBluer || m > hidden_from_;
  if (bluer && less < kToldApart * std::sqrt(2 / dof) * before) return {};
  const long double w = 1 / (1 + std::pow(z / 2, 4)), rest = less > 0 ? 1 - w : 0;
  const long double variance = w * before / white + rest * less;
  return {variance, static_cast<double>((w / white + rest) * before / variance), static_cast<double>(c * spread_here)};
}

void MissingSamples::add_octave(double m, const PresentTerms& terms, long double variance) {
  if (variance < 0 && terms.terms > 0) hidden_from_ = std::min(hidden_from_, m);
  if (variance > 0 && terms.starts > 0) {
    const long double mask = terms.imbalance / static_cast<long double>(terms.starts);
    weighted_ += static_cast<long double>(m) * mask * variance;
    weight_ += mask;
  }
  const long double last = spread_.empty() ? 0 : spread_.back();
  spread_.push_back(weight_ > 0 ? weighted_ / weight_ : last);
}

}  // namespace libchar
