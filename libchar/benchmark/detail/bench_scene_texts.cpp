#include "libchar/benchmark/detail/bench_scene_texts.hpp"

namespace libchar {

std::vector<std::pair<std::string_view, std::string_view>> bench_scene_texts() {
  return {{"rv-3.3-uncalibrated.yaml", scene_rv_3_3_uncalibrated()},
          {"rv-3.3-calibrated.yaml", scene_rv_3_3_calibrated()},
          {"rv-5.1-fault-free.yaml", scene_rv_5_1_fault_free()},
          {"rv-5.1-faults.yaml", scene_rv_5_1_faults()},
          {"lever-arm.yaml", scene_lever_arm()},
          {"rv-2.5-tilt.yaml", scene_rv_2_5_tilt()}};
}

}  // namespace libchar
