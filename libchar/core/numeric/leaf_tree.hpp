#pragma once
// A record of any length as leaves of 2^20 samples, joined in a binary tree by their numbers, like a binary counter.
// Node (height, place) is of the leaves place * 2^height up to the next place. Two nodes become one only when they are
// the halves of such a node. So the operands and the order of every sum are those of the record, whoever computes it:
// one thread or many, one machine or a hundred.

#include <cstdint>
#include <utility>
#include <vector>

namespace libchar {

inline constexpr std::uint64_t kLeafSamples = std::uint64_t{1} << 20U;

template <class Sums>
struct LeafNode {
  std::uint64_t height = 0, place = 0;
  Sums sums;

  std::uint64_t first_leaf() const { return place << height; }
  std::uint64_t end_leaf() const { return (place + 1) << height; }
};

/// Of one channel. `Stage` has a type `Sums`, `join(Sums&, Sums later)`, and `settle(Sums&, height, first_leaf)`, which
/// is called once for every node and may make less of what grows with the record.
template <class Stage>
class LeafTree {
 public:
  using Sums = typename Stage::Sums;

  /// The stage must live as long.
  explicit LeafTree(Stage& stage) : stage_(&stage) {}

  /// The node whose leaves follow those of the last one.
  void add(LeafNode<Sums> node) {
    nodes_.push_back(std::move(node));
    while (siblings()) {
      join_last();
      LeafNode<Sums>& both = nodes_.back();
      ++both.height;
      both.place /= 2;
      stage_->settle(both.sums, both.height, both.first_leaf());
    }
  }
  /// Those that have no sibling here, left to right.
  std::vector<LeafNode<Sums>>& nodes() { return nodes_; }
  bool empty() const { return nodes_.empty(); }
  /// All of a record: the nodes that are left, of falling height, joined left to right. The tree is empty then.
  Sums whole() {
    std::vector<LeafNode<Sums>> rest = std::exchange(nodes_, {});
    for (LeafNode<Sums>& node : rest) {
      nodes_.push_back(std::move(node));
      if (nodes_.size() == 2) join_last();
    }
    return rest.empty() ? Sums{} : std::move(std::exchange(nodes_, {}).front().sums);
  }

 private:
  bool siblings() const {
    if (nodes_.size() < 2) return false;
    const LeafNode<Sums>&left = nodes_[nodes_.size() - 2], &right = nodes_.back();
    return left.height == right.height && left.place % 2 == 0 && right.place == left.place + 1;
  }
  void join_last() {
    LeafNode<Sums> right = std::move(nodes_.back());
    nodes_.pop_back();
    stage_->join(nodes_.back().sums, std::move(right.sums));
  }

  Stage* stage_;
  std::vector<LeafNode<Sums>> nodes_;
};

}  // namespace libchar
