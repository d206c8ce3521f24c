#pragma once
// The statistics of the Allan family: one row each, read by the estimator, the command line, its
// help, JSON and the pages.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace libchar {

enum class DeviationType {
  adev,
  oadev,
  mdev,
  tdev,
  hdev,
  ohdev,
  totdev,
  pdev,
  mtotdev,
  ttotdev,
  htotdev,
  theo1,
  theobr,
  theoh,
  mtie,
  tierms
};

/// How a statistic is made; each has a file of its own.
enum class DeviationFamily {
  differences,  ///< allan_deviation.cpp
  parabola,     ///< detail/parabolic.cpp: differences of fitted slopes
  extended,     ///< detail/extended.cpp: windows of 3m, each continued by reflection
  theo,         ///< detail/theo.cpp: m even, tau = 3/4 m dt
  interval      ///< detail/time_interval.cpp: of phase, whose offset in frequency counts
};

/// With x the phase, W its running sum and m the averaging factor: a term of `differences` is the difference of `order`
/// at step m of x, or of W / m. The deviation is sqrt(mean of squares / divisor) / tau.
struct DeviationRow {
  DeviationType type;
  std::string_view word;  ///< on the command line and in JSON: "oadev"
  std::string_view title;
  int order;         ///< of the difference
  bool of_sum;       ///< of W / m instead of x: x averaged over m points (modified)
  double divisor;    ///< makes it the standard deviation of white noise
  bool overlapping;  ///< terms at every sample, else at multiples of m
  bool as_time;      ///< times tau / sqrt(3)
  bool reflected;    ///< terms at every inner point of the record continued by reflection
  DeviationFamily family = DeviationFamily::differences;

  /// Rate samples that one term spans at averaging factor m (at the smallest possible factor, if m is below it).
  std::uint64_t span(std::uint64_t m) const;
  /// Its square is the Allan variance, whose curves and covariance are known exactly.
  bool is_allan() const { return order == 2 && !reflected && family == DeviationFamily::differences; }
  /// Nothing states how well it is known.
  bool without_interval() const { return family == DeviationFamily::interval; }
};

/// In the order of `DeviationType`.
std::span<const DeviationRow> deviation_rows();
const DeviationRow& deviation_row(DeviationType type);

/// Unit of the statistic of a rate in `unit`: the same, or, where it is one of the time error (TDEV, MTIE…), that of
/// its integral, "deg" of "deg/s". Numbers without a unit are fractional frequencies, and their time errors seconds.
std::string deviation_unit(DeviationType type, std::string_view unit);

std::string_view name_of(DeviationType type);  ///< "oadev"
std::optional<DeviationType> deviation_type(std::string_view name);
/// Their words, for the choices of a command line.
std::vector<std::string> deviation_words();

}  // namespace libchar
