#include "libchar/fusion/detail/delay_search.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "libchar/core/lanes.hpp"

namespace libchar::fusion {
namespace {

/// D_s of all starts. Lanes are separate starts, so wider registers give the same bits.
LIBCHAR_WIDE_LANES void cityblock(const double* series,
                                  std::size_t starts,
                                  const double* query,
                                  std::size_t dimension,
                                  double* distances) {
  for (std::size_t s = 0; s < starts; ++s) distances[s] = std::fabs(series[s] - query[0]);
  for (std::size_t j = 1; j < dimension; ++j)
    for (std::size_t s = 0; s < starts; ++s) distances[s] += std::fabs(series[s + j] - query[j]);
}

}  // namespace

DelaySearch::DelaySearch(std::size_t dimension, std::size_t neighbours, std::size_t most)
    : dimension_(dimension), neighbours_(neighbours), distances_(most), found_(neighbours) {
  assert(dimension > 0 && neighbours > 0);
}

std::span<const Neighbour> DelaySearch::nearest(const double* series,
                                                std::size_t starts,
                                                const double* query) {
  assert(starts <= distances_.size());
  cityblock(series, starts, query, dimension_, distances_.data());
  std::size_t count = 0;
  double worst = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < starts; ++s) {
    const double distance = distances_[s];
    // Starts come in order, so "not smaller" loses ties to the earlier one; NaN is never smaller.
    if (!(distance < worst) || std::isnan(series[s + dimension_])) continue;
    std::size_t place = count < neighbours_ ? count++ : count - 1;
    for (; place > 0 && distance < found_[place - 1].distance; --place)
      found_[place] = found_[place - 1];
    found_[place] = {distance, static_cast<std::ptrdiff_t>(s)};
    if (count == neighbours_) worst = found_[count - 1].distance;
  }
  return {found_.data(), count};
}

double prediction(std::span<const Neighbour> found, const double* series, std::size_t dimension) {
  if (found.empty()) return std::nan("");
  const auto after = [&](const Neighbour& n) {
    return series[n.start + static_cast<std::ptrdiff_t>(dimension)];
  };
  // Below a rounding of the values themselves, distances say nothing.
  const double floor = std::max(std::numeric_limits<double>::epsilon() * std::abs(after(found[0])),
                                std::numeric_limits<double>::min());
  const double base = after(found[0]);
  const double nearest = std::max(found[0].distance, floor);
  double sum = 0, weights = 0;
  for (const Neighbour& n : found) {
    const double weight = nearest / std::max(n.distance, floor);
    weights += weight;
    sum += weight * (after(n) - base);
  }
  return base + sum / weights;
}

}  // namespace libchar::fusion
