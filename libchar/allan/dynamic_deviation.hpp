#pragma once
// The Allan deviation as it changes in time.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"

namespace libchar {

struct DynamicOptions {
  std::uint64_t window = 0;  ///< samples; at least 8
  std::uint64_t step = 0;    ///< samples between windows; 0: half a window
};

struct DynamicWindow {
  double from_s = 0, to_s = 0;  ///< after the first sample
  AllanCurve curve;             ///< no points where the window has too few samples
};

struct DynamicDeviation {
  DeviationType type = DeviationType::oadev;
  std::vector<DynamicWindow> windows;
  std::vector<std::string> notes;
};

/// L. Galleani, P. Tavella, "The dynamic Allan variance", IEEE Trans. UFFC 56 (2009) 450: the
/// deviation of each window of the record, which stands for its middle. Windows begin at 0, step, 2
/// step … while they fit. Throws Error(usage) for a window that is too short or longer than the
/// record, or more windows than a million; Error(numeric) when no window gives a point.
DynamicDeviation dynamic_deviation(std::span<const double> record,
                                   double dt_s,
                                   const DynamicOptions& dynamic,
                                   const AllanOptions& options = {});

}  // namespace libchar
