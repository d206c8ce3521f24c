#include "libchar/fusion/detail/delay_search.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>

#include "libchar/core/numeric/lanes.hpp"

namespace libchar::fusion {
namespace {

constexpr std::size_t kSortedByRank = 128, kClassesPerNeighbour = 3;
constexpr std::size_t kGroup = 16;  // starts whose smallest distance is known

using FourBits = std::int64_t __attribute__((vector_size(32)));

/// D_s of all starts, NaN where a value or the successor is missing, the smallest of each group (the last one may be
/// shorter), and the smallest of each class: starts as many apart as there are classes, a multiple of the groups' size.
/// Lanes are separate starts, so wider registers give the same bits.
LIBCHAR_LANES void cityblock_lanes(const double* series, std::size_t starts, const double* query, std::size_t dimension,
                                   double* distances, double* smallest, double* of_class, std::size_t classes) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr std::int64_t kNoSign = std::numeric_limits<std::int64_t>::max();
  const FourBits no_sign = {kNoSign, kNoSign, kNoSign, kNoSign};
  const std::size_t whole = starts / kGroup * kGroup;
  for (std::size_t c = 0; c < classes; ++c) of_class[c] = kInfinity;
  std::size_t in_class = 0;  // s modulo classes
  for (std::size_t s = 0; s < whole; s += kGroup) {
    Four sum[kGroup / 4] = {};
    for (std::size_t j = 0; j < dimension; ++j)
      for (std::size_t l = 0; l < kGroup / 4; ++l) {
        const Four off = LIBCHAR_FOUR(series + s + j + 4 * l) - query[j];
        sum[l] += reinterpret_cast<Four>(reinterpret_cast<FourBits>(off) & no_sign);
      }
    Four least = {kInfinity, kInfinity, kInfinity, kInfinity};
    for (std::size_t l = 0; l < kGroup / 4; ++l) {
      const Four after = LIBCHAR_FOUR(series + s + dimension + 4 * l);
      sum[l] += after - after;
      least = sum[l] < least ? sum[l] : least;
      LIBCHAR_FOUR_TO(distances + s + 4 * l) = sum[l];
      double* const lane = of_class + in_class + 4 * l;
      const Four before = LIBCHAR_FOUR(lane);
      LIBCHAR_FOUR_TO(lane) = sum[l] < before ? sum[l] : before;
    }
    smallest[s / kGroup] = std::min(std::min(least[0], least[1]), std::min(least[2], least[3]));
    in_class = in_class + kGroup == classes ? 0 : in_class + kGroup;
  }
  if (whole == starts || classes == 0) return;
  smallest[whole / kGroup] = kInfinity;
  for (std::size_t s = whole; s < starts; ++s) {
    distances[s] = 0;
    for (std::size_t j = 0; j < dimension; ++j) distances[s] += std::fabs(series[s + j] - query[j]);
    distances[s] += series[s + dimension] - series[s + dimension];
    if (distances[s] < smallest[whole / kGroup]) smallest[whole / kGroup] = distances[s];
    if (distances[s] < of_class[s % classes]) of_class[s % classes] = distances[s];
  }
}
constexpr InLanes<cityblock_lanes> cityblock;

LIBCHAR_LANES std::int64_t at_most_lanes(const double* values, std::size_t count, double limit) {
  std::int64_t sum = 0;
  for (std::size_t k = 0; k < count; ++k) sum += values[k] <= limit ? 1 : 0;
  return sum;
}
constexpr InLanes<at_most_lanes> at_most;

/// A limit that at least `wanted` of the values, none negative, keep, and few more: by halves of
/// what lies between in steps of the last bit. Infinite where so many are not finite.
double limit_for(const double* values, std::size_t count, std::int64_t wanted) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr int kHalves = 12;
  double low = kInfinity, high = 0;
  for (std::size_t k = 0; k < count; ++k) {
    low = std::min(low, values[k]);
    high = std::max(high, values[k] < kInfinity ? values[k] : 0);
  }
  if (at_most(values, count, high) < wanted) return kInfinity;
  auto below = std::bit_cast<std::int64_t>(low), above = std::bit_cast<std::int64_t>(high);
  for (int k = 0; k < kHalves; ++k) {
    const std::int64_t middle = below + (above - below) / 2;
    if (at_most(values, count, std::bit_cast<double>(middle)) >= wanted)
      above = middle;
    else
      below = middle;
  }
  return std::bit_cast<double>(above);
}

