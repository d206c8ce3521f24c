// Steps that something outside makes differ in size; those of a trap in a transistor, or of a loose contact, are all alike, up and down
// (M. J. Kirton and M. J. Uren, Advances in Physics 38, 1989). The size is the weighted mean of the steps' sizes.
#include "libchar/fit/events/telegraph.hpp"

#include <algorithm>
#include <cmath>

namespace libchar {
namespace {

constexpr int kFewestJumps = 6;
constexpr double kAlike = 0.25;

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
