#pragma once
// All files of a characterization.

#include <filesystem>
#include <vector>

#include "libchar/characterize/characterization_view.hpp"
#include "libchar/core/file/output_files.hpp"

namespace libchar {

/// report.html, report.json, curves.csv and a sensor model CHANNEL.sensor.yaml for each channel that
/// was fitted, with their paths in `folder`: what `write_outputs` takes.
std::vector<OutputFile> report_files(const CharacterizationView& view,
                                     const std::filesystem::path& folder);

}  // namespace libchar
