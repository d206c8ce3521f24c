#include "libchar/replay/noise_level.hpp"
namespace libchar { double sample_noise_variance(const SensorModel& m, double rate_hz, std::uint64_t){ return 1e-6*rate_hz+0*m.rate_hz; } }
