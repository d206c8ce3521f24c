#pragma once
// The recommended method of a replay with what it learnt, as one C99 file without the heap.

#include <cstddef>
#include <string>
#include <vector>

#include "libchar/replay/fusion_file.hpp"

namespace libchar::detail {

struct DeviceOptions {
  std::string algorithm;          ///< label; empty: the recommended one
  bool single = false;            ///< float instead of double
  std::string prefix = "fusion";  ///< of the names in the file
};

struct DeviceSource {
  std::string text;
  std::string algorithm;  ///< label
  std::size_t state_bytes = 0;
  double operations = 0;                  ///< of a step
  double cycles_m4f = 0, cycles_m33 = 0;  ///< estimates
  std::vector<std::string> notes;         ///< how it differs from the library's form
};

/// Throws Error(usage) where the method has no form in C, or where samples go through something that has none.
DeviceSource device_source(const LearntFusion& learnt, const DeviceOptions& options = {});

/// The algorithm of this label, the recommended one where it is empty. Throws Error(usage).
const LearntAlgorithm& algorithm_to_apply(const LearntFusion& learnt, const std::string& label);

}  // namespace libchar::detail
