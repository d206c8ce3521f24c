// The Allan family by differences of the phase x (cumulated rate), step m, tau = m dt, n terms (NIST SP 1065, 5):
//
//   ADEV, OADEV   sum (x_{i+2m} - 2 x_{i+m} + x_i)^2 / (2 tau^2 n)
//                 i = 0, m, 2m, … / every i
//   HDEV, OHDEV   sum (x_{i+3m} - 3 x_{i+2m} + 3 x_{i+m} - x_i)^2 / (6 tau^2 n)
//                 likewise
//   MDEV          sum (x averaged over m points, then the second difference)^2 / (2 tau^2 n)
//                 = third difference of the sum W of x, divided by m:
//                 sum (W_{i+3m} - 3 W_{i+2m} + 3 W_{i+m} - W_i)^2 / (2 m^2 tau^2 n)
//   TDEV          tau MDEV / sqrt(3)
//   TOTDEV        OADEV's terms centred on every inner point of x, which is continued beyond both
//                 ends by reflection about the end point; that is, the rate is mirrored
//
// The other families are in detail/parabolic.cpp (PDEV), detail/extended.cpp (MTOT, TTOT, HTOT),
// detail/theo.cpp (Theo1, TheoBR, TheoH) and detail/time_interval.cpp (MTIE, TIE rms).
//
// Where samples of a rate are missing all of these but TOTDEV take means over what is present
// (detail/kernels/present_points.cpp); of phase each term that touches a missing sample is dropped. Sums run over fixed
// pieces of 65536 starts, added in order, so that the result does not depend on the number of threads.

#include "libchar/allan/allan_deviation.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "libchar/allan/allan_covariance.hpp"
#include "libchar/allan/detail/anchored_phase.hpp"
#include "libchar/allan/detail/family.hpp"
#include "libchar/allan/detail/kernels/present_points.hpp"
#include "libchar/core/numeric/present.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/parallel/parallel.hpp"
#include "libchar/core/parallel/thread_limit.hpp"
#include "libchar/core/process/work.hpp"
#include "libchar/core/refusal.hpp"
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
      const double m = std::round(static_cast<double>(kDenseUpTo) * std::pow(10, k / kDensePerDecade));
      if (m > static_cast<double>(largest)) break;
      factors.push_back(static_cast<std::uint64_t>(m));
    }
  }
  return factors;
}

