#pragma once
// What the families of statistics beside plain differences share: a record without its gaps, pieces
// of its phase or rate near where they are looked at, and sums of terms in a fixed order.

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/detail/anchored_phase.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/parallel/parallel.hpp"

namespace libchar {

struct FamilyInput {
  std::span<const double> record;
  DataKind data = DataKind::rate;
  double dt_s = 1;
  double scale = 1;                                ///< power of two by which all is multiplied
  std::vector<IndexRange> stretches;               ///< of samples of the record, none missing
  std::uint64_t work_a_point = 0;                  ///< operations; beyond them starts are spaced, 0: never
  std::size_t points(const IndexRange& s) const {  ///< of phase, in a stretch
    return s.end - s.begin + (data == DataKind::rate ? 1 : 0);
  }
  std::size_t rates(const IndexRange& s) const { return points(s) - 1; }
};

/// Points at the ascending `factors`; no terms where none fits.
using FamilyPoints = std::vector<AllanPoint> (*)(const FamilyInput& input, const DeviationRow& row,
                                                 const std::vector<std::uint64_t>& factors,
                                                 std::vector<std::string>& notes);
std::vector<AllanPoint> parabolic_points(const FamilyInput&, const DeviationRow&, const std::vector<std::uint64_t>&,
                                         std::vector<std::string>&);
std::vector<AllanPoint> extended_points(const FamilyInput&, const DeviationRow&, const std::vector<std::uint64_t>&,
                                        std::vector<std::string>&);
std::vector<AllanPoint> theo_points(const FamilyInput&, const DeviationRow&, const std::vector<std::uint64_t>&,
                                    std::vector<std::string>&);
std::vector<AllanPoint> interval_points(const FamilyInput&, const DeviationRow&, const std::vector<std::uint64_t>&,
                                        std::vector<std::string>&);

/// Averaging factor of Theo1 whose averaging time, 3/4 m, is nearest to `tau`, in samples.
std::uint64_t theo_factor(double tau);
/// Averaging times of TheoH up to this many samples are the Allan deviation's: a fifth of the record.
std::uint64_t last_allan_factor(std::uint64_t samples);

/// Phase points first, first + 1 … of a stretch, less a straight line (of which the statistics see nothing), times the
/// scale. The sum begins anew here: what a long record adds up to costs its differences no digits.
void local_phase(const FamilyInput& input, std::size_t first, std::span<double> out);
/// The same with the line, which begins at 0.
void local_phase_with_offset(const FamilyInput& input, std::size_t first, std::span<double> out);
/// Rate samples first, first + 1 … less the first of them, times the scale; of phase its differences.
void local_rate(const FamilyInput& input, std::size_t first, std::span<double> out);

struct FamilySum {
  double sum = 0;
  std::uint64_t terms = 0;
};

/// sqrt(sum / (divisor terms)) / (m dt): by m alone where the record is a rate, whose phase is in units of dt.
AllanPoint family_point(const FamilyInput& input, std::uint64_t m, double tau_s, double divisor, const FamilySum& sum);

/// Every how manieth start is used, so that `starts` of `work` operations each cost no more than is
/// allowed: at most m/16, which leaves the degrees of freedom as they are to a hundredth.
std::size_t family_stride(const FamilyInput& input, std::uint64_t m, std::uint64_t starts, std::uint64_t work);

/// `point_of(m, spaced)` of each factor, with a note of how many of them are `spaced`: do not use every start.
std::vector<AllanPoint> spaced_points(const std::vector<std::uint64_t>& factors, std::vector<std::string>& notes,
                                      const std::function<AllanPoint(std::size_t m, bool& spaced)>& point_of);

/// Sum over blocks of `block` term starts in `stretch`: `of_block(first, count)` adds up the starts
/// first, first + stride …
template <typename OfBlock>
FamilySum over_blocks(std::size_t begin, std::size_t starts, std::size_t stride, std::size_t block,
                      const OfBlock& of_block) {
  const std::size_t used = (starts + stride - 1) / stride;
  std::vector<double> part((used + block - 1) / block);
  parallel::for_each(0, part.size(), [&](std::size_t k) {
    const std::size_t first = k * block;
    part[k] = of_block(begin + first * stride, std::min(block, used - first));
  });
  FamilySum all;
  for (const double p : part) all.sum += p;
  all.terms = used;
  return all;
}

}  // namespace libchar
