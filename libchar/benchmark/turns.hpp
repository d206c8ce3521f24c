#pragma once
// Times of several pieces of work, taken in turns, so that whatever else the machine does falls on all of them alike.

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "libchar/core/numeric/interval.hpp"

namespace libchar {
// A measured figure with what is known of it, and the order statistics and means that make one.

/// NaN: not measured.
struct Figure {
  double value = std::numeric_limits<double>::quiet_NaN();
  /// about 95 %; infinite on a side where the values are too few to say
  Interval ci95 = {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  std::uint64_t count = 0;  ///< values behind it
};

/// Median of independent values and its distribution-free interval: the order statistics between
/// which the population's median lies with at least 95 % (binomial; David & Nagaraja, Order
/// Statistics, 2003, §7.1). Fewer than six values: no limits.
Figure median_figure(std::vector<double> values);

/// Median of times whose interval is to hold the median of another run of the same, too: order statistics at 99 %, and
/// at least 1.5 % to either side (where code and data come to lie differs from run to run).
Figure time_figure(std::vector<double> values);

/// Mean and its interval by Student's t. One value: no limits.
Figure mean_figure(const std::vector<double>& values);

/// Root mean square of independent, about normal values with mean zero: chi-square with as many degrees of freedom.
Figure rms_figure(const std::vector<double>& values);

/// Share of `count` trials that hit, with Wilson's score interval.
Figure share_figure(std::size_t hits, std::size_t count);

/// Do the intervals leave it open which of two is larger?
bool unresolved(const Figure& a, const Figure& b);

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
