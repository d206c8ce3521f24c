#pragma once
// Two independent coefficients, or two points of curves: what is their ratio, and is it beyond chance?

#include <optional>
#include <vector>

#include "libchar/core/coefficient.hpp"
#include "libchar/core/document/enum_table.hpp"

namespace libchar {

enum class TermDifference {
  larger,        ///< beyond chance
  smaller,       ///< beyond chance
  not_resolved,  ///< the intervals allow none
  not_judged,    ///< one of the two cannot be relied on, or only limits are known
  only_one,      ///< fitted in one of the two only
};
template <>
inline constexpr auto enum_table<TermDifference> =
    enum_words<TermDifference, "larger smaller not_resolved not_judged only_one">;

namespace detail {

/// Of one to another.
struct TermRatio {
  std::optional<double> ratio;  ///< none: one has no value
  Interval ci95;
  std::optional<double> p;  ///< two-sided, of this ratio or one farther from 1 when both are equal
};

bool relied_on(const Coefficient& c);
Coefficient scaled(Coefficient c, double factor);

TermRatio ratio_of(const Coefficient& b, const Coefficient& a);

/// Of b from a, where the probability of a difference of equal sensors is `share`.
TermDifference difference_of(const Coefficient& b, const Coefficient& a, double share);

/// The square root of the mean of squares, such as of the three axes of a sensor.
Coefficient root_mean_square(const std::vector<Coefficient>& all);

/// Which of several is the smallest, and which of them could be it as well.
struct Lowest {
  std::optional<std::size_t> best;     ///< none: none can be relied on
  std::vector<std::size_t> not_apart;  ///< not distinguished from it
};

/// Of the ones that take part. `share`: as difference_of.
Lowest lowest_of(const std::vector<Coefficient>& all,
                 const std::vector<bool>& takes_part,
                 double share);

}  // namespace detail
}  // namespace libchar
