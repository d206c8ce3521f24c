#pragma once
// The comparison of a recording with a simulation of its model, as JSON.

#include "libchar/characterize/characterization_view.hpp"
#include "libchar/core/json.hpp"

namespace libchar {

/// {"name","agrees","sentences","terms":[…],"allan":{…},"spectrum":{…}}.
Json verification_json(const ChannelView& view);

}  // namespace libchar
