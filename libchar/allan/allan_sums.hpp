#pragma once
// What the pyramid of octaves has found of a part of a record, and how the parts of neighbours become that of both.

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/core/numeric/state_archive.hpp"

namespace libchar {

/// Sums over the terms of one averaging factor; d is the difference of the means of what is present
/// in neighbouring windows.
struct PresentTerms {
  long double squares = 0;    ///< of d
  long double shortfall = 0;  ///< of (weight of a window in d)² · (1/present - 1/m)
  long double imbalance = 0;  ///< of the squared differences of the shares present, over all starts
  std::uint64_t terms = 0;    ///< in `squares` and `shortfall`
  std::uint64_t starts = 0;   ///< in `imbalance`
  void operator+=(const PresentTerms& other);
};

/// Values of one level at an end of a part, each with the number of samples it lacks.
struct LevelEnd {
  static constexpr std::size_t kMost = 7;  ///< that a term across a boundary can reach
  std::array<double, kMost> value{}, absent{};
  std::size_t count = 0;

  void push_back(double z, double lacks);  ///< the first ones stay
  void push_last(double z, double lacks);  ///< the last ones stay
};

/// Level l of a part: sums of 2^l samples less the part's origin, and the samples themselves at level 0 (NaN: missing).
struct AllanLevel {
  std::uint64_t count = 0;  ///< values
  LevelEnd head, tail;
  std::array<PresentTerms, 3> terms{};  ///< of sums of 1 and 2 (level 0 only) and of 4 values
};

struct AllanSums {
  std::uint64_t samples = 0, missing = 0;
  double origin = std::numeric_limits<double>::quiet_NaN();  ///< the first sample that is there
  std::vector<AllanLevel> levels;
};

/// Adds the part that follows directly. What is in `sums` must have a multiple of the least power
/// of two of samples that is not below those of `later`, or be empty: then no sum of `later`
/// straddles the boundary. Else std::logic_error.
void join(AllanSums& sums, const AllanSums& later);

/// Of the record times a factor, for its curve: no part is joined to them any more.
void scale(AllanSums& sums, double factor);

/// The curve of the record. Throws Error(numeric) where no term fits it.
AllanCurve octave_curve(const AllanSums& sums, double dt_s);

void write_state(const AllanSums& sums, StateWriter& to);
AllanSums read_allan_sums(StateReader& from);

}  // namespace libchar
