#pragma once
// Which method is recommended: not simply the smallest number.

#include <cstddef>
#include <optional>
#include <vector>

#include "libchar/replay/replay_result.hpp"

namespace libchar {

/// A method or a sensor that has a value at clearly fewer instants than others is not the best by that.
inline constexpr double kLeastAvailable = 0.9;

/// Several sensors have a part in its estimates; else it hands one of them on.
bool combines_sensors(const AlgorithmResult& algorithm);

/// Of the methods that ran (bounds apart), the one of the smallest error. Those within the practical tolerance of it
/// tie (without a reference, whose scores hold the noise of the sensor that is left out, those of equal score): a
/// mended form wins before the one as published, then the cheaper one by `costs` (declared, one an algorithm). A method
/// whose interval spans a decade is not chosen while there is another. `fusions`: only of those that combine sensors.
std::optional<std::size_t> choose_method(const ReplayResult& result, const std::vector<double>& costs,
                                         bool fusions = false);

/// Without scores: of the methods that ran, the highest of those that a failing sensor does not lead astray.
std::optional<std::size_t> choose_robust(const ReplayResult& result);

}  // namespace libchar
