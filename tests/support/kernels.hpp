#pragma once
// The hand-written kernels, each where the library runs it, with the time that it takes for each kind
// of instructions that this processor has. A kernel that is right on one processor may be a cliff on
// another: SHA-256 between 256-bit instructions took forty times longer on some.

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/process/processor.hpp"

namespace test {

struct Kernel {
  std::string name;
  std::size_t bytes = 0;        ///< that it reads
  std::function<double()> run;  ///< once; a number that depends on all of it
};

/// "csv", "allan", "spectrum", "noise", "fusion"; the bench of that name prints them.
std::vector<Kernel> kernels_of(std::string_view group);

struct KernelTime {
  Kernel kernel;
  double copy_s = 0;              ///< memcpy of as many bytes
  std::vector<double> seconds{};  ///< by kAllInstructions, as far as they are there: the best
  std::vector<double> results{};
};
/// Processor time of this thread, all kinds in turn, warm.
KernelTime time_of(Kernel kernel, int rounds = 15);

/// A table: bytes a second of each kind of instructions, and beside memcpy and the first kind.
void print_kernels(std::string_view group);

}  // namespace test