std::vector<std::uint64_t> listed(const std::vector<double>& taus, double dt_s, double largest,
                                  std::vector<std::string>& notes) {
  std::vector<std::uint64_t> factors;
  std::uint64_t too_long = 0, moved = 0;
  for (const double tau : taus) {
    if (!(tau > 0) || !std::isfinite(tau))
      throw usage_error("E0201", "`taus_s`")
          .says("an averaging time must be a positive number of seconds")
          .got(shortest(tau));
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
    notes.push_back(std::to_string(moved) +
                    " of the listed averaging times moved to the nearest multiple of the sampling interval (" +
                    duration_text(dt_s) + ")");
  return factors;
}

/// How the numbers of a grid, in samples, become averaging factors of a statistic of the Theo family: Theo1 has even
/// factors from 10 on, and averaging times of three quarters of them. A regular grid of Theo1 is of its factors; a
/// list, and TheoH's grids, which begin with Allan's factors, are of averaging times.
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

/// Ascending averaging factors of the grid that `options` asks for in a record of `samples` rate
/// samples. Listed times that the record is too short for are left out and noted. Throws
/// Error(usage) for a time that is not positive and finite.
std::vector<std::uint64_t> averaging_factors(const AllanOptions& options, double dt_s, std::uint64_t samples,
                                             std::vector<std::string>& notes) {
  const double duration = static_cast<double>(samples) * dt_s;
  const DeviationRow& row = deviation_row(options.type);
  std::optional<TheoGrid> theo;
  if (row.family == DeviationFamily::theo) theo.emplace(row, options.grid, samples);
  const bool interval = row.family == DeviationFamily::interval;
  const double tau_max = options.tau_max_s > 0 ? options.tau_max_s
                                               : duration * (interval ? 1
                                                             : theo   ? kTheoReach
                                                                      : 0.5);
  // A hair of slack: tau_max and tau_min are decimal numbers, the multiples of dt are not.
  const double slack = 1 + 1e-9;
  double reach = std::max(1.0, std::floor(tau_max / dt_s * slack * (theo ? theo->stretch() : 1)));
  reach = std::min(reach, static_cast<double>(largest_factor(row, samples)));
  std::vector<std::uint64_t> factors = options.grid == TauGrid::list
                                           ? listed(options.taus_s, dt_s, reach, notes)
                                           : regular_grid(options.grid, static_cast<std::uint64_t>(reach));
  if (theo) factors = theo->factors(factors);
  for (const std::uint64_t m : options.more_factors)
    if (static_cast<double>(m) <= reach) factors.push_back(m);
  std::sort(factors.begin(), factors.end());
  factors.erase(std::unique(factors.begin(), factors.end()), factors.end());
  std::erase_if(factors, [&](std::uint64_t m) {
    return (theo ? theo->time(m) : static_cast<double>(m)) * dt_s * slack < options.tau_min_s;
  });
  return factors;
}

constexpr std::uint64_t kPiece = 65536;

/// Starts [begin, end) on the grid of multiples of `stride`.
struct Starts {
  std::uint64_t begin, end, stride;
  std::uint64_t count() const { return end > begin ? (end - begin + stride - 1) / stride : 0; }
};

/// Term starts inside a gap-free stretch of phase points; W reaches one position beyond the points it sums.
Starts starts_in(const IndexRange& stretch, const DeviationRow& f, std::uint64_t m, std::uint64_t stride) {
  const std::uint64_t reach = static_cast<std::uint64_t>(f.order) * m + (f.of_sum ? 0 : 1);
  const std::uint64_t end = stretch.end >= reach ? stretch.end - reach + 1 : 0;
  return {(stretch.begin + stride - 1) / stride * stride, end, stride};
}

/// The record continued by mirrored copies of `reach` samples at both ends (phase: reflected about its end points).
std::vector<double> continued(std::span<const double> x, std::size_t reach, DataKind kind) {
  std::vector<double> all;
  all.reserve(x.size() + 2 * reach);
  if (kind == DataKind::rate) {
    for (std::size_t j = reach; j-- > 0;) all.push_back(x[j]);
    all.insert(all.end(), x.begin(), x.end());
    for (std::size_t j = 0; j < reach; ++j) all.push_back(x[x.size() - 1 - j]);
    return all;
  }
  const double last = x.back() - x[0];
  for (std::size_t j = reach; j > 0; --j) all.push_back(-(x[j] - x[0]));
  for (const double value : x) all.push_back(value - x[0]);
  for (std::size_t j = 1; j <= reach; ++j) all.push_back(last + (last - (x[x.size() - 1 - j] - x[0])));
  return all;
}

struct Totals {
  double sum = 0;
  std::uint64_t terms = 0;
};

/// All terms with starts in the ranges, cut into pieces at multiples of kPiece and added in order.
Totals total_over(const AnchoredPhase& phase, const DeviationRow& f, std::uint64_t m,
                  const std::vector<Starts>& ranges) {
  const std::size_t pieces = detail::in_memory(phase.points / kPiece + 1);
  std::vector<Totals> part(pieces);
  parallel::for_each(0, pieces, [&](std::size_t piece) {
    const std::uint64_t begin = piece * kPiece, end = begin + kPiece;
    auto range = std::partition_point(ranges.begin(), ranges.end(), [&](const Starts& r) { return r.end <= begin; });
    for (; range != ranges.end() && range->begin < end; ++range) {
      const std::uint64_t stride = range->stride;
      const Starts cut = {std::max(range->begin, (begin + stride - 1) / stride * stride), std::min(range->end, end),
                          stride};
      if (cut.count() == 0) continue;
      part[piece].terms += cut.count();
      part[piece].sum += sum_of_squares(phase, f.order, f.of_sum, detail::in_memory(m), detail::in_memory(cut.begin),
                                        detail::in_memory(cut.end), detail::in_memory(stride));
    }
  });
  Totals all;
  for (const Totals& p : part) {
    all.sum += p.sum;
    all.terms += p.terms;
  }
  return all;
}

std::vector<Starts> ranges_of(const AnchoredPhase& phase, const DeviationRow& f, std::uint64_t m, std::uint64_t reach,
                              std::uint64_t stride) {
  if (f.reflected)  // centred on the inner points of the record within its continuation
    return {{reach + 1 - m, phase.points - reach - 1 - m, 1}};
  std::vector<Starts> ranges;
  for (const IndexRange& s : phase.stretches) {
    const Starts r = starts_in(s, f, m, stride);
    if (r.count() > 0) ranges.push_back(r);
  }
  return ranges;
}

AllanPoint point_of(const Totals& total, const DeviationRow& f, std::uint64_t m, double dt_s, double scale,
                    DataKind kind) {
  AllanPoint point;
  const double factor = static_cast<double>(m);
  point.m = m;
  point.tau_s = factor * dt_s;
  point.terms = total.terms;
  double step = kind == DataKind::rate ? factor : point.tau_s;
  if (f.of_sum) step *= factor;
  point.deviation = std::sqrt(total.sum / (f.divisor * static_cast<double>(total.terms))) / step;
  point.deviation /= scale;
  if (f.as_time) point.deviation *= point.tau_s / std::sqrt(3.0);
  return point;
}

[[noreturn]] void too_short(const DeviationRow& f, std::uint64_t samples) {
  const std::uint64_t needed = f.span(1);
  throw numeric_error("E0401").says(std::string(f.word) + " needs at least " + std::to_string(needed) +
                                    " consecutive samples; none of its terms fits the " + std::to_string(samples) +
                                    " of this record");
}

IndexRange longest(std::span<const double> record) {
  IndexRange best;
  std::size_t begin = 0;
  for (std::size_t i = 0; i <= record.size(); ++i)
    if (i == record.size() || !std::isfinite(record[i])) {
      if (i - begin > best.end - best.begin) best = {begin, i};
      begin = i + 1;
    }
  return best;
}

/// Of the longest gap-free stretch only: reflection has no meaning at a gap.
std::span<const double> without_gaps(std::span<const double> record, const DeviationRow& row, AllanCurve& curve) {
  const IndexRange s = longest(record);
  if (s.end - s.begin == record.size()) return record;
  curve.notes.push_back(
      (row.family == DeviationFamily::differences ? std::string("total deviation") : std::string(row.title)) +
      " of the longest stretch without gaps only, samples " + std::to_string(s.begin) + " to " + std::to_string(s.end) +
      " of " + std::to_string(record.size()));
  return record.subspan(s.begin, s.end - s.begin);
}

[[noreturn]] void none_fits(const AllanCurve& curve) {
  throw numeric_error("E0401").says("no averaging time that was asked for fits the record of " +
                                    duration_text(static_cast<double>(curve.samples) * curve.dt_s));
}

void check(double dt_s, const AllanOptions& options) {
  if (!(dt_s > 0) || !std::isfinite(dt_s))
    throw usage_error("E0201").says("the sampling interval must be a positive number of seconds").got(shortest(dt_s));
  if (options.grid == TauGrid::list && options.taus_s.empty())
    throw usage_error("E0201").says("no averaging time is listed");
}

std::vector<AllanPoint> points_of_phase(const AnchoredPhase& phase, const DeviationRow& f, std::uint64_t reach,
                                        const std::vector<std::uint64_t>& factors, DataKind kind,
                                        const AllanCurve& curve) {
  std::vector<AllanPoint> points(factors.size());
  parallel::for_each(0, factors.size(), [&](std::size_t k) {
    const std::uint64_t m = factors[k];
    AllanPoint asked;
    asked.m = m;
    const Totals total = total_over(phase, f, m, ranges_of(phase, f, m, reach, stride_of(curve, asked)));
    if (total.terms > 0) points[k] = point_of(total, f, m, curve.dt_s, phase.scale, kind);
  });
  return points;
}

void fill_points(const std::vector<AllanPoint>& points, const std::vector<std::uint64_t>& factors, AllanCurve& curve) {
  std::vector<std::uint64_t> empty;
  for (std::size_t k = 0; k < points.size(); ++k)
    if (points[k].terms > 0)
      curve.points.push_back(points[k]);
    else
      empty.push_back(factors[k]);
  note_missing(empty, curve);
}

std::uint64_t not_finite(std::span<const double> record) {
  const auto rest = record.subspan(finite_run(record));
  return static_cast<std::uint64_t>(
      std::count_if(rest.begin(), rest.end(), [](double v) { return !std::isfinite(v); }));
}

AnchoredPhase anchored(std::span<const double> record, DataKind kind, bool summed) {
  return kind == DataKind::rate ? anchored_phase_of_rate(record, summed) : anchored_phase_of_phase(record, summed);
}

FamilyPoints maker_of(DeviationFamily family) {
  switch (family) {
    case DeviationFamily::parabola:
      return parabolic_points;
    case DeviationFamily::extended:
      return extended_points;
    case DeviationFamily::theo:
      return theo_points;
    case DeviationFamily::interval:
      return interval_points;
    case DeviationFamily::differences:
      break;
  }
  return nullptr;
}

/// An equal share for each point of a long list.
std::uint64_t share_of_work(const AllanOptions& options, std::size_t points) {
  constexpr std::uint64_t kPointsInFull = 32;
  if (options.work_a_point == 0 || points <= kPointsInFull) return options.work_a_point;
  return std::max<std::uint64_t>(1, options.work_a_point / points * kPointsInFull);
}

std::vector<AllanPoint> points_of_family(std::span<const double> used, const DeviationRow& row,
                                         const AllanOptions& options, const std::vector<std::uint64_t>& factors,
                                         AllanCurve& curve) {
  FamilyInput input{used, options.data, curve.dt_s, balancing_scale(used), {}, 0};
  input.work_a_point = share_of_work(options, factors.size());
  for (std::size_t begin = 0; begin < used.size(); ++begin) {
    const std::size_t end = begin + finite_run(used.subspan(begin));
    if (end > begin) input.stretches.push_back({begin, end});
    begin = end;
  }
  return maker_of(row.family)(input, row, factors, curve.notes);
}

/// Takes no gaps: the longest stretch without one is used.
bool of_one_stretch(const DeviationRow& row) { return row.reflected || row.family == DeviationFamily::theo; }

}  // namespace

