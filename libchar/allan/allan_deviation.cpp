// The Allan family by differences of the phase x (cumulated rate), step m, tau = m dt, n terms
// (NIST SP 1065, 5):
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
// (detail/missing_samples.cpp); of phase each term that touches a missing sample is dropped. Sums
// run over fixed pieces of 65536 starts, added in order, so that the result does not depend on the
// number of threads.

#include "libchar/allan/allan_deviation.hpp"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>

#include "libchar/allan/allan_covariance.hpp"
#include "libchar/allan/detail/anchored_phase.hpp"
#include "libchar/allan/detail/family.hpp"
#include "libchar/allan/detail/kernels/present_points.hpp"
#include "libchar/allan/detail/tau_grid.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/numeric/present.hpp"
#include "libchar/core/process/thread_limit.hpp"
#include "libchar/core/process/work.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kPiece = 65536;

/// Starts [begin, end) on the grid of multiples of `stride`.
struct Starts {
  std::uint64_t begin, end, stride;
  std::uint64_t count() const { return end > begin ? (end - begin + stride - 1) / stride : 0; }
};

/// Term starts inside a gap-free stretch of phase points; W reaches one position beyond the points
/// it sums.
Starts starts_in(const IndexRange& stretch,
                 const DeviationRow& f,
                 std::uint64_t m,
                 std::uint64_t stride) {
  const std::uint64_t reach = static_cast<std::uint64_t>(f.order) * m + (f.of_sum ? 0 : 1);
  const std::uint64_t end = stretch.end >= reach ? stretch.end - reach + 1 : 0;
  return {(stretch.begin + stride - 1) / stride * stride, end, stride};
}

/// The record continued by mirrored copies of `reach` samples at both ends (phase: reflected about
/// its end points).
std::vector<double> continued(std::span<const double> x, std::uint64_t reach, DataKind kind) {
  std::vector<double> all;
  all.reserve(x.size() + 2 * reach);
  if (kind == DataKind::rate) {
    for (std::uint64_t j = reach; j-- > 0;) all.push_back(x[j]);
    all.insert(all.end(), x.begin(), x.end());
    for (std::uint64_t j = 0; j < reach; ++j) all.push_back(x[x.size() - 1 - j]);
    return all;
  }
  const double last = x.back() - x[0];
  for (std::uint64_t j = reach; j > 0; --j) all.push_back(-(x[j] - x[0]));
  for (const double value : x) all.push_back(value - x[0]);
  for (std::uint64_t j = 1; j <= reach; ++j)
    all.push_back(last + (last - (x[x.size() - 1 - j] - x[0])));
  return all;
}

struct Totals {
  double sum = 0;
  std::uint64_t terms = 0;
};

/// All terms with starts in the ranges, cut into pieces at multiples of kPiece and added in order.
Totals total_over(const AnchoredPhase& phase,
                  const DeviationRow& f,
                  std::uint64_t m,
                  const std::vector<Starts>& ranges) {
  const std::uint64_t pieces = phase.points / kPiece + 1;
  std::vector<Totals> part(pieces);
  tbb::parallel_for(std::uint64_t{0}, pieces, [&](std::uint64_t piece) {
    const std::uint64_t begin = piece * kPiece, end = begin + kPiece;
    auto range = std::partition_point(
        ranges.begin(), ranges.end(), [&](const Starts& r) { return r.end <= begin; });
    for (; range != ranges.end() && range->begin < end; ++range) {
      const std::uint64_t stride = range->stride;
      const Starts cut = {std::max(range->begin, (begin + stride - 1) / stride * stride),
                          std::min(range->end, end),
                          stride};
      if (cut.count() == 0) continue;
      part[piece].terms += cut.count();
      part[piece].sum += sum_of_squares(phase, f.order, f.of_sum, m, cut.begin, cut.end, stride);
    }
  });
  Totals all;
  for (const Totals& p : part) {
    all.sum += p.sum;
    all.terms += p.terms;
  }
  return all;
}

