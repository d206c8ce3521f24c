#pragma once
// States of stretches as they arrive: are they of one log, and do they cover it?

#include <span>
#include <string>
#include <vector>

#include "libchar/characterize/stretches.hpp"

namespace libchar {

struct OrderedState {
  const NamedState* state;
  StretchHead head;
};

/// Of each channel, in the order of their leaves. Throws Error(input) by name unless they are of one log and of these settings (E0724)
/// and cover it, no leaf of a channel twice (E0725).
std::vector<std::vector<OrderedState>> states_in_order(std::span<const NamedState> states,
                                                       const std::string& settings);

}  // namespace libchar
