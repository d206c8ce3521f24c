#include "libchar/characterize/detail/leaf_tree.hpp"

#include <utility>

namespace libchar {

void LeafTree::add(LeafNode node) {
  nodes_.push_back(std::move(node));
  const auto siblings = [&] {
    if (nodes_.size() < 2) return false;
    const LeafNode &left = nodes_[nodes_.size() - 2], &right = nodes_.back();
    return left.height == right.height && left.place % 2 == 0 && right.place == left.place + 1;
  };
  while (siblings()) {
    join_last();
    ++nodes_.back().height;
    nodes_.back().place /= 2;
    if (nodes_.back().height == kSettledHeight)
      stage_->settle(nodes_.back().sums, nodes_.back().first_leaf());
  }
}

void LeafTree::join_last() {
  LeafNode right = std::move(nodes_.back());
  nodes_.pop_back();
  stage_->join(nodes_.back().sums, std::move(right.sums));
}

ChannelSums LeafTree::whole() {
  std::vector<LeafNode> rest = std::exchange(nodes_, {});
  for (LeafNode& node : rest) {
    nodes_.push_back(std::move(node));
    if (nodes_.size() == 2) join_last();
  }
  return rest.empty() ? ChannelSums{} : std::move(std::exchange(nodes_, {}).front().sums);
}

}  // namespace libchar
