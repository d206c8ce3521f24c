#include "libchar/log/detail/lossy_packets.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/core/numeric/median.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/log/time/recent_stamps.hpp"

namespace libchar {
namespace {

std::int64_t later(std::int64_t stamp, double ns) {
  std::int64_t out = 0;
  return __builtin_add_overflow(stamp, clamped_whole<std::int64_t>(std::round(ns)), &out) ? stamp : out;
}

/// Packets of a log's first rows, without the last, which may be cut.
struct Sizes {
  std::vector<std::size_t> rows;
  std::vector<double> steps;  ///< from each to the next
};

Sizes sizes_of(const std::vector<std::int64_t>& stamps) {
  Sizes out{{1}, {}};
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    if (stamps[i] == stamps[i - 1]) {
      ++out.rows.back();
      continue;
    }
    out.steps.push_back(step_between(stamps[i - 1], stamps[i]));
    out.rows.push_back(1);
  }
  out.rows.pop_back();
  return out;
}

/// Time from packet to packet; 0 where they do not come evenly.
double time_apart(const std::vector<double>& steps) {
  constexpr double kOff = 0.1, kSteady = 0.9, kMost = 20;
  std::vector<double> sorted = steps;
  const double usual = median_in_place(sorted, Middle::lower);
  double time = 0, packets = 0, steady = 0;
  for (const double step : steps) {
    const double multiple = std::round(step / usual);
    if (multiple < 1 || multiple > kMost || std::fabs(step - multiple * usual) > kOff * usual) continue;
    time += step;
    packets += multiple;
    ++steady;
  }
  return steady >= kSteady * static_cast<double>(steps.size()) ? time / packets : 0;
}

/// Whole packets among short ones, or these among those, stand as evenly as where the numbers of rows beat with a
/// clock: rows lost at random leave distances that scatter as much as their mean.
bool beat(const std::vector<std::size_t>& sizes, std::size_t whole) {
  constexpr std::size_t kFewest = 3;
  constexpr double kScatter = 0.25;  // of that of random ones
  const auto n = static_cast<double>(sizes.size());
  const auto full = static_cast<double>(std::count(sizes.begin(), sizes.end(), whole));
  const bool of_full = 2 * full < n;
  std::vector<double> apart;
  std::size_t last = sizes.size();
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if ((sizes[i] == whole) != of_full) continue;
    if (last < i) apart.push_back(static_cast<double>(i - last));
    last = i;
  }
  if (apart.size() < kFewest) return false;
  double sum = 0, squares = 0;
  for (const double one : apart) {
    sum += one;
    squares += one * one;
  }
  const auto count = static_cast<double>(apart.size());
  const double mean = sum / count;
  return squares / count - mean * mean < kScatter * mean * (mean - 1);
}

/// Is each row lost with one probability? Then whole packets are as many, and sizes scatter as much, as that makes.
bool lost_at_random(const std::vector<std::size_t>& sizes, std::size_t whole) {
  constexpr double kMostLost = 0.35, kFewest = 4;
  const auto m = static_cast<double>(whole), n = static_cast<double>(sizes.size());
  double sum = 0, squares = 0, full = 0;
  for (const std::size_t size : sizes) {
    const auto rows = static_cast<double>(size);
    sum += rows;
    squares += rows * rows;
    full += size == whole ? 1 : 0;
  }
  const double mean = sum / n, lost = 1 - mean / m, variance = squares / n - mean * mean;
  const double as_whole = n * std::pow(1 - lost, m), as_scattered = mean * lost;
  const double near = 3 * std::sqrt(as_whole) + 0.1 * as_whole;
  return lost <= kMostLost && as_whole >= kFewest && n - full >= kFewest && std::fabs(full - as_whole) <= near &&
         variance > 0.5 * as_scattered && variance < 2 * as_scattered;
}

}  // namespace

std::optional<LossyPackets> find_lossy_packets(const std::vector<std::int64_t>& stamps) {
  constexpr std::size_t kFewest = 8, kLeastRows = 3;
  const Sizes all = sizes_of(stamps);
  if (all.rows.size() < kFewest) return std::nullopt;
  const std::vector<std::size_t> sizes(all.rows.begin() + 1, all.rows.end());
  const auto [least, most] = std::minmax_element(sizes.begin(), sizes.end());
  if (*most < kLeastRows || *least == *most || all.rows[0] > *most) return std::nullopt;
  const auto whole = static_cast<std::size_t>(std::count(sizes.begin(), sizes.end(), *most));
  const bool random = !beat(sizes, *most);
  LossyPackets out{time_apart(all.steps), *most, all.rows[0], random && lost_at_random(sizes, *most),
                   random && 2 * whole > sizes.size()};
  if (!(out.apart_ns > 0)) return std::nullopt;
  return out;
}

void PacketRows::spread(std::vector<std::int64_t>& stamps, std::size_t from) {
  for (std::size_t i = from; i < stamps.size(); ++i) {
    if (!begun_ || stamps[i] != stamp_) next_packet(stamps[i]);
    stamps[i] = later(begin_, static_cast<double>(row_) * packets_.interval_ns());
    row_ = std::min(row_ + 1, packets_.rows - 1);  // more rows share the last instant, as doubles do
  }
}

void PacketRows::next_packet(std::int64_t stamp) {
  constexpr double kFollows = 1.0 / 16, kNear = 0.4;
  const double step = step_between(stamp_, stamp), packets = std::round(step / packets_.apart_ns);
  const double off = step_between(begin_, stamp) - packets * packets_.apart_ns;
  const bool near = begun_ && packets >= 1 && std::fabs(off) < kNear * packets_.apart_ns;
  if (begun_) row_ = 0;
  begin_ = near ? later(stamp, (kFollows - 1) * off) : stamp;
  begun_ = true;
  stamp_ = stamp;
}

}  // namespace libchar
