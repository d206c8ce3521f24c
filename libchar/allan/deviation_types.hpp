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

enum class DeviationType { adev, oadev, mdev, tdev, hdev, ohdev, totdev };

/// With the phase x, its running sum W and the averaging factor m, a term is the difference of
/// `order` at step m of x, or of W / m; the deviation is sqrt(mean of squares / divisor) / tau.
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

  /// Samples that one term spans at averaging factor m.
  std::uint64_t span(std::uint64_t m) const;
  /// Its square is the Allan variance, whose curves and covariance are known exactly.
  bool is_allan() const { return order == 2 && !reflected; }
};

/// In the order of `DeviationType`.
std::span<const DeviationRow> deviation_rows();
const DeviationRow& deviation_row(DeviationType type);

std::string_view name_of(DeviationType type);  ///< "oadev"
std::optional<DeviationType> deviation_type(std::string_view name);
/// Their words, for the choices of a command line.
std::vector<std::string> deviation_words();

}  // namespace libchar
