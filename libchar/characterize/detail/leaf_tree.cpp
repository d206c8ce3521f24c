#include "libchar/characterize/detail/leaf_tree.hpp"

#include <tbb/parallel_for.h>

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
    if (nodes_.back().height == kSettledHeight) settle_last();
  }
}

void LeafTree::join_last() {
  LeafNode right = std::move(nodes_.back());
  nodes_.pop_back();
  std::vector<ChannelSums>& left = nodes_.back().channels;
  tbb::parallel_for(std::size_t{0}, left.size(), [&](std::size_t c) {
    (*stages_)[c].join(left[c], std::move(right.channels[c]));
    right.channels[c] = {};
  });
}

void LeafTree::settle_last() {
  LeafNode& node = nodes_.back();
  tbb::parallel_for(std::size_t{0}, node.channels.size(), [&](std::size_t c) {
    (*stages_)[c].settle(node.channels[c], node.first_leaf());
  });
}

std::vector<ChannelSums> LeafTree::whole() {
  std::vector<LeafNode> rest = std::exchange(nodes_, {});
  if (rest.empty()) return {};
  for (LeafNode& node : rest) {
    nodes_.push_back(std::move(node));
    if (nodes_.size() == 2) join_last();
  }
  return std::move(std::exchange(nodes_, {}).front().channels);
}

}  // namespace libchar
