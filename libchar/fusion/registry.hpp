#pragma once
// All fusion algorithms, in the order in which reports list them.

#include <memory>
#include <span>
#include <string_view>

#include "libchar/fusion/description.hpp"
#include "libchar/fusion/options.hpp"

namespace libchar::fusion {

struct Array;
class Runner;  // runner.hpp

struct Entry {
  const Description* description;
  std::span<const Option> options;
  std::size_t own_options = 0;  ///< the first of them; the others are those of the fault detector before it
  /// Throws Error(usage) when the algorithm cannot run on what is given (ask `why_not` first).
  std::unique_ptr<Runner> (*make)(const Array&, const Settings&);
  /// Of a step, as declared: nanoseconds of a core of 3 GHz.
  double (*cost_ns)(const Array&, const Settings&);
  /// It wants to `look` at the whole run before its first step.
  bool (*looks_ahead)(const Settings&);
};

std::span<const Entry> algorithms();
/// nullptr: no algorithm has this name.
const Entry* find_algorithm(std::string_view name);
/// Throws Error(usage) with the nearest name.
const Entry& algorithm(std::string_view name);

}  // namespace libchar::fusion
