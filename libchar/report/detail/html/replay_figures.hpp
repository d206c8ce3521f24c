#pragma once
// The figures of a replay's page, in their sections; replay_page.js draws into them. "": nothing to
// draw.

#include <string>

#include "libchar/replay/view/replay_view.hpp"

namespace libchar {

/// The run over time: reference, best method, best single sensor, the error of both.
std::string run_section(const ReplayView& view);
/// Dots with whiskers, best first.
std::string ranking_figure(const ReplayView& view);
/// When which sensor was out, against the faults that the scene knows.
std::string faults_figure(const ReplayView& view);
/// Window RMS, weights, variances, Allan deviation of the error.
std::string time_section(const ReplayView& view);
/// Each sensor beside what fusing them gives.
std::string sensors_figure(const ReplayView& view);
/// Error against run time and memory; folded where the run time decides nothing.
std::string cost_section(const ReplayView& view);

}  // namespace libchar
