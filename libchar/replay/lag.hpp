#pragma once
#include <span>
namespace libchar {
struct LagEstimate { double lag_s; double correlation; };
LagEstimate estimate_lag(std::span<const double> sensor, std::span<const double> reference, double rate_hz, double most_s);
}
