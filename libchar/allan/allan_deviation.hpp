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
  double bias = 1;       ///< by which `add_intervals` has divided the variance (confidence.hpp)
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
  /// Operations that an averaging time of the Theo family and of the extended total deviations (O(N
  /// m)) may cost; beyond them terms start every m/16 samples or less, and a note says so. 0: no
  /// limit
  std::uint64_t work_a_point = std::uint64_t{1} << 28U;
  int threads = 0;  ///< 0 = all cores; the result does not depend on it
};

/// Deviations of a record, with full overlap unless the options say otherwise. NaN = missing: means
/// are over what is present of a window, more than half (detail/missing_samples.cpp); phase drops
/// every term that touches a missing one.
/// Equations and sources in allan_deviation.cpp (SP 1065). Offsets cost no digits, powers of two
/// scale exactly. Throws Error(numeric) when no point is possible, naming the number of samples
/// needed; Error(usage) for a bad tau.
AllanCurve allan_deviation(std::span<const double> record,
                           double dt_s,
                           const AllanOptions& options = {});

/// What is left of a curve at octaves between `tau_min_s` and `tau_max_s`, as allan_deviation would
/// leave it. Throws Error(numeric) when nothing is.
AllanCurve limited(const AllanCurve& octaves, const AllanOptions& options);

}  // namespace libchar
