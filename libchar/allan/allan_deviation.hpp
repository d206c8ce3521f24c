#pragma once
// The Allan family of deviations of a record.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libchar/allan/deviation_types.hpp"
#include "libchar/core/document/enum_table.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/core/numeric/interval.hpp"

namespace libchar {

/// rate: N samples averaged over dt; phase: N + 1 points of the integral of the rate
enum class DataKind { rate, phase };
/// m = 1,2,4…; 1,2,4,10,20,40…; every m (log-thinned above 1000); as listed; every m
enum class TauGrid { octave, decade, dense, list, all };

template <>
inline constexpr auto enum_table<TauGrid> = enum_words<TauGrid, "octave decade dense list all">;

struct AllanPoint {
  std::uint64_t m = 0;  ///< averaging factor
  double tau_s = 0;
  double deviation = 0;
  std::uint64_t terms = 0;  ///< second (third) differences that were averaged
  /// equivalent degrees of freedom for the mixture given to `add_intervals`; 0 before
  double edf = 0;
  Interval ci68, ci95;   ///< equal-tailed chi-square, at confidence 68.27 % and 95 %
  bool reliable = true;  ///< edf >= 5
  double inflation = 1;  ///< of the relative standard deviation, by missing samples
  double added = 0;      ///< to the variance by missing samples, as white noise would; taken off
  double bias = 1;       ///< by which `add_intervals` has divided the variance (confidence.cpp)
};

struct AllanCurve {
  /// Whether `add_intervals` takes out the bias that SP 1065 states for the modified and Hadamard total deviations
  enum class Bias { sp1065, none };
  DeviationType type = DeviationType::oadev;
  Bias without = Bias::sp1065;
  double dt_s = 1;
  std::uint64_t samples = 0;  ///< rate samples, missing ones included
  std::uint64_t missing = 0;
  std::uint64_t used = 0;  ///< rate samples of the stretch that was used: `samples`, or fewer
  /// 0: full overlap; 4: for m >= 8 only every (m/4)-th term was used (its whole part)
  std::uint64_t stride_divisor = 0;
  std::vector<AllanPoint> points;
  std::vector<std::string> notes;  ///< what was approximated or left out
};

template <>
inline constexpr auto enum_table<AllanCurve::Bias> = enum_words<AllanCurve::Bias, "sp1065 none">;

struct AllanOptions {
  DeviationType type = DeviationType::oadev;
  AllanCurve::Bias bias = AllanCurve::Bias::sp1065;  ///< taken out
  DataKind data = DataKind::rate;
  TauGrid grid = TauGrid::octave;
  /// for TauGrid::list; rounded to multiples of dt, each used once; must be > 0
  std::vector<double> taus_s;
  std::vector<std::uint64_t> more_factors;  ///< next to those of the grid, as far as they go
  double tau_min_s = 0;                     ///< 0 = dt
  /// 0 = T/2, of the Theo family 3/4 T, of MTIE and TIE rms T (each type's own limit is applied as well)
  double tau_max_s = 0;
  /// 0: every term; d: every (m/d)-th from m = 2 d on, where none of a rate's samples is missing
  std::uint64_t stride_divisor = 0;
  /// Operations that an averaging time of the Theo family and of the extended total deviations (O(N m)) may cost;
  /// beyond them terms start every m/16 samples or less, and a note says so. 0: no limit
  std::uint64_t work_a_point = std::uint64_t{1} << 28U;
  int threads = 0;  ///< 0 = all cores; the result does not depend on it
};

/// Deviations of a record, with full overlap unless the options say otherwise. NaN = missing: means
/// are over what is present of a window, more than half (detail/kernels/present_points.cpp); phase drops
/// every term that touches a missing one.
/// Equations and sources in allan_deviation.cpp (SP 1065). Offsets cost no digits, powers of two scale exactly. Throws
/// Error(numeric) when no point is possible, naming the number of samples needed; Error(usage) for a bad tau.
AllanCurve allan_deviation(std::span<const double> record, double dt_s, const AllanOptions& options = {});

/// What is left of a curve at octaves between `tau_min_s` and `tau_max_s`, as allan_deviation would
/// leave it. Throws Error(numeric) when nothing is.
AllanCurve limited(const AllanCurve& octaves, const AllanOptions& options);

// How well the points of an Allan curve are known: chi-square intervals by exact degrees of freedom.

/// Fills edf, ci68, ci95 and reliable of every point for the fitted mixture. Also takes out of the modified and
/// Hadamard total deviations the bias that SP 1065 states for them, unless it is to stay (`bias`: raw variance over
/// this one). MTIE and TIE rms have no interval: edf stays 0.
void add_intervals(AllanCurve& curve, const Mixture& theta);

namespace detail {
/// Degrees of freedom, and the intervals that follow from them.
void set_dof(AllanPoint& point, double edf);
}  // namespace detail

// Averaging times between the octaves of a curve, for plots: ten a decade.

namespace detail {
/// Factors between octaves whose terms start every sample: an `allan_deviation` that also takes them
/// (more_factors) sums the record once for both.
std::vector<std::uint64_t> exact_factors(const AllanOptions& options, double dt_s, std::uint64_t samples);
}  // namespace detail

/// Adds m = round(10^(i/10)) to a curve of octaves (oadev) of this record, between `tau_min_s` and `tau_max_s`. From
/// m = 16 on terms start every m/16 to m/8 samples, which costs a hundredth of the degrees of freedom; m is rounded to
/// that. Records longer than `exact_samples` get none below m = 64; records with missing samples exact ones, or none.
/// `exact`: points at `exact_factors`, where they are there already.
void add_ten_a_decade(std::span<const double> record, const AllanOptions& options, std::uint64_t exact_samples,
                      AllanCurve& octaves, std::span<const AllanPoint> exact = {});

// Deviations of single devices from their differences: the three-cornered hat, and the same for any number of them.

/// What is known of a device at an averaging time.
enum class HatStatus {
  resolved,      ///< the variance is at least twice its standard deviation
  not_resolved,  ///< positive, but less
  negative,      ///< the others' noise hides it, or the devices are not independent
};

template <>
inline constexpr auto enum_table<HatStatus> = enum_words<HatStatus, "resolved not_resolved negative">;

struct HatPoint {
  std::uint64_t m = 0;
  double tau_s = 0;
  double variance = 0;     ///< squared unit of the statistic; may be negative
  double variance_sd = 0;  ///< its standard deviation, for independent devices of white noise
  double deviation = 0;    ///< root of the variance; NaN where that is negative
  std::uint64_t terms = 0;
  HatStatus status = HatStatus::resolved;
};

struct CorneredHat {
  DeviationType type = DeviationType::oadev;
  std::vector<std::vector<HatPoint>> devices;  ///< [device][averaging time]
  std::vector<std::string> notes;
};

/// From n >= 3 records of one length that measure the same at the same time, each with noise of its
/// own: variances of all pairwise differences, then least squares (cornered_hat.cpp). A statistic
/// that is a mean square (all but MTIE, TheoBR and TheoH). Throws Error(usage) for others, fewer
/// than three records, or lengths that differ; as allan_deviation.
CorneredHat cornered_hat(std::span<const std::vector<double>> records, double dt_s, const AllanOptions& options = {});

/// From three records of differences, a - b, b - c, c - a, each measured by itself: the covariances of the two that a
/// device is in, in which the noise of the measurements drops out (Groslambert). Overlapping Allan variance only.
CorneredHat cornered_hat_of_differences(std::span<const std::vector<double>> differences, double dt_s,
                                        const AllanOptions& options = {});

// The Allan deviation as it changes in time.

struct DynamicOptions {
  std::uint64_t window = 0;  ///< samples; at least 8
  std::uint64_t step = 0;    ///< samples between windows; 0: half a window
};

struct DynamicWindow {
  double from_s = 0, to_s = 0;  ///< after the first sample
  AllanCurve curve;             ///< no points where the window has too few samples
};

struct DynamicDeviation {
  DeviationType type = DeviationType::oadev;
  std::vector<DynamicWindow> windows;
  std::vector<std::string> notes;
};

/// L. Galleani, P. Tavella, "The dynamic Allan variance", IEEE Trans. UFFC 56 (2009) 450: the
/// deviation of each window of the record, which stands for its middle. Windows begin at 0, step, 2
/// step … while they fit. Throws Error(usage) for a window that is too short or longer than the
/// record, or more windows than a million; Error(numeric) when no window gives a point.
DynamicDeviation dynamic_deviation(std::span<const double> record, double dt_s, const DynamicOptions& dynamic,
                                   const AllanOptions& options = {});

}  // namespace libchar
