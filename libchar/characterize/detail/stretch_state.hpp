#pragma once
// The bytes of a channel over a stretch: what they are of, what the log says of itself, and the nodes of the leaves.

#include <string>
#include <string_view>
#include <vector>

#include "libchar/characterize/detail/leaf.hpp"
#include "libchar/characterize/stretches.hpp"

namespace libchar {

/// All but the nodes.
struct StretchState {
  StretchHead head;
  LogInfo log;  ///< its head, and what had to be repaired in the stretch
};

/// The nodes are let go of one by one as they are written.
std::string write_stretch(const StretchState& state, std::vector<ChannelNode>& nodes);

/// Checks the whole of `bytes`, which must stay.
StateReader stretch_reader(std::string_view bytes, const std::string& name);
/// Up to the nodes.
StretchState read_stretch(StateReader& from);
/// How many nodes follow; and each of them.
std::size_t read_node_count(StateReader& from);
ChannelNode read_node(StateReader& from, const LeafStage& stage);

}  // namespace libchar
