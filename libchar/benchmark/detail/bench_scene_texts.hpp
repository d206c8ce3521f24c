#pragma once
// The built-in scenes: files of fixtures/scenes, embedded at build time.

#include <string_view>

namespace libchar {

std::string_view scene_rv_3_3_uncalibrated();
std::string_view scene_rv_3_3_calibrated();
std::string_view scene_rv_5_1_fault_free();
std::string_view scene_rv_5_1_faults();
std::string_view scene_lever_arm();
std::string_view scene_rv_2_5_tilt();

}  // namespace libchar
