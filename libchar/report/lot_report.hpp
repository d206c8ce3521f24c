#pragma once
// Several devices or axes side by side: what is written, shown and printed of them.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "libchar/characterize/lot.hpp"
#include "libchar/core/json.hpp"
#include "libchar/core/output_files.hpp"

namespace libchar {

struct LotReport {
  std::span<const Characterization> devices;
  const Lot* lot = nullptr;
  std::vector<std::string>
      folders;  ///< of each device's own report, relative to the page; "": none
  std::vector<std::string> command;
};

/// lot.html and lot.json.
std::vector<OutputFile> lot_files(const LotReport& report, const std::filesystem::path& folder);
Json lot_json(const LotReport& report);
std::string lot_html(const LotReport& report);
std::string lot_text(const LotReport& report, std::size_t width = 0);

}  // namespace libchar
