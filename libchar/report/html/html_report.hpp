#pragma once
// The page of a characterization, as text: whoever calls writes it (whole_file.hpp).

#include <filesystem>
#include <string>
#include <vector>

#include "libchar/characterize/characterization_view.hpp"
#include "libchar/core/file/output_files.hpp"

namespace libchar {

/// One self-contained page: no network, opens from disk. The same bytes for the same characterization.
std::string html_report(const Characterization& result);
/// The same where its view and its document are there already.
std::string html_report(const CharacterizationView& view, const Json& without_times);

// The document of a characterization (docs/json.md).

/// {"format":"characterization","version":1, …, "fit": {"format":"noise-fit",…}} (docs/json.md).
Json json_report(const Characterization& result);
Json json_report(const CharacterizationView& view);
/// The document without "measured": all that a page shows, and the same bytes for the same characterization.
Json json_without_times(const CharacterizationView& view);
void add_times(Json& document, const Characterization& result);

// All files of a characterization.

/// report.html, report.json, curves.csv and a sensor model CHANNEL.sensor.yaml for each channel that
/// was fitted, with their paths in `folder`: what `write_outputs` takes.
std::vector<OutputFile> report_files(const CharacterizationView& view, const std::filesystem::path& folder);

}  // namespace libchar