AllanCurve allan_deviation(std::span<const double> record, double dt_s, const AllanOptions& options) {
  check(dt_s, options);
  const DeviationRow& f = deviation_row(options.type);
  const auto rate_samples = [&](std::uint64_t size) {
    return options.data == DataKind::rate || size == 0 ? size : size - 1;
  };
  AllanCurve curve;
  curve.type = options.type;
  curve.without = options.bias;
  curve.dt_s = dt_s;
  curve.samples = rate_samples(record.size());
  curve.missing = not_finite(record);
  const bool total = f.reflected, family = f.family != DeviationFamily::differences;
  const auto used = of_one_stretch(f) ? without_gaps(record, f, curve) : record;
  curve.used = rate_samples(used.size());
  const auto factors = averaging_factors(options, dt_s, curve.used, curve.notes);
  if (curve.used < f.span(1)) too_short(f, curve.samples);
  const std::size_t reach = total && !factors.empty() ? detail::in_memory(factors.back()) : 0;
  const int cores = processors_given();
  parallel::Threads arena(options.threads > 0 ? std::min(options.threads, cores) : cores);
  arena.run([&] {
    if (family) return fill_points(points_of_family(used, f, options, factors, curve), factors, curve);
    if (curve.missing > 0 && options.data == DataKind::rate && of_window_means(f))
      return fill_points(points_of_present(used, f, factors, dt_s), factors, curve);
    const AnchoredPhase phase = total ? anchored(continued(used, reach, options.data), options.data, false)
                                      : anchored(used, options.data, f.of_sum);
    if (f.overlapping && !total) curve.stride_divisor = options.stride_divisor;
    fill_points(points_of_phase(phase, f, reach, factors, options.data, curve), factors, curve);
  });
  if (curve.points.empty() && curve.missing > 0 && options.grid != TauGrid::list) too_short(f, curve.samples);
  if (curve.points.empty()) none_fits(curve);
  for (const AllanPoint& point : curve.points) count_work(WorkKind::allan_terms, point.terms);
  return curve;
}

AllanCurve limited(const AllanCurve& octaves, const AllanOptions& options) {
  AllanCurve curve = octaves;
  const std::vector<std::uint64_t> wanted = averaging_factors(options, curve.dt_s, curve.samples, curve.notes);
  std::erase_if(curve.points,
                [&](const AllanPoint& point) { return !std::binary_search(wanted.begin(), wanted.end(), point.m); });
  if (curve.points.empty()) none_fits(curve);
  return curve;
}

}  // namespace libchar
