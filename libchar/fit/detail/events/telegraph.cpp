// Steps that something outside makes differ in size; those of a trap in a transistor, or of a loose contact, are all alike, and up follows
// down (M. J. Kirton and M. J. Uren, Advances in Physics 38, 1989). The size is the weighted mean of the steps' sizes.
#include "libchar/fit/detail/events/telegraph.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace libchar {
namespace {

constexpr int kFewestJumps = 6;
constexpr double kAlike = 0.25;

/// How often a step follows one of its own sign: between these a jump went unfound.
int not_in_turn(std::span<const Event> events) {
  std::vector<std::pair<double, double>> steps;
  for (const Event& event : events)
    if (event.kind == EventKind::step) steps.emplace_back(event.at_s, event.size);
  std::sort(steps.begin(), steps.end());
  int same = 0;
  for (std::size_t i = 1; i < steps.size(); ++i)
    same += steps[i].second * steps[i - 1].second > 0 ? 1 : 0;
  return same;
}

}  // namespace

std::optional<Telegraph> telegraph_of(std::span<const Event> events,
                                      int further,
                                      double duration_s) {
  double weight = 0, sum = 0;
  int up = 0, down = 0;
  for (const Event& event : events) {
    if (event.kind != EventKind::step) continue;
    weight += 1 / (event.sd * event.sd);
    sum += std::abs(event.size) / (event.sd * event.sd);
    (event.size > 0 ? up : down) += 1;
  }
  if (up + down < kFewestJumps || std::min(up, down) < 2) return std::nullopt;
  if (4 * not_in_turn(events) > further) return std::nullopt;
  const double size = sum / weight;
  for (const Event& event : events) {
    if (event.kind != EventKind::step) continue;
    const double off = std::abs(std::abs(event.size) - size);
    if (off > 4 * event.sd || off > kAlike * size + 2 * event.sd) return std::nullopt;
  }
  const int jumps = up + down + further;
  return Telegraph{size, 1 / std::sqrt(weight), jumps, duration_s / (jumps + 1)};
}

}  // namespace libchar
