#pragma once
// Are the steps of a record the jumps of a two-level process?

#include <optional>
#include <span>

#include "libchar/fit/signs/events.hpp"

namespace libchar {

/// From six steps on, of one size within their standard deviations and a quarter, up as well as down. `further`: places beside them
/// where the scores ask for more.
std::optional<Telegraph> telegraph_of(std::span<const Event> events,
                                      int further,
                                      double duration_s);

}  // namespace libchar
