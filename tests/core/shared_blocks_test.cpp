#include "libchar/core/process/shared_blocks.hpp"

#include <catch2/catch.hpp>

using namespace libchar;

namespace {

struct Taker final : BlockTaker {
  bool free = true;
  std::vector<double> samples, power;
  std::size_t blocks = 0;
  bool take_block(std::span<const double> block) override {
    if (!free) return false;
    ++blocks;
    samples.insert(samples.end(), block.begin(), block.end());
    return true;
  }
  void push(std::span<const double> more) override { samples.insert(samples.end(), more.begin(), more.end()); }
  void take_power(std::vector<double> sums) override { power = std::move(sums); }
};

}  // namespace

TEST_CASE("shared blocks: the taker gets every sample once, and says which blocks it wants") {
  const std::vector<double> x = {1, 2, 3, 4, 5, 6, 7};
  const auto block = [&](std::size_t i) { return std::span(x).subspan(2 * i, 2); };
  Taker taker;
  SharedBlocks blocks(2, taker);
  CHECK(blocks.length() == 2);
  CHECK(blocks.offer(block(0), true));
  CHECK_FALSE(blocks.offer(block(1), false));  // a sample is missing: its transform is of no use
  taker.free = false;
  CHECK_FALSE(blocks.offer(block(2), true));
  blocks.close(std::span(x).subspan(6), {0, 0.5});
  CHECK(taker.samples == x);
  CHECK(taker.blocks == 1);
  CHECK(taker.power == std::vector<double>{0, 0.5});
}
