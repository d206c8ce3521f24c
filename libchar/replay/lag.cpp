#include "libchar/replay/lag.hpp"
namespace libchar { LagEstimate estimate_lag(std::span<const double>, std::span<const double>, double, double){return {0,1};} }
