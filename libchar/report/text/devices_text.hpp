#pragma once
// Cornered hats and dynamic deviations as tables and documents (docs/json.md).

#include <string>

#include "libchar/characterize/log_devices.hpp"
#include "libchar/core/document/json.hpp"

namespace libchar {

/// channel,unit,tau_s,deviation,variance,variance_sd,status,terms: a row a device and averaging time; no deviation where the variance is negative.
std::string hat_csv(const LogHat& hat);
Json hat_json(const LogHat& hat);

/// channel,unit,time_s,from_s,to_s,tau_s,deviation,terms: a row a window and averaging time; `time_s` is the window's middle.
std::string dynamic_csv(const LogDynamic& dynamic);
Json dynamic_json(const LogDynamic& dynamic);

}  // namespace libchar
