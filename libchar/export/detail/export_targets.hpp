#pragma once
// The writers of the targets, one file export_TARGET.cpp each. The table in exports.cpp has seen to
// it that the models which the target needs are there.

#include "libchar/export/exports.hpp"

namespace libchar {

Export export_kalibr(const SensorGroup&, const ExportOptions&);
Export export_euroc(const SensorGroup&, const ExportOptions&);
Export export_openvins(const SensorGroup&, const ExportOptions&);
Export export_orbslam3(const SensorGroup&, const ExportOptions&);
Export export_basalt(const SensorGroup&, const ExportOptions&);
Export export_vins(const SensorGroup&, const ExportOptions&);
Export export_gtsam(const SensorGroup&, const ExportOptions&);
Export export_ros(const SensorGroup&, const ExportOptions&);
Export export_sdf(const SensorGroup&, const ExportOptions&);
Export export_rotors(const SensorGroup&, const ExportOptions&);
Export export_airsim(const SensorGroup&, const ExportOptions&);
Export export_gnss_ins_sim(const SensorGroup&, const ExportOptions&);
Export export_matlab(const SensorGroup&, const ExportOptions&);
Export export_px4(const SensorGroup&, const ExportOptions&);
Export export_json(const SensorGroup&, const ExportOptions&);

}  // namespace libchar
