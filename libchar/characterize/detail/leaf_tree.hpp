#pragma once
// Leaves joined in a binary tree by their numbers, like a binary counter: node (height, place) is of the leaves place * 2^height up to
// the next place, and two become one only when they are the halves of such a node. Which nodes there are then depends on the range of
// leaves, and what is in a node on its leaves only.

#include <cstdint>
#include <vector>

#include "libchar/characterize/detail/leaf.hpp"

namespace libchar {

/// Of one channel.
struct LeafNode {
  std::uint64_t height = 0, place = 0;
  ChannelSums sums;

  std::uint64_t first_leaf() const { return place << height; }
  std::uint64_t end_leaf() const { return (place + 1) << height; }
};

class LeafTree {
 public:
  /// The stage must live as long.
  explicit LeafTree(LeafStage& stage) : stage_(&stage) {}

  /// The node whose leaves follow those of the last one.
  void add(LeafNode node);
  /// Those that have no sibling here, left to right.
  std::vector<LeafNode>& nodes() { return nodes_; }
  /// All of a log: the nodes that are left, of falling height, joined left to right. The tree is empty then.
  ChannelSums whole();

 private:
  void join_last();

  LeafStage* stage_;
  std::vector<LeafNode> nodes_;
};

}  // namespace libchar
