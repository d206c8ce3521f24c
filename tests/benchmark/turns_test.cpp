// In turns: each at every place, after every other, as often.

#include "libchar/benchmark/turns.hpp"

#include <catch2/catch.hpp>
#include <map>

using namespace libchar;

TEST_CASE("order of rounds: everybody at every place equally often") {
  constexpr std::size_t kCount = 5;
  std::map<std::pair<std::size_t, std::size_t>, int> at;  // subject, place
  for (std::size_t round = 0; round < 2 * kCount; ++round) {
    const auto order = order_of_round(kCount, round);
    REQUIRE(order.size() == kCount);
    for (std::size_t place = 0; place < kCount; ++place) ++at[{order[place], place}];
  }
  CHECK(at.size() == kCount * kCount);
  for (const auto& [key, times] : at) CHECK(times == 2);
  CHECK(order_of_round(0, 3).empty());
}

TEST_CASE("machine: what it is, and that a busy neighbour is said") {
  const MachineWatch watch;
  const Machine machine = watch.finish();
  CHECK(machine.cores >= 1);
  CHECK(machine.memory_gib > 0);
  CHECK_FALSE(machine.processor.empty());
  Machine busy;
  busy.cores = 4;
  CHECK(load_sentence(busy).empty());
  busy.others = 1.5;
  CHECK(load_sentence(busy).find("1.5 of 4 processors") != std::string::npos);
}
