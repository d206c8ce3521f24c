#pragma once
// Parts of a record joined as leaves of a log are: siblings by their numbers, what is left of
// falling height from left to right.

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace test {

template <class Part, class Take, class Join>
Part joined_parts(std::span<const double> record, std::size_t leaf, Take take, Join join) {
  struct Node {
    std::size_t height, place;
    Part part;
  };
  std::vector<Node> nodes;
  for (std::size_t i = 0; i * leaf < record.size(); ++i) {
    const std::size_t count = std::min(leaf, record.size() - i * leaf);
    nodes.push_back({0, i, take(record.subspan(i * leaf, count), (i + 1) * leaf >= record.size())});
    while (nodes.size() > 1 && nodes[nodes.size() - 2].height == nodes.back().height && nodes.back().place % 2 == 1) {
      Node right = std::move(nodes.back());
      nodes.pop_back();
      join(nodes.back().part, std::move(right.part));
      ++nodes.back().height;
      nodes.back().place /= 2;
    }
  }
  for (std::size_t i = 1; i < nodes.size(); ++i) join(nodes[0].part, std::move(nodes[i].part));
  return std::move(nodes[0].part);
}

}  // namespace test
