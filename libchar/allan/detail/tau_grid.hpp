#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"

namespace libchar {

/// Ascending averaging factors of the grid that `options` asks for in a record of `samples` rate
/// samples. Listed times that the record is too short for are left out and noted. Throws
/// Error(usage) for a time that is not positive and finite.
std::vector<std::uint64_t> averaging_factors(const AllanOptions& options,
                                             double dt_s,
                                             std::uint64_t samples,
                                             std::vector<std::string>& notes);

}  // namespace libchar