/// How many of the values are smaller than each.
LIBCHAR_LANES void ranks_lanes(double* values, std::size_t count, std::size_t* places) {
  for (std::size_t k = count; k % 4 != 0; ++k) values[k] = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < count; ++i) {
    FourBits smaller = {};
    for (std::size_t k = 0; k < count; k += 4) smaller -= LIBCHAR_FOUR(values + k) < values[i];
    places[i] = static_cast<std::size_t>(smaller[0] + smaller[1] + smaller[2] + smaller[3]);
  }
}
constexpr InLanes<ranks_lanes> ranks;

}  // namespace

DelaySearch::DelaySearch(std::size_t dimension, std::size_t neighbours, std::size_t most)
    : dimension_(dimension),
      neighbours_(neighbours),
      distances_(most),
      smallest_(most / kGroup + 1),
      of_class_(kClassesPerNeighbour * neighbours / kGroup * kGroup + kGroup),
      within_distances_(most + 4),
      within_(most + 1),
      found_(neighbours) {
  assert(dimension > 0 && neighbours > 0);
}

std::span<const Neighbour> DelaySearch::nearest(const double* series, std::size_t starts, const double* query) {
  assert(starts <= distances_.size());
  cityblock(series, starts, query, dimension_, distances_.data(), smallest_.data(), of_class_.data(), of_class_.size());
  // As many classes as neighbours have one at or below it; what is near comes one after the other,
  // so hardly two in a class.
  const double limit = limit_for(of_class_.data(), of_class_.size(), static_cast<std::int64_t>(neighbours_));
  const std::size_t count = take_within(limit, starts);
  if (count > kSortedByRank)
    sort_by_distance(count);
  else
    rank_by_distance(count);
  return {found_.data(), std::min(count, neighbours_)};
}

/// Starts within the limit, in order, and their distances; without a branch, as one in ten could not be foretold.
std::size_t DelaySearch::take_within(double limit, std::size_t starts) {
  std::size_t count = 0;
  for (std::size_t first = 0; first < starts; first += kGroup) {
    if (!(smallest_[first / kGroup] <= limit)) continue;
    const std::size_t end = std::min(starts, first + kGroup);
    for (std::size_t s = first; s < end; ++s) {
      const double distance = distances_[s];
      within_[count] = static_cast<std::ptrdiff_t>(s);
      within_distances_[count] = distance;
      count += distance <= limit ? 1 : 0;
    }
  }
  return count;
}

void DelaySearch::sort_by_distance(std::size_t count) {
  const auto end = within_.begin() + static_cast<std::ptrdiff_t>(count);
  std::sort(within_.begin(), end, [this](std::ptrdiff_t a, std::ptrdiff_t b) {
    const double da = distances_[static_cast<std::size_t>(a)], db = distances_[static_cast<std::size_t>(b)];
    return da < db || (da == db && a < b);
  });
  for (std::size_t k = 0; k < std::min(count, neighbours_); ++k)
    found_[k] = {distances_[static_cast<std::size_t>(within_[k])], within_[k]};
}

/// Each goes where it belongs: as many are nearer. Few of them, and no comparison that could not be foretold.
void DelaySearch::rank_by_distance(std::size_t count) {
  std::size_t places[kSortedByRank];
  ranks(within_distances_.data(), count, places);
  for (std::size_t k = 0; k < std::min(count, neighbours_); ++k) found_[k].start = -1;
  for (std::size_t k = 0; k < count; ++k) {
    std::size_t place = places[k];
    while (place < neighbours_ && found_[place].start >= 0) ++place;  // equal, but earlier
    if (place < neighbours_) found_[place] = {within_distances_[k], within_[k]};
  }
}

double prediction(std::span<const Neighbour> found, const double* series, std::size_t dimension) {
  if (found.empty()) return std::nan("");
  const auto after = [&](const Neighbour& n) { return series[n.start + static_cast<std::ptrdiff_t>(dimension)]; };
  // Below a rounding of the values themselves, distances say nothing.
  const double floor =
      std::max(std::numeric_limits<double>::epsilon() * std::abs(after(found[0])), std::numeric_limits<double>::min());
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