std::vector<Starts> ranges_of(const AnchoredPhase& phase,
                              const DeviationRow& f,
                              std::uint64_t m,
                              std::uint64_t reach,
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

AllanPoint point_of(const Totals& total,
                    const DeviationRow& f,
                    std::uint64_t m,
                    double dt_s,
                    double scale,
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
  throw Error({ErrorKind::numeric,
               "E0401",
               "",
               std::string(f.word) + " needs at least " + std::to_string(needed) +
                   " consecutive samples; none of its terms fits the " + std::to_string(samples) +
                   " of this record"});
}

IndexRange longest(std::span<const double> record) {
  IndexRange best;
  std::uint64_t begin = 0;
  for (std::uint64_t i = 0; i <= record.size(); ++i)
    if (i == record.size() || !std::isfinite(record[i])) {
      if (i - begin > best.end - best.begin) best = {begin, i};
      begin = i + 1;
    }
  return best;
}

/// Of the longest gap-free stretch only: reflection has no meaning at a gap.
std::span<const double> without_gaps(std::span<const double> record,
                                     const DeviationRow& row,
                                     AllanCurve& curve) {
  const IndexRange s = longest(record);
  if (s.end - s.begin == record.size()) return record;
  curve.notes.push_back((row.family == DeviationFamily::differences ? std::string("total deviation")
                                                                    : std::string(row.title)) +
                        " of the longest stretch without gaps only, samples " +
                        std::to_string(s.begin) + " to " + std::to_string(s.end) + " of " +
                        std::to_string(record.size()));
  return record.subspan(s.begin, s.end - s.begin);
}

[[noreturn]] void none_fits(const AllanCurve& curve) {
  throw Error({ErrorKind::numeric,
               "E0401",
               "",
               "no averaging time that was asked for fits the record of " +
                   duration_text(static_cast<double>(curve.samples) * curve.dt_s)});
}

void check(double dt_s, const AllanOptions& options) {
  if (!(dt_s > 0) || !std::isfinite(dt_s))
    throw Error({ErrorKind::usage,
                 "E0201",
                 "",
                 "the sampling interval must be a positive number of seconds",
                 shortest(dt_s)});
  if (options.grid == TauGrid::list && options.taus_s.empty())
    throw Error({ErrorKind::usage, "E0201", "", "no averaging time is listed"});
}

std::vector<AllanPoint> points_of_phase(const AnchoredPhase& phase,
                                        const DeviationRow& f,
                                        std::uint64_t reach,
                                        const std::vector<std::uint64_t>& factors,
                                        DataKind kind,
                                        const AllanCurve& curve) {
  std::vector<AllanPoint> points(factors.size());
  tbb::parallel_for(std::size_t{0}, factors.size(), [&](std::size_t k) {
    const std::uint64_t m = factors[k];
    AllanPoint asked;
    asked.m = m;
    const Totals total =
        total_over(phase, f, m, ranges_of(phase, f, m, reach, stride_of(curve, asked)));
    if (total.terms > 0) points[k] = point_of(total, f, m, curve.dt_s, phase.scale, kind);
  });
  return points;
}

void fill_points(const std::vector<AllanPoint>& points,
                 const std::vector<std::uint64_t>& factors,
                 AllanCurve& curve) {
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
  return kind == DataKind::rate ? anchored_phase_of_rate(record, summed)
                                : anchored_phase_of_phase(record, summed);
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

std::vector<AllanPoint> points_of_family(std::span<const double> used,
                                         const DeviationRow& row,
                                         const AllanOptions& options,
                                         const std::vector<std::uint64_t>& factors,
                                         AllanCurve& curve) {
  FamilyInput input{used, options.data, curve.dt_s, balancing_scale(used), {}, 0};
  input.work_a_point = share_of_work(options, factors.size());
  for (std::uint64_t begin = 0; begin < used.size(); ++begin) {
    const std::uint64_t end = begin + finite_run(used.subspan(begin));
    if (end > begin) input.stretches.push_back({begin, end});
    begin = end;
  }
  return maker_of(row.family)(input, row, factors, curve.notes);
}

/// Takes no gaps: the longest stretch without one is used.
bool of_one_stretch(const DeviationRow& row) {
  return row.reflected || row.family == DeviationFamily::theo;
}

}  // namespace

AllanCurve allan_deviation(std::span<const double> record,
                           double dt_s,
                           const AllanOptions& options) {
  check(dt_s, options);
  const DeviationRow& f = deviation_row(options.type);
  const auto rate_samples = [&](std::uint64_t size) {
    return options.data == DataKind::rate || size == 0 ? size : size - 1;
  };
  AllanCurve curve;
  curve.type = options.type;
  curve.dt_s = dt_s;
  curve.samples = rate_samples(record.size());
  curve.missing = not_finite(record);
  const bool total = f.reflected, family = f.family != DeviationFamily::differences;
  const auto used = of_one_stretch(f) ? without_gaps(record, f, curve) : record;
  curve.used = rate_samples(used.size());
  const auto factors = averaging_factors(options, dt_s, curve.used, curve.notes);
  if (curve.used < f.span(1)) too_short(f, curve.samples);
  const std::uint64_t reach = total && !factors.empty() ? factors.back() : 0;
  const int cores = processors_given();
  tbb::task_arena arena(options.threads > 0 ? std::min(options.threads, cores) : cores);
  arena.execute([&] {
    if (family)
      return fill_points(points_of_family(used, f, options, factors, curve), factors, curve);
    if (curve.missing > 0 && options.data == DataKind::rate && of_window_means(f))
      return fill_points(points_of_present(used, f, factors, dt_s), factors, curve);
    const AnchoredPhase phase =
        total ? anchored(continued(used, reach, options.data), options.data, false)
              : anchored(used, options.data, f.of_sum);
    if (f.overlapping && !total) curve.stride_divisor = options.stride_divisor;
    fill_points(points_of_phase(phase, f, reach, factors, options.data, curve), factors, curve);
  });
  if (curve.points.empty() && curve.missing > 0 && options.grid != TauGrid::list)
    too_short(f, curve.samples);
  if (curve.points.empty()) none_fits(curve);
  for (const AllanPoint& point : curve.points) count_work(WorkKind::allan_terms, point.terms);
  return curve;
}

AllanCurve limited(const AllanCurve& octaves, const AllanOptions& options) {
  AllanCurve curve = octaves;
  const std::vector<std::uint64_t> wanted =
      averaging_factors(options, curve.dt_s, curve.samples, curve.notes);
  std::erase_if(curve.points, [&](const AllanPoint& point) {
    return !std::binary_search(wanted.begin(), wanted.end(), point.m);
  });
  if (curve.points.empty()) none_fits(curve);
  return curve;
}

}  // namespace libchar
