#pragma once
// Which of some values stand apart from the others: further from their median than `limit` times the normal deviation
// that the median distance shows. The limit is where of normal values one of three, four or five is in 5 % of draws, and
// of more in fewer.

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "libchar/core/numeric/median.hpp"

namespace libchar {

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

}  // namespace libchar
