#pragma once
// Is the noise the same throughout a record?

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libchar/core/numeric/interval.hpp"

namespace libchar {

struct Event;
namespace detail {
struct FittedSums;
}
using namespace detail;
struct NoiseFit;

/// How much the Allan deviation at one averaging time differs between stretches of a record.
struct StretchSpread {
  double tau_s = 0;
  std::uint64_t stretches = 0;
  double relative_sd = 0;  ///< of the deviation of a stretch, beyond what chance makes of it
  double independent = 1;  ///< stretches of as much to say: fewer where neighbours are alike
  double p = 1;            ///< of as much scatter in noise that is the same throughout
};

struct Stationarity {
  bool tested = false;                ///< long enough, and without too many missing samples
  std::vector<StretchSpread> spread;  ///< octaves, shortest first
  bool steady = true;                 ///< no octave with p below a hundredth over their number
  bool noticeable = false;            ///< not steady, by a twentieth and more
  /// of the clearest octave: its averaging time, how long a stretch is, where in the record and by
  /// how much its deviation is largest and smallest
  double clearest_tau_s = 0;
  double stretch_s = 0;
  Interval largest_s, smallest_s;
  double largest = 1, smallest = 1;  ///< over that of the whole record
  std::string sentence;              ///< "" where steady
};

/// Compares sixteen stretches of a record (spikes, steps and drift taken out) at every octave that fits a stretch
/// sixteen times. Compares four at longer octaves, which fit a stretch eight times. `fit`: what the degrees of freedom
/// of long averaging times are computed with.
Stationarity test_stationarity(std::span<const double> record, double rate_hz, const NoiseFit& fit);
/// The same of sums over its leaves. `events`: that were taken out of it before `fit`.
Stationarity test_stationarity(const FittedSums& sums, std::span<const Event> events, double rate_hz,
                               const NoiseFit& fit);

namespace detail {
/// At the nearest octave; none where the record is steady.
StretchSpread spread_at(const Stationarity& stationarity, double tau_s);
}  // namespace detail

/// ln(Allan deviation) of another stretch at this averaging time is within so much of the record's (95 %, by Student's
/// t, beyond chance): by the spread at the nearest octave; 0 where the record is steady.
double spread_reach(const Stationarity& stationarity, double tau_s);

}  // namespace libchar
