#pragma once
// Times of several pieces of work, taken in turns, so that whatever else the machine does falls on all of them alike.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "libchar/benchmark/figure.hpp"

namespace libchar {

/// In which order `count` subjects run in a round: rotated by one each round and reversed in every
/// second, so that each runs at every place, and after every other, about as often.
std::vector<std::size_t> order_of_round(std::size_t count, std::size_t round);

/// Seconds of processor time of this thread.
double thread_seconds();

/// The machine, and its load by other programs.
struct Machine {
  std::string processor;  ///< as the system names it
  std::uint64_t cores = 0;
  double memory_gib = 0;
  std::string system;            ///< kernel and architecture
  double others = 0;             ///< processors that other programs kept busy meanwhile, on average
  double wall_s = 0, cpu_s = 0;  ///< of this program meanwhile
};

/// Watches from its making to `finish`.
class MachineWatch {
 public:
  MachineWatch();
  Machine finish() const;

 private:
  double wall_, own_, busy_;
};

/// A sentence when others kept more than a tenth of a processor busy; else empty.
std::string load_sentence(const Machine& machine);

}  // namespace libchar
