#pragma once
// Detections of the faults that a scene knows, and further alarms.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libchar/fusion/fault_log.hpp"
#include "libchar/simulate/fault.hpp"

namespace libchar {

/// A stretch during which an algorithm had a sensor out.
struct FoundFault {
  std::uint64_t sensor = 0;
  std::string kind;  ///< the rule that raised it
  double from_s = 0;
  std::optional<double> to_s;  ///< none: out until the end
};

/// How an algorithm dealt with one of the faults that the scene knows.
struct FaultAnswer {
  std::uint64_t fault = 0;           ///< index into ReplayResult::faults
  std::optional<double> found_s;     ///< delay from the fault's beginning; none: never while it lasted
  std::optional<double> returned_s;  ///< delay from the fault's end until the sensor was used again
};

/// The stretches of a log of events. `sensors`: the sensor of each channel; empty: they are the same.
std::vector<FoundFault> found_faults(const fusion::FaultLog& log, const std::vector<std::size_t>& sensors,
                                     double start_s, double rate_hz);

namespace detail {

/// What an algorithm did about sensors that fail, and who led.
struct FaultsFound {
  /// A stretch during which another estimator than the baseline led.
  struct Lead {
    std::string lead;  ///< fusion::Lead
    double from_s = 0;
    std::optional<double> to_s;  ///< none: until the end
    std::string ended;           ///< why it ended, fusion::HandOverReason; empty: at the end of the run
  };

  bool watches_faults = false;  ///< it takes sensors out; `faults` and `answers` mean something
  std::vector<FoundFault> faults;
  std::uint64_t faults_not_kept = 0;
  std::vector<FaultAnswer> answers;
  std::vector<Lead> leads;       ///< of an algorithm with several estimators
  std::uint64_t hand_overs = 0;  ///< all of them
};

/// The stretches of a log of hand-overs.
std::vector<FaultsFound::Lead> lead_stretches(const fusion::HandOverLog& log, double start_s, double rate_hz);

}  // namespace detail

/// One for each known fault that lies within [start_s, end_s).
std::vector<FaultAnswer> answers_to(const std::vector<SensorFault>& known, const std::vector<FoundFault>& found,
                                    double start_s, double end_s);

/// How much was raised where no fault is known: a false alarm, as far as the scene knows.
std::size_t alarms_without_fault(const std::vector<SensorFault>& known, const std::vector<FoundFault>& found);

}  // namespace libchar
