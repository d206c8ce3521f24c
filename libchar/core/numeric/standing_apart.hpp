#pragma once
// Which values are apart from the others: further from their median than some times the normal deviation that their
// median distance from it shows. Of three, four and five normal values one is as far in 5 % of draws, of more in fewer.

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "libchar/core/numeric/median.hpp"

namespace libchar::detail {

inline std::vector<bool> standing_apart(std::span<const double> values) {
  std::vector<double> sorted(values.begin(), values.end()), away;
  const double median = median_in_place(sorted);
  for (const double value : values) away.push_back(std::abs(value - median));
  const std::size_t n = values.size();
  const double limit = (n == 3 ? 22 : n == 5 ? 8 : 7) * kMadToSd * median_in_place(away);
  std::vector<bool> out;
  for (const double value : values) out.push_back(n >= 3 && std::abs(value - median) > limit);
  return out;
}

}  // namespace libchar::detail
