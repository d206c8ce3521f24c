#pragma once
// How long the segments of a record are.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libchar/spectrum/welch.hpp"

namespace libchar::welch_detail {

/// A quarter of the record as in [RV app. A], or what the caller asked for; halved until enough
/// segments are whole, which is noted. Throws Error(numeric) where none of 8 samples is.
std::uint64_t choose_segment(std::span<const double> record,
                             const WelchOptions& options,
                             std::vector<std::string>& notes);

}  // namespace libchar::welch_detail
