#pragma once
// Rows of the parts of a replay's report.

#include "libchar/core/document/fields.hpp"
#include "libchar/replay/report/replay_report.hpp"

namespace libchar {

const Fields<ReplayReport::Stretch>& reported_run_fields();
const Fields<ReplayReport::Fault>& reported_fault_fields();
const Fields<FaultAnswer>& reported_answer_fields();
const Fields<SensorResult>& reported_sensor_fields();

}  // namespace libchar
