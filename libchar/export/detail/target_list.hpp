#pragma once
// The export targets, one line each in the order of the documentation: the line declares
// `ExportTarget NAME_target()` of targets/NAME.cpp and puts it into the table of targets.cpp.

#include "libchar/export/exports.hpp"

// clang-format off
#define LIBCHAR_EXPORT_TARGETS(TARGET) \
  TARGET(kalibr) \
  TARGET(euroc) \
  TARGET(openvins) \
  TARGET(orbslam3) \
  TARGET(basalt) \
  TARGET(vins) \
  TARGET(okvis) \
  TARGET(rovio) \
  TARGET(maplab) \
  TARGET(lio_sam) \
  TARGET(fast_lio) \
  TARGET(gtsam) \
  TARGET(ros) \
  TARGET(sdf) \
  TARGET(rotors) \
  TARGET(airsim) \
  TARGET(gnss_ins_sim) \
  TARGET(pegasus) \
  TARGET(carla) \
  TARGET(mujoco) \
  TARGET(webots) \
  TARGET(kf_gins) \
  TARGET(navego) \
  TARGET(matlab) \
  TARGET(px4) \
  TARGET(json)
// clang-format on

namespace libchar {

#define LIBCHAR_DECLARE_TARGET(NAME) ExportTarget NAME##_target();
LIBCHAR_EXPORT_TARGETS(LIBCHAR_DECLARE_TARGET)
#undef LIBCHAR_DECLARE_TARGET

}  // namespace libchar
