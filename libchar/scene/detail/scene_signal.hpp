#pragma once
// The description of a true signal in a scene or beside it.

#include <string>
#include <vector>

#include "libchar/core/document/document.hpp"
#include "libchar/simulate/signal.hpp"

namespace libchar {

/// One signal: a map {kind, …} with the keys of its kind; a bare word is a kind, a bare number a
/// constant. `earlier` names the signals that stand before it (`of` may be such a name or an index
/// from 0). Samples of kind recording are left unread.
SignalSpec read_signal(const Document& node,
                       const std::string& file,
                       const std::string& path,
                       const std::vector<std::string>& earlier = {});

}  // namespace libchar
